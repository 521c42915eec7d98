#pragma once

#include <tactnet/deployment/eight_bit/stream.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// The ranges of maps that steps in 8 bits read from `next`, in their order.
struct stream_observation {
    std::size_t frames;                              ///< of a recording
    std::vector<std::pair<double, double>> ranges{}; ///< the lowest and highest number of each map
    std::vector<std::size_t> halvings{};             ///< of each range, see halvings_of

    float out_of_range = 0; ///< a number of a map that is not finite or exceeds `most`, if there is one
    static constexpr float most = 1e30F;

    /// Appends the range of a map.
    void observe(const std::vector<float>& map) {
        for (const float number : map)
            if (!(std::abs(number) <= most))
                out_of_range = number;
        const auto [lowest, highest] = std::minmax_element(map.begin(), map.end());
        ranges.emplace_back(static_cast<double>(*lowest), static_cast<double>(*highest));
        halvings.push_back(halvings_of(map));
    }
    /// The largest n for which at most a hundredth of some numbers exceed the largest magnitude ÷ 2ⁿ.
    [[nodiscard]] [[gnu::cold]] static std::size_t halvings_of(std::span<const float> numbers) {
        constexpr std::size_t most_halvings = 24;
        float largest = 0;
        for (const float number : numbers)
            largest = std::max(largest, std::abs(number));
        std::size_t count = 0;
        for (; count < most_halvings && largest > 0; ++count) {
            largest /= 2;
            const auto beyond = std::count_if(numbers.begin(), numbers.end(),
                                              [&](float number) { return std::abs(number) > largest; });
            if (100 * static_cast<std::size_t>(beyond) > numbers.size())
                break;
        }
        return count;
    }
};

/// Runs the layer of a step in 8 bits in single precision, over whole recordings, frame after frame.
template <class Step>
struct stream_observer {
    [[nodiscard]] static std::vector<float> run(const float* values, const std::vector<float>& in,
                                                stream_observation& found) {
        using exact = typename Step::exact;
        constexpr std::size_t features = exact::features, outputs = exact::outputs;
        aligned_vector<float> packed(exact::packed_elements);
        exact::pack(values, packed.data());
        const std::size_t count = in.size() / features;
        std::vector<float> out(count * outputs);
        alignas(vector_alignment) std::array<float, kernels::padded_size<float>(features)> x{};
        alignas(vector_alignment) std::array<float, exact::map_elements> y;
        typename exact::state memory;
        for (std::size_t frame = 0; frame < count; ++frame) {
            if (frame % found.frames == 0)
                memory = {};
            std::copy_n(in.data() + frame * features, features, x.data());
            exact::run(packed.data(), x.data(), memory, y.data(), nullptr);
            std::copy_n(y.data(), outputs, out.data() + frame * outputs);
        }
        if constexpr (Step::observes_output)
            found.observe(out);
        return out;
    }
};
template <class... Steps>
struct stream_observer<stream_chain<Steps...>> {
    [[nodiscard]] static std::vector<float> run(const float* values, std::vector<float> map,
                                                stream_observation& found) {
        ((map = stream_observer<Steps>::run(values, map, found), values += Steps::parameters), ...);
        return map;
    }
};
template <class Format, class Main, class Skip>
struct stream_observer<residual_stream_step<Format, Main, Skip>> {
    [[nodiscard]] static std::vector<float> run(const float* values, const std::vector<float>& in,
                                                stream_observation& found) {
        std::vector<float> out = stream_observer<Main>::run(values, in, found);
        const std::vector<float> added = stream_observer<Skip>::run(values + Main::parameters, in, found);
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] += added[i];
        found.observe(out);
        return out;
    }
};

}}} // namespace tactnet::detail

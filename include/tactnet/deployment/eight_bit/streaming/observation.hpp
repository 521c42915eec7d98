#pragma once

#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// Runs layers of a stream in single precision over whole recordings, and finds the ranges of their outputs,
/// in the order in which steps in 8 bits read them.
struct stream_observation {
    std::size_t frames;                              ///< of a recording
    std::vector<std::pair<double, double>> ranges{}; ///< the lowest and highest number of each map

    float out_of_range = 0; ///< a number of a map that is not finite or exceeds `most`, if there is one
    static constexpr float most = 1e30F;

    /// Appends the range of a map.
    void observe(const std::vector<float>& map) {
        for (const float number : map)
            if (!(std::abs(number) <= most))
                out_of_range = number;
        const auto [lowest, highest] = std::minmax_element(map.begin(), map.end());
        ranges.emplace_back(static_cast<double>(*lowest), static_cast<double>(*highest));
    }
    /// The outputs of a step of a stream (deployment/streaming) for recordings, frame after frame.
    template <class Step, std::size_t Inputs, std::size_t Outputs>
    [[nodiscard]] std::vector<float> run(const float* values, const std::vector<float>& in) const {
        aligned_vector<float> packed(Step::packed_elements);
        Step::pack(values, packed.data());
        const std::size_t count = in.size() / Inputs;
        std::vector<float> out(count * Outputs);
        alignas(vector_alignment) std::array<float, kernels::padded_size<float>(Inputs)> x{};
        alignas(vector_alignment) std::array<float, kernels::padded_size<float>(Outputs)> y;
        typename Step::state memory;
        for (std::size_t frame = 0; frame < count; ++frame) {
            if (frame % frames == 0)
                memory = {};
            std::copy_n(in.data() + frame * Inputs, Inputs, x.data());
            Step::run(packed.data(), x.data(), memory, y.data());
            std::copy_n(y.data(), Outputs, out.data() + frame * Outputs);
        }
        return out;
    }
};

}}} // namespace tactnet::detail

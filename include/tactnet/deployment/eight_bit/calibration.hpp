#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/deployment/eight_bit/layout_of.hpp>
#include <tactnet/deployment/eight_bit/observed.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Finds the ranges of the maps of a network in 8 bits from images, which should be training images: never
/// those that it is judged by. First each map gets the range that its numbers had; then, map by map, the
/// fraction of that range is taken with which the outputs differ least, by the sum of their squares, from
/// those in single precision.
template <class Network>
class eight_bit_calibration {
    using float_plan = deployment_plan<Network, single_precision>;
    using byte_plan = deployment_plan<Network, eight_bit>;
    using floats = deployed<Network, single_precision>;
    using bytes = deployed<Network, eight_bit>;
    using observed = detail::observed_step<typename float_plan::step, typename byte_plan::step>;

public:
    static constexpr shape input_shape = Network::input_shape;
    static constexpr std::size_t maps = observed::maps, outputs = floats::outputs;
    /// Images beyond these change ranges too little to pay for the time.
    static constexpr std::size_t most_images = 256;

    /// The input is (count − mean) × scale. `frames` holds images one behind the other,
    /// [channel][row][column]; of more than `most_images`, images in even distances are taken. Throws
    /// std::invalid_argument unless there is at least one whole image, and if a form cannot be made of the
    /// network or the float form recognises an image as broken.
    template <class Count>
    eight_bit_calibration(const Network& network, std::span<const float, input_shape.size()> mean,
                          float scale, std::span<const Count> frames)
        : folded_(bytes::view_type::folded_elements), reference_(network, mean, scale) {
        const std::size_t count = frames.size() / input_shape.size();
        if (count == 0 || count * input_shape.size() != frames.size())
            throw std::invalid_argument("deploy: expected one or more calibration images of " +
                                        std::to_string(input_shape.size()) + " counts, found " +
                                        std::to_string(frames.size()) + " counts");
        const std::size_t used = std::min(count, most_images);
        for (std::size_t i = 0; i < used; ++i) {
            const std::span<const Count> image =
                frames.subspan(i * count / used * input_shape.size(), input_shape.size());
            images_.insert(images_.end(), image.begin(), image.end());
        }
        fold(network, mean, scale);
        observe();
        search();
        round_weights(folded_layout_of<typename bytes::view_type>(), folded_);
    }
    /// Of `deployed`, with these ranges; weights are whole multiples of their scales.
    [[nodiscard]] std::span<const float, bytes::view_type::folded_elements> folded() const {
        return std::span<const float, bytes::view_type::folded_elements>(folded_.data(), folded_.size());
    }
    /// The root of the mean square of what outputs differ by from those in single precision, on the images.
    [[nodiscard]] double output_error() const { return std::sqrt(error_); }

private:
    [[nodiscard]] std::size_t count() const { return images_.size() / input_shape.size(); }
    [[nodiscard]] auto image(std::size_t i) const {
        return tensor_view<const float, input_shape>(images_.data() + i * input_shape.size());
    }

    void fold(const Network& network, std::span<const float, input_shape.size()> mean, float scale) {
        float furthest = 255;
        for (std::size_t e = 0; e < images_.size(); ++e)
            furthest = std::max(furthest, std::abs(images_[e] - mean[e % input_shape.size()]));
        for (const float m : mean)
            furthest = std::max({furthest, std::abs(m), std::abs(255 - m)});
        // The most steps of which words hold this, a power of two.
        float steps = 128;
        while (steps * furthest > 32700 && steps > 1e-30f)
            steps /= 2;
        std::copy(mean.begin(), mean.end(), folded_.begin());
        folded_[input_shape.size()] = steps;
        folded_[input_shape.size() + 1] = 32700 / steps;
        input_ = {scale / steps, 0};
        byte_plan::fold(
            {network.learnable_values().data(), network.running_statistics().data(), network.epsilon},
            folded_.data() + bytes::view_type::steps_folded);
    }
    /// What each map held, and the outputs.
    void observe() {
        using view = typename floats::view_type;
        using entrance = frame_entrance<single_precision, input_shape>;
        const std::vector<float, aligned_allocator<float>> packed = [&] {
            std::vector<float, aligned_allocator<float>> numbers(view::packed_elements);
            view::pack(reference_.folded().data(), numbers.data());
            return numbers;
        }();
        const std::unique_ptr<typename view::scratch> memory(new typename view::scratch); // not zeroed
        float* const in = memory->elements.data();
        float* const out = in + entrance::map;
        constexpr std::size_t output_elements =
            frame_exit<single_precision, view::steps::output, view::steps::output_stride>::map;
        targets_.resize(count() * outputs);
        for (std::size_t i = 0; i < count(); ++i) {
            const std::span<float, outputs> to(targets_.data() + i * outputs, outputs);
            if (reference_(image(i), to, *memory) != frame_status::recognised)
                throw std::invalid_argument(
                    "deploy: expected calibration images that the network recognises, "
                    "found number " +
                    std::to_string(i) + " of those taken broken");
            (void)entrance::read(packed.data(), image(i).data(), in);
            observed::run(packed.data() + entrance::packed, in, out, out + output_elements, seen_.data());
        }
    }
    /// The largest fraction first, so that of equal ones it is kept.
    static constexpr std::array fractions{1.0, 0.95, 0.9, 0.85, 0.8, 0.7, 0.6, 0.5};

    void search() {
        std::array<double, maps> of_full;
        of_full.fill(1);
        error_ = error_with(of_full);
        for (int sweep = 0; sweep < 2; ++sweep)
            for (std::size_t m = 0; m < maps; ++m) {
                double best = of_full[m];
                for (const double fraction : fractions) {
                    std::array<double, maps> tried = of_full;
                    tried[m] = fraction;
                    if (const double error = error_with(tried); error < error_)
                        error_ = error, best = fraction;
                }
                of_full[m] = best;
            }
        set_ranges(of_full);
    }
    void set_ranges(const std::array<double, maps>& of_full) {
        std::array<map_range, maps> ranges;
        for (std::size_t m = 0; m < maps; ++m)
            ranges[m] = map_range::of(static_cast<double>(seen_[m].lowest) * of_full[m],
                                      static_cast<double>(seen_[m].highest) * of_full[m]);
        observed::set_ranges(folded_.data() + bytes::view_type::steps_folded, input_, {}, ranges.data());
    }
    /// The mean square of what outputs differ by.
    double error_with(const std::array<double, maps>& of_full) {
        set_ranges(of_full);
        const bytes network(folded());
        const std::unique_ptr<typename bytes::scratch> memory(new typename bytes::scratch); // not zeroed
        double sum = 0;
        for (std::size_t i = 0; i < count(); ++i) {
            std::array<float, outputs> found;
            if (network(image(i), found, *memory) != frame_status::recognised)
                return std::numeric_limits<double>::infinity();
            for (std::size_t o = 0; o < outputs; ++o) {
                const double difference =
                    static_cast<double>(found[o]) - static_cast<double>(targets_[i * outputs + o]);
                sum += difference * difference;
            }
        }
        return sum / static_cast<double>(count() * outputs);
    }

    std::vector<float> folded_, images_, targets_;
    floats reference_;
    std::array<detail::map_extremes, maps> seen_{};
    map_range input_;
    double error_ = 0;
};

} // namespace TACTNET_ARCH
} // namespace tactnet

#pragma once

#include <tactnet/quantisation/filter_rounding.hpp>
#include <tactnet/quantisation/node_executor.hpp>
#include <tactnet/quantisation/reference_operators.hpp>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace detail {

/// Of the pixels of images one behind the other, every how many-th is taken where `enough` of them do:
/// without a factor in common with the pixels of an image, so that each of these is met.
[[nodiscard]] inline std::size_t pixel_stride(std::size_t images, std::size_t pixels, std::size_t enough) {
    const std::size_t wanted = std::max<std::size_t>(images * pixels / enough, 1);
    for (std::size_t off = 0;; ++off) { // the nearest such number; 1 is one of them
        if (std::gcd(wanted + off, pixels) == 1)
            return wanted + off;
        if (std::gcd(wanted - off, pixels) == 1)
            return wanted - off;
    }
}

/// Gives a network rounded weights and biases that make up for rounding errors, step by step: those with
/// which sums, made of maps as 8 bits round them, come nearest to the exact ones. So each step also mends
/// what those before it have left. A filter keeps weights that are merely rounded where others do not come
/// nearer on every eighth image, which the fit does not see.
class weight_rounding {
public:
    /// One image in this many judges and takes no part in the fit. Chosen: an eighth costs the fit little.
    static constexpr std::size_t judges_every = 8;
    /// With fewer there is no judge, and weights stay as they are.
    static constexpr std::size_t fewest_images = judges_every;
    /// Of each image all maps are kept, exact and rounded: as many numbers as 128 MB hold.
    static constexpr std::size_t most_kept = (std::size_t{128} << 20) / sizeof(float);
    /// Convolutions with more are left as they are: memory and time grow with their square. Of this many,
    /// each of the three tables of products (of images that fit, of judges, and their covariance) takes 32
    /// MB.
    static constexpr std::size_t most_taps = 2048;
    /// Of a convolution as many pixels are looked at, or all. Derived: a covariance of as many numbers as it
    /// has taps needs several times as many samples. Measured as in filter_rounding, with 1024, 2048, 8192
    /// and 65536 in place of the second: outputs are off by 0.109, 0.105, 0.099, 0.101.
    static constexpr std::size_t pixels_of_tap = 8, fewest_pixels = 8192;
    /// Magnitudes that sums must bear: of a word of 16 bits, and of a byte without a sign.
    static constexpr double largest_word = 32768, largest_byte = 255;

    /// `exact`: folded numbers whose weights are not rounded, with ranges and scales. `images` lie one behind
    /// the other.
    [[gnu::cold]] weight_rounding(const calibration_graph& net, std::span<const map_range> ranges,
                                  std::span<const float> exact, float scale, std::span<const float> images)
        : net_(net),
          ranges_(ranges),
          exact_(exact),
          folded_(exact.size()),
          images_(std::min(images.size() / net.maps[0].size.size(),
                           std::max(most_kept / (2 * net.numbers), fewest_images))) {
        std::copy_n(exact.data(), exact.size(), folded_.data());
        if (images_ < fewest_images)
            return;
        exact_maps_ = std::vector<float>(images_ * net.numbers),
        rounded_maps_ = std::vector<float>(images_ * net.numbers);
        for (std::size_t i = 0; i < images_; ++i) {
            const shape input = net.maps[0].size;
            const float* const image = &images[i * (images.size() / input.size()) / images_ * input.size()];
            write_reference_input(input, exact, scale, image, false, exact_maps_.data() + i * net.numbers);
            write_reference_input(input, exact, scale, image, true, rounded_maps_.data() + i * net.numbers);
        }
        for (const graph_node& step : net.nodes) {
            const node_executor exactly(net, step, exact_, false);
            if (step.is_convolution() && step.taps() <= most_taps)
                fit(step, exactly);
            const node_executor roundly(net, step, folded_, true);
            const map_range& range = range_of(step.output);
            for (std::size_t i = 0; i < images_; ++i) {
                exactly(exact_maps_.data() + i * net.numbers, range);
                roundly(rounded_maps_.data() + i * net.numbers, range);
            }
        }
    }
    /// Of the network, with the weights that were found.
    [[nodiscard]] std::span<const float> folded() const { return folded_; }

private:
    [[nodiscard]] const map_range& range_of(std::size_t map) const {
        static constexpr map_range any;
        return net_.maps[map].range == calibration_graph::none ? any : ranges_[net_.maps[map].range];
    }

    [[gnu::cold]] void fit(const graph_node& step, const node_executor& exactly) {
        const std::size_t of_group = step.filters / step.groups;
        for (std::size_t group = 0; group < step.groups; ++group) {
            pixel_moments seen(step.taps(), of_group), judges(step.taps(), of_group);
            add_pixels(step, exactly, group, seen, judges);
            if (seen.empty() || judges.empty())
                continue;
            filter_rounding best(seen, step.taps());
            for (std::size_t f = 0; f < of_group; ++f)
                fit_filter(step, group * of_group + f, f, best, seen, judges);
        }
    }
    [[gnu::cold]] void fit_filter(const graph_node& step, std::size_t filter, std::size_t in_group,
                                  filter_rounding& best, const pixel_moments& seen,
                                  const pixel_moments& judges) {
        const std::size_t taps = step.taps(), all = step.filters * taps;
        float* const of_step = folded_.data() + step.folded;
        const std::span<float> weights(of_step + filter * taps, taps);
        float& bias = of_step[all + filter];
        const float scale = of_step[all + step.filters + filter];
        std::vector<float> rounded(taps), fitted(taps);
        for (std::size_t t = 0; t < taps; ++t)
            rounded[t] = static_cast<float>(quantised(weights[t], static_cast<double>(scale))) * scale;
        best(in_group, weights, scale, fitted);
        const auto fitted_bias = static_cast<float>(seen.best_bias(in_group, fitted));
        const step_ranges ranges{range_of(step.input), range_of(step.added), range_of(step.output)};
        const double largest_input = net_.maps[step.input].range == 0 ? largest_word : largest_byte;
        const bool fits = filter_of(fitted.data(), taps, static_cast<double>(fitted_bias), scale, ranges,
                                    step.adds, largest_input, 0)
                              .fits();
        if (!fits || !(judges.error(in_group, fitted, static_cast<double>(fitted_bias)) <
                       judges.error(in_group, rounded, static_cast<double>(bias))))
            return;
        std::copy(fitted.begin(), fitted.end(), weights.begin());
        bias = fitted_bias;
    }

    /// Of all images and pixels, or of some in even distances where many tell no more.
    void add_pixels(const graph_node& step, const node_executor& exactly, std::size_t group,
                    pixel_moments& seen, pixel_moments& judges) const {
        const std::size_t rows = step.window.output_rows(), columns = step.window.output_columns();
        const std::size_t every =
            pixel_stride(images_, rows * columns, std::max(pixels_of_tap * step.taps(), fewest_pixels));
        const std::size_t of_group = step.filters / step.groups;
        node_executor::sums sums = exactly.make_sums();
        std::vector<std::pair<std::size_t, float>> inputs(step.taps());
        std::vector<float> wanted(of_group);
        std::size_t pixel = 0;
        for (std::size_t i = 0; i < images_; ++i) {
            const float* const in = rounded_maps_.data() + i * net_.numbers;
            for (std::size_t y = 0; y < rows; ++y)
                for (std::size_t x = 0; x < columns; ++x) {
                    if (pixel++ % every != 0)
                        continue;
                    exactly.sums_at(exact_maps_.data() + i * net_.numbers, y, x, sums);
                    for (std::size_t f = 0; f < of_group; ++f) {
                        const std::size_t filter = group * of_group + f;
                        wanted[f] = sums[exactly.place_of(filter)];
                        if (step.adds) // the other map is what it is
                            wanted[f] -= in[net_.maps[step.added].begin +
                                            (y * columns + x) * net_.maps[step.added].size.channels + filter];
                    }
                    std::size_t found = 0;
                    exactly.for_each_tap(y, x, [&](std::size_t g, std::size_t tap, std::size_t place) {
                        const float value = in[net_.maps[step.input].begin + place];
                        if (g == group && value != 0)
                            inputs[found++] = {tap, value};
                    });
                    (i % judges_every == judges_every - 1 ? judges : seen)
                        .add(std::span(inputs.data(), found), wanted);
                }
        }
    }

    const calibration_graph& net_;
    std::span<const map_range> ranges_;
    std::span<const float> exact_;
    std::vector<float> folded_;
    std::size_t images_;
    std::vector<float> exact_maps_, rounded_maps_;
};

} // namespace detail
} // namespace TACTNET_ARCH
} // namespace tactnet

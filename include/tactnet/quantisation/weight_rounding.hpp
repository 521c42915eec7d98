#pragma once

#include <tactnet/quantisation/filter_rounding.hpp>
#include <tactnet/quantisation/node_executor.hpp>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// The stride over the pixels of consecutive images with which about `enough` pixels are used. It has no
/// common factor with the pixels of an image, so that it meets each of them.
[[nodiscard]] inline std::size_t pixel_stride(std::size_t images, std::size_t pixels, std::size_t enough) {
    const std::size_t wanted = std::max<std::size_t>(images * pixels / enough, 1);
    for (std::size_t off = 0;; ++off) { // the nearest such number; 1 is one of them
        if (std::gcd(wanted + off, pixels) == 1)
            return wanted + off;
        if (std::gcd(wanted - off, pixels) == 1)
            return wanted - off;
    }
}

/// Rounds weights and biases step by step so that they compensate for rounding errors: the sums over maps in
/// 8 bits come closest to the exact sums. So each step also compensates for the errors of the steps before
/// it. A filter keeps the nearest weights unless the fitted ones reduce the error on every eighth image,
/// which the fit does not use.
class weight_rounding {
public:
    /// One image in this many is held out for validation. Chosen: an eighth costs the fit little.
    static constexpr std::size_t held_out_every = 8;
    /// With fewer images none is held out, and weights are rounded to the nearest.
    static constexpr std::size_t fewest_images = held_out_every;
    /// All maps of each image are kept, exact and rounded, in at most 128 MB.
    static constexpr std::size_t max_kept = (std::size_t{128} << 20) / sizeof(float);
    /// Convolutions with more taps get the nearest weights: memory and time grow with the square of the taps.
    /// With this many, each of the three tables of products (of the fit, of the validation, and the
    /// covariance) takes 32 MB.
    static constexpr std::size_t max_taps = 2048;
    /// A convolution is fitted on this many pixels, or on all. Derived: a covariance over the taps needs
    /// several times as many samples as taps. Measured as in filter_rounding, with 1024, 2048, 8192 and 65536
    /// in place of the second: the error of outputs is 0.109, 0.105, 0.099, 0.101.
    static constexpr std::size_t pixels_of_tap = 8, fewest_pixels = 8192;

    /// `exact`: folded numbers with exact weights, with ranges and scales. `images` are consecutive.
    [[gnu::cold]] weight_rounding(const calibration_graph& net, std::span<const map_range> ranges,
                                  std::span<const float> exact, float scale, std::span<const float> images)
        : net_(net),
          ranges_(ranges),
          exact_(exact),
          folded_(exact.size()),
          images_(std::min(images.size() / net.maps[0].size.size(),
                           std::max(max_kept / (2 * net.numbers), fewest_images))) {
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
            const node_executor exact_run(net, step, exact_, false);
            if (step.convolution != nullptr && step.convolution->taps() <= max_taps)
                fit(step, exact_run.convolution());
            const node_executor rounded_run(net, step, folded_, true);
            const map_range range = net.range_of(step.output, ranges);
            for (std::size_t i = 0; i < images_; ++i) {
                exact_run.run(exact_maps_.data() + i * net.numbers, range);
                rounded_run.run(rounded_maps_.data() + i * net.numbers, range);
            }
        }
    }
    /// The folded numbers of the network with the weights found.
    [[nodiscard]] std::span<const float> folded() const { return folded_; }

private:
    [[gnu::cold]] void fit(const graph_node& step, const convolution_reference& exact) {
        const kernels::frame_convolution& kernel = *step.convolution;
        const std::size_t of_group = kernel.filters / kernel.groups, taps = kernel.taps();
        for (std::size_t group = 0; group < kernel.groups; ++group) {
            pixel_moments seen(taps, of_group), held_out(taps, of_group);
            add_pixels(step, exact, group, seen, held_out);
            if (seen.empty() || held_out.empty())
                continue;
            filter_rounding best(seen, taps);
            for (std::size_t f = 0; f < of_group; ++f)
                fit_filter(step, group * of_group + f, f, best, seen, held_out);
        }
    }
    [[gnu::cold]] void fit_filter(const graph_node& step, std::size_t filter, std::size_t in_group,
                                  filter_rounding& best, const pixel_moments& seen,
                                  const pixel_moments& held_out) {
        const kernels::frame_convolution& kernel = *step.convolution;
        const std::size_t taps = kernel.taps(), all = kernel.filters * taps;
        float* const of_step = folded_.data() + step.folded;
        const std::span<float> weights(of_step + filter * taps, taps);
        float& bias = of_step[all + filter];
        const float scale = of_step[all + kernel.filters + filter];
        std::vector<float> rounded(taps), fitted(taps);
        for (std::size_t t = 0; t < taps; ++t)
            rounded[t] = rounded_weight(weights[t], scale);
        best.round(in_group, weights, scale, fitted);
        const auto fitted_bias = static_cast<float>(seen.best_bias(in_group, fitted));
        const bool fits = filter_of(fitted.data(), taps, static_cast<double>(fitted_bias), scale,
                                    net_.ranges_of(step, ranges_), kernel.accumulates, step.largest_input, 0)
                              .fits();
        if (!fits || !(held_out.error(in_group, fitted, static_cast<double>(fitted_bias)) <
                       held_out.error(in_group, rounded, static_cast<double>(bias))))
            return;
        std::copy(fitted.begin(), fitted.end(), weights.begin());
        bias = fitted_bias;
    }

    /// Adds the pixels of all images, or evenly spaced ones where there are more than enough.
    void add_pixels(const graph_node& step, const convolution_reference& exact, std::size_t group,
                    pixel_moments& seen, pixel_moments& held_out) const {
        const kernels::frame_convolution& kernel = *step.convolution;
        const std::size_t rows = kernel.window.output_rows(), columns = kernel.window.output_columns();
        const std::size_t every =
            pixel_stride(images_, rows * columns, std::max(pixels_of_tap * kernel.taps(), fewest_pixels));
        const std::size_t of_group = kernel.filters / kernel.groups;
        convolution_reference::sums sums = exact.make_sums();
        std::vector<std::pair<std::size_t, float>> inputs(kernel.taps());
        std::vector<float> wanted(of_group);
        std::size_t pixel = 0;
        for (std::size_t i = 0; i < images_; ++i) {
            const float *const maps = exact_maps_.data() + i * net_.numbers,
                               *const rounded_maps = rounded_maps_.data() + i * net_.numbers,
                               *const in = net_.map(rounded_maps, step.input),
                               *const added = net_.map(rounded_maps, step.added);
            for (std::size_t y = 0; y < rows; ++y)
                for (std::size_t x = 0; x < columns; ++x) {
                    if (pixel++ % every != 0)
                        continue;
                    exact.sums_at(net_.map(maps, step.input), net_.map(maps, step.added), y, x, sums);
                    for (std::size_t f = 0; f < of_group; ++f) {
                        const std::size_t filter = group * of_group + f;
                        wanted[f] = sums[exact.place_of(filter)];
                        if (kernel.accumulates) // the other map is what it is
                            wanted[f] -= added[(y * columns + x) * kernel.filters + filter];
                    }
                    std::size_t found = 0;
                    exact.for_each_tap(y, x, [&](std::size_t g, std::size_t tap, std::size_t place) {
                        const float value = in[place];
                        if (g == group && value != 0)
                            inputs[found++] = {tap, value};
                    });
                    (i % held_out_every == held_out_every - 1 ? held_out : seen)
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

}}} // namespace tactnet::detail

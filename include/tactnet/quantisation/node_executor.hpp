#pragma once

#include <tactnet/kernels/rows/operations.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/operators/activations/function.hpp>
#include <tactnet/quantisation/graph.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>

// The operators of the calibration graph, as plain loops in single precision; node_executor has convolutions
// and executes any node, exact or with every number rounded to 8 bits.

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// Writes the first map of an image, exact or rounded to words. The folded numbers begin with the mean and
/// the steps per count of the words; the input is (count − mean) × scale.
[[gnu::cold]] inline void write_reference_input(const shape& input, std::span<const float> folded,
                                                float scale, const float* image, bool rounded, float* to) {
    const float steps = folded[input.size()];
    for (std::size_t e = 0; e < input.size(); ++e) {
        const std::size_t channel = e / input.area(), pixel = e % input.area();
        const float mean = folded[e];
        to[pixel * input.channels + channel] =
            rounded ? (std::nearbyint(image[e] * steps) - std::nearbyint(mean * steps)) * (scale / steps)
                    : (image[e] - mean) * scale;
    }
}

[[gnu::cold]] inline void reference_norm(const graph_node& step, const float* folded, const float* in,
                                         float* out) {
    const std::size_t channels = step.from.channels;
    for (std::size_t e = 0; e < step.from.size(); ++e) {
        out[e] = folded[e % channels] * in[e] + folded[channels + e % channels];
        if (step.relu)
            out[e] = std::max(out[e], 0.0f);
    }
}
template <class Function>
[[gnu::cold]] void reference_activation(const graph_node& step, const float*, const float* in, float* out) {
    using number = std::conditional_t<takes_vectors<Function>, double, float>;
    for (std::size_t e = 0; e < step.from.size(); ++e)
        out[e] = static_cast<float>(Function::value(static_cast<number>(in[e])));
}
[[gnu::cold]] inline void reference_square_root(const graph_node& step, const float*, const float* in,
                                                float* out) {
    for (std::size_t e = 0; e < step.from.size(); ++e)
        out[e] = static_cast<float>(std::sqrt(std::max(static_cast<double>(in[e]), 0.0) + step.offset) -
                                    std::sqrt(step.offset));
}
[[gnu::cold]] inline void reference_max_pool(const graph_node& step, const float*, const float* in,
                                             float* out) {
    const sliding_window& w = step.window;
    const shape from = step.from, to = step.to;
    const auto pixels = [](std::size_t index, std::size_t kernel, std::size_t stride, std::size_t before,
                           std::size_t size) {
        const std::size_t begin = index * stride;
        return std::pair(std::max(begin, before) - before, std::min(begin + kernel - before, size));
    };
    for (std::size_t e = 0; e < to.size(); ++e) {
        const std::size_t pixel = e / to.channels, c = e % to.channels;
        const auto [top, bottom] = pixels(pixel / to.columns, w.kernel.rows, w.stride.rows, w.top, from.rows);
        const auto [left, right] =
            pixels(pixel % to.columns, w.kernel.columns, w.stride.columns, w.left, from.columns);
        out[e] = -std::numeric_limits<float>::infinity();
        for (std::size_t y = top; y < bottom; ++y)
            for (std::size_t x = left; x < right; ++x)
                out[e] = std::max(out[e], in[(y * from.columns + x) * from.channels + c]);
    }
}
[[gnu::cold]] inline void reference_average_pool(const graph_node& step, const float*, const float* in,
                                                 float* out) {
    const shape from = step.from;
    step.means.for_each([&](std::size_t o, pixel_range rows, pixel_range columns, std::size_t divisor) {
        for (std::size_t c = 0; c < from.channels; ++c) {
            float sum = 0;
            for (std::size_t y = rows.begin; y < rows.end; ++y)
                for (std::size_t x = columns.begin; x < columns.end; ++x)
                    sum += in[(y * from.columns + x) * from.channels + c];
            out[o * from.channels + c] = sum / static_cast<float>(divisor);
        }
    });
}
/// The operator of a step with a function `reference`.
template <class Step>
void reference_own_step(const graph_node&, const float* folded, const float* in, float* out) {
    Step::reference(folded, in, out);
}
[[gnu::cold]] inline void reference_softmax(std::span<float> numbers) {
    kernels::softmax_of<float>(numbers, numbers);
}

/// A step with its weights in the order of use.
class node_executor {
public:
    /// The sums of one pixel, one per filter.
    using sums = aligned_vector<float>;

    /// `folded`: all folded numbers of the network. `rounded`: weights and outputs are rounded to 8 bits,
    /// with the ranges and scales among the folded numbers.
    [[gnu::cold]] node_executor(const calibration_graph& net, const graph_node& step,
                                std::span<const float> folded, bool rounded)
        : net_(net),
          step_(step),
          of_step_(folded.data() + step.folded),
          rounded_(rounded && net.maps[step.output].range != calibration_graph::none) {
        if (step.is_convolution())
            order_weights(rounded);
    }

    /// Reads maps of an image and writes one of them, whose range is `output`.
    [[gnu::cold]] void run(float* maps, const map_range& output) const {
        const float* const in = maps + net_.maps[step_.input].begin;
        float* const out = maps + net_.maps[step_.output].begin;
        const shape to = step_.to;
        if (step_.is_convolution())
            convolve(maps, out, to);
        else if (step_.multiplies)
            multiply(in, maps + net_.maps[step_.added].begin, out, to);
        else
            step_.reference(step_, of_step_, in, out);
        if (rounded_)
            for (std::size_t pixel = 0; pixel < to.area(); ++pixel)
                for (std::size_t c = 0; c < (step_.is_convolution() ? step_.filters : to.channels); ++c) {
                    float& number = out[pixel * to.channels + step_.first + c];
                    number = nearest(number, output);
                }
    }

    /// The sums of a convolution at one pixel, with the bias and the map that it adds to.
    [[gnu::noinline]] void sums_at(const float* maps, std::size_t y, std::size_t x, sums& to) const {
        const feature_map& from = net_.maps[step_.input];
        const std::size_t in_group = padded_ * step_.taps();
        std::copy(biases_.begin(), biases_.end(), to.begin());
        for_each_tap(y, x, [&](std::size_t group, std::size_t tap, std::size_t place) {
            const float value = maps[from.begin + place];
            if (value == 0)
                return;
            const kernels::vector<float> all(value);
            const float* const weights = &weights_[group * in_group + tap * padded_];
            float* const sum = &to[group * padded_];
            for (std::size_t f = 0; f < padded_; f += kernels::lanes<float>)
                kernels::store(sum + f, kernels::multiply_add<float>(all, kernels::load(weights + f),
                                                                     kernels::load<float>(sum + f)));
        });
        if (!step_.accumulates)
            return;
        const feature_map& added = net_.maps[step_.added];
        for (std::size_t f = 0; f < step_.filters; ++f)
            to[place_of(f)] +=
                maps[added.begin + (y * step_.window.output_columns() + x) * added.size.channels + f];
    }
    /// The index of the sum of a filter.
    [[nodiscard]] std::size_t place_of(std::size_t filter) const {
        const std::size_t of_group = step_.filters / step_.groups;
        return filter / of_group * padded_ + filter % of_group;
    }
    [[nodiscard]] sums make_sums() const { return sums(step_.groups * padded_); }
    /// body(group, tap of a filter, place in the map) for every tap that falls on a pixel.
    template <class Body>
    void for_each_tap(std::size_t y, std::size_t x, Body&& body) const {
        const sliding_window& w = step_.window;
        const std::size_t of_group = w.input.channels / step_.groups;
        for (std::size_t i = 0; i < w.kernel.rows; ++i)
            for (std::size_t j = 0; j < w.kernel.columns; ++j) {
                const std::size_t row = y * w.stride.rows + i - w.top, // wraps round before the image
                    column = x * w.stride.columns + j - w.left;
                if (row >= w.input.rows || column >= w.input.columns)
                    continue;
                const std::size_t pixel = (row * w.input.columns + column) * w.input.channels;
                for (std::size_t c = 0; c < w.input.channels; ++c)
                    body(c / of_group, c % of_group * w.kernel.area() + i * w.kernel.columns + j, pixel + c);
            }
    }

private:
    [[nodiscard]] float relu(float value) const { return step_.relu ? std::max(value, 0.0f) : value; }
    /// A number rounded to a byte of the range.
    [[nodiscard]] static float nearest(float value, const map_range& range) {
        constexpr float largest_byte = 255;
        return (std::clamp(std::nearbyint(value / range.scale) + range.zero_point, 0.0f, largest_byte) -
                range.zero_point) *
               range.scale;
    }
    [[gnu::cold]] void order_weights(bool as_bytes) {
        const std::size_t taps = step_.taps(), all = step_.filters * taps;
        padded_ = kernels::padded_size<float>(step_.filters / step_.groups);
        weights_ = aligned_vector<float>(step_.groups * taps * padded_);
        biases_ = aligned_vector<float>(step_.groups * padded_);
        for (std::size_t f = 0; f < step_.filters; ++f) {
            const float scale = of_step_[all + step_.filters + f];
            const std::size_t place = place_of(f), group = place / padded_;
            biases_[place] = of_step_[all + f];
            for (std::size_t t = 0; t < taps; ++t) {
                const float weight = of_step_[f * taps + t];
                weights_[(group * taps + t) * padded_ + place % padded_] =
                    as_bytes ? static_cast<float>(quantised(weight, static_cast<double>(scale))) * scale
                             : weight;
            }
        }
    }
    [[gnu::cold]] static void multiply(const float* in, const float* factors, float* out, shape map) {
        for (std::size_t e = 0; e < map.size(); ++e)
            out[e] = in[e] * factors[e % map.channels];
    }
    [[gnu::cold]] void convolve(const float* maps, float* out, shape to) const {
        const std::size_t rows = step_.window.output_rows(), columns = step_.window.output_columns();
        sums here = make_sums(), most = make_sums();
        for (std::size_t pixel = 0; pixel < to.area(); ++pixel) {
            const std::size_t top = pixel / to.columns * step_.pool.rows,
                              left = pixel % to.columns * step_.pool.columns;
            std::fill(most.begin(), most.end(), -std::numeric_limits<float>::infinity());
            for (std::size_t y = top; y < std::min(top + step_.pool.rows, rows); ++y)
                for (std::size_t x = left; x < std::min(left + step_.pool.columns, columns); ++x) {
                    sums_at(maps, y, x, here);
                    for (std::size_t i = 0; i < most.size(); ++i)
                        most[i] = std::max(most[i], here[i]);
                }
            for (std::size_t f = 0; f < step_.filters; ++f)
                out[pixel * to.channels + step_.first + f] = relu(most[place_of(f)]);
        }
    }

    const calibration_graph& net_;
    const graph_node& step_;
    const float* of_step_;
    bool rounded_;
    std::size_t padded_ = 0;                 ///< filters of a group, rounded up to whole vectors
    aligned_vector<float> weights_, biases_; ///< [group][tap][filter], [group][filter]
};

}}} // namespace tactnet::detail

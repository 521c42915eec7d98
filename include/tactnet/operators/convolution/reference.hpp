#pragma once

#include <tactnet/kernels/frame_convolution.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <cstddef>
#include <limits>

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// A convolution or a dense layer in single precision, for calibration: compiled once for all. Maps have no
/// gaps between pixels.
class convolution_reference {
public:
    /// The sums of one pixel, one per filter.
    using sums = aligned_vector<float>;

    /// Reads the folded numbers of the step; `rounded`: weights as bytes times the scale of their filter.
    [[gnu::cold]] convolution_reference(const kernels::frame_convolution& kernel, const float* folded,
                                        bool rounded)
        : kernel_(kernel),
          padded_(kernels::padded_size<float>(kernel.filters / kernel.groups)),
          weights_(kernel.groups * kernel.taps() * padded_),
          biases_(kernel.groups * padded_) {
        const std::size_t taps = kernel.taps(), all = kernel.filters * taps;
        for (std::size_t f = 0; f < kernel.filters; ++f) {
            const float scale = folded[all + kernel.filters + f];
            const std::size_t place = place_of(f), group = place / padded_;
            biases_[place] = folded[all + f];
            for (std::size_t t = 0; t < taps; ++t) {
                const float weight = folded[f * taps + t];
                weights_[(group * taps + t) * padded_ + place % padded_] =
                    rounded ? rounded_weight(weight, scale) : weight;
            }
        }
    }
    /// The index of the sum of a filter.
    [[nodiscard]] std::size_t place_of(std::size_t filter) const {
        const std::size_t of_group = kernel_.filters / kernel_.groups;
        return filter / of_group * padded_ + filter % of_group;
    }
    [[nodiscard]] sums make_sums() const { return sums(kernel_.groups * padded_); }

    /// The sums at one pixel, with the bias and the map that it adds to, if it accumulates.
    [[gnu::noinline]] void sums_at(const float* in, const float* added, std::size_t y, std::size_t x,
                                   sums& to) const {
        const std::size_t in_group = padded_ * kernel_.taps();
        std::copy(biases_.begin(), biases_.end(), to.begin());
        for_each_tap(y, x, [&](std::size_t group, std::size_t tap, std::size_t place) {
            const float value = in[place];
            if (value == 0)
                return;
            const kernels::vector<float> all(value);
            const float* const weights = &weights_[group * in_group + tap * padded_];
            float* const sum = &to[group * padded_];
            for (std::size_t f = 0; f < padded_; f += kernels::lanes<float>)
                kernels::store(sum + f, kernels::multiply_add<float>(all, kernels::load(weights + f),
                                                                     kernels::load<float>(sum + f)));
        });
        if (kernel_.accumulates)
            for (std::size_t f = 0; f < kernel_.filters; ++f)
                to[place_of(f)] += added[(y * kernel_.window.output_columns() + x) * kernel_.filters + f];
    }
    /// body(group, tap of a filter, place in the map) for every tap that falls on a pixel.
    template <class Body>
    void for_each_tap(std::size_t y, std::size_t x, Body&& body) const {
        const sliding_window& w = kernel_.window;
        const std::size_t of_group = w.input.channels / kernel_.groups;
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
    /// Writes its channels of a map of this shape.
    [[gnu::cold]] void run(const float* in, const float* added, float* out, const shape& map) const {
        const std::size_t rows = kernel_.window.output_rows(), columns = kernel_.window.output_columns();
        sums here = make_sums(), most = make_sums();
        for (std::size_t pixel = 0; pixel < map.area(); ++pixel) {
            const std::size_t top = pixel / map.columns * kernel_.pool.rows,
                              left = pixel % map.columns * kernel_.pool.columns;
            std::fill(most.begin(), most.end(), -std::numeric_limits<float>::infinity());
            for (std::size_t y = top; y < std::min(top + kernel_.pool.rows, rows); ++y)
                for (std::size_t x = left; x < std::min(left + kernel_.pool.columns, columns); ++x) {
                    sums_at(in, added, y, x, here);
                    for (std::size_t i = 0; i < most.size(); ++i)
                        most[i] = std::max(most[i], here[i]);
                }
            for (std::size_t f = 0; f < kernel_.filters; ++f) {
                const float sum = most[place_of(f)];
                out[pixel * map.channels + kernel_.map_offset + f] =
                    kernel_.rectifies() ? std::max(sum, 0.0f) : sum;
            }
        }
    }

private:
    const kernels::frame_convolution& kernel_;
    std::size_t padded_;                     ///< filters of a group, rounded up to whole vectors
    aligned_vector<float> weights_, biases_; ///< [group][tap][filter], [group][filter]
};

}}} // namespace tactnet::detail

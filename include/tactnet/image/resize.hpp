#pragma once

#include <tactnet/image/resize_kernel.hpp>
#include <tactnet/kernels/map/resample.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

// Resize between sizes known at compile time, with constant weights and without heap. For sizes known only at
// run time, see dynamic_resize.hpp.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

template <class Kernel, shape From, shape To>
struct resize_plan {
    static_assert(From.size() > 0 && To.size() > 0,
                  "resize: there must be at least one row, one column and one channel on both sides");
    static_assert(From.channels == To.channels,
                  "resize: channels are resized one by one, and must be as many on both sides");

    using down = resize_axis<Kernel, From.rows, To.rows>;
    using along = resize_axis<Kernel, From.columns, To.columns>;

    // The pass that reduces the work of the other comes first.
    static constexpr std::size_t down_cost(std::size_t columns) {
        return To.rows * down::taps * kernels::row_vectors(columns, kernels::row_lanes<float>(columns)) *
               (kernels::row_lanes<float>(columns) * sizeof(float) == 64 ? 2 : 1);
    }
    static constexpr std::size_t along_cost(std::size_t rows) {
        return rows * kernels::cheapest_bands<along>::cost;
    }
    static constexpr bool down_first =
        down_cost(From.columns) + along_cost(To.rows) <= along_cost(From.rows) + down_cost(To.columns);

    // Vector loads read beyond shorter rows.
    static constexpr bool readable = From.columns >= kernels::min_lanes<float>;

    static void run(const float* from, float* to) {
        // Vectors also multiply inputs by weights of zero. That is harmless if all inputs are finite and not
        // too large, or if all outputs are.
        constexpr bool has_gaps = down::has_gaps || along::has_gaps || kernels::lanes<float> != 1;
        if constexpr (!has_gaps) {
            run<false>(from, to);
        } else if constexpr (From.area() <= To.area()) {
            if (kernels::all_addable<From.area()>(from))
                run<false>(from, to);
            else
                run<true>(from, to);
        } else {
            run<false>(from, to);
            if (!kernels::all_addable<To.area()>(to))
                run<true>(from, to);
        }
    }
    template <bool Guarded>
    static void run(const float* from, float* to) {
        if constexpr (down_first) {
            alignas(vector_alignment) std::array<float, To.rows * From.columns> middle;
            kernels::resample_down<down, From.columns, From.columns, From.columns, Guarded>(from,
                                                                                            middle.data());
            kernels::resample_along<along, To.rows, From.columns, To.columns, Guarded>(middle.data(), to);
        } else {
            constexpr std::size_t stride = kernels::padded_size<float>(To.columns);
            alignas(vector_alignment) std::array<float, From.rows * stride> middle;
            if constexpr (To.columns < kernels::min_lanes<float>) // vectors read the whole stride
                middle.fill(0);
            kernels::resample_along<along, From.rows, From.columns, stride, Guarded>(from, middle.data());
            kernels::resample_down<down, To.columns, stride, To.columns, Guarded>(middle.data(), to);
        }
    }
    template <class Count>
    static void run_channels(const Count* from, float* to) {
        for (std::size_t channel = 0; channel < From.channels; ++channel) {
            const Count* const source = from + channel * From.area();
            float* const result = to + channel * To.area();
            if constexpr (std::is_same_v<Count, float> && readable) {
                run(source, result);
            } else {
                alignas(vector_alignment) std::array<float, From.area() + kernels::lanes<float>> numbers{};
                for (std::size_t e = 0; e < From.area(); ++e)
                    numbers[e] = static_cast<float>(source[e]);
                run(numbers.data(), result);
            }
        }
    }
};

} // namespace detail

/// Resizes an image of counts or floats, channel by channel. `Kernel` is `keys_cubic<…>` or lagrange_cubic.
/// The result may overshoot the range of the input. NaN and infinity only reach outputs that give them a
/// nonzero weight. Uses the stack for `From` and one pass of the result.
template <shape From, shape To, class Kernel = keys_cubic<>>
void resize(tensor_view<const float, From> from, tensor_view<float, To> to) {
    detail::resize_plan<Kernel, From, To>::run_channels(from.data(), to.data());
}
/// Resizes an image of 8-bit counts.
template <shape From, shape To, class Kernel = keys_cubic<>>
void resize(tensor_view<const std::uint8_t, From> from, tensor_view<float, To> to) {
    detail::resize_plan<Kernel, From, To>::run_channels(from.data(), to.data());
}

/// Clamps a number to 0 … 255 and rounds it; NaN becomes 0.
[[nodiscard]] constexpr std::uint8_t saturate_to_count(float value) {
    const float kept = value > 0 ? (value < 255 ? value : 255) : 0;
    return static_cast<std::uint8_t>(kept + 0.5f);
}

/// Resizes an image to counts, rounded and clamped to 0 … 255.
template <shape From, shape To, class Kernel = keys_cubic<>, class Count>
    requires std::is_convertible_v<Count, tensor_view<const std::uint8_t, From>> ||
             std::is_convertible_v<Count, tensor_view<const float, From>>
void resize(const Count& from, tensor_view<std::uint8_t, To> to) {
    tensor<float, To> exact;
    resize<From, To, Kernel>(from, exact.view());
    for (std::size_t e = 0; e < To.size(); ++e)
        to.data()[e] = saturate_to_count(exact.data()[e]);
}

// Resize between sizes known only at run time, such as those of image files, in double precision.

/// The taps of all outputs of a size known at run time, in double precision.
template <class Kernel>
class dynamic_axis {
public:
    using output = detail::resize_taps<std::vector<double>>;

    dynamic_axis(std::size_t from, std::size_t to) : table_(to) {
        for (std::size_t o = 0; o < to; ++o) {
            table_[o].weights.resize(detail::max_taps(from, to));
            detail::find_taps<Kernel>(o, from, to, table_[o]);
        }
    }
    [[nodiscard]] const output& operator[](std::size_t index) const { return table_[index]; }
    [[nodiscard]] std::size_t size() const { return table_.size(); }

private:
    std::vector<output> table_;
};

namespace detail {

template <class Kernel, class Count>
[[nodiscard]] std::vector<double> resize_exactly(std::span<const Count> image, std::size_t rows,
                                                 std::size_t columns, std::size_t new_rows,
                                                 std::size_t new_columns) {
    if (rows == 0 || columns == 0 || new_rows == 0 || new_columns == 0 || image.size() / rows != columns ||
        image.size() % rows != 0)
        throw std::invalid_argument("resize_bicubic: expected non-empty images and rows × columns pixels");
    // Products of sizes below this do not wrap around.
    constexpr std::size_t max_pixels = std::numeric_limits<std::size_t>::max() / sizeof(double) / 64;
    if (new_columns > max_pixels / new_rows || columns > max_pixels / new_rows)
        throw std::length_error("resize_bicubic: expected an image that fits into memory");
    const dynamic_axis<Kernel> down(rows, new_rows), along(columns, new_columns);
    std::vector<double> middle(new_rows * columns), result(new_rows * new_columns);
    for (std::size_t y = 0; y < new_rows; ++y)
        down[y].for_each([&](std::size_t row, double weight) {
            for (std::size_t x = 0; x < columns; ++x)
                middle[y * columns + x] += weight * static_cast<double>(image[row * columns + x]);
        });
    for (std::size_t y = 0; y < new_rows; ++y)
        for (std::size_t x = 0; x < new_columns; ++x)
            along[x].for_each([&](std::size_t column, double weight) {
                result[y * new_columns + x] += weight * middle[y * columns + column];
            });
    return result;
}

} // namespace detail

/// Resizes a row-major 8-bit image, rounded and clamped to 0 … 255. `Kernel` is as in resize. Throws
/// std::invalid_argument if an image is empty or its size does not match the pixels, and std::length_error or
/// std::bad_alloc if the new one does not fit into memory.
template <class Kernel = keys_cubic<>>
[[nodiscard]] std::vector<std::uint8_t> resize_bicubic(std::span<const std::uint8_t> image, std::size_t rows,
                                                       std::size_t columns, std::size_t new_rows,
                                                       std::size_t new_columns) {
    const auto exact = detail::resize_exactly<Kernel>(image, rows, columns, new_rows, new_columns);
    std::vector<std::uint8_t> result(exact.size());
    std::transform(exact.begin(), exact.end(), result.begin(), [](double value) {
        return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
    });
    return result;
}
/// Resizes a row-major image of floats, without clamping.
template <class Kernel = keys_cubic<>>
[[nodiscard]] std::vector<float> resize_bicubic(std::span<const float> image, std::size_t rows,
                                                std::size_t columns, std::size_t new_rows,
                                                std::size_t new_columns) {
    const auto exact = detail::resize_exactly<Kernel>(image, rows, columns, new_rows, new_columns);
    return {exact.begin(), exact.end()};
}

}} // namespace tactnet

#pragma once

#include <tactnet/deployment/eight_bit/format.hpp>
#include <tactnet/deployment/steps/pooling.hpp>
#include <tactnet/kernels/integer/vector.hpp>
#include <tactnet/tensor/pooling_windows.hpp>

#include <cstddef>
#include <cstdint>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A max pool in 8 bits: the largest byte stands for the largest number.
template <sliding_window Window, std::size_t Stride>
struct pool_step<eight_bit, Window, Stride>
    : step_without_parameters<
          eight_bit, shape{Window.output_rows(), Window.output_columns(), Window.input.channels}, Stride> {
    static void run(const std::int8_t*, const std::uint8_t* in, std::uint8_t* out, std::uint8_t*) noexcept {
        constexpr std::size_t width = kernels::widest_bytes(Stride);
        using bytes = kernels::uint8_vec<width>;
        for_each_window<Window>([&](std::size_t o, pixel_range rows, pixel_range columns) {
            for (std::size_t channel = 0; channel < Stride; channel += width) {
                bytes largest{};
                for (std::size_t y = rows.begin; y < rows.end; ++y)
                    for (std::size_t x = columns.begin; x < columns.end; ++x) {
                        const auto here =
                            kernels::load_any<bytes>(in + (y * Window.input.columns + x) * Stride + channel);
                        largest = here > largest ? here : largest;
                    }
                kernels::store_any(out + o * Stride + channel, largest);
            }
        });
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet

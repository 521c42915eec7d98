#pragma once

#include <tactnet/kernels/integer/convolution/methods.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/operators/convolution/step.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A convolution in 8 bits with its epilogue, by the method of least cost.
template <class Input, class Output, kernels::frame_convolution Kernel>
struct convolution_step<eight_bit_between<Input, Output>, Kernel>
    : step_base<eight_bit, shape{Kernel.output_rows(), Kernel.output_columns(), Kernel.filters},
                Kernel.output_stride()> {
    static_assert(!Kernel.activation->exists || Kernel.rectifies(),
                  "convolution_step: in 8 bits, other activation functions than ReLU are steps of their own");
    static constexpr kernels::frame_convolution kernel = Kernel;
    static constexpr bool fills_map = Kernel.map_stride == 0;
    static constexpr std::size_t weights = Kernel.filters * Kernel.taps();
    static constexpr bool writes_bytes = std::is_same_v<Output, std::uint8_t>;
    static constexpr std::size_t number_elements = sizeof(Output); ///< bytes per number that it writes
    static constexpr folded_arrays arrays{{"weight",
                                           folded_kind::weights,
                                           {Kernel.filters, Kernel.window.input.channels / Kernel.groups,
                                            Kernel.window.kernel.rows, Kernel.window.kernel.columns}},
                                          {"bias", folded_kind::numbers, {Kernel.filters}},
                                          {"scale", folded_kind::scales, {Kernel.filters}},
                                          range_of_input,
                                          Kernel.accumulates ? range_of_added : folded_array{},
                                          writes_bytes ? range_of_output : folded_array{}};
    static constexpr std::size_t folded_elements = arrays.numbers();
    static constexpr double largest_input = std::is_same_v<Input, std::uint8_t> ? 255 : 32768;

private:
    static constexpr std::size_t biases = weights, weight_scales = biases + Kernel.filters;
    static_assert(Kernel.ungrouped().fits_map(),
                  "convolution_step: the output does not fit its place in the wider map: "
                  "fits_map() says what it takes");

public:
    using method = kernels::integer_method<Kernel, Input>;

private:
    // After the weights: starts, factors, weights of the other map, then three bytes.
    static constexpr std::size_t filter_array_bytes =
        pad_to_cache_line<std::int8_t>(method::filter_places * sizeof(std::int32_t));
    static constexpr std::size_t starts = pad_to_cache_line<std::int8_t>(method::packed_elements),
                                 factors = starts + filter_array_bytes, added = factors + filter_array_bytes,
                                 bytes = added + (Kernel.accumulates ? filter_array_bytes : 0);
    static constexpr std::size_t lowest = 0, zero = 1, padding = 2;

public:
    static constexpr std::size_t packed_elements = bytes + pad_to_cache_line<std::int8_t>(3);
    static constexpr std::size_t workspace_elements =
        pad_to_cache_line<std::uint8_t>(method::workspace_elements);

    /// Also sets the scales of the weights, which follow from the ranges.
    static constexpr void set_ranges(float* to, const step_ranges& values) {
        for (std::size_t f = 0; f < Kernel.filters; ++f)
            to[weight_scales + f] = detail::scale_of_filter(to + f * Kernel.taps(), Kernel.taps(),
                                                            static_cast<double>(to[biases + f]), values,
                                                            Kernel.accumulates, largest_input);
        arrays.write_ranges(to, values);
    }

    static constexpr void pack(const float* from, std::int8_t* to) {
        constexpr std::size_t of_one = Kernel.taps();
        const step_ranges maps = arrays.read_ranges(from);
        std::array<detail::filter_scale, Kernel.filters> scales{};
        for (std::size_t f = 0; f < Kernel.filters; ++f) {
            scales[f] = detail::filter_of(from + f * of_one, of_one, static_cast<double>(from[biases + f]),
                                          from[weight_scales + f], maps, Kernel.accumulates, largest_input,
                                          method::offset);
            const double factor =
                writes_bytes ? scales[f].unit / static_cast<double>(maps.output.scale) : scales[f].unit;
            std::int8_t* const place = to + method::place(f) * sizeof(std::int32_t);
            detail::store_number(place + starts, static_cast<std::int32_t>(scales[f].start));
            detail::store_number(place + factors, static_cast<float>(factor));
            if constexpr (Kernel.accumulates)
                detail::store_number(place + added, static_cast<std::int32_t>(scales[f].added));
        }
        const auto weight = [&](std::size_t filter, std::size_t channel, std::size_t row,
                                std::size_t column) {
            constexpr extent2d k = Kernel.window.kernel;
            return detail::quantised(from[filter * of_one + (channel * k.rows + row) * k.columns + column],
                                     scales[filter]);
        };
        method::pack(weight, to);
        const auto zero_byte = static_cast<double>(maps.output.zero_point);
        detail::store_byte(to + bytes + lowest, Kernel.rectifies() ? zero_byte : 0);
        detail::store_byte(to + bytes + zero, zero_byte);
        detail::store_byte(to + bytes + padding, static_cast<double>(maps.input.zero_point));
    }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t* memory) noexcept {
        const auto byte = [&](std::size_t which) { return detail::load_byte(packed_values + bytes + which); };
        const kernels::integer_epilogue epilogue{packed_values + starts,
                                                 packed_values + factors,
                                                 packed_values + added,
                                                 {byte(lowest), 255, byte(zero)},
                                                 byte(padding)};
        method::run(packed_values, epilogue, reinterpret_cast<const Input*>(in),
                    reinterpret_cast<Output*>(out) + Kernel.map_offset, memory);
    }
};

}} // namespace tactnet

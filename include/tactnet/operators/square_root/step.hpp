#pragma once

#include <tactnet/kernels/frame/elementwise.hpp>
#include <tactnet/lowering/step.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// √(x + offset) − √offset, and 0 for x below 0. `Offset` is a std::ratio.
template <class Format, shape Map, std::size_t Stride, class Offset>
struct square_root_step;
template <class Format, shape Map, std::size_t Stride, class Offset>
struct step_description<square_root_step<Format, Map, Stride, Offset>> {
    static constexpr const char* header = "tactnet/operators/square_root/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::square_root_step", "Square root", std::type_identity<Format>{}, Map,
           input_stride_argument{}, std::type_identity<Offset>{});
    }
};

template <shape Map, std::size_t Stride, class Offset>
struct square_root_step<single_precision, Map, Stride, Offset> : step_base<single_precision, Map, Stride> {
    static constexpr double offset = static_cast<double>(Offset::num) / static_cast<double>(Offset::den);

    /// x + offset must stay finite too, and roots of small numbers exceed the numbers.
    static double output_bound(const float*, double input) { return std::max(input, 1.0) + offset; }
    static void run(const float*, const float* in, float* out, float*) noexcept {
        kernels::transform_map<Map.area() * Stride>(kernels::shifted_root(static_cast<float>(offset)), in,
                                                    out);
    }
};

}} // namespace tactnet

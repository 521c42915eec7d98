#pragma once

#include <tactnet/kernels/arch/compiler_vector.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <array>
#include <cstddef>
#include <cstring>
#include <utility>

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

namespace detail {

/// One step for a pair of rows: exchanges the lanes of `a` whose index has the bit `Distance` with the lanes
/// of `b` whose index has not.
template <std::size_t Distance, class Vector, std::size_t... I>
[[gnu::always_inline]] inline void exchange_lanes(Vector& a, Vector& b, std::index_sequence<I...>) {
    constexpr std::size_t count = sizeof...(I);
    const Vector low = __builtin_shufflevector(a, b, ((I & Distance) == 0 ? I : count + I - Distance)...);
    b = __builtin_shufflevector(a, b, ((I & Distance) == 0 ? I + Distance : count + I)...);
    a = low;
}

template <std::size_t Distance, class Vector, std::size_t Count>
[[gnu::always_inline]] inline void exchange_blocks(std::array<Vector, Count>& rows) {
    if constexpr (Distance < Count) {
#pragma GCC unroll 64
        for (std::size_t row = 0; row < Count; ++row)
            if ((row & Distance) == 0)
                exchange_lanes<Distance>(rows[row], rows[row + Distance], std::make_index_sequence<Count>{});
        exchange_blocks<2 * Distance>(rows);
    }
}

} // namespace detail

/// Transposes a square of `lanes<T>` rows and columns, to[i][j] = from[j][i]; strides are in elements from
/// one row to the next. In registers: off-diagonal blocks of 1 × 1, 2 × 2 and so on are exchanged.
template <class T>
[[gnu::always_inline]] inline void transpose(const T* from, std::size_t from_stride, T* to,
                                             std::size_t to_stride) {
    using row = typename detail::compiler_vector<T, lanes<T>>::type;
    std::array<row, lanes<T>> rows;
#pragma GCC unroll 64
    for (std::size_t i = 0; i < lanes<T>; ++i)
        std::memcpy(&rows[i], from + i * from_stride, sizeof(row));
    detail::exchange_blocks<1>(rows);
#pragma GCC unroll 64
    for (std::size_t i = 0; i < lanes<T>; ++i)
        std::memcpy(to + i * to_stride, &rows[i], sizeof(row));
}

/// Transposes up to `lanes<T>` features of a lane block: to[sample][feature] = from[feature][sample], with
/// zeros after the last feature.
template <class T>
void transpose(const T* from, std::size_t features, T* to) {
    constexpr std::size_t width = lanes<T>;
    if (features == width)
        return transpose(from, width, to, width);
    for (std::size_t sample = 0; sample < width; ++sample)
        for (std::size_t f = 0; f < width; ++f)
            to[sample * width + f] = f < features ? from[f * width + sample] : T{};
}

}}} // namespace tactnet::kernels

#pragma once

// Sizes from 7 × 13 to 28 × 50, at compile time: every number of rows, and of columns those on both sides of
// every published resolution and some between. TACTNET_TEST_EVERY_SIZE takes all 836, which costs minutes and
// gigabytes.

#include <tactnet/tensor/shape.hpp>

#include <cstddef>
#include <utility>

namespace support {

inline constexpr std::size_t smallest_rows = 7, largest_rows = 28;

#ifdef TACTNET_TEST_EVERY_SIZE
template <std::size_t... I>
constexpr auto columns_from_13(std::index_sequence<I...>) -> std::index_sequence<13 + I...>;
using tested_columns = decltype(columns_from_13(std::make_index_sequence<38>{}));
#else
using tested_columns = std::index_sequence<13, 14, 18, 19, 22, 25, 26, 30, 35, 36, 43, 50>;
#endif

template <template <tactnet::shape> class Check, std::size_t Rows, std::size_t... Column>
constexpr bool holds_in_row(std::index_sequence<Column...>) {
    return (Check<tactnet::shape{Rows, Column, 1}>::value && ...);
}
template <template <tactnet::shape> class Check, std::size_t... Row>
constexpr bool holds_in_rows(std::index_sequence<Row...>) {
    return (holds_in_row<Check, smallest_rows + Row>(tested_columns{}) && ...);
}
/// Check<shape>::value at each of these sizes.
template <template <tactnet::shape> class Check>
inline constexpr bool holds_at_every_size =
    holds_in_rows<Check>(std::make_index_sequence<largest_rows - smallest_rows + 1>{});

/// Outputs of a pool with 'same' padding.
constexpr std::size_t halved(std::size_t size, std::size_t stride = 2) {
    return (size + stride - 1) / stride;
}

} // namespace support

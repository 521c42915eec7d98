#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/svm/feature_rows.hpp>

#include <algorithm>
#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

/// For what is made of each row and not kept: blocks of rows, so that the memory for it does not grow with
/// their number. `bytes_each` is what a row takes; a block is one row or more, and takes 16 MiB or less
/// unless one row takes more.
/// take(rows) is called for one block after the other.
template <std::size_t Features, class Take>
void for_each_block(feature_rows<Features> rows, std::size_t bytes_each, const Take& take) {
    constexpr std::size_t most_bytes = std::size_t{1} << 24U;
    const std::size_t most = std::max<std::size_t>(1, most_bytes / std::max<std::size_t>(1, bytes_each));
    for (std::size_t first = 0; first < rows.size(); first += most) {
        const std::size_t count = std::min(most, rows.size() - first);
        take(feature_rows<Features>(rows.values().subspan(first * rows.features(), count * rows.features()),
                                    rows.features()));
    }
}

} // namespace detail

} // namespace TACTNET_ARCH
} // namespace tactnet

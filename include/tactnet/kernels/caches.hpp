#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>

// The caches of one core, by which kernels cut their work into parts that stay in cache. Sizes change times,
// never results: each output is the same sum in the same order.
//
// Configuration: for a known processor, define TACTNET_L1_CACHE_KIB and TACTNET_L2_CACHE_KIB, plain numbers
// of KiB, before the first header of the library. Nearly every processor with vectors has at least the
// defaults. Translation units with other sizes use namespaces of their own, like those for other instruction
// sets (config.hpp).
#if (defined(TACTNET_L1_CACHE_KIB) && defined(TACTNET_L1_CACHE_BY_DEFAULT)) ||                               \
    (defined(TACTNET_L2_CACHE_KIB) && defined(TACTNET_L2_CACHE_BY_DEFAULT))
#error "tactnet: define TACTNET_L1_CACHE_KIB and TACTNET_L2_CACHE_KIB before the first header of the library"
#endif

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Bytes of the first level, for data.
#if defined(TACTNET_L1_CACHE_BY_DEFAULT)
inline constexpr std::size_t l1_cache_bytes = 32 * 1024;
#else
inline constexpr std::size_t l1_cache_bytes = TACTNET_L1_CACHE_KIB * std::size_t{1024};
#endif
/// Bytes of the second level.
#if defined(TACTNET_L2_CACHE_BY_DEFAULT)
inline constexpr std::size_t l2_cache_bytes = 512 * 1024;
#else
inline constexpr std::size_t l2_cache_bytes = TACTNET_L2_CACHE_KIB * std::size_t{1024};
#endif
static_assert(
    l1_cache_bytes >= 4096 && l2_cache_bytes >= l1_cache_bytes,
    "tactnet: expected at least 4 KiB of L1 (TACTNET_L1_CACHE_KIB), and of L2 (TACTNET_L2_CACHE_KIB) as "
    "much as of L1");

/// The part of the first level for an intermediate map; weights and outputs stream through the rest.
inline constexpr std::size_t l1_map_bytes = l1_cache_bytes / 4 * 3;
/// Up to so many bytes, weights that are read again for each part of a map come quickly enough from the
/// second level.
inline constexpr std::size_t l2_weight_bytes = l2_cache_bytes / 8;

}}} // namespace tactnet::kernels

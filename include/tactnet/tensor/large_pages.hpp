#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>

#if defined(__linux__)
#include <cerrno>
#include <sys/mman.h>
#endif

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace detail {

/// Bytes of the larger pages of x86-64 and, where pages have 4 KiB, of 64-bit ARM.
inline constexpr std::size_t large_page = std::size_t{2} << 20U;
/// Below a few of them the rounding to whole ones costs more memory than it saves time.
inline constexpr std::size_t least_on_large_pages = 2 * large_page;

/// Asks for large pages for the whole ones in a block that begins at one: the first write to each page costs
/// an interruption, and so does each page that the translation buffer has forgotten. A system may refuse,
/// which changes nothing but the time. Memory is then taken 2 MiB at a time, and stays marked when it is
/// freed.
inline void prefer_large_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) noexcept {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    const int before = errno;
    (void)::madvise(memory, bytes / large_page * large_page, MADV_HUGEPAGE);
    errno = before; // an allocation that succeeds leaves it alone
#endif
}

} // namespace detail
} // namespace TACTNET_ARCH
} // namespace tactnet

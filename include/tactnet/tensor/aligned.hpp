#pragma once

#include <tactnet/tensor/alignment.hpp>
#include <tactnet/tensor/large_pages.hpp>

#include <cstddef>
#include <new>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// An allocator whose memory vector loads may be aligned on; large blocks lie on large pages where the system
/// has them.
template <class T>
struct aligned_allocator {
    using value_type = T;

    aligned_allocator() = default;
    template <class U>
    constexpr aligned_allocator(const aligned_allocator<U>&) noexcept {}

    [[nodiscard]] T* allocate(std::size_t count) {
        if (count > static_cast<std::size_t>(-1) / 2 / sizeof(T))
            throw std::bad_array_new_length();
        const std::size_t bytes = count * sizeof(T);
        void* const memory = ::operator new(bytes, alignment_of(count));
        if (bytes >= detail::least_on_large_pages)
            detail::prefer_large_pages(memory, bytes);
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t count) noexcept { ::operator delete(memory, alignment_of(count)); }

    friend constexpr bool operator==(const aligned_allocator&, const aligned_allocator&) { return true; }

private:
    static constexpr std::align_val_t alignment_of(std::size_t count) {
        return std::align_val_t{count * sizeof(T) < detail::least_on_large_pages ? alignment
                                                                                 : detail::large_page};
    }
};

template <class T>
using aligned_vector = std::vector<T, aligned_allocator<T>>;

} // namespace TACTNET_ARCH
} // namespace tactnet

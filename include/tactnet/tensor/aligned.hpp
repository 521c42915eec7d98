#pragma once

#include <tactnet/tensor/alignment.hpp>

#include <cstddef>
#include <new>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// An allocator whose memory vector loads may be aligned on.
template <class T>
struct aligned_allocator {
    using value_type = T;

    aligned_allocator() = default;
    template <class U>
    constexpr aligned_allocator(const aligned_allocator<U>&) noexcept {}

    [[nodiscard]] T* allocate(std::size_t count) {
        if (count > static_cast<std::size_t>(-1) / 2 / sizeof(T))
            throw std::bad_array_new_length();
        return static_cast<T*>(::operator new (count * sizeof(T), std::align_val_t{alignment}));
    }
    void deallocate(T* memory, std::size_t) noexcept {
        ::operator delete (memory, std::align_val_t{alignment});
    }

    friend constexpr bool operator==(const aligned_allocator&, const aligned_allocator&) { return true; }
};

template <class T>
using aligned_vector = std::vector<T, aligned_allocator<T>>;

} // namespace TACTNET_ARCH
} // namespace tactnet

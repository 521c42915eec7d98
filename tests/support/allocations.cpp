#include <atomic>
#include <cstdlib>
#include <new>
#include <support/allocations.hpp>

#if defined(_WIN32)
#include <malloc.h>
#endif

namespace {

std::atomic<std::size_t> count{0}, bytes{0};

/// Null where there is no memory.
void* try_to_allocate(std::size_t size, std::size_t alignment) noexcept {
    count.fetch_add(1, std::memory_order_relaxed);
    bytes.fetch_add(size, std::memory_order_relaxed);
    const std::size_t whole = (size / alignment + 1) * alignment; // as aligned_alloc asks
#if defined(_WIN32)
    return _aligned_malloc(whole, alignment);
#else
    return std::aligned_alloc(alignment, whole);
#endif
}
void release(void* memory) noexcept {
#if defined(_WIN32)
    _aligned_free(memory);
#else
    std::free(memory);
#endif
}
void* allocate(std::size_t size, std::size_t alignment) {
    if (void* const memory = try_to_allocate(size, alignment))
        return memory;
    throw std::bad_alloc();
}

} // namespace

std::size_t support::allocations() noexcept {
    return count.load(std::memory_order_relaxed);
}

std::size_t support::bytes_allocated() noexcept {
    return bytes.load(std::memory_order_relaxed);
}

// The array forms call these. So do the non-throwing ones of the standard library, but not those of the
// address sanitizer, whose memory must not come back to the operators here: std::stable_sort asks for such.
void* operator new(std::size_t size) {
    return allocate(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return allocate(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    return try_to_allocate(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}
void* operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
    return try_to_allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
    release(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    release(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    release(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    release(memory);
}

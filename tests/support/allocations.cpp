#include <atomic>
#include <cstdlib>
#include <new>
#include <support/allocations.hpp>

namespace {

std::atomic<std::size_t> count{0}, bytes{0};

void* allocate(std::size_t size, std::size_t alignment) {
    count.fetch_add(1, std::memory_order_relaxed);
    bytes.fetch_add(size, std::memory_order_relaxed);
    const std::size_t whole = (size / alignment + 1) * alignment; // as aligned_alloc asks
    if (void* memory = std::aligned_alloc(alignment, whole))
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

// The array and non-throwing forms call these.
void* operator new(std::size_t size) {
    return allocate(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}

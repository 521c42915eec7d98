#pragma once

// What a piece of work takes of a processor. SEMIHOSTING says that there is an emulator to report to: what is
// built without is the program of a product, whose flash counts.

#include <board.hpp>

#ifdef SEMIHOSTING
#include <cstddef>
#include <cstdint>

extern "C" std::uint32_t last_bss[], stack_begins[]; // from firmware.ld

inline volatile std::uint32_t& device(std::uint32_t address) {
    return *reinterpret_cast<volatile std::uint32_t*>(address);
}

inline void tell(const char* name, std::uint32_t number) {
    print(name);
    char digits[12];
    char* first = digits + sizeof(digits);
    *--first = '\0', *--first = '\n';
    do
        *--first = static_cast<char>('0' + number % 10);
    while ((number /= 10) > 0);
    print(first);
}

/// Counts down: 24 bits of the system's timer, or 32 of the instructions of a RISC-V.
#ifdef __riscv
constexpr std::uint32_t tick_bits = 0xFFFFFFFF;
#else
constexpr std::uint32_t tick_bits = 0xFFFFFF;
#endif
inline std::uint32_t ticks_left() {
#ifdef __riscv
    std::uint32_t instructions;
    asm volatile("csrr %0, minstret" : "=r"(instructions));
    return ~instructions;
#else
    return device(0xE000E018);
#endif
}

/// Tells the bytes of stack that a frame takes, which is painted below here and looked at afterwards, and the
/// ticks for 20 frames. work() is false if it fails.
template <class Work>
[[gnu::noinline]] void tell_costs(const Work& work) {
    constexpr std::uint32_t paint = 0xC0FFEE11;
    auto* const here = static_cast<std::uint32_t*>(__builtin_frame_address(0));
    auto* const lowest = last_bss;
    for (volatile std::uint32_t* word = here - 16; word > lowest; --word)
        *word = paint;
    if (!work())
        leave(1);
    const volatile std::uint32_t* word = lowest + 1;
    while (*word == paint)
        ++word;
    tell("stack ", word == lowest + 1 ? ~0u : static_cast<std::uint32_t>(stack_begins - word) * 4);
#ifndef __riscv
    device(0xE000E014) = 0xFFFFFF;
    device(0xE000E018) = 0;
    device(0xE000E010) = 5;
#endif
    const auto ticks_of_frames = [&](std::size_t count) {
        const std::uint32_t before = ticks_left();
        for (std::size_t frame = 0; frame < count; ++frame)
            if (!work())
                leave(1);
        return (before - ticks_left()) & tick_bits;
    };
    const std::uint32_t of_none = ticks_of_frames(0), of_some = ticks_of_frames(20);
    tell("ticks of 20 frames ", of_some - of_none);
}
#endif

#pragma once

// What a Cortex-M without an operating system needs around a test: what happens at its start, a way to report
// results to the debugger (semihosting), which an emulator is as well, and what a piece of work takes.
// TEST_REPORT says that there is a debugger: without one a processor would stop, and reporting takes flash.

#include <array>
#include <cstddef>
#include <cstdint>

#if defined(__cpp_exceptions) || defined(__cpp_rtti)
#error "this program is to be built with -fno-exceptions -fno-rtti"
#endif

extern "C" {
// From firmware.ld.
extern std::uint32_t data_in_flash[], first_data[], last_data[], first_bss[], last_bss[], stack_begins[];
extern void (*const first_constructor[])();
extern void (*const last_constructor[])();
void reset();
}

__attribute__((section(".vectors"), used))
const void* const start_of_flash[] = {stack_begins, reinterpret_cast<const void*>(&reset)};

inline volatile std::uint32_t& device(std::uint32_t address) {
    return *reinterpret_cast<volatile std::uint32_t*>(address);
}

/// The first that `reset` calls.
inline void start_board() {
    device(0xE000ED88) = 0xF << 20; // the floating-point unit
    asm volatile("dsb\nisb");
    for (std::uint32_t *to = first_data, *from = data_in_flash; to < last_data;)
        *to++ = *from++;
    for (std::uint32_t* to = first_bss; to < last_bss;)
        *to++ = 0;
    for (auto* constructor = first_constructor; constructor != last_constructor; ++constructor)
        (*constructor)();
}

#ifdef TEST_REPORT
inline void ask_debugger(std::uint32_t what, const void* with) {
    register std::uint32_t r0 asm("r0") = what;
    register const void* r1 asm("r1") = with;
    asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}
inline void tell(const char* name, std::uint32_t number) {
    ask_debugger(4, name);
    char digits[12];
    char* first = digits + sizeof(digits);
    *--first = '\0', *--first = '\n';
    do
        *--first = static_cast<char>('0' + number % 10);
    while ((number /= 10) > 0);
    ask_debugger(4, first);
}
[[noreturn]] inline void leave(std::uint32_t status) {
    const std::array<std::uint32_t, 2> because{0x20026, status}; // the program has ended
    ask_debugger(0x20, because.data());
    for (;;) {
    }
}

/// Tells the bytes of stack that a frame takes, which is painted below here and looked at afterwards, and the
/// ticks of the system's timer, 24 bits counting down, for 20 frames. work() is false if it fails.
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
    device(0xE000E014) = 0xFFFFFF;
    device(0xE000E018) = 0;
    device(0xE000E010) = 5;
    const auto ticks_of_frames = [&](std::size_t count) {
        volatile std::uint32_t& now = device(0xE000E018);
        const std::uint32_t before = now;
        for (std::size_t frame = 0; frame < count; ++frame)
            if (!work())
                leave(1);
        return (before - now) & 0xFFFFFF;
    };
    const std::uint32_t of_none = ticks_of_frames(0), of_some = ticks_of_frames(20);
    tell("ticks of 20 frames ", of_some - of_none);
}
#endif

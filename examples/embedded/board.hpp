#pragma once

// How a program without an operating system reports: to a debugger, or to an emulator, which answers the same
// calls (semihosting). Without SEMIHOSTING, `print` does nothing and `leave` waits for ever, since a
// processor without a debugger would stop at such a call.

#include <array>
#include <cstdint>

#ifdef SEMIHOSTING
inline void ask_debugger(std::uintptr_t what, const void* with) {
#ifdef __riscv
    register std::uintptr_t a0 asm("a0") = what;
    register const void* a1 asm("a1") = with;
    // The three instructions by which a debugger knows the call must not be compressed.
    asm volatile(".option push\n.option norvc\nslli x0, x0, 0x1f\nebreak\nsrai x0, x0, 7\n.option pop"
                 : "+r"(a0)
                 : "r"(a1)
                 : "memory");
#else
    register std::uintptr_t r0 asm("r0") = what;
    register const void* r1 asm("r1") = with;
    asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
#endif
}
#endif

inline void print([[maybe_unused]] const char* text) {
#ifdef SEMIHOSTING
    ask_debugger(4, text);
#endif
}

/// Ends the program: 0 if all is well.
[[noreturn]] inline void leave([[maybe_unused]] int status) {
#ifdef SEMIHOSTING
    const std::array<std::uintptr_t, 2> because{0x20026, static_cast<std::uintptr_t>(status)};
    ask_debugger(0x20, because.data());
#endif
    for (;;) {
    }
}

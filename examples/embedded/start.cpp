// What a Cortex-M or a RISC-V does between reset and main.

#include "board.hpp"

#include <cstdint>

#if defined(__cpp_exceptions) || defined(__cpp_rtti)
#error "this program is to be built with -fno-exceptions -fno-rtti"
#endif

int program() asm("main"); // C++ lets no program call its own

extern "C" {
// From firmware.ld.
extern std::uint32_t data_in_flash[], first_data[], last_data[], first_bss[], last_bss[], stack_begins[];
extern void (*const first_constructor[])();
extern void (*const last_constructor[])();

[[noreturn]] void reset() {
#ifdef __ARM_FP
    *reinterpret_cast<volatile std::uint32_t*>(0xE000ED88) = 0xF << 20; // the floating-point unit
    asm volatile("dsb\nisb");
#endif
    for (std::uint32_t *to = first_data, *from = data_in_flash; to < last_data;)
        *to++ = *from++;
    for (std::uint32_t* to = first_bss; to < last_bss;)
        *to++ = 0;
    for (auto* constructor = first_constructor; constructor != last_constructor; ++constructor)
        (*constructor)();
    leave(program());
}
}

#ifdef __riscv
asm(".section .vectors, \"ax\"\n"
#ifdef __riscv_flen
    "li t0, 0x6000\ncsrs mstatus, t0\n" // the floating-point unit
#endif
    "la sp, stack_begins\nj reset\n.text");
#else
__attribute__((section(".vectors"), used))
const void* const start_of_flash[] = {stack_begins, reinterpret_cast<const void*>(&reset)};
#endif

// The whole program of a Cortex-M without an operating system: it runs the self-test of an exported header,
// counts what a frame takes, and tells both to the debugger (semihosting), which an emulator is as well.
// TEST_HEADER names the header, TEST_SAME_BITS says that the outputs must have the bits of the machine that
// wrote it, as those in 8 bits have, TEST_REPORT says that there is a debugger to tell: without one a
// processor would stop, and what tells takes flash.

#include TEST_HEADER

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

namespace {

volatile std::uint32_t& device(std::uint32_t address) {
    return *reinterpret_cast<volatile std::uint32_t*>(address);
}

/// What the last frame gave, so that no compiler leaves it out.
std::array<float, gripper::recogniser_type::outputs> outputs;

bool recognise() {
    return gripper::recogniser.infer(gripper::selftest_frame, outputs) == tactnet::frame_status::ok;
}

#ifdef TEST_REPORT
void ask_debugger(std::uint32_t what, const void* with) {
    register std::uint32_t r0 asm("r0") = what;
    register const void* r1 asm("r1") = with;
    asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}
void tell(const char* name, std::uint32_t number) {
    ask_debugger(4, name);
    char digits[12];
    char* first = digits + sizeof(digits);
    *--first = '\0', *--first = '\n';
    do
        *--first = static_cast<char>('0' + number % 10);
    while ((number /= 10) > 0);
    ask_debugger(4, first);
}
[[noreturn]] void leave(std::uint32_t status) {
    const std::array<std::uint32_t, 2> because{0x20026, status}; // the program has ended
    ask_debugger(0x20, because.data());
    for (;;) {
    }
}

/// Bytes of stack that one frame takes: it is painted below here, and looked at afterwards.
[[gnu::noinline]] std::uint32_t stack_of_a_frame() {
    constexpr std::uint32_t paint = 0xC0FFEE11;
    auto* const here = static_cast<std::uint32_t*>(__builtin_frame_address(0));
    auto* const lowest = last_bss;
    for (volatile std::uint32_t* word = here - 16; word > lowest; --word)
        *word = paint;
    if (!recognise())
        leave(1);
    const volatile std::uint32_t* word = lowest + 1;
    while (*word == paint)
        ++word;
    return word == lowest + 1 ? ~0u : static_cast<std::uint32_t>(stack_begins - word) * 4;
}

/// Ticks of the system's timer, 24 bits counting down.
std::uint32_t ticks_of_frames(std::size_t count) {
    volatile std::uint32_t& now = device(0xE000E018);
    const std::uint32_t before = now;
    for (std::size_t i = 0; i < count; ++i)
        if (!recognise())
            leave(1);
    return (before - now) & 0xFFFFFF;
}
#endif

} // namespace

extern "C" void reset() {
    device(0xE000ED88) = 0xF << 20; // the floating-point unit
    asm volatile("dsb\nisb");
    for (std::uint32_t *to = first_data, *from = data_in_flash; to < last_data;)
        *to++ = *from++;
    for (std::uint32_t* to = first_bss; to < last_bss;)
        *to++ = 0;
    for (auto* constructor = first_constructor; constructor != last_constructor; ++constructor)
        (*constructor)();
    const bool passes = gripper::passes_selftest();
#ifdef TEST_REPORT
    if (!passes)
        leave(2);
    tell("stack ", stack_of_a_frame());
#ifdef TEST_SAME_BITS
    if (outputs != gripper::selftest_outputs)
        leave(3);
#endif
    device(0xE000E014) = 0xFFFFFF;
    device(0xE000E018) = 0;
    device(0xE000E010) = 5;
    constexpr std::size_t frames = 20;
    const std::uint32_t of_none = ticks_of_frames(0), of_some = ticks_of_frames(frames);
    tell("ticks of 20 frames ", of_some - of_none);
    leave(0);
#else
    for (;;)
        if (!passes || !recognise())
            return;
#endif
}

// A program as a target without files runs it: built without exceptions and run-time type information. On
// Linux it gives up all system calls but reading, writing and ending (seccomp's strict mode) before the first
// frame.
//
// TEST_SAME_BITS  the outputs must have the bits of the machine that wrote the header
// TEST_SEALED     it must be possible to give up system calls

#include "large.hpp" // compiled only: it is not for a stack
#include "mixed.hpp"
#include "recorded.hpp"
#include "recorded_in_bytes.hpp"
#include "small.hpp"
#include "tagging.hpp"

#include <array>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#if defined(__cpp_exceptions) || defined(__cpp_rtti)
#error "this program is to be built with -fno-exceptions -fno-rtti"
#endif

namespace {

template <class Outputs>
bool right(const Outputs& found, const Outputs& expected) {
    float largest = 0, error = 0;
    bool same = true;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const float size = expected[i] < 0 ? -expected[i] : expected[i], difference = found[i] - expected[i];
        largest = size > largest ? size : largest;
        error = difference > error ? difference : -difference > error ? -difference : error;
        same = same && found[i] == expected[i];
    }
#ifdef TEST_SAME_BITS
    return same;
#else
    return error <= 1e-5f * largest;
#endif
}

template <class Recogniser, class Frame, class Outputs>
bool infers(const Recogniser& recogniser, const Frame& frame, const Outputs& expected) {
    Outputs found{};
    return recogniser.infer(tactnet::tensor_view<const std::uint8_t, Recogniser::input_shape>(frame),
                            found) == tactnet::frame_status::ok &&
           right(found, expected);
}
template <class Recogniser, class Recording, class Outputs>
bool follows(const Recogniser& recogniser, const Recording& recording, const Outputs& expected) {
    std::array<float, sizeof(recording) / sizeof(float) / Recogniser::features * Recogniser::outputs> all{};
    typename Recogniser::state state;
    if (recogniser.run(recording, state, all) * Recogniser::outputs != all.size())
        return false;
    Outputs last{};
    for (std::size_t i = 0; i < last.size(); ++i)
        last[i] = all[all.size() - last.size() + i];
    return right(last, expected);
}

/// exit() would ask for a system call that is no longer there.
[[noreturn]] void leave(int status) {
    syscall(SYS_exit, status);
    for (;;) {
    }
}

} // namespace

int main() {
#if defined(__AVX2__) && defined(__FMA__)
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) {
        static constexpr char text[] = "skipped: this processor lacks the instructions\n";
        return write(1, text, sizeof(text) - 1) > 0 ? 0 : 1;
    }
#endif
    if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT) != 0) {
#ifdef TEST_SEALED
        return 2;
#endif
    }
    namespace small = gripper::recognition;
    if (!infers(small::recogniser, small::selftest_frame, small::selftest_outputs) ||
        !small::passes_selftest())
        leave(3);
    if (!infers(mixed::recogniser, mixed::selftest_frame, mixed::selftest_outputs) ||
        !mixed::passes_selftest())
        leave(4);
    if (!follows(recorded::recogniser, recorded::selftest_recording, recorded::selftest_outputs) ||
        !recorded::passes_selftest())
        leave(5);
    // In 8 bits, the same bits everywhere.
    namespace in_bytes = recorded_in_bytes;
    if (!follows(in_bytes::recogniser, in_bytes::selftest_recording, in_bytes::selftest_outputs) ||
        !in_bytes::passes_selftest())
        leave(6);
    if (!follows(tagging::recogniser, tagging::selftest_recording, tagging::selftest_outputs) ||
        !tagging::passes_selftest())
        leave(7);
    leave(0);
}

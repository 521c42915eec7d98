// The whole program of a Cortex-M without an operating system: it runs the self-test of an exported header,
// counts what a frame takes, and reports both to the debugger. TEST_HEADER names the header, TEST_SAME_BITS
// says that the outputs must have the bits of the machine that wrote it, as those in 8 bits have.

#include "costs.hpp"

#include TEST_HEADER

namespace {

/// What the last frame gave, so that no compiler leaves it out.
std::array<float, gripper::recogniser_type::outputs> outputs;

bool recognise() {
    return gripper::recogniser.infer(gripper::selftest_frame, outputs) == tactnet::frame_status::ok;
}

} // namespace

int main() {
    const bool passes = gripper::passes_selftest();
#ifdef SEMIHOSTING
    if (!passes)
        return 2;
    tell_costs(recognise);
#ifdef TEST_SAME_BITS
    if (outputs != gripper::selftest_outputs)
        return 3;
#endif
    return 0;
#else
    for (;;)
        if (!passes || !recognise())
            return 1;
#endif
}

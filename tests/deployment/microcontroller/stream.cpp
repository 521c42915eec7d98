// The whole program of a Cortex-M that follows a stream: it runs the self-test of an exported header, and
// counts what a frame takes.

#include "board.hpp"

#include TEST_HEADER

namespace {

gripper::recogniser_type::state state;
std::array<float, gripper::recogniser_type::outputs> outputs;

bool follow() {
    return gripper::recogniser.step(
               std::span(gripper::selftest_recording).first<gripper::recogniser_type::features>(), state,
               outputs) == tactnet::frame_status::ok;
}

} // namespace

extern "C" void reset() {
    start_board();
    const bool passes = gripper::passes_selftest();
#ifdef TEST_REPORT
    if (!passes)
        leave(2);
    tell_costs(follow);
    leave(0);
#else
    for (;;)
        if (!passes || !follow())
            return;
#endif
}

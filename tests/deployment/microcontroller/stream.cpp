// The whole program of a Cortex-M that follows a stream: it runs the self-test of an exported header, and
// counts what a frame takes.

#include "costs.hpp"

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

int main() {
    const bool passes = gripper::passes_selftest();
#ifdef SEMIHOSTING
    if (!passes)
        return 2;
    tell_costs(follow);
    return 0;
#else
    for (;;)
        if (!passes || !follow())
            return 1;
#endif
}

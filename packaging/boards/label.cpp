// Recognises a frame and prints its label, under ESP-IDF or Zephyr. recogniser.hpp is a network as
// `tactnet export --bits 8 --namespace gripper` writes it.

#include "recogniser.hpp"

#include <array>
#include <cstdint>
#include <cstdio>

namespace {

/// Stands for the sensor: the counts of one frame, row by row.
std::array<std::uint8_t, gripper::recogniser_type::input_shape.size()> read_tactels() {
    return gripper::selftest_frame;
}

gripper::recogniser_type::workspace workspace; // not on the stack of a small task

const char* label() {
    if (!gripper::passes_selftest(workspace))
        return "the self-test failed";
    const auto found = gripper::recogniser.classify(read_tactels(), workspace);
    return found ? gripper::classes[found->index].data() : "a broken frame";
}

} // namespace

#ifdef ESP_PLATFORM
extern "C" void app_main() {
    std::puts(label());
}
#else
int main() {
    std::puts(label());
    return 0;
}
#endif

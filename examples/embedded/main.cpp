// What a firmware does with a deployed network: no files, no heap, no exceptions, no run-time type
// information. recogniser.hpp was written by `tactnet export`, or as in write_header.cpp.

#include "board.hpp"
#include "recogniser.hpp"

#include <array>
#include <cstdint>

namespace {

/// Stands for the sensor: the counts of one frame, row by row.
std::array<std::uint8_t, gripper::recogniser_type::input_shape.size()> read_tactels() {
    return gripper::selftest_frame;
}

/// Stands for the display.
void show(const char* object) {
    print(object);
    print("\n");
}

} // namespace

int main() {
    // Once after start-up: compiler and processor make of a frame what they should.
    if (!gripper::passes_selftest())
        return 1;

    const auto counts = read_tactels();
    const auto found = gripper::recogniser.classify(counts);
    if (!found)
        return 1;
    show(gripper::classes[found->index].data()); // a literal, which ends in a zero
    return 0;
}

// Reads a matrix of tactels and prints what touches it. One multiplexer with 16 channels (such as CD74HC4067)
// leads the supply to a row, another a column to the analogue input, where a resistor to ground divides the
// voltage. recogniser.hpp is a network for at most 16 x 16 tactels, as `tactnet export --bits 8 --namespace
// gripper` writes it. Compile as C++20.

#include "recogniser.hpp"

#include <tactnet.h>

namespace {

using network = gripper::recogniser_type;
constexpr auto tactels = network::input_shape;
static_assert(tactels.rows <= 16 && tactels.columns <= 16, "a multiplexer has 16 channels");

constexpr std::uint8_t row_pins[] = {2, 3, 4, 5}, column_pins[] = {6, 7, 8, 9};
const int analogue_pin = A0;

std::array<std::uint8_t, tactels.size()> counts;
network::workspace workspace; // not on the stack, which is small

void select(const std::uint8_t (&pins)[4], std::size_t channel) {
    for (std::size_t bit_of = 0; bit_of < 4; ++bit_of)
        digitalWrite(pins[bit_of], channel >> bit_of & 1 ? HIGH : LOW);
}

void read_tactels() {
    for (std::size_t row = 0; row < tactels.rows; ++row) {
        select(row_pins, row);
        for (std::size_t column = 0; column < tactels.columns; ++column) {
            select(column_pins, column);
            delayMicroseconds(5); // until the voltage has settled
            counts[row * tactels.columns + column] = static_cast<std::uint8_t>(analogRead(analogue_pin));
        }
    }
}

} // namespace

void setup() {
    Serial.begin(115200);
    for (std::size_t i = 0; i < 4; ++i) {
        pinMode(row_pins[i], OUTPUT);
        pinMode(column_pins[i], OUTPUT);
    }
    analogReadResolution(8);
    if (!gripper::passes_selftest(workspace))
        Serial.println("the self-test failed");
}

void loop() {
    read_tactels();
    if (const auto found = gripper::recogniser.classify(counts, workspace)) {
        Serial.print(gripper::classes[found->index].data());
        Serial.print("\t");
        Serial.println(found->probability);
    }
    delay(50);
}

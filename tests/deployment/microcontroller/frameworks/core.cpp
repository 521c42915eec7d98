// What the frameworks have around a program: Arduino its core, the others puts and an entry.

#include <board.hpp>

#ifdef ARDUINO
#include "Arduino.h"
#include "recogniser.hpp"

namespace {
unsigned outputs, levels; // of the pins, a bit each
int bits = 10;
double printed;
gripper::recogniser_type::workspace workspace;
} // namespace

serial_port Serial;
void serial_port::begin(unsigned long) {}
void serial_port::print(const char* text) {
    ::print(text);
}
void serial_port::println(const char* text) {
    ::print(text);
    ::print("\n");
}
void serial_port::println(double number) {
    printed = number;
    ::print("\n");
}
void pinMode(std::uint32_t pin, std::uint32_t mode) {
    outputs |= mode << pin;
}
void digitalWrite(std::uint32_t pin, std::uint32_t value) {
    levels = (levels & ~(1u << pin)) | value << pin;
}
/// The tactel that the pins select, of the frame that the header holds.
int analogRead(std::uint32_t pin) {
    constexpr unsigned columns = gripper::recogniser_type::input_shape.columns;
    if (pin != A0 || outputs != 0x3FC)
        leave(4);
    return gripper::selftest_frame[(levels >> 2 & 15) * columns + (levels >> 6 & 15)] << (bits - 8);
}
void analogReadResolution(int wanted) {
    bits = wanted;
}
void delay(unsigned long) {}
void delayMicroseconds(unsigned int) {}
int main() {
    setup();
    loop();
    const auto found = gripper::recogniser.classify(gripper::selftest_frame, workspace);
    return found && printed == found->probability ? 0 : 5; // another frame was read
}
#else
extern "C" int puts(const char* text) {
    print(text);
    print("\n");
    return 0;
}
#ifdef ESP_PLATFORM
extern "C" void app_main();
int main() {
    app_main();
    return 0;
}
#endif
#endif

#pragma once

// What a sketch finds of Arduino, with the macros of its cores, and a matrix behind two multiplexers.

#include <cstdint>

#define HIGH 0x1
#define LOW 0x0
#define OUTPUT 0x1
#define A0 14
#define PI 3.1415926535897932384626433832795
#define DEFAULT 1
#define DISPLAY 0x1
#define B1 1
#define F(text) (text)
#define sq(x) ((x) * (x))
#define bit(b) (1UL << (b))
#define word(...) makeWord(__VA_ARGS__)
#define radians(deg) ((deg)*DEG_TO_RAD)
#define lowByte(w) ((std::uint8_t)((w)&0xff))
#define constrain(amt, low, high) ((amt) < (low) ? (low) : ((amt) > (high) ? (high) : (amt)))

struct serial_port {
    void begin(unsigned long baud);
    void print(const char* text);
    void println(const char* text);
    void println(double number);
};
extern serial_port Serial;

void pinMode(std::uint32_t pin, std::uint32_t mode);
void digitalWrite(std::uint32_t pin, std::uint32_t value);
int analogRead(std::uint32_t pin);
void analogReadResolution(int bits);
void delay(unsigned long milliseconds);
void delayMicroseconds(unsigned int microseconds);
void setup();
void loop();

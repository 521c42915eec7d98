// A network as a header in a web page, to copy: everything that your own page needs. recogniser.hpp was
// written by `tactnet export`, or as in examples/embedded/write_header.cpp. docs/browser.md has the command
// that compiles this file. The page then says:
//
//     const files = { wasi_snapshot_preview1: new Proxy({}, { get: () => () => 0 }) }; // never called
//     const source = fetch('recogniser.wasm');
//     const { instance } = await WebAssembly.instantiateStreaming(source, files);
//     const { memory, counts, classify, probability } = instance.exports;
//     new Uint8Array(memory.buffer, counts(), rows * columns).set(frame); // row by row
//     console.log(classify(), probability()); // the number of the class, −1 for none

#include "recogniser.hpp"

#include <array>
#include <cstdint>

#define FOR_THE_PAGE(name) extern "C" __attribute__((export_name(#name)))

namespace {

std::array<std::uint8_t, gripper::recogniser_type::input_shape.size()> frame;
double of_class = 0;

} // namespace

FOR_THE_PAGE(counts) std::uint8_t* counts() {
    return frame.data();
}
FOR_THE_PAGE(classify) int classify() {
    const auto found = gripper::recogniser.classify(frame);
    of_class = found ? found->probability : 0;
    return found ? static_cast<int>(found->index) : -1;
}
FOR_THE_PAGE(probability) double probability() {
    return of_class;
}
/// Whether compiler and browser still make of a frame in the header what they should.
FOR_THE_PAGE(passes_selftest) bool passes_selftest() {
    return gripper::passes_selftest();
}

// What the C++ library makes of a weight file and frames, to the bit: scores FILE FRAMES [FILE_IN_8_BITS]
// prints all outputs as hexadecimal numbers, and at last the nanoseconds per call.

#include <tactnet/io.hpp>
#include <tactnet/quantisation.hpp>
#include <tactnet/tactnet.hpp>

#include <array>
#include <chrono>
#include <cstdio>
#include <vector>

using net = tactnet::tactnet4<tactnet::shape{14, 25}, 5>;

template <class Deployed>
void print(const Deployed& network, const std::vector<std::byte>& frames) {
    std::array<float, net::outputs> outputs{};
    std::array<std::uint8_t, 14 * 25> frame{};
    for (std::size_t i = 0; i < frames.size(); i += frame.size()) {
        std::transform(&frames[i], &frames[i] + frame.size(), frame.begin(),
                       [](std::byte count) { return std::to_integer<std::uint8_t>(count); });
        if (network.infer(frame, outputs) != tactnet::frame_status::ok)
            std::puts("broken");
        for (const float output : outputs)
            std::printf("%a\n", static_cast<double>(output));
    }
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < 20000; ++i)
        static_cast<void>(network.infer(frame, outputs));
    const std::chrono::duration<double, std::nano> taken = std::chrono::steady_clock::now() - begin;
    std::fprintf(stderr, "%.0f\n", taken.count() / 20000);
}

int main(int, char** arguments) {
    const std::vector<std::byte> frames = tactnet::read_file(arguments[2]);
    print(tactnet::load_deployed<net>(arguments[1]), frames);
    print(tactnet::load_deployed<net, tactnet::eight_bit>(arguments[3]), frames);
}

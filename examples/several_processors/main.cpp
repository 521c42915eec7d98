#include "network.hpp"
#include "recogniser.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

// One program for several processors: it holds the network once for each instruction set and picks at start
// what the processor has. This unit is compiled for the least of them, so that it runs everywhere.

namespace {

/// From the best to the one that runs everywhere, as far as this processor has them.
std::vector<const recogniser*> usable() {
    std::vector<const recogniser*> list;
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("fma"))
        list.push_back(&recogniser_avx512);
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        list.push_back(&recogniser_avx2);
    list.push_back(&recogniser_base);
    return list;
}

} // namespace

int main() {
    // In a program of your own: tactnet::load_model<net>("weights.safetensors"). Here any numbers will do.
    net network;
    float value = 0.02f;
    for (float& parameter : network.learnable_values())
        parameter = value = std::fmod(value * 7.3f + 0.011f, 0.2f) - 0.09f;
    const auto deployed = tactnet::deploy(network);

    std::array<std::uint8_t, net::input_shape.size()> frame{};
    for (std::size_t i = 0; i < frame.size(); ++i)
        frame[i] = static_cast<std::uint8_t>(i * 37 % 251);
    std::array<float, net::outputs> expected{};
    if (deployed.infer(frame, expected) != tactnet::frame_status::ok)
        return 1;

    const std::vector<const recogniser*> list = usable();
    std::printf("picked: %s\n", list.front()->instruction_set);
    // A program takes the first; this one shows that all of them find the same, but for rounding.
    float size = 0;
    for (const float logit : expected)
        size = std::max(size, std::abs(logit));
    for (const recogniser* one : list) {
        one->take(deployed.folded().data());
        std::array<float, net::outputs> logits{};
        if (!one->recognise(frame.data(), logits.data()))
            return 1;
        float difference = 0;
        for (std::size_t i = 0; i < logits.size(); ++i)
            difference = std::max(difference, std::abs(logits[i] - expected[i]));
        std::printf("%s: within %.1g of the largest logit\n", one->instruction_set,
                    static_cast<double>(difference / size));
        if (!(size > 0 && difference <= 1e-4f * size))
            return 1;
    }
}

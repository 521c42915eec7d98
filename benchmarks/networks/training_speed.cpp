// Images per second in inference and in training steps of the three networks (training_step.hpp). Gradients
// must agree with a network in double precision.

#include "training_step.hpp"

#include <tactnet/networks.hpp>

int main() {
    constexpr std::size_t rounds = 15;
    constexpr tactnet::shape image{28, 50, 1};
    using net4 = tactnet::tactnet4<image, 22>;
    using net6 = tactnet::tactnet6<image, 22>;
    using residual = tactnet::tactresnet<image, 22>;
    const double peak = benchmark::peak_multiply_adds(rounds);
    benchmark::print_table_head(peak, rounds);
    bool good = benchmark::measure<net4>("TactNet-4", 32, peak, rounds);
    good = benchmark::measure<net6>("TactNet-6", 32, peak, rounds) && good;
    good = benchmark::measure<net6>("TactNet-6", 704, peak, rounds) && good;
    good = benchmark::measure<residual>("TactResNet", 32, peak, rounds) && good;
    std::printf("\n");
    good = benchmark::checked<net4>("TactNet-4") && good;
    good = benchmark::checked<net6>("TactNet-6") && good;
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}

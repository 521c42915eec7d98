// Images per second when SqueezeNet 1.1 learns touches, all layers trained, from pressure images of 28 x 50
// (training_step.hpp). peers/pytorch_training.py times the same step: pytorch_training.py 32 squeezenet1_1.

#include "training_step.hpp"

#include <tactnet/transfer/networks.hpp>

int main() {
    constexpr std::size_t rounds = 5;
    using network = tactnet::squeezenet_nn<tactnet::shape{28, 50}, 22>;
    const double peak = benchmark::peak_multiply_adds(15);
    benchmark::print_table_head(peak, rounds);
    return benchmark::measure<network>("SqueezeNet", 32, peak, rounds) ? EXIT_SUCCESS : EXIT_FAILURE;
}

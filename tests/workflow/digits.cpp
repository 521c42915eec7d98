// What scripts/matrix compares between compilers: trains a small network on drawn bars and deploys it. Prints
// the instruction set, then a checksum of the trained weights and of all outputs in single precision and in 8
// bits.

#include <tactnet/deployment.hpp>
#include <tactnet/detail/instruction_set.hpp>
#include <tactnet/detail/xxh64.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/quantisation.hpp>
#include <tactnet/training.hpp>

#include <array>
#include <cinttypes>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape size{8, 16};
using net = network<size, conv2d<8, 3>, batch_norm, relu, max_pool<2>, conv2d<16, 3>, batch_norm, relu,
                    max_pool<2>, dense<3>>;

template <class Deployed>
void print_outputs(const Deployed& network, const std::vector<std::uint8_t>& pixels) {
    xxh64 sum;
    for (std::size_t at = 0; at < pixels.size(); at += size.size()) {
        std::array<float, 3> logits{};
        const tensor_view<const std::uint8_t, size> frame(pixels.data() + at);
        if (network.infer(frame, std::span(logits)) == frame_status::ok)
            sum.update(std::as_bytes(std::span(logits)));
    }
    std::printf(" %016" PRIx64, sum.digest());
}

} // namespace

int main() {
    std::vector<std::uint8_t> pixels;
    std::vector<std::size_t> labels;
    for (std::size_t i = 0; i < 60; ++i) {
        labels.push_back(i / 20);
        for (std::size_t row = 0; row < size.rows; ++row)
            for (std::size_t column = 0; column < size.columns; ++column) {
                const bool lies = row == 1 + i % 5, stands = column == 1 + i % 11;
                const bool pressed = (labels[i] != 1 && lies) || (labels[i] != 0 && stands);
                pixels.push_back(static_cast<std::uint8_t>(pressed ? 100 + i * 2 : i % 3));
            }
    }
    recipe how = recipe::default_for(size.rows, size.columns);
    how.epochs = 3;
    thread_pool threads(1);
    const labelled_images images{pixels, labels, 3};
    trainer<net> training(how, images, split_data(labels, 3, split_rule::random, 1), 1, threads);
    while (!training.finished())
        training.run_epoch();
    const model<net> trained{training.best(), training.input_normalisation(), {"lies", "stands", "cross"}};

    xxh64 weights;
    trained.network.for_each_parameter(
        [&](auto, const auto& values) { weights.update(std::as_bytes(std::span(values))); });
    std::printf("%s %016" PRIx64, std::string(instruction_set).c_str(), weights.digest());
    print_outputs(deploy(trained), pixels);
    print_outputs(deploy<eight_bit>(trained, std::span<const std::uint8_t>(pixels)), pixels);
    std::printf("\n");
}

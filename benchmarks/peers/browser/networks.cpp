// The networks of the page in docs/browser, for compare.mjs in this folder, which runs it:
//
//     benchmark_browser WEIGHTS FOLDER ROUNDS [IMAGES]
//
// Built with vectors as wide as WebAssembly's. Reads the weights of a page and writes each network to FOLDER,
// 0.onnx and so on. Prints as JSON what the networks are and their native times in microseconds per frame,
// the fastest of ROUNDS; and, with a folder of images of 28 × 50 with one subfolder per class, the percentage
// of them that each network recognises.

#include "../../support/measure.hpp"
#include "../onnx_model.hpp"
#include "recognisers.hpp" // of examples/browser

#include <tactnet/detail/instruction_set.hpp>
#include <tactnet/io/images/set.hpp>
#include <tactnet/io/write_file.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <decode_image.hpp>
#include <exception>
#include <fstream>
#include <iterator>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

namespace {

using namespace browser;

std::vector<std::uint8_t> contents(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw std::runtime_error("cannot read " + path);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// The network in single precision, its batch norms folded; it takes counts.
template <class Network>
benchmark::described_network write_onnx(const stored_network<Network>& stored, const std::string& path) {
    constexpr std::size_t pixels = Network::input_shape.size();
    if (stored.scale != 1)
        throw std::runtime_error("expected an input of scale 1, found " + std::to_string(stored.scale));
    const std::vector<float> folded = stored.in_floats();
    const auto described = benchmark::described_network::of_folded<Network>(
        folded.data() + stored_network<Network>::float_view::steps_folded);
    tactnet::write_file(path, benchmark::onnx_model(described, 1, {folded.data(), folded.data() + pixels}));
    return described;
}

template <class Network>
double microseconds(both_formats<Network>& network, bool in_8_bits, std::size_t rounds) {
    constexpr std::size_t frames = 16; // per round: far more than the resolution of the clock
    std::array<float, classes> logits{};
    const auto infer = [&] {
        for (std::size_t i = 0; i < frames; ++i)
            if (!network.infer(in_8_bits, logits))
                throw std::runtime_error("logits that are not finite");
    };
    return benchmark::time_rounds(rounds, infer).fastest * 1e6 / frames;
}

template <class Network>
double recognised(both_formats<Network>& network, bool in_8_bits, const tactnet::image_set& images) {
    std::array<float, classes> logits{};
    std::size_t right = 0;
    for (std::size_t i = 0; i < images.labels.size(); ++i) {
        network.take(std::span<const std::uint8_t, array_shape.size()>(
            images.pixels.data() + i * array_shape.size(), array_shape.size()));
        right += network.infer(in_8_bits, logits) && tactnet::first_largest(logits) == images.labels[i];
    }
    return 100 * static_cast<double>(right) / static_cast<double>(images.labels.size());
}

void print_pair(const char* name, double floats, double bytes) {
    std::printf(", \"%s\": {\"single\": %.9g, \"bytes\": %.9g}", name, floats, bytes);
}

} // namespace

int main(int count, char** arguments) {
    try {
        const int rounds = count > 3 ? std::atoi(arguments[3]) : 0;
        if (count < 4 || count > 5 || rounds < 1)
            throw std::invalid_argument("expected WEIGHTS FOLDER ROUNDS [IMAGES], with at least one round");
        recognisers all;
        if (!all.load(contents(arguments[1])))
            throw std::runtime_error(std::string(arguments[1]) +
                                     ": the weights do not belong to the networks of examples/browser");
        std::optional<tactnet::image_set> images;
        if (count == 5)
            images = tactnet::load_images(tactnet::list_image_folder(arguments[4]), array_shape.rows,
                                          array_shape.columns, decode_image);
        if (images && images->classes.size() != classes)
            throw std::runtime_error(std::string(arguments[4]) + ": expected 22 classes, found " +
                                     std::to_string(images->classes.size()));

        const auto families =
            std::apply([](const auto&... listed) { return std::array{listed.family...}; }, networks);
        std::printf("{\"native\": \"%s\", \"networks\": [", tactnet::instruction_set.data());
        for (std::size_t place = 0; place < network_count; ++place)
            all.visit(place, [&]<class Network>(both_formats<Network>& network) {
                const auto described =
                    write_onnx(network.stored, arguments[2] + ("/" + std::to_string(place)) + ".onnx");
                std::printf(
                    "%s\n{\"name\": \"%s, %zu × %zu\", \"rows\": %zu, \"columns\": %zu, \"terms\": %zu",
                    place > 0 ? "," : "", families[place].data(), Network::input_shape.rows,
                    Network::input_shape.columns, Network::input_shape.rows, Network::input_shape.columns,
                    described.terms());
                const auto time = [&](bool in_8_bits) {
                    return microseconds(network, in_8_bits, static_cast<std::size_t>(rounds));
                };
                print_pair("microseconds", time(false), time(true));
                if (images)
                    print_pair("recognised", recognised(network, false, *images),
                               recognised(network, true, *images));
                std::printf("}");
            });
        std::printf("]}\n");
    } catch (const std::exception& error) {
        std::fprintf(stderr, "benchmark_browser: %s\n", error.what());
        return 1;
    }
    return 0;
}

// What the networks of the page give natively for touches of the page, and how far other instruction sets may
// be from it:
//
//     test_browser_reference WEIGHTS TILES
//
// TILES is what the page's function `tiles` says of each network in WebAssembly, as numbers: how many
// convolutions, then rows and columns of each. Writes JSON: per touch its counts, and per network the logits
// in single precision, the bound of what they and those in WebAssembly may differ by, and the logits in 8
// bits.

#include "page.cpp" // of examples/browser

#include <cstdio>
#include <deployment/deployed_network.hpp>
#include <exception>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

namespace {

/// Returns the network before folding: its batch norms multiply by one.
template <class Network>
support::network_parameters unfolded(const both_formats<Network>& from) {
    Network network;
    const std::vector<float> folded = from.stored.in_floats();
    const float* next = folded.data() + Network::input_shape.size() + 2;
    network.for_each_parameter([&](const tactnet::parameter& p, auto values) {
        using tactnet::parameter_role;
        for (float& value : values)
            switch (p.role) {
            case parameter_role::weight:
            case parameter_role::bias:
                value = *next++;
                break;
            case parameter_role::scale:
                value = 1;
                break;
            case parameter_role::running_variance:
                value = static_cast<float>(1 - static_cast<double>(network.epsilon));
                break;
            default:
                value = 0;
            }
    });
    if (next != folded.data() + folded.size())
        throw std::logic_error("reference: the layers have other numbers than the page's network");
    return support::parameters_of(network);
}

std::vector<double> bounds(const support::sample& outputs) {
    std::vector<double> result;
    for (const auto& output : outputs)
        result.push_back(output.error);
    return result;
}

template <class Numbers>
void print(const char* name, const Numbers& all) {
    std::printf("\"%s\":[", name);
    for (std::size_t i = 0; i < std::size(all); ++i)
        std::printf("%s%.9g", i > 0 ? "," : "", static_cast<double>(all[i]));
    std::printf("]");
}

std::vector<std::uint8_t> contents(const char* path) {
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw std::runtime_error(std::string("cannot read ") + path);
    return {std::istreambuf_iterator<char>(file), {}};
}

void write_touch(std::size_t label, std::uint32_t number,
                 const std::vector<std::vector<support::tile_size>>& tiles) {
    take_object(label, number);
    const auto held = page().numbers;
    simulate(held[0], held[1], 0, held[2], 0);
    std::printf("{\"label\":%zu,", label);
    print("counts", page().raw);
    std::printf(",\"networks\":[");
    for (std::size_t place = 0; place < network_count; ++place)
        page().networks.visit(place, [&]<class Network>(both_formats<Network>& network) {
            constexpr tactnet::shape input = Network::input_shape;
            std::printf("%s{", place > 0 ? "," : "");
            network.take(page().raw);
            print("frame", network.frame);
            if (!network.infer(false, page().logits))
                throw std::runtime_error("logits that are not finite");
            std::printf(",");
            print("logits", page().logits);
            const std::vector<float> counts(network.frame.begin(), network.frame.end());
            const std::span<const float> mean(network.stored.in_bytes.data(), input.size());
            const support::sample in = support::bounded_input(counts, mean, network.stored.scale);
            support::described_network described = support::describe<Network>();
            const auto parameters = unfolded(network);
            const support::sample here = support::bounded_outputs(described, parameters, in);
            const support::error_shares shares = support::shares_of(page().logits, here);
            if (!shares.good())
                throw std::runtime_error("native logits outside of their own bound");
            described.tiles = tiles.at(place);
            std::vector<double> both = bounds(here);
            const std::vector<double> there = bounds(support::bounded_outputs(described, parameters, in));
            for (std::size_t i = 0; i < both.size(); ++i)
                both[i] += there[i];
            std::printf(",");
            print("bounds", both);
            if (!network.infer(true, page().logits))
                throw std::runtime_error("logits in 8 bits that are not finite");
            std::printf(",");
            print("bytes", page().logits);
            std::printf("}");
        });
    std::printf("]}");
}

} // namespace

int main(int count, char** arguments) {
    try {
        if (count != 3)
            throw std::invalid_argument("expected the weights of the page and the tiles of its networks");
        page().weights = contents(arguments[1]);
        if (!load())
            throw std::runtime_error("the weights do not belong to these networks");
        std::ifstream from(arguments[2]);
        std::vector<std::vector<support::tile_size>> tiles(network_count);
        for (auto& list : tiles) {
            std::size_t convolutions = 0;
            from >> convolutions;
            list.resize(convolutions);
            for (support::tile_size& tile : list)
                from >> tile.rows >> tile.columns;
        }
        if (!from)
            throw std::runtime_error("the file of tiles is not complete");
        std::printf("[");
        for (std::size_t label = 0; label < classes; label += 3) {
            std::printf(label > 0 ? ",\n" : "");
            write_touch(label, 7, tiles);
        }
        std::printf("]\n");
    } catch (const std::exception& error) {
        std::fprintf(stderr, "reference: %s\n", error.what());
        return 1;
    }
    return 0;
}

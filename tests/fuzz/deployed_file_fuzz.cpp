// Any bytes as the file of a network in 8 bits: it is loaded, or refused with a file_error, and nothing else
// happens. What was loaded takes any frame, bit-exact once saved and loaded again.

#include "fuzz_target.hpp"
#include "safetensors_input.hpp"

#include <tactnet/io/eight_bit_file.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/quantisation.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace {

using fuzz::require;

/// Small, with all that arrays may be: of words, sums, a batch norm, branches, an average pool.
using net = tactnet::network<tactnet::shape{3, 4}, tactnet::conv2d<4, 2>, tactnet::relu,
                             tactnet::residual<tactnet::sequence<tactnet::conv2d<4, 1>>>, tactnet::batch_norm,
                             tactnet::concatenation<tactnet::sequence<tactnet::conv2d<4, 1>>,
                                                    tactnet::sequence<tactnet::conv2d<4, 1>>>,
                             tactnet::average_pool<2>, tactnet::dense<3>>;
using in_bytes = tactnet::deployed<net, tactnet::eight_bit>;
constexpr std::size_t pixels = net::input_shape.size();

std::vector<std::uint8_t> frames() {
    std::vector<std::uint8_t> all;
    for (std::size_t i = 0; i < 3 * pixels; ++i)
        all.push_back(static_cast<std::uint8_t>(i < pixels ? 255 * (i % 2) : i * 83));
    return all;
}
std::vector<float> outputs_of(const in_bytes& network) {
    return tactnet::detail::logits_of(network, frames(), network.classes().size());
}
tactnet::safetensors_writer file_of(const in_bytes& network, std::span<const std::uint8_t> selftest = {}) {
    tactnet::safetensors_writer writer;
    tactnet::add_deployed(writer, tactnet::folded_layout_of<in_bytes::view_type>(), network.folded(),
                          network.classes(), selftest, [&](std::span<const std::uint8_t> images) {
                              return tactnet::detail::logits_of(network, images, network.classes().size());
                          });
    return writer;
}

void check(std::vector<std::byte> bytes) {
    try {
        // Or hardly any mutated file would come further.
        const auto file =
            tactnet::safetensors::parse(std::move(bytes), "input", tactnet::checksum_rule::ignore);
        const auto loaded = tactnet::load_deployed<net, tactnet::eight_bit>(file);
        const auto again = tactnet::load_deployed<net, tactnet::eight_bit>(
            tactnet::safetensors::parse(file_of(loaded).to_bytes(), "again"));
        require(std::memcmp(loaded.folded().data(), again.folded().data(), loaded.folded().size_bytes()) ==
                0);
        const std::vector<float> before = outputs_of(loaded), after = outputs_of(again);
        require(std::memcmp(before.data(), after.data(), before.size() * sizeof(float)) == 0);
    } catch (const tactnet::file_error& error) {
        require(error.file().starts_with("input") && !error.expected().empty() && !error.found().empty());
    }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    check_both_forms(data, size, check);
    return 0;
}

std::vector<std::vector<std::uint8_t>> fuzz_seeds() {
    std::vector<std::vector<std::uint8_t>> seeds;
    tactnet::model<net> model;
    float number = 0;
    model.network.for_each_parameter([&](const tactnet::parameter& p, auto values) {
        for (float& v : values)
            v = p.role == tactnet::parameter_role::running_variance
                    ? 1
                    : ((number += 37) > 50 ? number -= 101 : number) / 64;
    });
    model.normalise.scale = 1.0f / 64;
    model.classes = {"a", "b", "c"};
    const std::vector<std::uint8_t> some = frames();
    add_seeds(seeds, file_of(tactnet::deploy<tactnet::eight_bit>(model, std::span(some)), some));
    model.classes = {"a", "b"};
    add_seeds(seeds, file_of(tactnet::deploy<tactnet::eight_bit>(model, std::span(some))));
    return seeds;
}

// TACTNET_TEST_UNIT is the function's name.

#include "reduced.hpp"

#include "deployed_network.hpp"

#include <tactnet/networks/tactnet4.hpp>

#include <bit>

#define TACTNET_TEST_TEXT_OF(name) #name
#define TACTNET_TEST_TEXT(name) TACTNET_TEST_TEXT_OF(name)

using namespace tactnet;

namespace {

template <class Network>
void append(reduced_result& result, std::uint64_t seed) {
    Network net;
    support::fill(net, seed);
    // Small enough that no softmax is sure of itself: an output of one would hide all errors.
    constexpr std::size_t size = Network::input_shape.size();
    constexpr float scale = 1.0f / 128;
    const std::vector<float> mean(size, 40.5f);
    const auto fast = deploy(net, std::span<const float, size>(mean), scale);
    const auto layers = support::describe<Network>();
    const std::vector<std::uint8_t> counts = support::make_frame(size, seed);
    std::vector<float> out(Network::outputs, NAN);
    const auto status = fast(tensor_view<const std::uint8_t, Network::input_shape>(counts.data()),
                             std::span<float, Network::outputs>(out));
    const std::vector<float> exact(counts.begin(), counts.end());
    support::error_shares errors =
        support::shares_of(out, support::bounded_outputs(layers, support::parameters_of(net),
                                                         support::bounded_input(exact, mean, scale)));
    if (status != frame_status::recognised)
        errors.of_bound = INFINITY;
    for (const float o : out)
        result.bits.push_back(std::bit_cast<std::uint32_t>(o));
    result.of_bound = std::max(result.of_bound, errors.of_bound);
    result.of_deviation = std::max(result.of_deviation, errors.of_deviation);
}

} // namespace

reduced_result TACTNET_TEST_UNIT() {
    reduced_result result;
    result.instruction_set = TACTNET_TEST_TEXT(TACTNET_ARCH);
    append<tactnet4<shape{14, 25}, 22>>(result, 31);
    // Tiles, taps, a sum, overlapping pools, softmax; channels that fill no vector.
    append<network<shape{9, 10, 2}, batch_norm, conv2d<12, 3>, relu, max_pool<3, 1>,
                   residual<sequence<conv2d<12, 3>, batch_norm>>, relu, conv2d<33, 2>, max_pool<2>, relu,
                   conv2d<5, extent(2, 3), 2, pad(1)>, batch_norm, dense<9>, softmax>>(result, 32);
    return result;
}

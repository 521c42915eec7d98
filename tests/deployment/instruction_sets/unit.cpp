// TACTNET_TEST_UNIT is the function's name.

#include "unit.hpp"

#include "../deployed_network.hpp"

#include <tactnet/detail/instruction_set.hpp>
#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/quantisation/calibration.hpp>
#include <tactnet/quantisation/stream_calibration.hpp>
#include <tactnet/runtime/thread_pool.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <support/layers/whole_reference.hpp>
#include <support/layers/whole_reference_streams.hpp>
#include <support/same_bits.hpp>

using namespace tactnet;

namespace {

/// Whether frames that pass together, on one thread or two, have the bits of each alone.
template <class Network, class Deployed>
bool same_together(const Deployed& fast, std::uint64_t seed) {
    constexpr std::size_t many = 9, size = Network::input_shape.size(), outputs = Network::outputs;
    std::vector<std::uint8_t> frames;
    std::vector<float> alone(many * outputs);
    bool same = true;
    for (std::size_t frame = 0; frame < many; ++frame) {
        const std::vector<std::uint8_t> counts = support::make_frame(size, seed + frame);
        frames.insert(frames.end(), counts.begin(), counts.end());
        same &= fast.infer(tensor_view<const std::uint8_t, Network::input_shape>(counts.data()),
                           std::span<float, outputs>(alone.data() + frame * outputs, outputs)) ==
                frame_status::ok;
    }
    for (const std::size_t threads : {1U, 2U}) {
        thread_pool pool(threads);
        std::vector<float> together(many * outputs, NAN);
        same &= fast.infer(std::span<const std::uint8_t>(frames), std::span<float>(together), pool) ==
                    frame_status::ok &&
                support::same_bits(together, alone);
    }
    return same;
}

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
    const auto status = fast.infer(tensor_view<const std::uint8_t, Network::input_shape>(counts.data()),
                                   std::span<float, Network::outputs>(out));
    const std::vector<float> exact(counts.begin(), counts.end());
    support::error_shares errors =
        support::shares_of(out, support::bounded_outputs(layers, support::parameters_of(net),
                                                         support::bounded_input(exact, mean, scale)));
    if (status != frame_status::ok)
        errors.of_bound = INFINITY;
    result.same_together = result.same_together && same_together<Network>(fast, seed);
    for (const float o : out)
        result.bits.push_back(std::bit_cast<std::uint32_t>(o));
    result.of_bound = std::max(result.of_bound, errors.of_bound);
    result.of_deviation = std::max(result.of_deviation, errors.of_deviation);
}

/// A network in 8 bits of drawn numbers, folded already: folding and calibrating take sums of floats, which
/// may differ from one instruction set to another. From there on all is whole, or rounded once.
template <class Network>
void append_whole(reduced_result& result, std::uint64_t seed) {
    using in_bytes = deployed<Network, eight_bit>;
    using view = typename in_bytes::view_type;
    constexpr std::size_t size = Network::input_shape.size();
    support::numbers draw(seed);
    // Whole numbers divided by powers of two: no product with them is contracted into another number.
    const auto next = [&](float low, float high, float parts) {
        return std::round(draw.next(low * parts, high * parts)) / parts;
    };
    std::vector<float> folded(view::folded_elements);
    for (float& number : folded)
        number = next(-0.25f, 0.25f, 4096);
    for (std::size_t e = 0; e < size; ++e)
        folded[e] = next(0, 60, 1024);
    folded[size] = 64, folded[size + 1] = 500; // steps of a count, the largest count
    const detail::calibration_graph steps = calibration_graph_of<view>();
    std::vector<map_range> ranges{{1.0f / 2048, 0}}; // the frame's
    while (ranges.size() < steps.ranges)
        ranges.push_back({next(2, 6, 16) / 128, next(60, 200, 1)});
    steps.set_ranges(folded.data(), ranges);
    for (const folded_step& step : folded_layout_of<view>().steps)
        if (const auto* const epsilon = step.find("epsilon"))
            folded[epsilon->offset] = 0x1p-10f;

    const in_bytes network{std::span<const float, view::folded_elements>(folded)};
    result.same_together = result.same_together && same_together<Network>(network, seed);
    for (std::uint64_t frame = 0; frame < 4; ++frame) {
        const std::vector<std::uint8_t> counts = support::make_frame(size, seed + frame);
        std::vector<float> out(Network::outputs, NAN);
        const auto status =
            network.infer(tensor_view<const std::uint8_t, Network::input_shape>(counts.data()),
                          std::span<float, Network::outputs>(out));
        const std::vector<float> expected =
            support::reference_outputs<view>(folded, std::span<const std::uint8_t>(counts));
        result.as_reference = result.as_reference && status == frame_status::ok;
        for (std::size_t o = 0; o < out.size(); ++o) {
            result.whole.push_back(std::bit_cast<std::uint32_t>(out[o]));
            result.as_reference =
                result.as_reference && result.whole.back() == std::bit_cast<std::uint32_t>(expected.at(o));
        }
    }
}

/// A stream in 8 bits of drawn numbers, folded already.
template <class Network>
void append_stream(reduced_result& result, std::uint64_t seed) {
    using stream_in_bytes = deployed_stream<Network, eight_bit>;
    using lowered = typename lowered_stream<Network, eight_bit>::type;
    using view = typename stream_in_bytes::view_type;
    support::numbers draw(seed);
    const auto next = [&](float low, float high, float parts) {
        return std::round(draw.next(low * parts, high * parts)) / parts;
    };
    std::vector<float> parameters(Network::parameters), folded(stream_in_bytes::folded_elements),
        recording(6 * stream_in_bytes::features);
    for (float& number : parameters)
        number = next(-0.5f, 0.5f, 4096);
    for (float& number : recording)
        number = next(-2, 2, 4096);
    std::fill_n(folded.data(), stream_in_bytes::features, 1.0f / 4096);
    lowered::fold({parameters.data(), nullptr, 0}, folded.data() + view::steps_folded);
    const detail::calibration_graph net = calibration_graph_of<view>();
    std::vector<map_range> ranges{{1.0f / 4096, 0}}; // of the words
    while (ranges.size() < net.ranges)
        ranges.push_back({next(2, 6, 16) / 128, next(60, 200, 1)});
    net.set_ranges(folded.data(), ranges);

    const stream_in_bytes stream{std::span<const float, stream_in_bytes::folded_elements>(folded)};
    typename stream_in_bytes::state memory;
    std::vector<float> out(6 * stream_in_bytes::outputs, NAN);
    result.as_reference =
        result.as_reference && stream.run(recording, memory, out) == 6 &&
        support::same_bits(out, support::reference_stream_outputs<Network>(folded, recording));
    for (const float o : out)
        result.whole.push_back(std::bit_cast<std::uint32_t>(o));
}

// All instruction sets fuse the same layers, here one pool of three: files name weights by the steps.
using of_pools = network<shape{36, 36}, conv2d<8, 3>, max_pool<3>, conv2d<16, 3>, max_pool<extent2d(2, 3)>,
                         relu, conv2d<4, 3>, max_pool<4>, dense<3>>;
static_assert(lowered_network<of_pools>::step::size == 6);

} // namespace

reduced_result TACTNET_TEST_UNIT() {
    reduced_result result;
    result.instruction_set = tactnet::instruction_set.data();
    append<tactnet4<shape{14, 25}, 22>>(result, 31);
    // Tiles, taps, a sum, overlapping pools, softmax; channels that fill no vector.
    append<network<shape{9, 10, 2}, batch_norm, conv2d<12, 3>, relu, max_pool<3, 1>,
                   residual<sequence<conv2d<12, 3>, batch_norm>>, relu, conv2d<33, 2>, max_pool<2>, relu,
                   conv2d<5, extent2d(2, 3), 2, pad(1)>, batch_norm, dense<9>, softmax>>(result, 32);
    // In 8 bits: words with few channels and with several, pools, a sum, branches, groups, strides.
    append_whole<
        network<shape{14, 13}, conv2d<8, 5>, relu, max_pool<2>, conv2d<16, 3>, relu, conv2d<7, 3>, dense<6>>>(
        result, 33);
    append_whole<network<shape{9, 10, 2}, batch_norm, conv2d<12, 3>, relu, max_pool<3, 1>,
                         residual<sequence<conv2d<12, 3>>>, relu,
                         concatenation<sequence<conv2d<4, 1>, relu>, sequence<conv2d<16, 3>, relu>>,
                         conv2d<33, 2>, max_pool<2>, relu, conv2d<6, 3, 1, padding::same, in_groups(3)>, relu,
                         conv2d<5, extent2d(2, 3), 2, pad(1)>, average_pool<2, 1>, dense<9>>>(result, 34);
    append_whole<network<shape{13, 14}, conv2d<12, 3>, max_pool<3>, relu, conv2d<20, 3>,
                         max_pool<extent2d(2, 4)>, dense<5>>>(result, 35);
    append_whole<
        network<shape{9, 8}, conv2d<12, 3>, group_norm<3>, relu, conv2d<20, 3>, instance_norm, conv2d<7, 3>,
                layer_norm<norm_over::channels>, conv2d<16, 3>, layer_norm<norm_over::frame>, dense<5>>>(
        result, 36);
    append_whole<network<shape{6, 7}, conv2d<9, 3>, local_response_norm<5, std::ratio<5>>, conv2d<6, 3>,
                         local_response_norm<2, std::ratio<1>, std::ratio<1, 2>, std::ratio<2>>, dense<3>>>(
        result, 39);
    append_stream<network<shape{9, 1, 3}, causal_conv1d<6, 3, 2>, relu, residual<causal_conv1d<6, 2>>,
                          gru<21>, lstm<18>, last_frame, dense<4>>>(result, 37);
    append_stream<network<shape{9, 1, 7}, lstm<5>, gru<33>>>(result, 38);
    return result;
}

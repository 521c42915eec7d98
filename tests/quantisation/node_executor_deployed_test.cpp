#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <deployment/eight_bit/networks.hpp>
#include <string>
#include <utility>
#include <vector>

// Whole networks by plain loops, compared with the deployed ones that they describe.

using namespace tactnet;
using support::mean_square;

namespace {

/// Every kind of step that there is.
using all_steps =
    network<shape{11, 10, 2}, square_root<std::ratio<3, 8>>, conv2d<8, 3>, batch_norm, relu, max_pool<3, 2>,
            residual<sequence<conv2d<8, 3>, relu, conv2d<12, 3>>, sequence<conv2d<12, 1>>>, relu,
            concatenation<sequence<conv2d<4, 1>, relu>, sequence<conv2d<8, 3>, relu>>,
            squeeze_excitation<12, 4>, conv2d<6, extent2d(2, 3), 1, pad(1), conv2d_options{.groups = 2}>,
            max_pool<2>, batch_norm, relu, residual<sequence<conv2d<6, 3>>>, average_pool<2, 1>, dense<5>>;
/// Every kind of step that gives a map another size, and a step with numbers of its own.
using resizing_steps = network<shape{7, 6, 2}, conv2d<8, 3>, parametric_relu,
                               upsample_to<extent2d(11, 13), interpolation::bilinear>, conv2d<5, 2, 2>,
                               adaptive_max_pool<extent2d(5, 4)>, transposed_conv2d<6, 3, 2>, relu,
                               upsample<extent2d(1, 2)>, conv2d<5, 2, 2>, parametric_relu, dense<5>>;
/// Norms with moments of each frame, and of responses.
using norm_steps =
    network<shape{7, 6, 2}, conv2d<8, 3>, group_norm<4>, relu, conv2d<6, 3>, layer_norm<norm_over::frame>,
            conv2d<12, 1>, layer_norm<norm_over::channels>, local_response_norm<3, std::ratio<2>>,
            conv2d<5, 2, 2>, instance_norm, relu, dense<5>>;

/// The map that a description writes last, of a frame of counts with a mean of zero.
template <class Network>
std::vector<float> plain_outputs(const detail::calibration_graph& steps, std::span<const float> folded,
                                 std::span<const map_range> ranges, std::span<const float> counts,
                                 float scale, bool rounded) {
    constexpr shape input = Network::input_shape;
    std::vector<float> maps(steps.numbers);
    for (std::size_t e = 0; e < input.size(); ++e)
        maps[e % input.area() * input.channels + e / input.area()] = counts[e] * scale;
    for (const detail::graph_node& step : steps.nodes) {
        const detail::feature_map& to = steps.maps[step.output];
        detail::node_executor(steps, step, folded, rounded)
            .run(maps.data(), to.range == detail::calibration_graph::none ? map_range{} : ranges[to.range]);
    }
    return {maps.end() - static_cast<std::ptrdiff_t>(Network::outputs), maps.end()};
}
/// The ranges of all maps, in the order of a description; those of the frame first.
std::vector<map_range> ranges_of(const detail::calibration_graph& steps, const folded_layout& layout,
                                 std::span<const float> folded) {
    std::vector<map_range> ranges(steps.ranges);
    for (const detail::graph_node& step : steps.nodes)
        for (const folded_step& of : layout.steps)
            if (of.arrays[0].offset == step.folded)
                for (const auto& [map, name] :
                     {std::pair{step.input, "input"}, std::pair{step.output, "output"}})
                    if (const auto* const array = of.find(name))
                        ranges[steps.maps[map].range] = map_range::read(&folded[array->offset]);
    return ranges;
}

/// Roots of mean squares over some frames, of the outputs': what a description differs by from the deployed
/// network, with exact weights and rounded as 8 bits, and what 8 bits differ by from single precision.
struct deviations {
    double exact = 0, rounded = 0, rounding = 0;
};
template <class Network>
deviations deviations_of() {
    const auto net = std::make_unique<Network>();
    support::fill(*net, 90);
    constexpr std::size_t size = Network::input_shape.size(), count = 6;
    const std::array<float, size> zero{};
    const std::vector<float> frames = support::frames_for<Network>(count, 91);
    using bytes = support::byte_network<Network>;
    using view = typename bytes::view_type;
    const eight_bit_calibration<Network> calibration(*net, zero, support::input_scale,
                                                     std::span<const float>(frames));
    const bytes in_bytes(calibration.folded());
    const auto in_floats = deploy(*net, zero, support::input_scale);
    const detail::calibration_graph steps = calibration_graph_of<view>();
    std::vector<float> exact(view::folded_elements); // weights before they are rounded
    lowered_network<Network, eight_bit>::fold(
        {net->learnable_values().data(), net->running_statistics().data(), net->epsilon},
        exact.data() + view::steps_folded);
    const std::vector<map_range> ranges = ranges_of(steps, folded_layout_of<view>(), calibration.folded());
    deviations sums;
    double usual = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::span<const float> frame = std::span(frames).subspan(i * size, size);
        const tensor_view<const float, Network::input_shape> shown(frame.data());
        std::array<float, Network::outputs> floats, whole;
        CHECK(in_floats.infer(shown, floats) == frame_status::ok);
        CHECK(in_bytes.infer(shown, whole) == frame_status::ok);
        const auto of = [&](std::span<const float> folded, bool rounded) {
            return plain_outputs<Network>(steps, folded, ranges, frame, support::input_scale, rounded);
        };
        usual += mean_square(floats);
        sums.exact += mean_square(of(exact, false), floats);
        sums.rounded += mean_square(of(calibration.folded(), true), whole);
        sums.rounding += mean_square(floats, whole);
    }
    return {std::sqrt(sums.exact / usual), std::sqrt(sums.rounded / usual), std::sqrt(sums.rounding / usual)};
}

/// Folded numbers with which every sum is exact in single precision too: scales become powers of two, weights
/// whole multiples of them and biases of what a step of a sum stands for. Frames then have counts that are
/// multiples of 16, so that words of 128 steps a count are multiples of 2¹¹; so are the biases of the first
/// step.
std::vector<float> exact_in_single_precision(const folded_layout& layout, std::span<const float> found) {
    std::vector<float> folded(found.begin(), found.end());
    const auto power = [](float& scale) { scale = std::exp2(std::ceil(std::log2(scale))); };
    for (const folded_step& step : layout.steps) {
        for (const folded_step::array& array : step.arrays)
            for (std::size_t i = 0; i < array.size; ++i)
                if (array.kind == folded_kind::scales || (array.kind == folded_kind::range && i == 0))
                    power(folded[array.offset + i]);
        const auto* const biases = step.find("bias");
        const auto* const scales = step.find("scale");
        const auto* const input = step.find("input");
        if (biases == nullptr || scales == nullptr)
            continue;
        const float together = &step == layout.steps.data() ? 0x1p11f : 1.0f;
        for (std::size_t f = 0; f < biases->size; ++f) {
            const float unit = folded[scales->offset + f] * folded[input->offset] * together;
            float& bias = folded[biases->offset + f];
            bias = std::nearbyint(bias / unit) * unit;
        }
    }
    round_weights(layout, folded);
    return folded;
}
/// Of how many outputs and frames the bits are others than those of the deployed network. Products of at most
/// 127 × 255 are summed over fewer than 500 taps, so below 2²⁴; those of the frame, below 18 × 127 × 2¹⁵, are
/// multiples of 2¹¹.
template <class Network>
std::size_t outputs_that_differ() {
    const auto net = std::make_unique<Network>();
    support::fill(*net, 92);
    constexpr std::size_t size = Network::input_shape.size(), count = 6;
    const std::array<float, size> zero{};
    std::vector<float> frames = support::frames_for<Network>(count, 93);
    for (float& number : frames)
        number = std::floor(number / 16) * 16;
    using view = typename support::byte_network<Network>::view_type;
    const eight_bit_calibration<Network> calibration(*net, zero, support::input_scale,
                                                     std::span<const float>(frames));
    const folded_layout layout = folded_layout_of<view>();
    const std::vector<float> folded = exact_in_single_precision(layout, calibration.folded());
    const support::byte_network<Network> bytes(
        std::span<const float>(folded).template first<view::folded_elements>());
    const detail::calibration_graph steps = calibration_graph_of<view>();
    const std::vector<map_range> ranges = ranges_of(steps, layout, folded);
    std::size_t different = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::span<const float> frame = std::span(frames).subspan(i * size, size);
        std::array<float, Network::outputs> whole;
        CHECK(bytes.infer(tensor_view<const float, Network::input_shape>(frame.data()), whole) ==
              frame_status::ok);
        const auto plain = plain_outputs<Network>(steps, folded, ranges, frame, support::input_scale, true);
        for (std::size_t o = 0; o < whole.size(); ++o)
            different += whole[o] != plain[o];
    }
    return different;
}

} // namespace

TEST_CASE("node_executor: where sums are exact, a description gives the bits of the deployed network") {
    CHECK(outputs_that_differ<network<shape{11, 10, 2}, conv2d<8, 3>, relu, dense<5>>>() == 0);
    CHECK(outputs_that_differ<network<shape{11, 10, 2}, conv2d<8, 3>, relu, max_pool<2>, conv2d<6, 2>, relu,
                                      average_pool<2>, dense<5>>>() == 0);
    CHECK(
        outputs_that_differ<network<
            shape{7, 10, 2}, conv2d<8, 3>, relu, max_pool<2>,
            residual<sequence<conv2d<8, 3>, relu, conv2d<12, 3>>, sequence<conv2d<12, 1>>>,
            concatenation<sequence<conv2d<4, 1>, relu>, sequence<conv2d<8, 3>, relu>>,
            conv2d<6, 2, 1, padding::same, conv2d_options{.groups = 2}>, max_pool<2>, dense<5>, softmax>>() ==
        0);
    CHECK(outputs_that_differ<network<shape{7, 6, 2}, conv2d<8, 3>, relu, adaptive_max_pool<extent2d(5, 4)>,
                                      transposed_conv2d<6, 3, 2>, relu, upsample<extent2d(1, 2)>,
                                      conv2d<5, 2, 2>, upsample<2, interpolation::bilinear>, dense<5>>>() ==
          0);
    CHECK(outputs_that_differ<network<shape{7, 6, 2}, conv2d<8, 3>, dilated_conv2d<6, 3>, relu,
                                      dilated_conv2d<4, 2, 3>, dense<5>>>() == 0);
}

TEST_CASE("node_executor: a description gives what the deployed network gives, exact and rounded") {
    // Exact: both forms sum in single precision. The longest sum has fewer than 900 terms, and a sum of n
    // terms is off by n · 2⁻²⁴ of their magnitudes at most, by about √n of it as signs differ; ten layers,
    // two forms: 2 · 10 · √900 · 2⁻²⁴ = 3.6e-5, which cancellation may double.
    //
    // Rounded: each byte is off by step / √12. Where the numbers before rounding differ by a part d of a
    // step, that part of the bytes become the next byte, which is off by a step: √(12 d) of the rounding
    // error. Norms round weights to 15 bits, so d = 255 / 65534; roots to 1/1024, of a step of 1/16 at least
    // half of that, so d < 1/128; group, instance and layer norms to 1/256, twice, so d < 1/128 too; such
    // bytes then differ in the sums after them by as little. With two such maps, d below 1/50: a half. Two
    // roundings that had nothing in common would differ by √2. Where there is neither, sums alone differ, and
    // the test above says more.
    //
    // Bilinear means are ties once in as many as there are parts of a pixel, 22 × 26 here.
    const auto check = [](const deviations& found) {
        MESSAGE("exact " << found.exact << ", rounded " << found.rounded << " of " << found.rounding);
        CHECK(found.exact < 7.2e-5);
        CHECK(found.rounding > found.exact);
        CHECK(found.rounded < 0.5 * found.rounding);
    };
    check(deviations_of<network<shape{11, 10, 2}, square_root<>, conv2d<8, 3>, relu, dense<5>>>());
    check(deviations_of<network<shape{11, 10, 2}, conv2d<8, 3>, relu, max_pool<2>, batch_norm, relu,
                                average_pool<2, 1>, dense<5>>>());
    check(deviations_of<all_steps>());
    check(deviations_of<resizing_steps>());
    check(deviations_of<norm_steps>());
}

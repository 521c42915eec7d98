#include "../networks.hpp"

#include <tactnet/networks/tactnet4.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

// Weights that know the rounding, and the plain loops by which they are found.

using namespace tactnet;

namespace {

/// Every kind of step that there is.
using all_steps =
    network<shape{11, 10, 2}, square_root<std::ratio<3, 8>>, conv2d<8, 3>, batch_norm, relu, max_pool<3, 2>,
            residual<sequence<conv2d<8, 3>, relu, conv2d<12, 3>>, sequence<conv2d<12, 1>>>, relu,
            concatenation<sequence<conv2d<4, 1>, relu>, sequence<conv2d<8, 3>, relu>>,
            conv2d<6, extent(2, 3), 1, pad(1), conv2d_options{.groups = 2}>, max_pool<2>, batch_norm, relu,
            residual<sequence<conv2d<6, 3>>>, average_pool<2, 1>, dense<5>>;

/// The map that a description writes last, of a frame of counts with a mean of zero.
template <class Network>
std::vector<float> plain_outputs(const detail::plain_network& steps, std::span<const float> folded,
                                 std::span<const map_range> ranges, std::span<const float> counts,
                                 float scale, bool rounded) {
    constexpr shape input = Network::input_shape;
    std::vector<float> maps(steps.numbers);
    for (std::size_t e = 0; e < input.size(); ++e)
        maps[e % input.area() * input.channels + e / input.area()] = counts[e] * scale;
    for (const detail::plain_step& step : steps.steps) {
        const detail::plain_map& to = steps.maps[step.output];
        detail::plain_run(steps, step, folded, rounded)(
            maps.data(), to.range == detail::plain_network::none ? map_range{} : ranges[to.range]);
    }
    std::vector<float> outputs(maps.end() - static_cast<std::ptrdiff_t>(Network::outputs), maps.end());
    if (steps.softmax != nullptr)
        steps.softmax(outputs);
    return outputs;
}
/// Of all maps, in the order of a description; those of the frame first.
std::vector<map_range> ranges_of(const detail::plain_network& steps, const folded_layout& layout,
                                 std::span<const float> folded) {
    std::vector<map_range> ranges(steps.ranges);
    for (const detail::plain_step& step : steps.steps)
        for (const folded_step& of : layout.steps)
            if (of.arrays[0].begin == step.folded)
                for (const auto& [map, name] :
                     {std::pair{step.input, "input"}, std::pair{step.output, "output"}})
                    if (const auto* const array = of.find(name))
                        ranges[steps.maps[map].range] = map_range::read(&folded[array->begin]);
    return ranges;
}
double mean_square(std::span<const float> a, std::span<const float> b = {}) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += std::pow(static_cast<double>(a[i]) - (b.empty() ? 0.0 : static_cast<double>(b[i])), 2);
    return sum / static_cast<double>(a.size());
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
    const detail::plain_network steps = plain_network_of<view>();
    std::vector<float> exact(view::folded_elements); // weights before they are rounded
    deployment_plan<Network, eight_bit>::fold(
        {net->learnable_values().data(), net->running_statistics().data(), net->epsilon},
        exact.data() + view::steps_folded);
    const std::vector<map_range> ranges = ranges_of(steps, folded_layout_of<view>(), calibration.folded());
    deviations sums;
    double usual = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::span<const float> frame = std::span(frames).subspan(i * size, size);
        const tensor_view<const float, Network::input_shape> shown(frame.data());
        std::array<float, Network::outputs> floats, whole;
        CHECK(in_floats(shown, floats) == frame_status::recognised);
        CHECK(in_bytes(shown, whole) == frame_status::recognised);
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

/// Numbers less than its one folded number become it.
struct at_least_step {
    static constexpr shape output{1, 3, 2};
    static constexpr std::size_t folded = 3, ranges = 1;
    static void set_ranges(float* to, const step_ranges& of_maps) { of_maps.input.write(to + 1); }
    static void exactly(const float* numbers, const float* in, float* out) {
        for (std::size_t e = 0; e < output.size(); ++e)
            out[e] = std::max(in[e], numbers[0]);
    }
};

/// Weights [output][input] for a dense layer over two inputs, and images of it.
using pair_net = network<shape{1, 2}, dense<1>>;
eight_bit_calibration<pair_net> on_pairs(const std::vector<float>& images) {
    pair_net n;
    const std::array<float, 3> values{127.4f / 127, 127.4f / 127 * 0.00354f, 0}; // 127 steps, and 0.45 of one
    std::copy(values.begin(), values.end(), n.learnable_values().begin());
    const std::array<float, 2> zero{};
    return {n, zero, 1, std::span<const float>(images)};
}

/// One filter over two inputs that go together, as in `on_pairs`: a description by hand. The frame's map has
/// the first range, that of words, or another, that of bytes.
constexpr float first = 127.4f, second = 0.49f;
detail::plain_network pair_description(std::size_t range_of_frame) {
    detail::plain_network net;
    net.ranges = 2;
    const std::size_t input = net.add_map({1, 2}, range_of_frame),
                      output = net.add_map({1, 1}, detail::plain_network::none);
    detail::plain_step step{.window = {{1, 2}, extent(1, 2), 1}, .filters = 1, .input = input};
    step.output = output;
    step.from = {1, 2}, step.to = {1, 1};
    step.folded = 4; // behind the mean and what words hold
    net.steps.push_back(step);
    return net;
}
std::vector<float> pair_images(float unit) {
    std::vector<float> images;
    for (int i = 0; i < 64; ++i) {
        const float x = unit * static_cast<float>(1 + i % 30);
        images.insert(images.end(), {x, 7 * x});
    }
    return images;
}
/// What weights_fit makes of two weights and a bias; weights are in steps of 1, and inputs are whole.
std::vector<float> fitted_pair(std::size_t range_of_frame, float bias) {
    const std::vector<float> exact{0, 0, 128, 255, first, second, bias, 1};
    const std::vector<map_range> ranges(2, map_range{1, 0});
    const detail::plain_network net = pair_description(range_of_frame);
    const detail::weights_fit found(net, ranges, exact, 1, pair_images(100));
    return {found.folded().begin() + 4, found.folded().end()};
}

/// Ranges and weights for one filter over two inputs, by someone who tells what error each weight makes.
struct judged_pair {
    std::vector<float> folded;
    double error, error_of_rounded;
};
judged_pair judge_pairs(float told) {
    static float error_of_fitted;
    error_of_fitted = told;
    std::vector<float> folded{0, 0, 0, 0, first, second, 0, 1};
    const detail::range_search found(
        pair_description(0), std::move(folded), 1, pair_images(1),
        [](std::span<const float> numbers, std::span<const float> shown, std::span<float> to) {
            const bool fitted = numbers[5] != second;
            for (std::size_t i = 0; i < to.size(); ++i)
                to[i] = shown[2 * i] * first + shown[2 * i + 1] * second + (fitted ? error_of_fitted : 2);
            return true;
        });
    return {{found.folded().begin() + 4, found.folded().end()}, found.error(), found.error_of_rounded()};
}

} // namespace

TEST_CASE("pixel_stride: all pixels of an image are met, of about as many as are enough") {
    for (const std::size_t pixels : {1u, 6u, 45u, 91u, 180u, 350u, 1400u})
        for (const std::size_t images : {8u, 100u, 704u, 1024u})
            for (const std::size_t enough : {8192u, 9216u}) {
                const std::size_t stride = detail::pixel_stride(images, pixels, enough);
                std::vector<bool> met(pixels);
                std::size_t taken = 0;
                for (std::size_t p = 0; p < images * pixels; p += stride, ++taken)
                    met[p % pixels] = true;
                CAPTURE(pixels);
                CAPTURE(images);
                CHECK(std::ranges::all_of(met, [](bool each) { return each; }));
                CHECK(taken >= std::min(images * pixels, enough / 2));
            }
}

TEST_CASE("plain_run: a description gives what the deployed network gives, exact and rounded") {
    // Sums in another order may fall on the other side of a tie, and the byte beside be written: the more
    // maps there are, the more often.
    const auto check = [](const deviations& found, double most) {
        CHECK(found.exact < 1e-4);
        CHECK(found.rounding > 1e-3);
        CHECK(found.rounded < most * found.rounding);
    };
    check(deviations_of<network<shape{11, 10, 2}, conv2d<8, 3>, relu, dense<5>>>(), 0.02);
    check(deviations_of<network<shape{11, 10, 2}, square_root<>, conv2d<8, 3>, relu, dense<5>>>(), 0.3);
    check(deviations_of<network<shape{11, 10, 2}, conv2d<8, 3>, relu, max_pool<2>, batch_norm, relu,
                                average_pool<2, 1>, dense<5>>>(),
          0.02);
    check(
        deviations_of<network<shape{11, 10, 2}, conv2d<8, 3>, relu,
                              residual<sequence<conv2d<8, 3>, relu, conv2d<12, 3>>, sequence<conv2d<12, 1>>>,
                              conv2d<6, 2, 1, same, conv2d_options{.groups = 2}>, dense<5>>>(),
        0.3);
    check(deviations_of<network<shape{11, 10, 2}, conv2d<8, 3>, relu,
                                concatenation<sequence<conv2d<4, 1>, relu>, sequence<conv2d<8, 3>, relu>>,
                                dense<5>, softmax>>(),
          0.3);
    check(deviations_of<all_steps>(), 0.5);
}

TEST_CASE("plain_run: a step of one's own is run as it says") {
    detail::plain_description description(at_least_step::output, 4);
    CHECK(description.append<at_least_step>(0) == 1);
    const detail::plain_network& steps = description.network();
    REQUIRE(steps.steps.size() == 1);
    std::vector<float> folded{9, 9, 9, 9, 0.5f, 0, 0};
    const std::vector<map_range> ranges{{0.25f, 7}};
    steps.set_ranges(folded.data(), ranges);
    CHECK(folded == std::vector<float>{9, 9, 9, 9, 0.5f, 0.25f, 7});
    std::vector<float> maps{-1, 0.25f, 0.75f, 3, 0, 0.5f, 0, 0, 0, 0, 0, 0};
    detail::plain_run(steps, steps.steps[0], folded, false)(maps.data(), {});
    CHECK(std::vector<float>(maps.begin() + 6, maps.end()) ==
          std::vector<float>{0.5f, 0.5f, 0.75f, 3, 0.5f, 0.5f});
}

TEST_CASE("eight_bit_calibration: fitted weights bring outputs nearer, on frames that it has not seen") {
    using net = tactnet4<shape{7, 13}, 22>;
    const auto network = std::make_unique<net>();
    support::fill(*network, 95);
    const std::vector<float> mean = support::mean_for<net>(95), frames = support::frames_for<net>(96, 96);
    constexpr std::size_t size = net::input_shape.size();
    const auto mean_frame = std::span(mean).first<size>();
    const eight_bit_calibration<net> fitted(*network, mean_frame, support::input_scale,
                                            std::span<const float>(frames)),
        again(*network, mean_frame, support::input_scale, std::span<const float>(frames));
    CHECK(support::same_bits(fitted.folded(), again.folded()));
    MESSAGE("root of the mean square: " << fitted.output_error() << ", of merely rounded weights "
                                        << fitted.output_error_of_rounded());
    CHECK(fitted.output_error() < 0.9 * fitted.output_error_of_rounded());

    // The same ranges and scales, with weights that are merely rounded.
    std::vector<float> rounded(fitted.folded().begin(), fitted.folded().end());
    deployment_plan<net, eight_bit>::fold(
        {network->learnable_values().data(), network->running_statistics().data(), network->epsilon},
        rounded.data() + support::byte_network<net>::view_type::steps_folded);
    const folded_layout layout = folded_layout_of<support::byte_network<net>::view_type>();
    for (const folded_step& step : layout.steps)
        for (const folded_step::array& array : step.arrays)
            if (array.kind == folded_kind::scales || array.kind == folded_kind::range)
                std::copy_n(fitted.folded().begin() + static_cast<std::ptrdiff_t>(array.begin), array.size,
                            rounded.begin() + static_cast<std::ptrdiff_t>(array.begin));
    round_weights(layout, rounded);
    const support::byte_network<net> with_fit(fitted.folded()),
        without(
            std::span<const float>(rounded).first<support::byte_network<net>::view_type::folded_elements>());
    const auto exact = deploy(*network, mean_frame, support::input_scale);
    double of_fitted = 0, of_rounded = 0;
    for (std::size_t i = 0; i < 60; ++i) {
        const auto counts = support::make_frame(size, 5000 + i);
        const tensor_view<const std::uint8_t, net::input_shape> frame(counts.data());
        std::array<float, net::outputs> a, b, c;
        CHECK(exact(frame, a) == frame_status::recognised);
        CHECK(with_fit(frame, b) == frame_status::recognised);
        CHECK(without(frame, c) == frame_status::recognised);
        of_fitted += mean_square(a, b), of_rounded += mean_square(a, c);
    }
    CHECK(of_fitted < 0.9 * of_rounded);
    // Weights are whole multiples still, of the same scales.
    std::vector<float> whole(fitted.folded().begin(), fitted.folded().end());
    round_weights(layout, whole);
    CHECK(support::same_bits(whole, fitted.folded()));
}

TEST_CASE("eight_bit_calibration: fitted weights bring outputs nearer in residual blocks too") {
    using net = network<shape{6, 5}, conv2d<8, 3>, relu, residual<sequence<conv2d<8, 3>>>, relu,
                        residual<sequence<conv2d<12, 3>>, sequence<conv2d<12, 1>>>, relu, dense<5>>;
    const auto network = std::make_unique<net>();
    support::fill(*network, 97);
    const auto calibration = support::calibrated(*network, 97, 96);
    CHECK(calibration.output_error() < 0.9 * calibration.output_error_of_rounded());
}

TEST_CASE("eight_bit_calibration: a weight makes up for what another one loses, where inputs go together") {
    // Merely rounded, the second weight is 0: 0.45 of a step are lost. Where the second input is always seven
    // times the first, 3.15 steps are lost of the first one's sum, and three of them come back.
    std::vector<float> together, apart;
    for (int i = 0; i < 64; ++i) {
        const auto x = static_cast<float>(1 + i % 30);
        together.insert(together.end(), {x, 7 * x});
        apart.insert(apart.end(), {x, 7 * static_cast<float>(1 + i * 11 % 31)});
    }
    const auto fitted = on_pairs(together);
    CHECK(fitted.output_error() < 0.6 * fitted.output_error_of_rounded());
    CHECK(on_pairs(apart).output_error() <= on_pairs(apart).output_error_of_rounded());

    // Images that took no part say otherwise: then weights are as they were.
    std::vector<float> contradicted = together;
    for (std::size_t i = 7; i < 64; i += 8)
        contradicted[2 * i + 1] = 0;
    const auto judged = on_pairs(contradicted);
    CHECK(judged.output_error() == judged.output_error_of_rounded());
    // Of seven images none is left to judge.
    together.resize(14);
    const auto few = on_pairs(together);
    CHECK(few.output_error() == few.output_error_of_rounded());
}

TEST_CASE("filter_fit: no move of one weight brings the sums nearer") {
    constexpr std::size_t taps = 5;
    support::numbers draw(7);
    detail::pixel_moments seen(taps, 1);
    std::vector<float> exact(taps);
    const float scale = 0.11f;
    for (std::size_t t = 0; t < taps; ++t) // rounded, all of them become smaller
        exact[t] = (static_cast<float>(t) - 1.6f) * scale;
    for (int pixel = 0; pixel < 200; ++pixel) {
        const float common = draw.next(0, 3);
        std::vector<std::pair<std::size_t, float>> inputs;
        float wanted = 0.25f;
        for (std::size_t t = 0; t < taps; ++t) {
            inputs.emplace_back(t, common + draw.next(0, 1));
            wanted += exact[t] * inputs.back().second;
        }
        seen.add(inputs, std::span<const float>(&wanted, 1));
    }
    std::vector<float> rounded(taps), fitted(taps);
    for (std::size_t t = 0; t < taps; ++t)
        rounded[t] = std::nearbyint(exact[t] / scale) * scale;
    detail::filter_fit(seen, taps)(0, exact, scale, fitted);
    const auto error = [&](const std::vector<float>& weights) {
        return seen.error(0, weights, seen.best_bias(0, weights));
    };
    const double least = error(fitted);
    CHECK(least < 0.5 * error(rounded));
    CHECK(error(exact) < 1e-6);
    for (std::size_t t = 0; t < taps; ++t)
        for (const float step : {-scale, scale}) {
            std::vector<float> moved = fitted;
            moved[t] += step;
            CHECK(error(moved) >= least);
        }
    // A bias beside the best one does worse, by the square of the distance.
    CHECK(seen.error(0, fitted, seen.best_bias(0, fitted) + 0.5) == doctest::Approx(least + 0.25));
}

TEST_CASE("weights_fit: weights whose sums might pass 32 bits are not taken") {
    // The fit turns (127, 0) into (124, 1): the second input is always seven times the first.
    const auto changes = [](std::size_t range, float bias) { return fitted_pair(range, bias)[1] != second; };
    const std::vector<float> near = fitted_pair(0, 0);
    CHECK(near[0] == 124);
    CHECK(near[1] == 1);
    CHECK(changes(1, 0));
    // Beside this bias there is room for bytes, which are at most 255, not for words, which reach 32768.
    constexpr float nearly_all = 0x1p31f - 0x1p21f;
    CHECK(!changes(0, nearly_all));
    CHECK(changes(1, nearly_all));
    // And where there is none for bytes.
    CHECK(!changes(1, 0x1p31f - 0x1p16f));
    CHECK(fitted_pair(0, nearly_all) == std::vector<float>{first, second, nearly_all, 1});
}

TEST_CASE("range_search: fitted weights are kept if outputs come nearer, and only then") {
    const judged_pair better = judge_pairs(1), no_better = judge_pairs(2), worse = judge_pairs(3);
    for (const judged_pair& each : {better, no_better, worse})
        CHECK(each.error_of_rounded == doctest::Approx(4));
    CHECK(better.error == doctest::Approx(1));
    CHECK(better.folded[0] == 124);
    CHECK(better.folded[1] == 1);
    for (const judged_pair& each : {no_better, worse}) {
        CHECK(each.error == each.error_of_rounded);
        CHECK(each.folded[0] == first);
        CHECK(each.folded[1] == second);
        CHECK(each.folded[2] == 0);
    }
}

#include "pair.hpp"

#include <tactnet/networks/tactnet4.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <deployment/eight_bit/networks.hpp>
#include <utility>
#include <vector>

// Rounded weights that make up for one another, of one filter and of whole networks.

using namespace tactnet;
using support::largest_byte;
using support::largest_word;
using support::mean_square;

namespace {

/// Weights [output][input] for a dense layer over two inputs, and images of it.
using pair_net = network<shape{1, 2}, dense<1>>;
eight_bit_calibration<pair_net> on_pairs(const std::vector<float>& images) {
    pair_net n;
    const std::array<float, 3> values{-127, 0.45f, 0}; // in steps of 1: so whole inputs give exact sums
    std::copy(values.begin(), values.end(), n.learnable_values().begin());
    const std::array<float, 2> zero{};
    return {n, zero, 1, std::span<const float>(images)};
}

/// The result of weight_rounding for two weights and a bias; weights are in steps of 1, and inputs are whole.
std::vector<float> fitted_pair(double largest_input, float bias) {
    const std::vector<float> exact{0, 0, 128, 255, support::first_weight, support::second_weight, bias, 1};
    const std::vector<map_range> ranges(2, map_range{1, 0});
    const detail::calibration_graph net = support::pair_description(largest_input);
    const detail::weight_rounding found(net, ranges, exact, 1, support::pair_images(100));
    return {found.folded().begin() + 4, found.folded().end()};
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
    // A tenth nearer is what is asked of the fit, no tolerance of rounding: of weights moved without
    // regard to one another, sums would come no nearer.
    CHECK(fitted.output_error() < 0.9 * fitted.output_error_of_rounded());

    // The same ranges and scales, with weights that are merely rounded.
    std::vector<float> rounded(fitted.folded().begin(), fitted.folded().end());
    lowered_network<net, eight_bit>::fold(
        {network->learnable_values().data(), network->running_statistics().data(), network->epsilon},
        rounded.data() + support::byte_network<net>::view_type::steps_folded);
    const folded_layout layout = folded_layout_of<support::byte_network<net>::view_type>();
    for (const folded_step& step : layout.steps)
        for (const folded_step::array& array : step.arrays)
            if (array.kind == folded_kind::scales || array.kind == folded_kind::range)
                std::copy_n(fitted.folded().begin() + static_cast<std::ptrdiff_t>(array.offset), array.size,
                            rounded.begin() + static_cast<std::ptrdiff_t>(array.offset));
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
        CHECK(exact.infer(frame, a) == frame_status::ok);
        CHECK(with_fit.infer(frame, b) == frame_status::ok);
        CHECK(without.infer(frame, c) == frame_status::ok);
        of_fitted += mean_square(a, b), of_rounded += mean_square(a, c);
    }
    CHECK(of_fitted < 0.9 * of_rounded); // as above
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
    CHECK(calibration.output_error() < 0.9 * calibration.output_error_of_rounded()); // as above
}

TEST_CASE("eight_bit_calibration: a weight makes up for what another one loses, where inputs go together") {
    // Merely rounded, the second weight is 0: 0.45 of a step are lost. Where the second input is always seven
    // times the first, these are 3.15 steps of the first weight, which three steps more bring down to 0.15:
    // a 21st, and less by the bias, which takes the mean.
    std::vector<float> together, apart;
    for (int i = 0; i < 64; ++i) {
        const auto x = static_cast<float>(1 + i % 30);
        together.insert(together.end(), {x, 7 * x});
        apart.insert(apart.end(), {x, 7 * static_cast<float>(1 + i * 11 % 31)});
    }
    const auto fitted = on_pairs(together);
    CHECK(fitted.folded()[4] == -124);
    CHECK(fitted.folded()[5] == 0);
    CHECK(fitted.output_error() < fitted.output_error_of_rounded() / 21);
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

TEST_CASE("weight_rounding: weights whose sums might exceed 32 bits are not chosen") {
    // The fit turns (127, 0) into (124, 1): the second input is always seven times the first.
    const auto changes = [](double largest_input, float bias) {
        return fitted_pair(largest_input, bias)[1] != support::second_weight;
    };
    const std::vector<float> near = fitted_pair(largest_word, 0);
    CHECK(near[0] == 124);
    CHECK(near[1] == 1);
    CHECK(changes(largest_byte, 0));
    // Beside this bias there is room for bytes, which are at most 255, not for words, which reach 32768.
    constexpr float nearly_all = 0x1p31f - 0x1p21f;
    CHECK(!changes(largest_word, nearly_all));
    CHECK(changes(largest_byte, nearly_all));
    // And where there is none for bytes.
    CHECK(!changes(largest_byte, 0x1p31f - 0x1p16f));
    CHECK(fitted_pair(largest_word, nearly_all) ==
          std::vector<float>{support::first_weight, support::second_weight, nearly_all, 1});
}

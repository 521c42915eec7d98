#include "networks.hpp"

#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <ratio>
#include <stdexcept>
#include <support/allocations.hpp>
#include <support/guarded_map.hpp>
#include <type_traits>
#include <vector>

// Group, instance, layer and local response norms in 8 bits: every bit against plain loops in whole numbers,
// and each byte against the layer in double precision.

using namespace tactnet;
using support::frames_that_differ;

namespace {

constexpr norm_over frame = norm_over::frame, channels = norm_over::channels;

} // namespace

TEST_CASE("eight_bit: group and instance norms give the bits of the plain reference") {
    using groups =
        network<shape{9, 11, 3}, conv2d<12, 3>, group_norm<4>, relu, max_pool<2>, conv2d<20, 3>, relu,
                group_norm<5>, conv2d<16, 3>, group_norm<1>, relu, conv2d<33, 1>, instance_norm, dense<4>>;
    CHECK(frames_that_differ<groups>(71, 20) == 0);
}

TEST_CASE("eight_bit: layer norms give the bits of the plain reference") {
    using layers =
        network<shape{7, 6, 3}, conv2d<20, 3>, layer_norm<frame>, relu, conv2d<33, 3>, layer_norm<channels>,
                relu, conv2d<8, 3>, layer_norm<channels>, conv2d<16, 3>, layer_norm<frame>, dense<5>>;
    CHECK(frames_that_differ<layers>(72, 20) == 0);
}

TEST_CASE(
    "eight_bit: norms in branches, after activations and before other steps give the reference's bits") {
    using main = sequence<conv2d<16, 3>, group_norm<4>, relu, conv2d<16, 3>>;
    using branches =
        network<shape{6, 7}, conv2d<16, 3>, residual<main>, instance_norm, silu,
                concatenation<sequence<conv2d<8, 1>, group_norm<2>, relu, conv2d<8, 3>>, conv2d<4, 3>>,
                layer_norm<channels>, squeeze_excitation<12, 3>, group_norm<3>, average_pool<2>, dense<3>,
                softmax>;
    CHECK(frames_that_differ<branches>(73, 20) == 0);
}

TEST_CASE("eight_bit: local response norms give the bits of the plain reference") {
    using strong = local_response_norm<5, std::ratio<5>>;
    using responses =
        network<shape{7, 6, 3}, conv2d<20, 3>, relu, strong, conv2d<33, 3>,
                local_response_norm<4, std::ratio<1>, std::ratio<1, 2>, std::ratio<2>>, max_pool<2>,
                conv2d<3, 1>, local_response_norm<7, std::ratio<3, 2>, std::ratio<1>, std::ratio<1, 3>>,
                conv2d<16, 2>, local_response_norm<>, local_response_norm<1, std::ratio<0>>, dense<5>>;
    CHECK(frames_that_differ<responses>(77, 20) == 0);
}

namespace {

/// Writes drawn bytes to `bytes`, a map with `Stride` bytes from one pixel to the next; returns their values.
template <shape Map, std::size_t Stride>
support::sample drawn_map(map_range range, auto draw_byte, aligned_vector<std::uint8_t>& bytes) {
    support::sample values(Map.size());
    for (std::size_t e = 0; e < Map.size(); ++e) {
        std::uint8_t& byte = bytes[e % Map.area() * Stride + e / Map.area()];
        byte = draw_byte(e);
        values[e].value = (byte - static_cast<double>(range.zero_point)) * static_cast<double>(range.scale);
    }
    return values;
}

/// How many steps of the output the bytes of a local response norm are further from the norm in double
/// precision than roundings may bring them: half a step for the byte; no other number is rounded more than
/// sixteen times on its way, the sum with the margin and five numbers each of three powers.
template <class Norm, shape Map, std::size_t Stride>
double responses_beyond_bound(map_range input, map_range output, auto draw_byte) {
    using place = layer_place<eight_bit, typename sequence<Norm>::template layer<float, Map>, 0, Stride>;
    using step = typename lowering<Norm>::template at<place>::step;
    std::array<float, step::folded_elements> folded{};
    step::arrays.write_ranges(folded.data(), {input, {}, output});
    constexpr std::size_t elements = Map.area() * Stride;
    aligned_vector<std::uint8_t> in(elements, std::uint8_t{0xa5}), out(elements);
    const support::sample values = drawn_map<Map, Stride>(input, draw_byte, in);
    aligned_vector<std::int8_t> packed(step::packed_elements);
    step::pack(folded.data(), packed.data());
    step::run(packed.data(), in.data(), out.data(), nullptr);
    const auto exact =
        support::reference_of<Norm>::on({Map.channels, Map.rows, Map.columns})->forward({}, {values});
    double worst = -INFINITY;
    for (std::size_t e = 0; e < Map.size(); ++e) {
        const double steps = exact[0][e].value / static_cast<double>(output.scale);
        const double wanted = std::clamp(steps + static_cast<double>(output.zero_point), 0.0, 255.0);
        const double found = out[e % Map.area() * Stride + e / Map.area()];
        worst = std::max(worst, std::abs(found - wanted) -
                                    (0.5 + 16 * support::unit_roundoff<float> * std::abs(steps)));
    }
    return worst;
}

} // namespace

TEST_CASE_TEMPLATE("eight_bit: a local response norm within half a step and sixteen roundings", Norm,
                   local_response_norm<>, local_response_norm<5, std::ratio<5>>,
                   local_response_norm<4, std::ratio<1>, std::ratio<1, 2>, std::ratio<2>>,
                   local_response_norm<7, std::ratio<1000>, std::ratio<1>, std::ratio<1, 1000>>,
                   local_response_norm<2, std::ratio<0>>) {
    std::uint64_t state = 84;
    const auto any = [&](std::size_t) { return static_cast<std::uint8_t>(128 + 127 * support::draw(state)); };
    for (const map_range input : {map_range{0.02f, 100}, map_range{1e-6f, 0}, map_range{1e3f, 255}})
        for (const float scale : {0.3F, 1.0F, 3.0F}) {
            const map_range output{input.scale * scale, 120};
            CHECK(responses_beyond_bound<Norm, shape{5, 7, 6}, 16>(input, output, any) <= 0);
            CHECK(responses_beyond_bound<Norm, shape{3, 2, 33}, 48>(input, output, any) <= 0);
            CHECK(responses_beyond_bound<Norm, shape{3, 2, 9}, 9>(input, output, any) <= 0);
        }
}

namespace {

/// The step of a norm by itself, on bytes, with the ReLU after it or without.
template <class Norm, shape Map, std::size_t Stride, bool Rectified>
auto lowered_norm() {
    using place = layer_place<eight_bit, typename sequence<Norm>::template layer<float, Map>, 0, Stride>;
    using norm = typename lowering<Norm>::template at<place>;
    if constexpr (Rectified)
        return norm::template fuse<relu, place>();
    else
        return std::type_identity<norm>{};
}

/// How many steps of the output the bytes of a norm are further from the norm in double precision than
/// roundings may bring them. `draw_byte` gives the bytes of the map.
///
/// The byte is rounded, and before that the product with the weight and the bias to 1/256: half a step and
/// 1/256. No other number is rounded more than eight times on its way to the product: the variance, its sum
/// with the margin, their root, its inverse, the distance, its product, the weight, and the last product.
template <class Norm, shape Map, std::size_t Stride, bool Rectified = false>
double steps_beyond_bound(map_range input, map_range output, float epsilon, auto draw_byte) {
    using step = typename decltype(lowered_norm<Norm, Map, Stride, Rectified>())::type::step;
    support::numbers draw(81);
    std::vector<double> parameters(step::folded_elements - 1 - 2 * map_range::numbers);
    std::vector<float> folded;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
        folded.push_back(p < parameters.size() / 2 ? draw.next(0.5f, 1.5f) : draw.next(-1, 1));
        parameters[p] = static_cast<double>(folded.back());
    }
    folded.push_back(epsilon);
    folded.resize(step::folded_elements);
    step::arrays.write_ranges(folded.data(), {input, {}, output});

    constexpr std::size_t elements = Map.area() * Stride;
    aligned_vector<std::uint8_t> in(elements, std::uint8_t{0xa5}), out(elements),
        memory(step::workspace_elements + 1, std::uint8_t{0xff});
    const support::sample values = drawn_map<Map, Stride>(input, draw_byte, in);
    aligned_vector<std::int8_t> packed(step::packed_elements);
    step::pack(folded.data(), packed.data());
    step::run(packed.data(), in.data(), out.data(), memory.data());
    CHECK(memory.back() == 0xff);

    const support::network_parameters call{parameters, {}, static_cast<double>(epsilon)};
    const auto exact =
        support::reference_of<Norm>::on({Map.channels, Map.rows, Map.columns})->forward(call, {values});
    double worst = -INFINITY;
    for (std::size_t e = 0; e < Map.size(); ++e) {
        const double steps = exact[0][e].value / static_cast<double>(output.scale),
                     bias = parameters[parameters.size() / 2 +
                                       (std::is_same_v<Norm, layer_norm<frame>> ? e : e / Map.area())];
        const double product = std::abs(steps - bias / static_cast<double>(output.scale));
        const double wanted = std::clamp(
            (Rectified ? std::max(steps, 0.0) : steps) + static_cast<double>(output.zero_point), 0.0, 255.0);
        const double found = out[e % Map.area() * Stride + e / Map.area()];
        worst = std::max(worst, std::abs(found - wanted) -
                                    (0.5 + 1 / 256.0 + 8 * support::unit_roundoff<float> * product));
    }
    return worst;
}

} // namespace

TEST_CASE_TEMPLATE("eight_bit: a norm within half a step, 1/256 and eight roundings of the norm in double",
                   Norm, group_norm<1>, group_norm<3>, instance_norm, layer_norm<frame>,
                   layer_norm<channels>) {
    std::uint64_t state = 83;
    const auto any = [&](std::size_t) { return static_cast<std::uint8_t>(128 + 127 * support::draw(state)); };
    const auto touched = [&](std::size_t e) {
        return static_cast<std::uint8_t>(e % 11 == 0 ? 255 - e % 7 : 3);
    };
    const auto constant = [](std::size_t) { return std::uint8_t{255}; };
    for (const map_range input : {map_range{0.02f, 100}, map_range{1e-6f, 0}, map_range{1e6f, 255}})
        for (const map_range output : {map_range{0.03f, 120}, map_range{0.005f, 0}})
            for (const float epsilon : {1e-5F, 0.5F}) {
                CHECK(steps_beyond_bound<Norm, shape{5, 7, 6}, 16>(input, output, epsilon, any) <= 0);
                CHECK(steps_beyond_bound<Norm, shape{5, 7, 48}, 48>(input, output, epsilon, touched) <= 0);
                CHECK(steps_beyond_bound<Norm, shape{5, 7, 9}, 9>(input, output, epsilon, constant) <= 0);
                CHECK(steps_beyond_bound<Norm, shape{5, 7, 6}, 16, true>(input, output, epsilon, any) <= 0);
            }
}

TEST_CASE("eight_bit: the squares of a large map need more than 32 bits") {
    const auto large = [](std::size_t e) { return static_cast<std::uint8_t>(e % 1000 == 0 ? 0 : 255); };
    CHECK(steps_beyond_bound<group_norm<1>, shape{260, 260, 2}, 4>({0.02f, 100}, {0.2f, 200}, 1e-5F, large) <=
          0);
}

TEST_CASE("eight_bit: an epsilon that is not above zero and a bias far beyond the output are rejected") {
    using net = network<shape{5, 6}, conv2d<4, 3>, group_norm<2>, dense<3>>;
    net trained;
    support::fill(trained, 74);
    std::vector<float> folded;
    {
        const auto calibration = support::calibrated(trained, 74, 3);
        folded.assign(calibration.folded().begin(), calibration.folded().end());
    }
    using bytes = support::byte_network<net>;
    const folded_layout layout = folded_layout_of<bytes::view_type>();
    const auto made = [&] {
        return bytes(std::span<const float, bytes::view_type::folded_elements>(folded));
    };
    CHECK_NOTHROW((void)made());
    float& epsilon = folded[layout.steps[1].find("epsilon")->offset];
    CHECK(epsilon == 1e-5F);
    for (const float wrong : {0.0F, -1.0F}) {
        epsilon = wrong;
        CHECK_THROWS_WITH_AS((void)made(),
                             doctest::Contains("step2.epsilon, element 0: expected a finite number above 0"),
                             std::invalid_argument);
    }
    epsilon = 1e-5F;
    const float step = folded[layout.steps[1].find("output")->offset];
    float& bias = folded[layout.steps[1].find("bias")->offset];
    for (const float steps : {7900.0F, -7900.0F}) {
        bias = steps * step;
        CHECK_NOTHROW((void)made());
        bias = steps * step * 1.01F;
        CHECK_THROWS_WITH_AS(
            (void)made(),
            doctest::Contains("step2.bias, element 0: expected at most 7936 steps of the output"),
            std::invalid_argument);
    }
    trained.epsilon = 0;
    CHECK_THROWS_AS((void)support::calibrated(trained, 74, 3), std::invalid_argument);
}

TEST_CASE("eight_bit: calls of a network with norms use no heap") {
    using net = network<shape{5, 6}, conv2d<4, 3>, group_norm<2>, relu, conv2d<6, 3>, layer_norm<frame>,
                        local_response_norm<>, conv2d<4, 1>, layer_norm<channels>, dense<3>>;
    net trained;
    support::fill(trained, 75);
    const support::byte_network<net> network(support::calibrated(trained, 75, 3).folded());
    const auto memory = std::make_unique<support::byte_network<net>::workspace>();
    const std::vector<std::uint8_t> counts = support::make_frame(net::input_shape.size(), 76);
    const tensor_view<const std::uint8_t, net::input_shape> shown(counts.data());
    std::array<float, net::outputs> out{}, again{};
    const std::size_t before = support::allocations();
    const frame_status status = network.infer(shown, out, *memory), on_stack = network.infer(shown, again);
    CHECK(support::allocations() == before);
    CHECK(status == frame_status::ok);
    CHECK(on_stack == frame_status::ok);
    CHECK(support::same_bits(out, again));
    CHECK_FALSE(support::same_bits(out, std::array<float, net::outputs>{}));
}

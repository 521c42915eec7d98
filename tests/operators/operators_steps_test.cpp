#include <tactnet/deployment/batch.hpp>
#include <tactnet/lowering/step.hpp>
#include <tactnet/operators/lowering.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ratio>
#include <support/guarded_map.hpp>
#include <vector>

using namespace tactnet;

TEST_CASE("largest_sum: the largest of |bias| + input x the sum of |weights|, over all outputs") {
    // Two outputs of three weights, then their biases.
    const std::array<float, 8> numbers{1, -2, 3, 4, 5, -6, 7, -8};
    CHECK(detail::largest_sum(numbers.data(), 2, 3, 2) == 2 * 15 + 8);
    CHECK(detail::largest_sum(numbers.data(), 2, 3, 0) == 8);
    const std::array<float, 8> first_is_larger{4, 5, -6, 1, -2, 3, 7, -8};
    CHECK(detail::largest_sum(first_is_larger.data(), 2, 3, 2) == 2 * 15 + 7);
    CHECK(detail::largest_sum(numbers.data(), 0, 3, 2) == 0);
    // In double precision: what single precision could not hold.
    const std::vector<float> huge{3e38F, 3e38F, 1};
    CHECK(detail::largest_sum(huge.data(), 1, 2, 10) == doctest::Approx(6e39));
}

TEST_CASE("activation_step: ReLU makes negative numbers zero, and nothing is written past the map") {
    using step = activation_step<single_precision, relu_function, shape{1, 2, 3}, 4>;
    alignas(64) std::array<float, 12> in{-1, 2, -3, 0, 4, -5, 6, 0, 7, 7, 7, 7}, out{};
    out.fill(-9);
    step::run(nullptr, in.data(), out.data(), nullptr);
    const std::array<float, 12> expected{0, 2, 0, 0, 4, 0, 6, 0, -9, -9, -9, -9};
    CHECK(out == expected);
}

namespace {

struct one_more {
    static constexpr const char *name = "one_more", *title = "One more", *type = "one_more", *header = "";
    static constexpr bool moves_zero = true;
    template <class T>
    static constexpr T value(T x) {
        return x + 1;
    }
    template <class T>
    static constexpr T backward(T, T gradient) {
        return gradient;
    }
};
static_assert(activation_function<one_more>);

} // namespace

TEST_CASE("activation_step: a function that moves zero leaves zeros after the last channel") {
    using step = activation_step<single_precision, one_more, shape{1, 2, 3}, 4>;
    alignas(64) std::array<float, 8> in{-1, 2, -3, 0, 4, -5, 6, 0}, out{};
    step::run(nullptr, in.data(), out.data(), nullptr);
    CHECK(out == std::array<float, 8>{0, 3, -2, 0, 5, -4, 7, 0});
    CHECK(step::output_bound(nullptr, 7) == 8);
}

namespace {

constexpr shape map{2, 2, 8};

template <class Rule>
double reach_of(double input) {
    return local_response_norm_step<single_precision, map, 8, Rule>::output_bound(nullptr, input);
}

} // namespace

TEST_CASE("local_response_norm_step::output_bound: the largest of x, of x by the smallest divisor, and of "
          "the squares") {
    using usual = kernels::response_rule<5, std::ratio<1, 10000>, std::ratio<3, 4>, std::ratio<2>>;
    CHECK(reach_of<usual>(0.1) == doctest::Approx(0.1));   // squares are small, and 2^-3/4 is below one
    CHECK(reach_of<usual>(3) == doctest::Approx(5 * 9.0)); // squares
    using amplifying = kernels::response_rule<5, std::ratio<1, 10000>, std::ratio<3, 4>, std::ratio<1, 16>>;
    CHECK(reach_of<amplifying>(0.5) == doctest::Approx(0.5 * std::pow(1.0 / 16, -0.75)));
}

TEST_CASE("softmax_step: over the channels of each pixel, zeros in the gaps, nothing past the last") {
    using step = softmax_step<single_precision, shape{1, 2, 2}, 4>;
    alignas(64) std::array<float, 12> in{0, 0, 7, 7, 1, 0, 7, 7, 9, 9, 9, 9}, out{};
    out.fill(-1);
    step::run(nullptr, in.data(), out.data(), nullptr);
    const double of_one = 1 / (1 + std::exp(-1.0));
    CHECK(out[0] == doctest::Approx(0.5));
    CHECK(out[1] == doctest::Approx(0.5));
    CHECK(out[4] == doctest::Approx(of_one));
    CHECK(out[5] == doctest::Approx(1 - of_one));
    for (const std::size_t between : {2u, 3u, 6u, 7u})
        CHECK(out[between] == 0);
    for (std::size_t behind = 8; behind < 12; ++behind)
        CHECK(out[behind] == -1);
}

namespace {

using dense_22 = dense_step<single_precision, kernels::frame_dense{{3, 5, 8}, 8, 22}>;
static_assert(!dense_22::layerwise);

} // namespace

TEST_CASE(
    "dense_step: frames together, whole register blocks of them and rests, have the bits of each alone") {
    constexpr std::size_t most = 2 * kernels::dense_frames<dense_22::kernel> + 1,
                          in_distance = dense_22::kernel.inputs() + 16,
                          out_distance = detail::map_distance<dense_22>;
    std::uint64_t state = 7;
    std::vector<float> folded(dense_22::folded_elements);
    for (float& value : folded)
        value = support::draw(state);
    aligned_vector<float> packed(dense_22::packed_elements), inputs(most * in_distance, NAN),
        alone(most * out_distance);
    dense_22::pack(folded.data(), packed.data());
    for (std::size_t frame = 0; frame < most; ++frame) {
        float* const in = inputs.data() + frame * in_distance;
        std::generate_n(in, dense_22::kernel.inputs(), [&] { return support::draw(state); });
        dense_22::run(packed.data(), in, alone.data() + frame * out_distance, nullptr);
    }
    for (std::size_t frames = 1; frames <= most; ++frames) {
        CAPTURE(frames);
        // Not even the place of a frame more is touched.
        support::guarded_map outputs((frames - 1) * out_distance + dense_22::output_stride, 99, NAN);
        const inline_executor<most> here{};
        dense_22::run_batch(packed.data(), inputs.data(), in_distance, outputs.data(), nullptr,
                            batch_executor<const inline_executor<most>>{here, frames});
        CHECK(outputs.untouched());
        std::size_t other = 0;
        for (std::size_t frame = 0; frame < frames; ++frame)
            for (std::size_t o = 0; o < dense_22::output_stride; ++o) {
                const std::size_t place = frame * out_distance + o;
                other += std::bit_cast<std::uint32_t>(outputs.data()[place]) !=
                         std::bit_cast<std::uint32_t>(alone[place]);
            }
        CHECK(other == 0);
    }
}

#include <tactnet/operators/convolution/step.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deployment/deployed_network.hpp>
#include <support/frame_convolution.hpp>
#include <vector>

// What no network of the library asks for yet: outputs among the channels of a wider map, and groups.

using namespace tactnet;

namespace {

using kernels::frame_convolution;

template <frame_convolution C>
using step_of = convolution_step<single_precision, C>;

/// The folded numbers of a step, and what it needs to run with them.
template <class Step>
struct numbers_of {
    aligned_vector<float> packed = aligned_vector<float>(Step::packed_elements);
    aligned_vector<float> scratch = aligned_vector<float>(Step::workspace_elements + 1);

    explicit numbers_of(const support::convolution_numbers& numbers) {
        std::vector<float> folded(numbers.weights.begin(), numbers.weights.end());
        folded.insert(folded.end(), numbers.bias.begin(), numbers.bias.end());
        REQUIRE(folded.size() == Step::folded_elements);
        Step::pack(folded.data(), packed.data());
    }
    void run(support::guarded_map& in, support::guarded_map& to) {
        Step::run(packed.data(), in.data(), to.data(), scratch.data());
        CHECK(to.untouched());
    }
};

template <frame_convolution C>
support::error_shares errors_of_step(std::uint64_t seed) {
    using step = step_of<C>;
    static_assert(step::output_stride == C.output_stride() &&
                  step::output.area() == C.output_rows() * C.output_columns());
    support::convolution_numbers numbers(C, 1, seed, 0.0f);
    support::guarded_map out = numbers.fresh_outputs();
    numbers_of<step>(numbers).run(numbers.laid_inputs, out);
    std::vector<float> found;
    for (std::size_t f = 0; f < C.filters; ++f)
        for (std::size_t p = 0; p < step::output.area(); ++p)
            found.push_back(out.data()[p * step::output_stride + C.map_offset + f]);
    // Behind the last channel a map of its own holds zeros; of a wider one the rest is not the step's.
    std::size_t wrong = 0;
    for (std::size_t p = 0; p < step::output.area(); ++p)
        for (std::size_t lane = 0; lane < step::output_stride; ++lane) {
            const float value = out.data()[p * step::output_stride + lane];
            if (lane < C.map_offset || lane >= C.map_offset + C.filters)
                wrong += C.map_stride > 0 ? !std::isnan(value) : value != 0;
        }
    CHECK(wrong == 0);
    return support::shares_of(found, numbers.expected(0, step::method::tile));
}

constexpr sliding_window over(shape input, extent2d kernel, extent2d stride = 1) {
    return sliding_window::over(input, kernel, stride, padding::same);
}

} // namespace

TEST_CASE("convolution_step: groups whose filters fill vectors, and groups whose filters do not") {
    // Two groups of 16 → 32, by taps with a stride, and by tiles; three of 5 → 3, joined with zeros between.
    CHECK(errors_of_step<frame_convolution{
              .window = over({6, 9, 32}, 5, 2), .filters = 64, .input_stride = 32, .groups = 2}>(1)
              .good());
    CHECK(errors_of_step<frame_convolution{
              .window = over({12, 12, 64}, 3), .filters = 128, .input_stride = 64, .groups = 2}>(2)
              .good());
    CHECK(errors_of_step<frame_convolution{
              .window = over({5, 4, 15}, 3), .filters = 9, .input_stride = 16, .groups = 3}>(3)
              .good());
    // Three of 8: they fill vectors, but on some instruction sets not the pixels.
    CHECK(errors_of_step<frame_convolution{
              .window = over({5, 4, 24}, 3), .filters = 24, .input_stride = 32, .groups = 3}>(5)
              .good());
    // By large tiles: groups among the channels of a wider map, and more weights than a near cache holds.
    CHECK(errors_of_step<frame_convolution{.window = over({9, 7, 64}, 3),
                                           .filters = 64,
                                           .input_stride = 64,
                                           .groups = 2,
                                           .map_stride = 192,
                                           .map_offset = 32}>(6)
              .good());
    CHECK(errors_of_step<frame_convolution{
              .window = over({6, 12, 128}, 3), .filters = 128, .input_stride = 128}>(7)
              .good());
    // Among the channels of a wider map.
    CHECK(errors_of_step<frame_convolution{.window = over({5, 4, 32}, 3),
                                           .filters = 32,
                                           .input_stride = 32,
                                           .groups = 2,
                                           .map_stride = 64,
                                           .map_offset = 16}>(6)
              .good());
    // Depthwise.
    CHECK(errors_of_step<frame_convolution{
              .window = over({5, 4, 6}, 3), .filters = 6, .input_stride = 16, .groups = 6}>(4)
              .good());
}

TEST_CASE("convolution_step: groups need no more weights than they have where they are computed "
          "one by one") {
    using grouped = step_of<frame_convolution{
        .window = over({6, 9, 32}, 5, 2), .filters = 64, .input_stride = 32, .groups = 2}>;
    using joined =
        step_of<frame_convolution{.window = over({6, 9, 32}, 5, 2), .filters = 64, .input_stride = 32}>;
    CHECK(2 * grouped::folded_elements == joined::folded_elements + 64);
    CHECK(grouped::packed_elements < joined::packed_elements);
}

TEST_CASE("convolution_step: two outputs side by side in one wider map, without a copy") {
    constexpr shape input{6, 5, 16};
    constexpr std::size_t stride = 64;
    // The expand layers of a fire module (Iandola et al., 2016): 1 × 1 and 3 × 3 over the same input.
    constexpr frame_convolution narrow{.window = over(input, 1),
                                       .filters = 32,
                                       .input_stride = 16,
                                       .activation = fused<relu_function>,
                                       .map_stride = stride};
    constexpr frame_convolution wide{.window = over(input, 3),
                                     .filters = 32,
                                     .input_stride = 16,
                                     .activation = fused<relu_function>,
                                     .map_stride = stride,
                                     .map_offset = 32};
    constexpr frame_convolution narrow_alone{
        .window = over(input, 1), .filters = 32, .input_stride = 16, .activation = fused<relu_function>};
    constexpr frame_convolution wide_alone{
        .window = over(input, 3), .filters = 32, .input_stride = 16, .activation = fused<relu_function>};
    support::convolution_numbers one(narrow, 1, 11), three(wide, 1, 12); // the same input for both
    support::guarded_map both(input.area() * stride, 555, -1.0f);
    support::guarded_map first(input.area() * step_of<narrow_alone>::output_stride, 555, -1.0f),
        second(input.area() * step_of<wide_alone>::output_stride, 555, -1.0f);
    numbers_of<step_of<narrow>>(one).run(one.laid_inputs, both);
    numbers_of<step_of<wide>>(three).run(one.laid_inputs, both);
    numbers_of<step_of<narrow_alone>>(one).run(one.laid_inputs, first);
    numbers_of<step_of<wide_alone>>(three).run(one.laid_inputs, second);
    bool same_numbers = true;
    for (std::size_t p = 0; p < input.area(); ++p) {
        for (std::size_t f = 0; f < 32; ++f)
            same_numbers = same_numbers && both.data()[p * stride + f] ==
                                               first.data()[p * step_of<narrow_alone>::output_stride + f];
        for (std::size_t f = 0; f < 32; ++f)
            same_numbers = same_numbers && both.data()[p * stride + 32 + f] ==
                                               second.data()[p * step_of<wide_alone>::output_stride + f];
    }
    CHECK(same_numbers);
    // Where vectors must be narrower than those of a map of its own, sums may be rounded otherwise.
    CHECK(errors_of_step<frame_convolution{.window = over(input, 3),
                                           .filters = 24,
                                           .input_stride = 16,
                                           .map_stride = stride,
                                           .map_offset = 24}>(8)
              .good());
}

TEST_CASE("convolution_step: where an output would reach into the next pixel it does not fit") {
    constexpr frame_convolution fits{
        .window = over({3, 3, 4}, 1), .filters = 16, .input_stride = 16, .map_stride = 32, .map_offset = 16};
    constexpr frame_convolution reaches{
        .window = over({3, 3, 4}, 1), .filters = 20, .input_stride = 16, .map_stride = 32, .map_offset = 16};
    static_assert(fits.fits_map() && !reaches.fits_map());
    constexpr frame_convolution groups_reach{.window = over({3, 3, 4}, 1),
                                             .filters = 32,
                                             .input_stride = 16,
                                             .groups = 2,
                                             .map_stride = 64,
                                             .map_offset = 48};
    static_assert(!groups_reach.ungrouped().fits_map());
    using net = network<shape{3, 3}, conv2d<16, 1>, dense<2>>;
    static_assert(deployed_step<lowered_network<net>::step>);
}

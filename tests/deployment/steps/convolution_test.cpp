#include <tactnet/deployment/steps/convolution.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deployment/deployed_network.hpp>
#include <support/guarded_map.hpp>
#include <support/layers/window_of.hpp>
#include <vector>

// What no network of the library asks for yet: outputs among the channels of a wider map, and groups.

using namespace tactnet;

namespace {

using kernels::frame_convolution;

template <frame_convolution C>
using step_of = convolution_step<single_precision, C>;

struct random_map {
    std::vector<double> exact; ///< [channel][row][column]
    support::guarded_map laid;
};

/// Numbers in a map whose pixels are `stride` elements apart, zeros after their channels.
random_map make_map(shape size, std::size_t stride, std::uint64_t seed) {
    random_map map{std::vector<double>(size.size()), support::guarded_map(size.area() * stride, 777, 0.0f)};
    support::numbers draw(seed);
    for (std::size_t c = 0; c < size.channels; ++c)
        for (std::size_t p = 0; p < size.area(); ++p) {
            const float value = draw.next(-1, 1);
            map.laid.data()[p * stride + c] = value;
            map.exact[c * size.area() + p] = static_cast<double>(value);
        }
    return map;
}

template <class Step>
struct numbers_of {
    std::vector<float> folded = std::vector<float>(Step::folded_elements);
    aligned_vector<float> packed = aligned_vector<float>(Step::packed_elements);
    aligned_vector<float> scratch = aligned_vector<float>(Step::workspace_elements + 1);

    explicit numbers_of(std::uint64_t seed) {
        support::numbers draw(seed);
        for (float& value : folded)
            value = draw.next(-1, 1);
        Step::pack(folded.data(), packed.data());
    }
};

/// A channel of the output by plain sums: group by group.
template <frame_convolution C>
support::sample expected_of(const std::vector<double>& in, const std::vector<float>& folded,
                            tactnet::extent2d tiled) {
    const std::size_t weights = C.filters * C.taps();
    support::sample exact(in.size()), biases(C.filters);
    for (std::size_t i = 0; i < in.size(); ++i)
        exact[i].value = in[i];
    for (std::size_t f = 0; f < C.filters; ++f)
        biases[f].value = static_cast<double>(folded[weights + f]);
    const std::vector<double> own(folded.begin(), folded.begin() + static_cast<std::ptrdiff_t>(weights));
    return support::bounded_convolution(support::window_of(C.window), C.filters, own, biases, exact, nullptr,
                                        {tiled.rows, tiled.columns}, C.groups);
}

template <frame_convolution C>
support::error_shares errors_of_step(std::uint64_t seed) {
    using step = step_of<C>;
    random_map in = make_map(C.window.input, C.input_stride, seed);
    numbers_of<step> numbers(seed + 1);
    support::guarded_map out(step::output.area() * step::output_stride, 555, NAN);
    step::run(numbers.packed.data(), in.laid.data(), out.data(), numbers.scratch.data());
    std::vector<float> found;
    for (std::size_t f = 0; f < C.filters; ++f)
        for (std::size_t p = 0; p < step::output.area(); ++p)
            found.push_back(out.data()[p * step::output_stride + C.map_offset + f]);
    CHECK(out.untouched());
    // Behind the last channel a map of its own holds zeros; of a wider one the rest is not the step's.
    std::size_t wrong = 0;
    for (std::size_t p = 0; p < step::output.area(); ++p)
        for (std::size_t lane = 0; lane < step::output_stride; ++lane) {
            const float value = out.data()[p * step::output_stride + lane];
            if (lane < C.map_offset || lane >= C.map_offset + C.filters)
                wrong += C.map_stride > 0 ? !std::isnan(value) : value != 0;
        }
    CHECK(wrong == 0);
    return support::shares_of(found, expected_of<C>(in.exact, numbers.folded, step::method::tile));
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
    constexpr frame_convolution narrow{
        .window = over(input, 1), .filters = 32, .input_stride = 16, .relu = true, .map_stride = stride};
    constexpr frame_convolution wide{.window = over(input, 3),
                                     .filters = 32,
                                     .input_stride = 16,
                                     .relu = true,
                                     .map_stride = stride,
                                     .map_offset = 32};
    constexpr frame_convolution narrow_alone{
        .window = over(input, 1), .filters = 32, .input_stride = 16, .relu = true};
    constexpr frame_convolution wide_alone{
        .window = over(input, 3), .filters = 32, .input_stride = 16, .relu = true};
    random_map in = make_map(input, 16, 7);
    support::guarded_map both(input.area() * stride, 555, -1.0f);
    support::guarded_map first(input.area() * step_of<narrow_alone>::output_stride, 555, -1.0f),
        second(input.area() * step_of<wide_alone>::output_stride, 555, -1.0f);
    const auto run = [&]<frame_convolution C>(std::uint64_t seed, support::guarded_map& to) {
        numbers_of<step_of<C>> numbers(seed);
        step_of<C>::run(numbers.packed.data(), in.laid.data(), to.data(), numbers.scratch.data());
        CHECK(to.untouched());
    };
    run.template operator()<narrow>(11, both);
    run.template operator()<wide>(12, both);
    run.template operator()<narrow_alone>(11, first);
    run.template operator()<wide_alone>(12, second);
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

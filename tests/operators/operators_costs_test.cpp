#include <tactnet/operators.hpp>

// What some operators cost, counted by hand; list.hpp compares all with the reference.

using namespace tactnet;

// A dilation of 1 is the convolution.
static_assert(dilated_conv2d<3, 3, 1, 2, pad(1, 0, 2, 1), in_groups(3)>::costs({8, 9, 6}) ==
              conv2d<3, 3, 2, pad(1, 0, 2, 1), in_groups(3)>::costs({8, 9, 6}));

// A 3 × 3 kernel over 5 × 5 pixels: each axis has 5 outputs, whose taps lie at −2, 0 and 2: 3 + 5 + 3 pixels.
static_assert(dilated_conv2d<7, 3>::costs({5, 5, 4}) == layer_costs{.output = {5, 5, 7},
                                                                    .parameters = 7 * 4 * 9 + 7,
                                                                    .multiply_adds = 25 * 7 * 4 * 9,
                                                                    .multiply_adds_on_pixels = 11 * 11 * 28});
static_assert(dilated_conv2d<7, 3, 2, 1, padding::valid>::costs({28, 50, 1}).output == shape{24, 46, 7});

// Neighbouring phases share their zeros: two phases of 14 rows with 1 zero before, between and after them.
// Those at the edges are padding.
static_assert(kernels::dilated_axis::of(28, 28, 3, 2, 1, 2).pixels() == 2 * 14 + 1);
static_assert(kernels::dilated_axis::of(28, 28, 3, 2, 1, 2).zeros_before == 1);
static_assert(kernels::dilated_axis::of(28, 28, 3, 2, 1, 2).zeros_after == 1);
static_assert(kernels::dilated_axis::of(28, 28, 3, 2, 1, 2).sum_of(27) == 28);
// Without padding they are side by side.
static_assert(kernels::dilated_axis::of(28, 24, 3, 2, 1, 0).pixels() == 28);

static_assert(transposed_conv2d<5, 3, 2, pad(1, 0, 1, 0)>::costs({3, 4, 2}).output == shape{6, 8, 5});
static_assert(transposed_conv2d<5, 3, 2, padding::valid>::costs({3, 4, 2}) ==
              layer_costs{.output = {7, 9, 5},
                          .parameters = 2 * 5 * 9 + 5,
                          .multiply_adds = 12 * 90,
                          .multiply_adds_on_pixels = 12 * 90});

// PyTorch: nn.Upsample(scale_factor=2, mode='bilinear') of 1, 5 gives 1, 2, 4, 5.
using twice = kernels::sampling_axis<interpolation::bilinear, 2, 4>;
static_assert(twice::table[0].weights[0] == 1 && twice::table[1].weights[0] == 0.75 &&
              twice::table[1].weights[1] == 0.25 && twice::table[2].weights[0] == 0.25 &&
              twice::table[3].weights[1] == 1);
static_assert(upsample<extent2d{2, 3}>::costs({5, 7, 4}) == layer_costs{.output = {10, 21, 4}});

#include "../deployment/deployed_network.hpp"

#include <doctest/doctest.h>

#include <type_traits>

// Layers that give a map another size, deployed, at sizes that fill no vector.

using namespace tactnet;

TEST_CASE("deployed: adaptive max pools whose bins overlap, repeat pixels, or fill vectors") {
    using net = network<shape{13, 11, 2}, conv2d<5, 3>, relu, adaptive_max_pool<extent2d(4, 7)>, //
                        conv2d<16, 3>, adaptive_max_pool<extent2d(5, 3)>,                        //
                        conv2d<24, 2>, relu, adaptive_max_pool<extent2d(9, 2)>, dense<5>>;
    CHECK(support::errors_of<net>(41, 5));
    // As the first layer, and as the last.
    CHECK(support::errors_of<network<shape{7, 5, 3}, adaptive_max_pool<extent2d(3, 2)>, dense<2>>>(42, 5));
    CHECK(support::errors_of<network<shape{7, 5}, conv2d<3, 3>, adaptive_max_pool<extent2d(3, 2)>>>(43, 5));
}

TEST_CASE("deployed: nearest and bilinear upsampling, by factors and to sizes") {
    using net = network<shape{5, 7, 2}, conv2d<5, 3>, relu, upsample<2>, conv2d<16, 3>,          //
                        upsample<extent2d(1, 3), interpolation::bilinear>, relu, max_pool<2, 3>, //
                        conv2d<24, 3, 2>, upsample_to<extent2d(5, 9), interpolation::bilinear>,  //
                        conv2d<4, 1>, upsample_to<extent2d(3, 13)>, dense<5>>;
    CHECK(support::errors_of<net>(46, 5));
    // As the first layer, as the last, and in the branches of a block and of a concatenation.
    CHECK(support::errors_of<
          network<shape{3, 5, 3}, upsample<2, interpolation::bilinear>, conv2d<3, 2>, upsample<3>>>(47, 5));
    using branch = sequence<conv2d<12, 3, 2>, upsample<2, interpolation::bilinear>>;
    using branches = network<shape{6, 8}, conv2d<12, 3>, residual<conv2d<12, 3>, branch>, relu,
                             concatenation<branch, conv2d<4, 1>>, dense<3>>;
    CHECK(support::errors_of<branches>(48, 5));
}

TEST_CASE("deployed: a convolution fuses an adaptive max pool of equal bins") {
    using net = network<shape{6, 9}, conv2d<8, 3>, relu, adaptive_max_pool<extent2d(2, 3)>, dense<3>>;
    static_assert(std::is_same_v<
                  lowered_network<net>::step,
                  lowered_network<network<shape{6, 9}, conv2d<8, 3>, relu, max_pool<3>, dense<3>>>::step>);
    CHECK(support::errors_of<net>(44, 5));
    // Not after another pool, and not if there are too many pixels for registers.
    using apart = network<shape{12, 8, 2}, conv2d<8, 3>, max_pool<2>, adaptive_max_pool<extent2d(3, 2)>,
                          adaptive_max_pool<1>, dense<3>>;
    CHECK(support::errors_of<apart>(45, 5));
}

TEST_CASE("deployed: transposed convolutions, with the batch norm and the ReLU after them") {
    using net = network<shape{3, 4, 2}, transposed_conv2d<5, 3, 2, pad(1, 0, 1, 0)>, batch_norm, relu, //
                        conv2d<8, 3, 2>, transposed_conv2d<16, 4, 2>, relu,                            //
                        transposed_conv2d<3, 2, extent2d(1, 3), padding::same, false>, batch_norm,     //
                        transposed_conv2d<4, 3, 1>, relu, batch_norm, dense<5>>;
    CHECK(support::errors_of<net>(49, 5));
    // In branches, and as the last layer.
    using branch = sequence<conv2d<12, 3, 2>, transposed_conv2d<12, 2>>;
    using branches =
        network<shape{6, 8}, conv2d<12, 3>, residual<conv2d<12, 3>, branch>, relu,
                concatenation<branch, conv2d<4, 1>>, transposed_conv2d<2, 5, 3, pad(0, 4, 2, 1)>>;
    CHECK(support::errors_of<branches>(50, 5));
}

TEST_CASE("deployed: dilated convolutions, with the batch norm and the ReLU after them") {
    using net = network<shape{9, 7, 2}, dilated_conv2d<5, 3>, batch_norm, relu,      //
                        dilated_conv2d<16, 3, 3>, relu, max_pool<2>,                 //
                        dilated_conv2d<8, 2, extent2d(1, 2), 1, pad(1)>, batch_norm, //
                        dilated_conv2d<8, 3, 2, 1, padding::same, in_groups(8)>, relu, batch_norm, dense<5>>;
    CHECK(support::errors_of<net>(57, 5));
    // With strides, in branches, and as the last layer.
    using branch = sequence<conv2d<12, 3>, dilated_conv2d<12, 3>, relu>;
    using branches = network<shape{8, 11}, dilated_conv2d<12, 3, 2, extent2d(1, 2)>,
                             residual<sequence<conv2d<12, 3>>, branch>, relu,
                             concatenation<branch, conv2d<4, 1>>, dilated_conv2d<2, 3, 2, 3, padding::same>>;
    CHECK(support::errors_of<branches>(58, 5));
}

namespace {

/// The errors of a deployed dilated convolution whose phases of the rows lie side by side.
template <shape Input, class Spec, class... After>
support::error_shares side_by_side_errors(std::uint64_t seed) {
    using layer = typename Spec::template layer<float, Input>;
    constexpr auto layout = kernels::dilated_layout::of(layer::window, layer::dilation, layer::outputs);
    static_assert(layout.phases_in_row > 1);
    return support::errors_of<network<Input, Spec, After...>>(seed, 3);
}

} // namespace

TEST_CASE("deployed: dilated convolutions whose phases of the rows lie side by side") {
    CHECK(side_by_side_errors<shape{5, 9, 3}, dilated_conv2d<8, 3, 2>, batch_norm, relu>(59));
    CHECK(side_by_side_errors<shape{7, 11, 2}, dilated_conv2d<3, 3, 3>, relu>(60));
    CHECK(side_by_side_errors<shape{14, 13, 8}, dilated_conv2d<16, 3, 4>, relu>(61));
    CHECK(side_by_side_errors<shape{9, 7, 2}, dilated_conv2d<8, 3, 5>>(62));
    CHECK(side_by_side_errors<shape{7, 7, 5}, dilated_conv2d<5, 5, 2>, relu>(63));
    CHECK(side_by_side_errors<shape{7, 6, 3}, dilated_conv2d<4, 2, extent2d(4, 1)>>(64));
    CHECK(side_by_side_errors<shape{7, 9, 4}, dilated_conv2d<4, 3, 4, 1, padding::same, in_groups(4)>>(65));
    // With strides and other padding.
    CHECK(side_by_side_errors<shape{13, 11, 2}, dilated_conv2d<3, 3, 4, 2>>(66));
    CHECK(side_by_side_errors<shape{9, 11, 2}, dilated_conv2d<3, 3, 3, 2>>(67));
    CHECK(side_by_side_errors<shape{9, 13, 2}, dilated_conv2d<3, 3, 5, extent2d(1, 3)>>(68));
    CHECK(side_by_side_errors<shape{13, 12, 2}, dilated_conv2d<3, 3, 4, 1, padding::valid>>(69));
    CHECK(side_by_side_errors<shape{9, 8, 2}, dilated_conv2d<8, 3, 4, 1, pad(3, 1, 0, 6)>>(70));
}

#include <tactnet/operators/training.hpp>

#include <cmath>
#include <support/layers/conformance.hpp>

using namespace tactnet;

TEST_CASE("adaptive_max_pool: of equal largest values the first gets the gradient, as in PyTorch") {
    using bound = trained_layer<adaptive_max_pool<2>, float, shape{2, 3, 1}>; // columns 0, 1 and 1, 2
    batch<float, shape{2, 3, 1}, kernels::lanes<float>> in(1), in_gradient(1);
    batch<float, shape{2, 2, 1}, kernels::lanes<float>> out(1), out_gradient(1);
    const float rows[] = {1, 1, 1, 2, 5, 5};
    for (std::size_t i = 0; i < 6; ++i)
        in(0, i) = rows[i];
    for (std::size_t i = 0; i < 4; ++i)
        out_gradient(0, i) = static_cast<float>(i + 1);
    bound::forward_block(in.view().lane_block(0), out.view().lane_block(0));
    bound::backward_block(in.view().lane_block(0), out.view().lane_block(0),
                          out_gradient.view().lane_block(0), in_gradient.view().lane_block(0));
    const float expected[] = {1, 2, 0, 0, 3 + 4, 0};
    for (std::size_t i = 0; i < 6; ++i)
        CHECK(in_gradient(0, i) == expected[i]);
}

// PyTorch: AdaptiveAvgPool2d(4) of 10 gives the bins 0-3, 2-5, 5-8, 7-10.
constexpr pooling_axis bins{.size = 10, .outputs = 4};
static_assert(bins.pixels(0).end == 3 && bins.pixels(1).begin == 2 && bins.pixels(1).end == 5 &&
              bins.pixels(2).begin == 5 && bins.pixels(2).end == 8 && bins.pixels(3).begin == 7);

namespace {

using bound = trained_layer<max_pool<3, 1, pad(1)>, float, shape{3, 3, 1}>;
using images = batch<float, shape{3, 3, 1}, kernels::lanes<float>>;

images pooled(const images& in) {
    images out(in.samples());
    thread_pool threads;
    no_memory none;
    bound::infer({.threads = threads}, nullptr, nullptr, none, in.view(), out.view());
    return out;
}

} // namespace

TEST_CASE("max_pool: padding never wins over negative values") {
    images in(1);
    for (std::size_t e = 0; e < 9; ++e)
        in(0, e) = -5;
    const images out = pooled(in);
    for (std::size_t e = 0; e < 9; ++e)
        CHECK(out(0, e) == -5);
}

TEST_CASE("max_pool: of equal values the first takes the whole gradient") {
    images in(1), out_gradient(1), in_gradient(1);
    for (std::size_t e = 0; e < 9; ++e)
        in(0, e) = 2;
    out_gradient(0, 4) = 7; // the window of the middle is the whole image
    const images out = pooled(in);
    thread_pool threads;
    no_memory none;
    bound::backward({.threads = threads}, nullptr, none, in.view(), out.as_const(), out_gradient.as_const(),
                    in_gradient.view(), nullptr);
    for (std::size_t e = 0; e < 9; ++e)
        CHECK(in_gradient(0, e) == (e == 0 ? 7 : 0));
}

TEST_CASE("max_pool: a NaN reaches every window that holds it, at any place") {
    for (std::size_t broken = 0; broken < 9; ++broken) {
        images in(1);
        for (std::size_t e = 0; e < 9; ++e)
            in(0, e) = static_cast<float>(e);
        in(0, broken) = std::nanf("");
        const images out = pooled(in);
        for (std::size_t e = 0; e < 9; ++e) {
            const bool near = std::abs(static_cast<int>(e / 3) - static_cast<int>(broken / 3)) <= 1 &&
                              std::abs(static_cast<int>(e % 3) - static_cast<int>(broken % 3)) <= 1;
            CHECK(std::isnan(out(0, e)) == near);
        }
    }
}

// What PyTorch's MaxPool2d(3, 2, ceil_mode=True) gives: 111 → 55, 112 → 56, and 3, 2, padding 1 of 5 → 3.
template <std::size_t Size, padding Padding, std::size_t Stride = 2>
constexpr std::size_t pooled_size =
    max_pool<3, Stride, Padding>::template layer<float, shape{Size, Size, 1}>::output.rows;
static_assert(pooled_size<111, ceil_mode()> == 55 && pooled_size<112, ceil_mode()> == 56);
static_assert(pooled_size<112, padding::valid> == 55 && pooled_size<5, ceil_mode(pad(1))> == 3);
// A window that would begin after the image is left out: 3, 5 of 6 with padding 1 begins at -1 and 4 only.
static_assert(pooled_size<6, ceil_mode(pad(1)), 5> == 2 && pooled_size<4, ceil_mode(pad(1)), 5> == 1);

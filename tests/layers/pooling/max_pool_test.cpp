#include <tactnet/layers/pooling/max_pool.hpp>

#include <cmath>
#include <support/layers/conformance.hpp>

using namespace tactnet;
using support::check_layer;

TEST_CASE("max_pool: 2, stride 1") {
    check_layer<max_pool<2, 1>, shape{5, 4, 3}>();
}
TEST_CASE("max_pool: 2, stride 2, odd sizes keep the rest") {
    check_layer<max_pool<2>, shape{7, 13, 2}>();
}
TEST_CASE("max_pool: 2, stride 2, valid drops the rest") {
    check_layer<max_pool<2, 2, padding::valid>, shape{7, 13, 2}>();
}
TEST_CASE("max_pool: 3, stride 2") {
    check_layer<max_pool<3, 2>, shape{7, 12, 1}>();
}
TEST_CASE("max_pool: 3, stride 2, valid") {
    check_layer<max_pool<3, 2, padding::valid>, shape{7, 12, 2}>();
}
TEST_CASE("max_pool: 3, stride 1") {
    check_layer<max_pool<3, 1>, shape{5, 4, 1}>();
}
TEST_CASE("max_pool: 5, stride 1, valid") {
    check_layer<max_pool<5, 1, padding::valid>, shape{5, 9, 2}>();
}
TEST_CASE("max_pool: 5, stride 1") {
    check_layer<max_pool<5, 1>, shape{4, 3, 1}>();
}
TEST_CASE("max_pool: 2 × 3") {
    check_layer<max_pool<extent2d{2, 3}>, shape{7, 13, 1}>();
}
TEST_CASE("max_pool: 2 × 3, stride 1 × 2, valid") {
    check_layer<max_pool<extent2d{2, 3}, extent2d{1, 2}, padding::valid>, shape{5, 8, 2}>();
}
TEST_CASE("max_pool: padding given") {
    check_layer<max_pool<3, 2, pad(1)>, shape{5, 4, 1}>();
}
TEST_CASE("max_pool: one tactel") {
    check_layer<max_pool<2>, shape{1, 1, 3}>();
}
TEST_CASE("max_pool: stride larger than the window") {
    check_layer<max_pool<1, 3>, shape{5, 7, 1}>();
}

namespace {

using bound = max_pool<3, 1, pad(1)>::layer<float, shape{3, 3, 1}>;
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

TEST_CASE("max_pool: ceil mode completes the last window") {
    check_layer<max_pool<3, 2, ceil_mode()>, shape{6, 7, 2}>();
}
TEST_CASE("max_pool: ceil mode with explicit padding, windows apart") {
    check_layer<max_pool<3, 5, ceil_mode(pad(1))>, shape{6, 4, 1}>();
}
TEST_CASE("max_pool: of each whole channel") {
    check_layer<global_max_pool, shape{5, 7, 3}>();
}

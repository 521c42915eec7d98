// Against the libraries that others resize with: tests/golden/resize.py made the file.

#include <tactnet/image/resize.hpp>
#include <tactnet/io/safetensors.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape from{20, 33};

const safetensors& golden() {
    static const safetensors file = safetensors::read(TACTNET_SOURCE_DIR "/tests/golden/resize.safetensors");
    return file;
}

/// Within 10⁻⁵ of the range of 255 everywhere, the border included: OpenCV itself computes coordinates in
/// single precision.
template <class Kernel, shape To>
void check(const std::string& library) {
    const auto expected =
        golden().values<float>(library + "." + std::to_string(To.rows) + "x" + std::to_string(To.columns));
    const auto image = golden().values<float>("input");
    REQUIRE(expected.size() == To.size());
    tensor<float, To> result;
    resize<from, To, Kernel>(tensor_view<const float, from>(image.data()), result.view());
    const auto running =
        resize_bicubic<Kernel>(std::span(image), from.rows, from.columns, To.rows, To.columns);
    double worst = 0, worst_running = 0;
    for (std::size_t e = 0; e < To.size(); ++e) {
        worst = std::max(worst, static_cast<double>(std::abs(result.data()[e] - expected[e])));
        worst_running = std::max(worst_running, static_cast<double>(std::abs(running[e] - expected[e])));
    }
    CHECK(worst <= 255e-5);
    CHECK(worst_running <= 255e-5);
}
template <class Kernel>
void check_all(const std::string& library) {
    check<Kernel, shape{10, 13}>(library);
    check<Kernel, shape{41, 70}>(library);
    check<Kernel, shape{31, 20}>(library);
    check<Kernel, shape{7, 66}>(library);
    check<Kernel, shape{20, 33}>(library);
}

} // namespace

TEST_CASE("resize: as OpenCV") {
    check_all<opencv_cubic>("opencv");
}
TEST_CASE("resize: as PyTorch, antialiased") {
    check_all<pillow_bicubic>("pytorch");
}
TEST_CASE("resize: as Pillow") {
    check_all<pillow_bicubic>("pillow");
}

#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/networks/model.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators/activations/layer.hpp>
#include <tactnet/operators/convolution/layer.hpp>
#include <tactnet/operators/dense/layer.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape size{4, 6, 1};

template <class... Last>
model<network<size, conv2d<2, 3>, relu, dense<5>, Last...>> example(std::size_t classes) {
    model<network<size, conv2d<2, 3>, relu, dense<5>, Last...>> m;
    float next = 0.3f;
    for (float& value : m.network.learnable_values().first(m.network.parameters))
        value = next = next < 0.5f ? next + 0.17f : next - 0.93f;
    std::fill(m.normalise.mean.begin(), m.normalise.mean.end(), 3.0f);
    m.normalise.scale = 0.01f;
    for (std::size_t c = 0; c < classes; ++c)
        m.classes.push_back("object " + std::to_string(c));
    return m;
}

std::vector<std::uint8_t> images(std::size_t count) {
    std::vector<std::uint8_t> pixels(count * size.size());
    std::iota(pixels.begin(), pixels.end(), std::uint8_t{7});
    return pixels;
}

} // namespace

TEST_CASE("model: logits of normalised images, a row of all outputs each") {
    const auto m = example(3);
    const auto pixels = images(21);
    thread_pool threads(2);
    const std::vector<float> found = m.logits(pixels, threads);
    using net = std::remove_cvref_t<decltype(m.network)>;
    REQUIRE(found.size() == 21 * net::outputs);
    net::workspace space;
    net::input_batch in(1);
    net::output_batch out(1);
    m.network.prepare(threads, space);
    std::size_t different = 0;
    for (std::size_t i = 0; i < 21; ++i) {
        in.set(0, m.normalise.apply(std::span(pixels).subspan(i * size.size()).first<size.size()>()));
        m.network.logits(in, out, threads, space);
        for (std::size_t o = 0; o < net::outputs; ++o)
            different += found[i * net::outputs + o] != out(0, o);
    }
    CHECK(different == 0);
}

TEST_CASE("model: logits are taken before a softmax") {
    thread_pool alone;
    CHECK(example<softmax>(5).logits(images(2), alone) == example(5).logits(images(2), alone));
}

TEST_CASE("model: an image of another size is refused") {
    const auto m = example(3);
    thread_pool alone;
    const std::vector<std::uint8_t> pixels = images(2);
    CHECK(m.logits(pixels, alone).size() == 2 * decltype(m.network)::outputs);
    for (const std::size_t wrong : {std::size_t{0}, size.size() - 1, size.size() + 1})
        CHECK_THROWS_WITH_AS(
            static_cast<void>(m.logits(std::span(pixels).first(wrong), alone)),
            ("logits: expected images of 24 pixels, found " + std::to_string(wrong) + " pixels").c_str(),
            std::invalid_argument);
}

namespace {
constexpr shape tiny{2, 3, 1};
}

TEST_CASE("normalisation: the mean of the chosen images alone") {
    std::vector<std::uint8_t> counts(3 * tiny.size());
    for (std::size_t i = 0; i < counts.size(); ++i)
        counts[i] = static_cast<std::uint8_t>(i < 6 ? i : i < 12 ? 255 : 10 * (i - 12) + 1);
    const std::vector<std::size_t> chosen{0, 2};
    const auto mean = normalisation<tiny>::mean_of(counts, chosen);
    for (std::size_t e = 0; e < tiny.size(); ++e)
        CHECK(mean.data()[e] == (static_cast<float>(e) + static_cast<float>(10 * e + 1)) / 2);
    const auto none = normalisation<tiny>::mean_of(counts, {});
    for (const float v : none)
        CHECK(v == 0);
}

TEST_CASE("normalisation: the mean of many is rounded once") {
    std::vector<std::uint8_t> counts(100000 * tiny.size(), 255);
    std::vector<std::size_t> all(100000);
    for (std::size_t i = 0; i < all.size(); ++i)
        all[i] = i;
    counts[0] = 254;
    const auto mean = normalisation<tiny>::mean_of(counts, all);
    CHECK(mean.data()[0] == static_cast<float>((254.0 + 255.0 * 99999) / 100000));
    CHECK(mean.data()[1] == 255);
}

TEST_CASE("normalisation: (count − mean) × scale") {
    normalisation<tiny> n;
    const std::array<std::uint8_t, 6> counts{0, 1, 128, 254, 255, 7};
    for (std::size_t e = 0; e < 6; ++e)
        CHECK(n.apply(counts).data()[e] == counts[e]); // as it is, to begin with
    n.scale = 1.0f / 255;
    CHECK(n.apply(counts).data()[4] == 255 * (1.0f / 255));
    n.mean.data()[3] = 0.5f;
    n.scale = 2;
    CHECK(n.apply(counts).data()[3] == 507);
    tensor<float, tiny> image;
    image.data()[3] = 1;
    n.apply(image);
    CHECK(image.data()[3] == 1);
}

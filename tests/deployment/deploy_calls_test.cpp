#include "deployed_network.hpp"

#include <tactnet/networks/tactnet4.hpp>

using namespace tactnet;

namespace {

using net = tactnet4<shape{28, 50}, 22>; // taps and tiles, and a last pool that reaches beyond the image

constexpr float scale = 0.02f;

std::vector<float> mean_image() {
    support::numbers draw(4);
    std::vector<float> mean(net::input_shape.size());
    for (float& m : mean)
        m = draw.next(0, 80);
    return mean;
}
const net& trained() {
    static const net network = [] {
        net n;
        support::fill(n, 40);
        return n;
    }();
    return network;
}
struct subject {
    using network = deployed<net>;
    static const network& fast() {
        static const std::vector<float> mean = mean_image();
        static const network made =
            deploy(trained(), std::span<const float, net::input_shape.size()>(mean), scale);
        return made;
    }
    static std::vector<float> bad_values() { return {}; }
};

} // namespace

#include "calls_suite.hpp"

TEST_CASE("deployed: NaN and infinity are reported where pixels may vanish in pools and ReLUs") {
    using forgetful = network<shape{9, 11, 2}, conv2d<4, 1>, relu, max_pool<2, 2, padding::valid>, dense<3>>;
    forgetful small;
    support::fill(small, 6);
    CHECK(bad_pixels_missed(deploy(small)) == 0);
}

TEST_CASE("deployed: numbers so large that sums overflow never pass as a result") {
    const fast_net plain = deploy(trained());
    const auto layers = support::describe<net>();
    std::size_t told = 0, wrong = 0;
    for (std::size_t i = 0; i < 200; ++i) {
        support::numbers draw(i + 600);
        const float most = std::pow(10.0f, 20 + 18.4f * static_cast<float>(i) / 200);
        std::vector<float> frame(pixels);
        for (float& pixel : frame)
            pixel = std::min(draw.next(-most, most) * 2, std::numeric_limits<float>::max());
        for (float& pixel : frame)
            pixel = std::isfinite(pixel) ? pixel : std::numeric_limits<float>::lowest();
        logits out;
        if (plain.infer(float_frame<fast_net>(frame.data()), std::span(out)) == frame_status::not_finite) {
            ++told;
            continue;
        }
        const auto expected = support::bounded_outputs(layers, support::parameters_of(trained()),
                                                       support::bounded_input(frame, {}, 1));
        wrong += !support::shares_of(out, expected).good();
    }
    CHECK(told > 0);
    CHECK(told < 200);
    CHECK(wrong == 0);
}

TEST_CASE("deployed: a sum that overflows is reported, though a ReLU would hide it") {
    using hides = network<shape{1, 3}, conv2d<1, extent2d(1, 3), 1, padding::valid>, relu, dense<1>>;
    hides n;
    const std::array<float, 6> values{-2, 1.1f, 1.1f, 0, 1, 0}; // of 3e38: first −inf, in truth 6e37
    std::copy(values.begin(), values.end(), n.learnable_values().begin());
    std::array<float, 1> out{};
    const auto run = [&](float value) {
        const std::array<float, 3> frame{value, value, value};
        return deploy(n).infer(frame, out);
    };
    CHECK(run(3e38f) == frame_status::not_finite);
    CHECK(run(1e30f) == frame_status::ok);
    CHECK(out[0] == doctest::Approx(0.2e30));
}

TEST_CASE("deployed: counts of 8 bits are accepted even where subtracting the mean exceeds the input limit") {
    using one = network<shape{1, 3}, dense<1>>;
    one n;
    std::fill_n(n.learnable_values().begin(), 3, 1e28f); // the bound is 1e7
    for (std::size_t place = 0; place < 3; ++place) {
        std::array<float, 3> mean{};
        mean[place] = 1e9f;
        const deployed<one> network = deploy(n, std::span<const float, 3>(mean), 1);
        const std::array<float, 3> frame{};
        std::array<float, 1> out{};
        CHECK(network.infer(frame, out) == frame_status::ok);
        CHECK(out[0] == doctest::Approx(-1e37));
    }
}

TEST_CASE("deployed: parameters that no training gives are refused") {
    using small = network<shape{1, 3}, conv2d<1, extent2d(1, 3), 1, padding::valid>, relu, dense<1>>;
    small n;
    n.learnable_values()[0] = 1e36f;
    CHECK_THROWS_WITH_AS(static_cast<void>(deploy(n)), doctest::Contains("up to 1e30"),
                         std::invalid_argument);
}

TEST_CASE("deployed: mean and scale give the bits of a frame prepared by hand") {
    const fast_net plain = deploy(trained());
    const std::vector<float> mean = mean_image();
    const std::vector<std::uint8_t> counts = frame_for<fast_net>(3);
    std::vector<float> frame = as_floats(counts);
    for (std::size_t i = 0; i < pixels; ++i)
        frame[i] = (frame[i] - mean[i]) * scale;
    logits out;
    CHECK(plain.infer(float_frame<fast_net>(frame.data()), std::span(out)) == frame_status::ok);
    CHECK(same_bits(out, output_of(subject::fast(), counts)));
}

TEST_CASE("deployed: parameters that are no numbers, and impossible variances, are refused") {
    using tiny = network<shape{4, 4}, batch_norm, conv2d<3, 3>, batch_norm, relu, dense<2>>;
    tiny good;
    support::fill(good, 5);
    CHECK_NOTHROW(static_cast<void>(deploy(good)));
    const auto refused = [&](auto&& spoil) {
        tiny bad = good;
        spoil(bad);
        CHECK_THROWS_AS(static_cast<void>(deploy(bad)), std::invalid_argument);
    };
    for (std::size_t i = 0; i < tiny::parameters; ++i)
        for (const float value :
             {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
            refused([&](tiny& bad) { bad.learnable_values()[i] = value; });
    good.for_each_parameter([&](const parameter& p, std::span<float>) {
        for (std::size_t i = p.offset; i < p.offset + p.size && !learnable(p.role); ++i) {
            refused(
                [&](tiny& bad) { bad.running_statistics()[i] = std::numeric_limits<float>::quiet_NaN(); });
            if (p.role == parameter_role::running_mean)
                refused(
                    [&](tiny& bad) { bad.running_statistics()[i] = std::numeric_limits<float>::infinity(); });
            else
                refused([&](tiny& bad) { bad.running_statistics()[i] = -1; });
        }
    });
    std::vector<float> mean(tiny::input_shape.size(), 1);
    const std::span<const float, tiny::input_shape.size()> means(mean);
    CHECK_THROWS_AS(static_cast<void>(deploy(good, means, INFINITY)), std::invalid_argument);
    for (const std::size_t bad : {std::size_t{0}, std::size_t{7}, mean.size() - 1}) {
        std::fill(mean.begin(), mean.end(), 1.0f);
        mean[bad] = NAN;
        CHECK_THROWS_WITH_AS(static_cast<void>(deploy(good, means, 1)),
                             doctest::Contains("expected a mean and a scale"), std::invalid_argument);
    }
}

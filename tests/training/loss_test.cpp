#include <tactnet/runtime/random.hpp>
#include <tactnet/training/data/split.hpp>
#include <tactnet/training/loss.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <support/tolerance.hpp>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape outputs{1, 1, 7};
template <class T>
using logits = batch<T, outputs, 4>;

/// −Σ wanted × log(probability), by the definition, in extended precision.
long double reference(const logits<double>& x, const std::vector<std::size_t>& labels, std::size_t classes,
                      double smoothing) {
    long double total = 0;
    for (std::size_t s = 0; s < x.samples(); ++s) {
        long double sum = 0;
        for (std::size_t c = 0; c < classes; ++c)
            sum += std::exp(static_cast<long double>(x(s, c)));
        for (std::size_t c = 0; c < classes; ++c) {
            const long double wanted = labels[s] == no_class ? 1 / static_cast<long double>(classes)
                                                             : smoothing / static_cast<double>(classes) +
                                                                   (c == labels[s] ? 1 - smoothing : 0.0);
            total -= wanted * std::log(std::exp(static_cast<long double>(x(s, c))) / sum);
        }
    }
    return total / static_cast<long double>(x.samples());
}

} // namespace

TEST_CASE("softmax_cross_entropy: value and gradient, smoothed and with fewer classes than outputs") {
    for (const std::size_t classes : {7u, 5u, 1u})
        for (const double smoothing : {0.0, 0.1}) {
            CAPTURE(classes);
            CAPTURE(smoothing);
            random_stream random(1, random_purposes::order);
            logits<double> x(6), gradient(6);
            std::vector<std::size_t> labels(6);
            for (std::size_t s = 0; s < 6; ++s) {
                for (std::size_t c = 0; c < 7; ++c)
                    x(s, c) = random.uniform(-3, 3);
                labels[s] = s == 4 ? no_class : s % classes;
            }
            for (std::size_t i = 0; i < gradient.view().lane_blocks() * gradient.view().lane_block_size; ++i)
                gradient.view().data()[i] = 99;
            const double loss = softmax_cross_entropy(x.as_const(), std::span<const std::size_t>(labels),
                                                      classes, smoothing, gradient.view());
            const double bound = support::accumulated(support::unit_roundoff<double>, 30) * 10;
            CHECK(support::within(loss,
                                  {static_cast<double>(reference(x, labels, classes, smoothing)), bound}));
            for (std::size_t s = 0; s < 6; ++s)
                for (std::size_t c = 0; c < 7; ++c) {
                    // Extended precision: the error of the difference is that of its step, h² / 6 of a
                    // third derivative below one, and of roundings of 10 over h.
                    constexpr double h = 1e-6;
                    logits<double> up = x, down = x;
                    up(s, c) += h, down(s, c) -= h;
                    const auto difference =
                        static_cast<double>((reference(up, labels, classes, smoothing) -
                                             reference(down, labels, classes, smoothing)) /
                                            static_cast<long double>(up(s, c) - down(s, c)));
                    CHECK(
                        support::within(gradient(s, c), {difference, h * h + 10 * 30 * 5.5e-20 / h + bound}));
                    if (c >= classes)
                        CHECK(gradient(s, c) == 0);
                }
            for (std::size_t c = 0; c < 7; ++c) // lanes without a sample
                for (std::size_t lane = 2; lane < 4; ++lane)
                    CHECK(gradient.view().lane_block(1)[c * 4 + lane] == 0);
        }
}

TEST_CASE("softmax_cross_entropy: finite whichever logit is the largest by far") {
    for (std::size_t largest = 0; largest < 3; ++largest) {
        logits<double> x(1), gradient(1);
        x(0, largest) = 1e4;
        const std::vector<std::size_t> label{largest};
        CHECK(softmax_cross_entropy<double>(x.as_const(), label, 3, 0.0, gradient.view()) == 0);
        CHECK(gradient(0, largest) == 0);
    }
}

TEST_CASE("softmax_cross_entropy: extreme logits stay finite") {
    for (const double smoothing : {0.0, 0.1}) {
        logits<float> x(2), gradient(2);
        for (std::size_t c = 0; c < 7; ++c)
            x(0, c) = c == 2 ? 1e30f : -1e30f, x(1, c) = c == 2 ? -1e30f : 1e30f;
        const std::vector<std::size_t> labels{2, 2};
        const double loss = softmax_cross_entropy(x.as_const(), std::span<const std::size_t>(labels), 7,
                                                  smoothing, gradient.view());
        CHECK(std::isfinite(loss));
        CHECK(loss > 1e29);
        for (std::size_t s = 0; s < 2; ++s)
            for (std::size_t c = 0; c < 7; ++c)
                CHECK(std::isfinite(gradient(s, c)));
        if (smoothing == 0) {
            CHECK(gradient(0, 2) == 0); // all right
            CHECK(gradient(1, 2) == -0.5f);
            CHECK(gradient(1, 0) == doctest::Approx(0.5 / 6));
        }
    }
}

TEST_CASE(
    "softmax_cross_entropy: a class that is ruled out costs nothing when it is not wanted; NaN is seen") {
    logits<float> x(1), gradient(1);
    for (std::size_t c = 0; c < 7; ++c)
        x(0, c) = c == 3 ? -std::numeric_limits<float>::infinity() : 0;
    const std::vector<std::size_t> labels{1};
    CHECK(softmax_cross_entropy(x.as_const(), std::span<const std::size_t>(labels), 7, 0.0,
                                gradient.view()) == doctest::Approx(std::log(6.0)));
    CHECK(gradient(0, 3) == 0);
    x(0, 5) = std::nanf("");
    CHECK(std::isnan(
        softmax_cross_entropy(x.as_const(), std::span<const std::size_t>(labels), 7, 0.0, gradient.view())));
}

#include "bicubic.hpp"

#include <tactnet/deployment/export/deployed_header.hpp>
#include <tactnet/transfer/as_photograph.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <deployment/deployed_network.hpp>
#include <memory>
#include <span>
#include <string>
#include <support/layers/conformance.hpp>
#include <utility>
#include <vector>

using namespace tactnet;

namespace {

std::size_t max_taps(const std::vector<std::vector<double>>& axis) {
    std::size_t most = 0;
    for (const auto& weights : axis)
        most = std::max(most, static_cast<std::size_t>(std::count_if(weights.begin(), weights.end(),
                                                                     [](double w) { return w != 0; })));
    return most;
}

/// body(output pixel, input pixel, weight) for all that are not zero.
template <class Body>
void for_each_tap(const std::vector<std::vector<double>>& down, const std::vector<std::vector<double>>& along,
                  const Body& body) {
    const std::size_t columns = along.front().size();
    for (std::size_t o = 0; o < down.size() * along.size(); ++o)
        for (std::size_t y = 0; y < down.front().size(); ++y)
            for (std::size_t x = 0; x < columns; ++x)
                if (const double w = down[o / along.size()][y] * along[o % along.size()][x]; w != 0)
                    body(o, y * columns + x, w);
}

/// A term passes its two weights' roundings, which the reference shares, and at most as many sums as there
/// are taps in both directions; then mean and scale, two roundings of the latter included.
class reference_photograph final : public support::reference_layer {
public:
    reference_photograph(support::extents3 in, std::size_t rows, std::size_t columns)
        : down_(support::bicubic(in.rows, rows)), along_(support::bicubic(in.columns, columns)) {
        input = in;
        output = {3, rows, columns};
        statistics = 6;
    }
    [[nodiscard]] support::samples forward(const support::reference_call& call,
                                           const support::samples& in) const override {
        const double sums = static_cast<double>(max_taps(down_) + max_taps(along_));
        support::samples out(in.size(), support::sample(output.size()));
        for (std::size_t s = 0; s < in.size(); ++s) {
            support::sample grey(output.area());
            std::vector<double> sizes(output.area()), squares(output.area());
            for_each_tap(down_, along_, [&](std::size_t o, std::size_t i, double w) {
                grey[o].value += w * in[s][i].value;
                grey[o].error += std::abs(w) * in[s][i].error;
                squares[o] += w * w * in[s][i].deviation * in[s][i].deviation;
                sizes[o] += std::abs(w) * (std::abs(in[s][i].value) + in[s][i].error);
            });
            for (std::size_t e = 0; e < output.size(); ++e) {
                const std::size_t o = e % output.area(), channel = e / output.area();
                const double mean = call.running[channel], scale = 1 / std::sqrt(call.running[3 + channel]);
                const double likely = call.roundoff * (sizes[o] + std::abs(mean));
                const double wrong = grey[o].error + support::accumulated(call.roundoff, sums) * sizes[o];
                out[s][e] = {(grey[o].value - mean) * scale,
                             scale * (wrong + support::accumulated(call.roundoff, 4) *
                                                  (std::abs(grey[o].value) + wrong + std::abs(mean))),
                             scale * std::sqrt(squares[o] + (sums + 4) * likely * likely)};
            }
        }
        return out;
    }
    [[nodiscard]] bool has_backward() const override { return true; }
    [[nodiscard]] support::reference_gradients backward(const support::reference_call& call,
                                                        const support::samples& in,
                                                        const support::samples& out_gradient) const override {
        // A term passes three channels and the scale, then the sums of all outputs that an input is a tap of.
        const double sums = static_cast<double>(5 + output.rows + output.columns);
        support::samples g(in.size(), support::sample(input.size()));
        for (std::size_t s = 0; s < in.size(); ++s)
            for_each_tap(down_, along_, [&](std::size_t o, std::size_t i, double w) {
                for (std::size_t channel = 0; channel < 3; ++channel) {
                    const double term = w / std::sqrt(call.running[3 + channel]) *
                                        out_gradient[s][channel * output.area() + o].value;
                    g[s][i].value += term;
                    g[s][i].error += support::accumulated(call.roundoff, sums) * std::abs(term);
                }
            });
        return {g, {}};
    }

private:
    std::vector<std::vector<double>> down_, along_;
};

} // namespace

template <extent2d Size>
struct support::reference_of<as_photograph<Size>> {
    static reference_pointer on(extents3 in) {
        return std::make_unique<reference_photograph>(in, Size.rows, Size.columns);
    }
};

TEST_CASE("as_photograph: what must hold of every layer") {
    support::check_layer<as_photograph<extent2d(9, 14)>, shape{4, 5, 1}>();
    support::check_layer<as_photograph<extent2d(3, 4)>, shape{7, 9, 1}>(); // smaller, antialiased
    support::check_layer<as_photograph<5>, shape{1, 1, 1}>();
    support::check_layer<sequence<as_photograph<extent2d(11, 9)>, conv2d<3, 3, 2, padding::valid>, relu>,
                         shape{5, 6, 1}>();
}

TEST_CASE("as_photograph: deployed within the derived bound") {
    using first = network<shape{6, 9, 1}, as_photograph<extent2d(17, 21)>, conv2d<5, 3, 2, padding::valid>,
                          relu, dense<4>>;
    const support::error_shares errors = support::errors_of<first>(51, 5);
    MESSAGE(errors);
    CHECK(errors.good());
    // Pixels that lie apart.
    using behind =
        network<shape{6, 7, 2}, conv2d<1, 3>, as_photograph<extent2d(10, 8)>, max_pool<2>, dense<3>>;
    CHECK(support::errors_of<behind>(52, 5).good());
    using last = network<shape{3, 4, 1}, as_photograph<extent2d(5, 6)>>;
    CHECK(support::errors_of<last>(53, 5).good());
}

TEST_CASE("as_photograph: memory in whole cache lines, so that the next frame's is aligned") {
    using step = as_photograph_step<single_precision, extent2d(28, 50), 1, extent2d(227, 227)>;
    using joining = as_photograph_step<single_precision, extent2d(28, 50), 16, extent2d(227, 227)>;
    static_assert(step::workspace_elements == pad_to_cache_line(step::workspace_elements) &&
                  step::packed_elements == pad_to_cache_line(step::packed_elements));
    static_assert(joining::workspace_elements == pad_to_cache_line(joining::workspace_elements) &&
                  joining::workspace_elements > step::workspace_elements);
}

TEST_CASE("as_photograph: its arrays are those of a norm without scale and shift") {
    using net = network<shape{28, 50, 1}, as_photograph<227>, conv2d<2, 3>>;
    const auto arrays = net::describe();
    REQUIRE(arrays.size() == 4);
    CHECK(arrays[0].name == "photograph.running_mean");
    CHECK(arrays[1].name == "photograph.running_var");
    CHECK(net::parameters == 2 * 3 * 9 + 2);
    CHECK(net::statistics == 6);
}

TEST_CASE("as_photograph: an exported header names its step") {
    using net = network<shape{3, 4, 1}, as_photograph<extent2d(5, 6)>, conv2d<2, 3>, dense<2>>;
    net network;
    support::fill(network, 54);
    const auto frame = support::make_frame(12, 1);
    const std::string text = deployed_header(
        deploy(network), {.network = "photograph", .namespace_name = "own", .classes = {"a", "b"}},
        std::span<const std::uint8_t, 12>(frame));
    CHECK(text.find("#include <tactnet/transfer/as_photograph_step.hpp>") != std::string::npos);
    CHECK(text.find("tactnet::as_photograph_step<tactnet::single_precision, ") != std::string::npos);
}

TEST_CASE("as_photograph: its step's output bound follows mean and scale of each channel") {
    // Between equal sizes every output is one of the inputs.
    using same_size = as_photograph_step<single_precision, extent2d(3, 4), 1, extent2d(3, 4)>;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        std::array<float, 6> numbers{0, 0, 0, 1, 1, 1};
        CHECK(same_size::output_bound(numbers.data(), 2) == doctest::Approx(2));
        numbers[channel] = -5, numbers[3 + channel] = 3;
        CHECK(same_size::output_bound(numbers.data(), 2) == doctest::Approx((2 + 5) * 3));
    }
    // Keys' kernel between two pixels: −1/16, 9/16, 9/16, −1/16.
    using twice = as_photograph_step<single_precision, extent2d(8, 8), 1, extent2d(16, 16)>;
    const std::array<float, 6> none{0, 0, 0, 1, 1, 1};
    CHECK(twice::output_bound(none.data(), 1) > 1.2);
    CHECK(twice::output_bound(none.data(), 1) < 2);
}

TEST_CASE("as_photograph: its step joins the pixels of its input, and no number after them") {
    using step = as_photograph_step<single_precision, extent2d(4, 4), 16, extent2d(4, 4)>;
    std::vector<float> in(17 * 16, 7.0f);
    aligned_vector<float> out(3 * 16 + 1), memory(step::workspace_elements + 1);
    out.back() = memory.back() = -9;
    const std::array<float, 6> numbers{0, 0, 0, 1, 1, 1};
    step::run(numbers.data(), in.data(), out.data(), memory.data());
    CHECK(out.front() == doctest::Approx(7));
    CHECK(out.back() == -9);
    CHECK(memory.back() == -9);
}

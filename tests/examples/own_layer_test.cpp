#include <tactnet/io.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bars.hpp>
#include <deployment/deployed_network.hpp>
#include <deployment/eight_bit/networks.hpp>
#include <filesystem>
#include <own_layer/network.hpp>
#include <support/layers/conformance.hpp>
#include <utility>

// A layer defined outside the library goes through all that a layer of the library's own goes through.

namespace {

constexpr double slope_of(unsigned percent) {
    return percent / 100.0;
}

class reference_leaky_relu final : public support::reference_layer {
public:
    reference_leaky_relu(support::extents3 size, double slope) : slope_(slope) { input = output = size; }

    [[nodiscard]] support::samples forward(const support::reference_call& call,
                                           const support::samples& in) const override {
        support::samples out = in;
        for (support::sample& each : out)
            for (support::bounded& b : each)
                b = scaled(b, b.value, call.roundoff);
        return out;
    }
    [[nodiscard]] bool has_backward() const override { return true; }
    [[nodiscard]] support::reference_gradients backward(const support::reference_call& call,
                                                        const support::samples& in,
                                                        const support::samples& out_gradient) const override {
        support::samples g = out_gradient;
        for (std::size_t s = 0; s < in.size(); ++s)
            for (std::size_t i = 0; i < input.size(); ++i)
                g[s][i] = scaled({g[s][i].value}, in[s][i].value, call.roundoff);
        return {g, {}};
    }

private:
    /// The slope is rounded, and the product.
    [[nodiscard]] support::bounded scaled(support::bounded b, double sign, double roundoff) const {
        if (sign > 0)
            return b;
        b.value *= slope_;
        return support::rounded_once(support::rounded_once(b, roundoff), roundoff);
    }

    double slope_;
};

} // namespace

template <unsigned Percent>
struct support::reference_of<own::leaky_relu<Percent>> {
    static reference_pointer on(extents3 in) {
        return std::make_unique<reference_leaky_relu>(in, slope_of(Percent));
    }
};

TEST_CASE("own_layer: what must hold of every layer") {
    support::check_layer<own::leaky_relu<1>, tactnet::shape{5, 4, 3}>();
    support::check_layer<own::leaky_relu<30>, tactnet::shape{1, 1, 1}>();
    support::check_layer<tactnet::sequence<tactnet::conv2d<4, 3>, own::leaky_relu<5>, tactnet::max_pool<2>>,
                         tactnet::shape{6, 5, 2}>();
}

TEST_CASE("own_layer: deployed within the derived bound") {
    const support::error_shares errors = support::errors_of<own::network>(41, 5);
    MESSAGE(errors);
    CHECK(errors.good());
    // Between layers that are joined otherwise, at sizes that fill no vector.
    using net = tactnet::network<tactnet::shape{5, 6, 2}, own::leaky_relu<20>, tactnet::conv2d<3, 2>,
                                 own::leaky_relu<1>, tactnet::relu, tactnet::batch_norm, own::leaky_relu<1>,
                                 tactnet::dense<4>, own::leaky_relu<7>>;
    CHECK(support::errors_of<net>(42, 5).good());
}

TEST_CASE("own_layer: in 8 bits the bits of the plain reference") {
    CHECK(support::frames_that_differ<own::network>(44, 10) == 0);
}

TEST_CASE("own_layer: the program's weight file and header are the same network") {
    const auto model = tactnet::load_model<own::network>(std::filesystem::path(TACTNET_OWN_LAYER_WEIGHTS));
    const auto network = tactnet::deploy(model);
    CHECK(bars::passes_selftest());
    CHECK(bars::classes == std::array<std::string_view, 3>{"lies", "stands", "cross"});
    for (std::size_t i = 0; i < 10; ++i) {
        const auto counts = support::make_frame(own::network::input_shape.size(), i);
        const tactnet::tensor_view<const std::uint8_t, own::network::input_shape> frame(counts.data());
        std::array<float, 3> expected{}, found{};
        REQUIRE(network.infer(frame, expected) == tactnet::frame_status::ok);
        REQUIRE(bars::recogniser.infer(frame, found) == tactnet::frame_status::ok);
        CHECK(expected == found);
    }
}

#include <tactnet/operators.hpp>
#include <tactnet/operators/norm_relu_pool/training.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <support/layers/conformance.hpp>
#include <support/layers/erased.hpp>
#include <type_traits>
#include <vector>

using namespace tactnet;
using support::check_layer;

// Windows that meet every pixel once, that overlap, that leave pixels out and that reach over the edge; no
// pooling at all.

TEST_CASE("norm_relu_pool: what must hold of every layer") {
    check_layer<norm_relu_pool<2>, shape{4, 6, 3}>();
    check_layer<norm_relu_pool<2>, shape{7, 5, 2}>();                    // keeps the rest
    check_layer<norm_relu_pool<2, 2, padding::valid>, shape{7, 5, 2}>(); // drops the rest
    check_layer<norm_relu_pool<2, 1>, shape{5, 4, 3}>();
    check_layer<norm_relu_pool<3, 2, pad(1)>, shape{5, 6, 1}>();
    check_layer<norm_relu_pool<1, 2>, shape{5, 4, 2}>(); // looks at every other pixel
    check_layer<norm_relu_pool<4, 3>, shape{7, 6, 1}>(); // larger than what is unrolled
    check_layer<norm_relu_pool<1>, shape{5, 4, 3}>();
    // Large values with a small deviation.
    check_layer<norm_relu_pool<2>, shape{4, 4, 2}>({.low = 1e3 - 2e-2, .high = 1e3 + 2e-2});
}

// What is joined, and that it changes no result.

static_assert(
    std::is_same_v<with_fused_norms<sequence<conv2d<2, 3>, batch_norm, relu, max_pool<2>, dense<3>>>,
                   sequence<conv2d<2, 3>, norm_relu_pool<2>, dense<3>>>);
static_assert(std::is_same_v<with_fused_norms<sequence<batch_norm, relu, conv2d<2, 3>, batch_norm>>,
                             sequence<norm_relu_pool<1>, conv2d<2, 3>, batch_norm>>);
static_assert(
    std::is_same_v<with_fused_norms<sequence<batch_norm, max_pool<2>, relu>>, // another order: not the same
                   sequence<batch_norm, max_pool<2>, relu>>);
static_assert(std::is_same_v<with_fused_norms<sequence<residual<sequence<batch_norm, relu>>, relu>>,
                             sequence<residual<sequence<norm_relu_pool<1>>, identity_layer>, relu>>);
static_assert(
    std::is_same_v<with_fused_norms<sequence<sequence<batch_norm, relu, max_pool<3, 2, padding::valid>>>>,
                   sequence<sequence<norm_relu_pool<3, 2, padding::valid>>>>);
static_assert(std::is_same_v<with_fused_norms<sequence<>>, sequence<>>);

namespace {

struct as_drawn {
    void operator()(auto&, auto&) const {}
};

struct results {
    aligned_vector<double> out, in_gradient, gradients, running;
};

/// `alter(values, in)` changes what was drawn.
template <class List, shape Input, class Alter>
results train(std::size_t count, const Alter& alter) {
    const auto layer = support::make_layer<List, double, Input>();
    const std::size_t places = kernels::padded_size<double>(count);
    const auto drawn = [](std::size_t size, std::uint32_t what) {
        aligned_vector<double> values(size);
        random_stream random(what, random_purposes::order);
        for (double& v : values)
            v = random.uniform(-1, 1);
        return values;
    };
    auto values = drawn(layer->parameters, 1), in = drawn(places * Input.size(), 2);
    alter(values, in);
    auto out_gradient = drawn(places * layer->output.size(), 3);
    for (std::size_t i = 0; i < out_gradient.size(); ++i) // lanes without a sample hold zeros
        if (i / (kernels::lanes<double> * layer->output.size()) * kernels::lanes<double> +
                i % kernels::lanes<double> >=
            count)
            out_gradient[i] = 0;
    results r{aligned_vector<double>(places * layer->output.size()), aligned_vector<double>(in.size()),
              aligned_vector<double>(layer->parameters), aligned_vector<double>(layer->statistics, 1.0)};
    thread_pool threads;
    const execution_context p{.threads = threads};
    layer->resize(count);
    layer->prepare(p, values.data(), r.running.data());
    layer->forward(p, values.data(), r.running.data(), count, in.data(), r.out.data());
    layer->backward(p, values.data(), count, in.data(), r.out.data(), out_gradient.data(),
                    r.in_gradient.data(), r.gradients.data());
    return r;
}

double largest_difference(const aligned_vector<double>& a, const aligned_vector<double>& b) {
    REQUIRE(a.size() == b.size());
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

template <class List, shape Input, class Alter = as_drawn>
void check_fused(const Alter& alter = {}) {
    for (const std::size_t count : {std::size_t{1}, 3 * kernels::lanes<double> + 1}) {
        const results plain = train<List, Input>(count, alter),
                      joined = train<with_fused_norms<List>, Input>(count, alter);
        CHECK(joined.out == plain.out);
        CHECK(joined.running == plain.running);
        // Sums over windows instead of pixels: the same terms in another order.
        CHECK(largest_difference(joined.gradients, plain.gradients) < 1e-11);
        CHECK(largest_difference(joined.in_gradient, plain.in_gradient) < 1e-11);
    }
}

} // namespace

TEST_CASE("with_fused_norms: a list gives what it gives layer by layer") {
    check_fused<
        sequence<conv2d<3, 3>, batch_norm, relu, max_pool<2>, conv2d<2, 3>, batch_norm, relu, dense<4>>,
        shape{7, 5, 1}>();
}
TEST_CASE("with_fused_norms: a residual block too") {
    check_fused<sequence<conv2d<2, 3>, batch_norm, relu,
                         residual<sequence<conv2d<2, 3>, batch_norm, relu, conv2d<2, 3>, batch_norm>,
                                  sequence<conv2d<2, 1>, batch_norm>>,
                         relu, max_pool<2, 1>>,
                shape{5, 4, 1}>();
}

TEST_CASE(
    "with_fused_norms: of equal elements the first is chosen, and a scale of zero makes all of them equal") {
    using list = sequence<batch_norm, relu, max_pool<2>>;
    check_fused<list, shape{6, 4, 1}>([](auto&, auto& in) {
        for (double& x : in)
            x = x > 0 ? 1 : -1;
    });
    check_fused<list, shape{6, 4, 1}>([](auto& values, auto&) { values[0] = 0, values[1] = 0.5; });
}
TEST_CASE("with_fused_norms: a NaN reaches the outputs that it reaches layer by layer") {
    using list = sequence<batch_norm, relu, max_pool<2>, batch_norm, relu>;
    constexpr shape size{4, 4, 1};
    const std::vector<double> values{1, 0, 1, 0}, running{0, 0, 1, 1};
    for (const std::size_t at : {0u, 5u, 6u, 9u, 15u}) {
        std::vector<aligned_vector<double>> outs;
        for (const auto& layer : {support::make_layer<list, double, size>(),
                                  support::make_layer<with_fused_norms<list>, double, size>()}) {
            aligned_vector<double> in(kernels::lanes<double> * size.size(), 0.25),
                out(kernels::lanes<double> * 4);
            in[at * kernels::lanes<double>] = std::nan("");
            thread_pool threads;
            layer->resize(1);
            layer->prepare({.threads = threads}, values.data(), running.data());
            layer->infer({.threads = threads}, values.data(), running.data(), 1, in.data(), out.data());
            outs.push_back(out);
        }
        std::size_t broken = 0;
        for (std::size_t i = 0; i < outs[0].size(); ++i) {
            broken += std::isnan(outs[0][i]);
            CHECK(std::isnan(outs[0][i]) == std::isnan(outs[1][i]));
        }
        CHECK(broken == 1);
    }
}
TEST_CASE("with_fused_norms: an empty batch has gradients of zero and moves no statistics") {
    using list = sequence<conv2d<2, 3>, batch_norm, relu, max_pool<2>, residual<conv2d<2, 3>>, dense<3>>;
    const auto layer = support::make_layer<with_fused_norms<list>, double, shape{5, 4, 1}>();
    const aligned_vector<double> values(layer->parameters, 0.5);
    aligned_vector<double> running{0, 0, 1, 1}, gradients(layer->parameters, 9);
    const aligned_vector<double> before = running;
    thread_pool threads;
    layer->resize(0);
    layer->prepare({.threads = threads}, values.data(), running.data());
    layer->forward({.threads = threads}, values.data(), running.data(), 0, nullptr, nullptr);
    layer->backward({.threads = threads}, values.data(), 0, nullptr, nullptr, nullptr, nullptr,
                    gradients.data());
    CHECK(running == before);
    CHECK(gradients == aligned_vector<double>(layer->parameters, 0));
}

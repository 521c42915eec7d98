#include <tactnet/layers.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <support/erased_layer.hpp>
#include <type_traits>

using namespace tactnet;

// What is joined, and that it changes no result.

static_assert(std::is_same_v<fused<sequence<conv2d<2, 3>, batch_norm, relu, max_pool<2>, dense<3>>>,
                             sequence<conv2d<2, 3>, norm_relu_pool<2>, dense<3>>>);
static_assert(std::is_same_v<fused<sequence<batch_norm, relu, conv2d<2, 3>, batch_norm>>,
                             sequence<norm_relu_pool<1>, conv2d<2, 3>, batch_norm>>);
static_assert(std::is_same_v<fused<sequence<batch_norm, max_pool<2>, relu>>, // another order: not the same
                             sequence<batch_norm, max_pool<2>, relu>>);
static_assert(std::is_same_v<fused<sequence<residual<sequence<batch_norm, relu>>, relu>>,
                             sequence<residual<sequence<norm_relu_pool<1>>, identity>, relu>>);
static_assert(std::is_same_v<fused<sequence<sequence<batch_norm, relu, max_pool<3, 2, valid>>>>,
                             sequence<sequence<norm_relu_pool<3, 2, valid>>>>);
static_assert(std::is_same_v<fused<sequence<>>, sequence<>>);

namespace {

struct results {
    aligned_vector<double> out, in_gradient, gradients, running;
};

template <class List, shape Input>
results train(std::size_t count) {
    const auto layer = support::make_layer<List, double, Input>();
    const std::size_t places = groups_of<double>(count) * lanes<double>;
    const auto drawn = [](std::size_t size, std::uint32_t what) {
        aligned_vector<double> values(size);
        random_stream random(what, draw::order);
        for (double& v : values)
            v = random.uniform(-1, 1);
        return values;
    };
    const auto values = drawn(layer->parameters, 1), in = drawn(places * Input.size(), 2);
    auto out_gradient = drawn(places * layer->output.size(), 3);
    for (std::size_t i = 0; i < out_gradient.size(); ++i) // lanes without a sample hold zeros
        if (i / (lanes<double> * layer->output.size()) * lanes<double> + i % lanes<double> >= count)
            out_gradient[i] = 0;
    results r{aligned_vector<double>(places * layer->output.size()), aligned_vector<double>(in.size()),
              aligned_vector<double>(layer->parameters), aligned_vector<double>(layer->statistics, 1.0)};
    thread_pool threads;
    const pass p{.threads = threads};
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

template <class List, shape Input>
void check_fused() {
    for (const std::size_t count : {std::size_t{1}, 3 * lanes<double> + 1}) {
        const results plain = train<List, Input>(count), joined = train<fused<List>, Input>(count);
        CHECK(joined.out == plain.out);
        CHECK(joined.running == plain.running);
        // Sums over windows instead of pixels: the same terms in another order.
        CHECK(largest_difference(joined.gradients, plain.gradients) < 1e-11);
        CHECK(largest_difference(joined.in_gradient, plain.in_gradient) < 1e-11);
    }
}

} // namespace

TEST_CASE("fused: a list gives what it gives layer by layer") {
    check_fused<
        sequence<conv2d<3, 3>, batch_norm, relu, max_pool<2>, conv2d<2, 3>, batch_norm, relu, dense<4>>,
        shape{7, 5, 1}>();
}
TEST_CASE("fused: a residual block too") {
    check_fused<sequence<conv2d<2, 3>, batch_norm, relu,
                         residual<sequence<conv2d<2, 3>, batch_norm, relu, conv2d<2, 3>, batch_norm>,
                                  sequence<conv2d<2, 1>, batch_norm>>,
                         relu, max_pool<2, 1>>,
                shape{5, 4, 1}>();
}

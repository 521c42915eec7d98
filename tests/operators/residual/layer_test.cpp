#include <tactnet/operators.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <support/layers/conformance.hpp>
#include <support/same_bits.hpp>
#include <vector>

using namespace tactnet;
using support::same_bits;

template <class T>
using array = aligned_vector<T>;

TEST_CASE("residual: branches of a single layer, named as lists of one") {
    using block = residual<conv2d<3, 3>, conv2d<3, 1>>;
    CHECK(support::arrays_of<block, shape{4, 3, 2}>() ==
          std::vector<std::string>{"layer.conv1.weight 3x2x3x3", "layer.conv1.bias 3",
                                   "layer.projection.conv1.weight 3x2x1x1", "layer.projection.conv1.bias 3"});
}

TEST_CASE("residual: the same bits as the sum of its branches") {
    using main_branch = sequence<conv2d<5, 3>, batch_norm>;
    using skip_branch = sequence<conv2d<5, 1>>;
    using block = residual<main_branch, skip_branch>;
    constexpr shape input{4, 3, 2};
    constexpr std::size_t count = kernels::lanes<float>;
    const auto whole = support::make_layer<block, float, input>();
    const auto main = support::make_layer<main_branch, float, input>();
    const auto skip = support::make_layer<skip_branch, float, input>();
    random_stream random(3, random_purposes::order);
    const auto filled = [&](std::size_t size) {
        array<float> a(size);
        for (float& value : a)
            value = static_cast<float>(random.uniform(-1, 1));
        return a;
    };
    const array<float> values = filled(whole->parameters), in = filled(input.size() * count);
    const array<float> out_gradient = filled(whole->output.size() * count);
    thread_pool threads;
    const execution_context p{.threads = threads};
    const auto run = [&](support::erased_layer<float>& layer, const float* own_values, array<float>& out,
                         array<float>& in_gradient, array<float>& gradients) {
        array<float> running(layer.statistics, 1.0f);
        out.resize(layer.output.size() * count), in_gradient.resize(in.size()),
            gradients.resize(layer.parameters);
        layer.resize(count);
        layer.prepare(p, own_values, running.data());
        layer.forward(p, own_values, running.data(), count, in.data(), out.data());
        layer.backward(p, own_values, count, in.data(), out.data(), out_gradient.data(), in_gradient.data(),
                       gradients.data());
    };
    array<float> out, in_gradient, gradients, main_out, main_in, main_gradients, skip_out, skip_in,
        skip_gradients;
    run(*whole, values.data(), out, in_gradient, gradients);
    run(*main, values.data(), main_out, main_in, main_gradients);
    run(*skip, values.data() + main->parameters, skip_out, skip_in, skip_gradients);
    for (std::size_t i = 0; i < out.size(); ++i)
        main_out[i] += skip_out[i];
    for (std::size_t i = 0; i < in.size(); ++i)
        main_in[i] += skip_in[i];
    main_gradients.insert(main_gradients.end(), skip_gradients.begin(), skip_gradients.end());
    CHECK(same_bits(out, main_out));
    CHECK(same_bits(in_gradient, main_in));
    CHECK(same_bits(gradients, main_gradients));
}

TEST_CASE("residual: dropouts of both branches draw masks of their own") {
    constexpr shape input{8, 16, 1};
    const auto layer =
        support::make_layer<residual<sequence<dropout<50>>, sequence<dropout<50>>>, float, input>();
    const std::size_t count = kernels::lanes<float>, elements = input.size() * count;
    const array<float> ones(elements, 1.0f);
    array<float> out(elements), in_gradient(elements), none;
    thread_pool threads;
    layer->resize(count);
    layer->forward({.threads = threads, .seed = 1}, nullptr, none.data(), count, ones.data(), out.data());
    const auto share = [&](float value) {
        return static_cast<double>(std::count(out.begin(), out.end(), value)) / static_cast<double>(elements);
    };
    const double deviation = 0.5 / std::sqrt(static_cast<double>(elements));
    CHECK(std::abs(share(0) - 0.25) < 4 * deviation);
    CHECK(std::abs(share(2) - 0.5) < 4 * deviation);
    CHECK(std::abs(share(4) - 0.25) < 4 * deviation);
    layer->backward({.threads = threads, .seed = 1}, nullptr, count, ones.data(), out.data(), ones.data(),
                    in_gradient.data(), nullptr);
    CHECK(in_gradient == out); // the masks of the forward pass
}

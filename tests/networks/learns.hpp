#pragma once

#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/training/initialise.hpp>
#include <tactnet/training/loss.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

namespace support {

/// A few steps of gradient descent on one batch must lower the loss, whatever the size of the image.
template <class Network>
void check_learns() {
    using namespace tactnet;
    constexpr std::size_t count = 12, area = Network::input_shape.size();
    CAPTURE(Network::input_shape.rows);
    CAPTURE(Network::input_shape.columns);
    Network net;
    initialise(net, he_normal{}, 1);
    random_stream random(2, random_purposes::order);
    typename Network::input_batch in(count);
    typename Network::output_batch out(count), out_gradient(count);
    std::vector<std::size_t> labels(count);
    for (std::size_t s = 0; s < count; ++s) {
        labels[s] = s % 4;
        for (std::size_t e = 0; e < area; ++e)
            in(s, e) = static_cast<float>(random.uniform(-1, 1));
    }
    thread_pool threads;
    typename Network::workspace space;
    std::vector<float> gradients(net.learnable_values().size());
    double first = 0, last = 0;
    for (int step = 0; step < 6; ++step) {
        net.prepare(threads, space);
        net.forward(in, out, threads, space);
        last = softmax_cross_entropy(out.as_const(), std::span<const std::size_t>(labels), Network::outputs,
                                     0.0, out_gradient.view());
        if (step == 0)
            first = last;
        net.backward(in, out, out_gradient, {nullptr, count}, gradients, threads, space);
        // As far as would lower the loss by a tenth if it were straight.
        double squares = 0;
        for (const float g : gradients)
            squares += static_cast<double>(g) * static_cast<double>(g);
        const auto rate = static_cast<float>(0.1 * last / squares);
        for (std::size_t i = 0; i < gradients.size(); ++i)
            net.learnable_values()[i] -= rate * gradients[i];
    }
    CHECK(std::isfinite(last));
    CHECK(first > 0.5);
    CHECK(last < 0.75 * first); // 0.9⁵ ≈ 0.59
}

/// At the smallest size and at an odd one between two published resolutions; TACTNET_TEST_EVERY_SIZE takes
/// more.
template <template <tactnet::shape> class Network>
void check_learns_at_sizes() {
    check_learns<Network<tactnet::shape{7, 13, 1}>>();
    check_learns<Network<tactnet::shape{13, 29, 1}>>();
#ifdef TACTNET_TEST_EVERY_SIZE
    check_learns<Network<tactnet::shape{8, 13, 1}>>();
    check_learns<Network<tactnet::shape{28, 50, 1}>>();
    check_learns<Network<tactnet::shape{11, 50, 1}>>();
#endif
}

} // namespace support

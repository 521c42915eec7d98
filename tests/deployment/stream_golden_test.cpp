// Against PyTorch's Conv1d, GRU, LSTM and Linear: tests/golden/time_layers.py made the file.

#include <tactnet/deployment.hpp>
#include <tactnet/deployment/stream.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/save_model.hpp>
#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <support/files/temporary_folder.hpp>
#include <support/layers/reference_of.hpp>
#include <support/same_bits.hpp>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape sequence_shape{13, 1, 3};
template <class T>
using net_in =
    basic_network<T, sequence_shape, causal_conv1d<7, 3, 2>, relu, gru<11>, lstm<6>, last_frame, dense<5>>;
using net = net_in<float>;

const safetensors& golden() {
    static const safetensors file =
        safetensors::read(TACTNET_SOURCE_DIR "/tests/golden/time_layers.safetensors");
    return file;
}
template <class T>
net_in<T> golden_network() {
    net_in<T> network;
    load_parameters(network, golden());
    return network;
}
/// The numbers of one frame after the other.
std::vector<float> golden_recording() {
    const std::vector<float> stored = golden().values<float>("selftest.input"); // [feature][frame]
    std::vector<float> recording(stored.size());
    for (std::size_t i = 0; i < stored.size(); ++i)
        recording[i % 13 * 3 + i / 13] = stored[i];
    return recording;
}

} // namespace

TEST_CASE("deployed_stream: reads PyTorch's parameters and gives its outputs after each frame") {
    const auto network = golden_network<float>();
    const auto stream = deploy_stream(network);
    const std::vector<double> expected = golden().values<double>("selftest.logits");
    const std::vector<float> recording = golden_recording();
    std::vector<float> found(expected.size());
    decltype(stream)::state memory;
    REQUIRE(stream.run(recording, memory, found) == 13);

    // The dense layer after each frame, for the bound of each output's error in single precision.
    using after_each = sequence<causal_conv1d<7, 3, 2>, relu, gru<11>, lstm<6>, causal_conv1d<5, 1>>;
    const auto reference = support::reference_of<after_each>::on({3, 13, 1});
    const std::vector<double> values(network.learnable_values().begin(), network.learnable_values().end());
    support::sample exact;
    for (const float value : golden().values<float>("selftest.input"))
        exact.push_back({static_cast<double>(value)});
    const support::samples bounds = reference->forward(
        {.values = values, .running = {}, .roundoff = support::unit_roundoff<float>}, {exact});
    for (std::size_t i = 0; i < found.size(); ++i) {
        const support::bounded& bound = bounds[0][i % 5 * 13 + i / 5];
        CHECK(std::abs(bound.value - expected[i]) < 1e-12);
        CHECK(support::within(static_cast<double>(found[i]), {expected[i], bound.error}));
        CHECK(bound.error < 1e-3); // the bound tells right from wrong
    }
}

TEST_CASE("recurrent: gradients through time are PyTorch's") {
    auto network = golden_network<double>();
    constexpr std::size_t lanes = kernels::lanes<double>;
    const std::vector<double> recording = golden().values<double>("selftest.input"),
                              direction = golden().values<double>("selftest.direction");
    net_in<double>::input_batch in(1), in_gradient(1);
    net_in<double>::output_batch out(1), out_gradient(1);
    for (std::size_t i = 0; i < recording.size(); ++i)
        in(0, i) = recording[i];
    for (std::size_t o = 0; o < 5; ++o)
        out_gradient(0, o) = direction[o];
    thread_pool threads;
    net_in<double>::workspace space;
    aligned_vector<double> gradients(network.learnable_values().size() + lanes);
    network.prepare(threads, space);
    network.forward(in, out, threads, space);
    network.backward(in, out.as_const(), out_gradient.as_const(), in_gradient, gradients, threads, space);

    // Sigmoid and tanh in double are within 1e-12 (detail/special_functions.hpp): five for each of 13 frames.
    const auto compare = [](const std::vector<double>& expected, const auto& found) {
        double largest = 0;
        for (const double value : expected)
            largest = std::max(largest, std::abs(value));
        CHECK(largest > 1e-3);
        for (std::size_t i = 0; i < expected.size(); ++i)
            CHECK(std::abs(found(i) - expected[i]) <= 5 * 13 * 1e-12 * largest);
    };
    compare(golden().values<double>("selftest.gradient.input"),
            [&](std::size_t i) { return static_cast<double>(in_gradient(0, i)); });
    for (const parameter& p : net::describe())
        compare(golden().values<double>("selftest.gradient." + p.name),
                [&](std::size_t i) { return gradients[p.offset + i]; });
}

TEST_CASE("recurrent: a saved model is read back to the same bits, with PyTorch's names and extents") {
    const model<net> trained{golden_network<float>(), {}, {"soft", "hard", "dynamic", "grasp", "slip"}};
    const support::temporary_folder folder;
    const auto path = folder.path() / "touches.safetensors";
    save_model(path, trained, {{"network", "touches over time"}});
    const safetensors file = safetensors::read(path.string());
    for (const parameter& p : net::describe()) {
        CHECK(file.at(p.name).extents == golden().at(p.name).extents);
        CHECK(support::same_bits(file.values<float>(p.name), golden().values<float>(p.name)));
    }
    const auto read = load_model<net>(path.string());
    CHECK(support::same_bits(read.network.learnable_values(), trained.network.learnable_values()));
    CHECK(read.classes == trained.classes);
}

#pragma once

// Networks that tactnet.onnx has made of ONNX models, compared with what ONNX Runtime makes of these models,
// or, where it is missing, with what the importer computes node by node.

#include "../deployment/deployed_network.hpp"

#include <tactnet/deployment/export/onnx_model.hpp>
#include <tactnet/io/deployed_file.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/svm_file.hpp>
#include <tactnet/io/write_file.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/svm.hpp>
#include <tactnet/training.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <support/layers/deployed_reference.hpp>
#include <support/layers/reference_of.hpp>
#include <type_traits>
#include <vector>

namespace imported {

/// The largest errors of imported networks, and how far the runtime is from the same reference.
struct errors {
    support::error_shares network, runtime;
};

/// Loads the network of a name, which repeats the self-test of its file, and computes the frames of the file
/// NAME.expected.safetensors. Every output lies within the bound that is derived for this network, and the
/// runtime's, whose sums are in some other order, within the bound for layers as they are trained: once for
/// its own roundings, once for those of weights that the import has folded.
template <class Network, bool Stream>
errors compare(const std::string& folder, const std::string& name) {
    const std::string path = folder + "/" + name;
    const auto file = tactnet::safetensors::read(path + ".safetensors"),
               expected = tactnet::safetensors::read(path + ".expected.safetensors");
    const auto trained = tactnet::load_model<Network>(file);
    if constexpr (tactnet::has_onnx_form<Network>)
        tactnet::write_file(path + ".again.onnx", tactnet::onnx_model(trained));
    const std::vector<std::uint8_t> counts = expected.values<std::uint8_t>("input");
    const std::vector<float> runtime = expected.values<float>("outputs");
    constexpr std::size_t size = Network::input_shape.size(), outputs = Network::outputs;
    REQUIRE(counts.size() / size * outputs == runtime.size());
    const std::span<const float> mean(trained.normalise.mean.data(), size);
    const auto parameters = support::parameters_of(trained.network);
    support::described_network layers;
    constexpr tactnet::shape input = Network::input_shape;
    layers.layers = support::reference_of<typename Network::specification>::on(
        {input.channels, input.rows, input.columns});
    const support::described_network plain = support::as_trained(layers);
    errors worst;
    std::vector<float> found(runtime.size());
    if constexpr (Stream) {
        tactnet::thread_pool alone;
        found = trained.logits(counts, alone);
    } else {
        layers = support::describe<Network>();
        const auto network = tactnet::load_deployed<Network>(file);
        for (std::size_t i = 0; i * size < counts.size(); ++i)
            REQUIRE(network.infer(std::span<const std::uint8_t, size>(counts.data() + i * size, size),
                                  std::span<float, outputs>(found.data() + i * outputs, outputs)) ==
                    tactnet::frame_status::ok);
    }
    for (std::size_t i = 0; i * size < counts.size(); ++i) {
        const std::vector<float> frame(counts.begin() + static_cast<std::ptrdiff_t>(i * size),
                                       counts.begin() + static_cast<std::ptrdiff_t>((i + 1) * size));
        const auto in = support::bounded_input(frame, mean, trained.normalise.scale);
        const auto own = support::bounded_outputs(Stream ? plain : layers, parameters, in);
        auto twice = support::bounded_outputs(plain, parameters, in);
        for (support::bounded& number : twice)
            number.error *= 2, number.deviation *= 2;
        // Deviations are of deployed networks: batches add their terms in another order.
        const auto shares = support::shares_of(std::span(found).subspan(i * outputs, outputs), own);
        worst.network.add({shares.of_bound, Stream ? 0 : shares.of_deviation});
        worst.runtime.add(support::shares_of(std::span(runtime).subspan(i * outputs, outputs), twice));
    }
    return worst;
}

/// Rows that a kernel machine gives another label than the runtime does.
template <class Machine>
std::size_t wrong_labels(const std::string& folder, const std::string& name) {
    const auto file = tactnet::safetensors::read(folder + "/" + name + ".safetensors");
    const Machine machine = [&]<class Kernel, std::size_t Features>(
                                std::type_identity<tactnet::kernel_machine<Kernel, Features>>) {
        return tactnet::load_kernel_machine<Kernel, Features>(file);
    }(std::type_identity<Machine>{});
    const auto rows = file.values<float>("selftest.input");
    const auto labels = file.values<std::int64_t>("selftest.labels");
    tactnet::thread_pool alone;
    const std::vector<std::size_t> found = machine.predict({rows, machine.features()}, alone);
    REQUIRE(found.size() == labels.size());
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < labels.size(); ++i)
        wrong += found[i] != static_cast<std::size_t>(labels[i]) ? 1 : 0;
    return wrong;
}

} // namespace imported

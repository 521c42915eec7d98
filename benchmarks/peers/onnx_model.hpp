#pragma once

#include "../support/described_network.hpp"

#include <tactnet/deployment/export/onnx_graph.hpp>

#include <cstddef>
#include <initializer_list>
#include <string>
#include <vector>

// Networks in the form that ONNX defines (https://onnx.ai, onnx.proto3).

namespace benchmark {

namespace onnx {

using tactnet::detail::onnx_attribute;

class graph {
public:
    graph(const described_network& network, const std::vector<float>& mean) : names_(network.maps().size()) {
        const tactnet::shape in = network.maps().front();
        names_[0] = "frames";
        if (!mean.empty())
            names_[0] =
                graph_.node("Sub", {"frames", graph_.constant(mean, {1, in.channels, in.rows, in.columns})});
        for (const operation& o : network.operations())
            add(o);
        graph_.node("Flatten", {names_[network.operations().back().output]}, {}, "logits");
    }
    [[nodiscard]] const tactnet::detail::onnx_graph& written() const { return graph_; }

private:
    void add(const operation& o) {
        const std::string& in = names_[o.input];
        switch (o.what) {
        case operation::kind::convolution: {
            const auto& kernel = o.window.kernel;
            const std::string weights =
                graph_.constant(o.weights, {o.to.channels, o.from.channels, kernel.rows, kernel.columns});
            std::string out = over("Conv", {in, weights, graph_.constant(o.bias, {o.to.channels})}, o.window);
            if (o.accumulates)
                out = graph_.node("Add", {out, names_[o.output]});
            names_[o.output] = o.relu ? graph_.node("Relu", {out}) : out;
            break;
        }
        case operation::kind::pool:
            names_[o.output] = over("MaxPool", {in}, o.window);
            break;
        case operation::kind::average:
            names_[o.output] = over("AveragePool", {in}, o.window);
            break;
        case operation::kind::relu:
            names_[o.output] = graph_.node("Relu", {in});
            break;
        case operation::kind::concatenation: {
            std::vector<std::string> inputs;
            for (const std::size_t map : o.inputs)
                inputs.push_back(names_[map]);
            names_[o.output] = graph_.node("Concat", inputs, {onnx_attribute("axis", std::size_t{1})});
            break;
        }
        case operation::kind::dense: {
            names_[o.output] = graph_.node("Gemm",
                                           {graph_.node("Flatten", {in}),
                                            graph_.constant(o.weights, {o.to.channels, o.from.size()}),
                                            graph_.constant(o.bias, {o.to.channels})},
                                           {onnx_attribute("transB", std::size_t{1})});
            break;
        }
        }
    }
    std::string over(const char* operation_name, std::initializer_list<std::string> inputs,
                     const tactnet::sliding_window& w) {
        const auto missing = [](std::size_t reach, std::size_t size) {
            return reach > size ? reach - size : 0;
        };
        const std::size_t bottom = missing((w.output_rows() - 1) * w.stride.rows + w.kernel.rows,
                                           w.input.rows + w.top),
                          right = missing((w.output_columns() - 1) * w.stride.columns + w.kernel.columns,
                                          w.input.columns + w.left);
        return graph_.node(operation_name, inputs,
                           {onnx_attribute("kernel_shape", {w.kernel.rows, w.kernel.columns}),
                            onnx_attribute("strides", {w.stride.rows, w.stride.columns}),
                            onnx_attribute("pads", {w.top, w.left, bottom, right})});
    }

    tactnet::detail::onnx_graph graph_;
    std::vector<std::string> names_; ///< of what each map holds by now
};

} // namespace onnx

/// Bytes of a model whose input is "frames", [batch][channel][row][column], and whose output is "logits". A
/// mean image, if there is one, is subtracted from the frames.
inline std::string onnx_model(const described_network& network, std::size_t batch,
                              const std::vector<float>& mean = {}) {
    const tactnet::shape in = network.maps().front(),
                         out = network.maps()[network.operations().back().output];
    return onnx::graph(network, mean)
        .written()
        .file("frames", {batch, in.channels, in.rows, in.columns}, "logits", {batch, out.size()}, 13);
}

} // namespace benchmark

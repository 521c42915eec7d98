#pragma once

#include "../support/described_network.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// Networks in the form that ONNX defines (https://onnx.ai, onnx.proto3).

namespace benchmark {

namespace onnx {

/// A message of protocol buffers: fields one after the other, each with its number.
class message {
public:
    message& number(std::uint64_t field, std::uint64_t value) {
        append(field << 3);
        append(value);
        return *this;
    }
    message& bytes(std::uint64_t field, std::string_view value) {
        append(field << 3 | 2);
        append(value.size());
        bytes_ += value;
        return *this;
    }
    message& inner(std::uint64_t field, const message& value) { return bytes(field, value.bytes_); }
    message& numbers(std::uint64_t field, const std::vector<std::size_t>& values) {
        for (const std::size_t value : values)
            number(field, value);
        return *this;
    }
    [[nodiscard]] const std::string& str() const { return bytes_; }

private:
    /// Seven bits per byte, the lowest first; the eighth reports that more bytes follow.
    void append(std::uint64_t value) {
        for (; value >= 128; value >>= 7)
            bytes_ += static_cast<char>(value % 128 + 128);
        bytes_ += static_cast<char>(value);
    }
    std::string bytes_;
};

enum : std::uint64_t { single_precision = 1 }; // TensorProto.DataType

inline message attribute(const std::string& name, std::size_t value) {
    return message().bytes(1, name).number(3, value).number(20, 2); // INT
}
inline message attribute(const std::string& name, const std::vector<std::size_t>& values) {
    return message().bytes(1, name).numbers(8, values).number(20, 7); // INTS
}
inline message named_map(const std::string& name, const std::vector<std::size_t>& sizes) {
    message shape;
    for (const std::size_t size : sizes)
        shape.inner(1, message().number(1, size));
    const message tensor = message().number(1, single_precision).inner(2, shape);
    return message().bytes(1, name).inner(2, message().inner(1, tensor));
}

class graph {
public:
    graph(const described_network& network, std::size_t batch, const std::vector<float>& mean)
        : names_(network.maps().size()) {
        const tactnet::shape in = network.maps().front(),
                             out = network.maps()[network.operations().back().output];
        names_[0] = "frames";
        if (!mean.empty())
            names_[0] =
                node("Sub", {"frames", constant(mean, {1, in.channels, in.rows, in.columns})}, next(), {});
        for (const operation& o : network.operations())
            add(o);
        node("Flatten", {names_[network.operations().back().output]}, "logits", {attribute("axis", 1)});
        graph_.bytes(2, "network");
        graph_.inner(11, named_map("frames", {batch, in.channels, in.rows, in.columns}));
        graph_.inner(12, named_map("logits", {batch, out.size()}));
    }
    [[nodiscard]] const message& proto() const { return graph_; }

private:
    void add(const operation& o) {
        const std::string& in = names_[o.input];
        switch (o.what) {
        case operation::kind::convolution: {
            const auto& kernel = o.window.kernel;
            std::string out =
                node("Conv",
                     {in, constant(o.weights, {o.to.channels, o.from.channels, kernel.rows, kernel.columns}),
                      constant(o.bias, {o.to.channels})},
                     next(), over(o.window));
            if (o.accumulates)
                out = node("Add", {out, names_[o.output]}, next(), {});
            names_[o.output] = o.relu ? node("Relu", {out}, next(), {}) : out;
            break;
        }
        case operation::kind::pool:
            names_[o.output] = node("MaxPool", {in}, next(), over(o.window));
            break;
        case operation::kind::average:
            names_[o.output] = node("AveragePool", {in}, next(), over(o.window));
            break;
        case operation::kind::relu:
            names_[o.output] = node("Relu", {in}, next(), {});
            break;
        case operation::kind::concatenation: {
            std::vector<std::string> inputs;
            for (const std::size_t map : o.inputs)
                inputs.push_back(names_[map]);
            names_[o.output] = node("Concat", inputs, next(), {attribute("axis", 1)});
            break;
        }
        case operation::kind::dense: {
            const std::string flat = node("Flatten", {in}, next(), {attribute("axis", 1)});
            names_[o.output] = node("Gemm",
                                    {flat, constant(o.weights, {o.to.channels, o.from.size()}),
                                     constant(o.bias, {o.to.channels})},
                                    next(), {attribute("transB", 1)});
            break;
        }
        }
    }
    static std::vector<message> over(const tactnet::sliding_window& w) {
        const auto missing = [](std::size_t reach, std::size_t size) {
            return reach > size ? reach - size : 0;
        };
        const std::size_t bottom = missing((w.output_rows() - 1) * w.stride.rows + w.kernel.rows,
                                           w.input.rows + w.top),
                          right = missing((w.output_columns() - 1) * w.stride.columns + w.kernel.columns,
                                          w.input.columns + w.left);
        return {attribute("kernel_shape", {w.kernel.rows, w.kernel.columns}),
                attribute("strides", {w.stride.rows, w.stride.columns}),
                attribute("pads", {w.top, w.left, bottom, right})};
    }
    std::string constant(const std::vector<float>& values, const std::vector<std::size_t>& sizes) {
        const std::string name = next();
        graph_.inner(
            5, message()
                   .numbers(1, sizes)
                   .number(2, single_precision)
                   .bytes(8, name)
                   .bytes(9, {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)}));
        return name;
    }
    std::string node(const std::string& operation_name, const std::vector<std::string>& inputs,
                     const std::string& output, const std::vector<message>& attributes) {
        message all;
        for (const std::string& input : inputs)
            all.bytes(1, input);
        all.bytes(2, output).bytes(4, operation_name);
        for (const message& each : attributes)
            all.inner(5, each);
        graph_.inner(1, all);
        return output;
    }
    std::string next() { return "t" + std::to_string(count_++); }

    message graph_;
    std::vector<std::string> names_; ///< of what each map holds by now
    std::size_t count_ = 0;
};

} // namespace onnx

/// Bytes of a model whose input is "frames", [batch][channel][row][column], and whose output is "logits". A
/// mean image, if there is one, is subtracted from the frames.
inline std::string onnx_model(const described_network& network, std::size_t batch,
                              const std::vector<float>& mean = {}) {
    using onnx::message;
    const onnx::graph made(network, batch, mean);
    return message()
        .number(1, 7) // version of the form
        .inner(7, made.proto())
        .inner(8, message().number(2, 13)) // of the operators
        .str();
}

} // namespace benchmark

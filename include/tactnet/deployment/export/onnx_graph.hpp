#pragma once

#include <tactnet/detail/arithmetic.hpp>

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// The form of ONNX files (https://onnx.ai, onnx.proto3), which needs no library: messages of fields, each
// with its number. onnx_model.hpp writes networks by it.

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// A message of protocol buffers: fields one after the other, each with its number.
class onnx_message {
public:
    onnx_message& number(std::uint64_t field, std::uint64_t value) {
        append(field << 3);
        append(value);
        return *this;
    }
    onnx_message& real(std::uint64_t field, float value) {
        append(field << 3 | 5);
        append_bytes(value);
        return *this;
    }
    onnx_message& bytes(std::uint64_t field, std::string_view value) {
        append(field << 3 | 2);
        append(value.size());
        bytes_ += value;
        return *this;
    }
    onnx_message& inner(std::uint64_t field, const onnx_message& value) { return bytes(field, value.bytes_); }
    onnx_message& numbers(std::uint64_t field, std::span<const std::size_t> values) {
        for (const std::size_t value : values)
            number(field, value);
        return *this;
    }
    /// Little-endian, as files have them.
    onnx_message& reals(std::uint64_t field, std::span<const float> values) {
        append(field << 3 | 2);
        append(values.size() * sizeof(float));
        for (const float value : values)
            append_bytes(value);
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
    void append_bytes(float value) {
        const auto bits = bits_as<std::uint32_t>(value);
        for (unsigned shift = 0; shift < 32; shift += 8)
            bytes_ += static_cast<char>(bits >> shift & 255);
    }
    std::string bytes_;
};

[[nodiscard]] inline onnx_message onnx_attribute(std::string_view name, std::size_t value) {
    return std::move(onnx_message().bytes(1, name).number(3, value).number(20, 2)); // INT
}
[[nodiscard]] inline onnx_message onnx_attribute(std::string_view name, float value) {
    return std::move(onnx_message().bytes(1, name).real(2, value).number(20, 1)); // FLOAT
}
[[nodiscard]] inline onnx_message onnx_attribute(std::string_view name, std::string_view value) {
    return std::move(onnx_message().bytes(1, name).bytes(4, value).number(20, 3)); // STRING
}
[[nodiscard]] inline onnx_message onnx_attribute(std::string_view name,
                                                 std::initializer_list<std::size_t> values) {
    return std::move(onnx_message().bytes(1, name).numbers(8, {values.begin(), values.size()}).number(20, 7));
}

/// Nodes and constants, which have names of their own.
class onnx_graph {
public:
    /// Returns the name of the array [sizes…].
    std::string constant(std::span<const float> values, std::initializer_list<std::size_t> sizes) {
        return constant(sizes, 1, [&](onnx_message& tensor) { tensor.reals(4, values); });
    }
    std::string constant(float value) { return constant({&value, 1}, {}); }
    /// Whole numbers of 64 bits, such as extents and axes.
    std::string whole_numbers(std::initializer_list<std::size_t> values) {
        return constant({values.size()}, 7, [&](onnx_message& tensor) {
            tensor.numbers(7, {values.begin(), values.size()});
        });
    }
    /// Adds a node and returns the name of its first output, which is `output` if that is given.
    std::string node(std::string_view operation, std::initializer_list<std::string> inputs,
                     std::initializer_list<onnx_message> attributes = {}, std::string output = {}) {
        return node(operation, std::span(inputs.begin(), inputs.size()), attributes, std::move(output));
    }
    std::string node(std::string_view operation, std::span<const std::string> inputs,
                     std::initializer_list<onnx_message> attributes = {}, std::string output = {}) {
        if (output.empty())
            output = next();
        onnx_message all;
        for (const std::string& input : inputs)
            all.bytes(1, input);
        all.bytes(2, output).bytes(3, output).bytes(4, operation);
        for (const onnx_message& each : attributes)
            all.inner(5, each);
        graph_.inner(1, all);
        return output;
    }
    /// The bytes of a model of this graph. A size of 0 is that of the batch, which is open. `properties` are
    /// stored as the file's metadata: names and values.
    [[nodiscard]] std::string
    file(std::string_view input, std::initializer_list<std::size_t> input_sizes, std::string_view output,
         std::initializer_list<std::size_t> output_sizes, std::size_t operator_set,
         std::span<const std::pair<std::string, std::string>> properties = {}) const {
        onnx_message whole = graph_;
        whole.bytes(2, "network").inner(11, named(input, input_sizes)).inner(12, named(output, output_sizes));
        onnx_message model;
        model.number(1, 7).bytes(2, "tactnet").inner(7, whole); // version 7 of the form
        model.inner(8, onnx_message().number(2, operator_set));
        for (const auto& [key, value] : properties)
            model.inner(14, onnx_message().bytes(1, key).bytes(2, value));
        return model.str();
    }

private:
    template <class Fill>
    std::string constant(std::initializer_list<std::size_t> sizes, std::uint64_t type, const Fill& fill) {
        std::string name = next();
        onnx_message tensor;
        tensor.numbers(1, {sizes.begin(), sizes.size()}).number(2, type);
        fill(tensor);
        graph_.inner(5, tensor.bytes(8, name));
        return name;
    }
    static onnx_message named(std::string_view name, std::initializer_list<std::size_t> sizes) {
        onnx_message extents;
        for (const std::size_t size : sizes)
            extents.inner(1, size == 0 ? onnx_message().bytes(2, "batch") : onnx_message().number(1, size));
        const onnx_message tensor = onnx_message().number(1, 1).inner(2, extents); // single precision
        return std::move(onnx_message().bytes(1, name).inner(2, onnx_message().inner(1, tensor)));
    }
    std::string next() { return "t" + std::to_string(count_++); }

    onnx_message graph_;
    std::size_t count_ = 0;
};

} // namespace detail
}} // namespace tactnet

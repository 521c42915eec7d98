#pragma once

#include <cstddef>
#include <string>

// Networks in the form that ONNX defines (https://onnx.ai, onnx.proto3), for peers that read it.

namespace benchmark {

class described_network;

/// Bytes of a model whose input is "frames", [batch][channel][row][column], and whose output is "logits".
[[nodiscard]] std::string onnx_model(const described_network& network, std::size_t batch);

} // namespace benchmark

#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

// What a peer must do: build a network once, then run it on frames. One file a peer; each is found by CMake
// and left out with a message where it is absent.

namespace benchmark {

class described_network;

class peer {
public:
    virtual ~peer() = default;
    /// Logits of as many frames as the peer was built for, one row each. Frames are float, logits too.
    virtual void run(std::span<const float> frames, std::span<float> logits) = 0;
};

/// The same in 8 bits: frames are bytes.
class byte_peer {
public:
    virtual ~byte_peer() = default;
    virtual void run(std::span<const std::uint8_t> frames, std::span<float> logits) = 0;
};

/// oneDNN, primitives called one after the other, in the layouts that it prefers.
[[nodiscard]] std::unique_ptr<peer> make_onednn(const described_network& network, std::size_t batch,
                                                std::size_t threads = 1);
/// OpenCV's engine for networks, on one thread.
[[nodiscard]] std::unique_ptr<peer> make_opencv_dnn(const described_network& network, std::size_t batch);
/// PyTorch's C++ functions, on one thread, in its usual layout.
[[nodiscard]] std::unique_ptr<peer> make_libtorch(const described_network& network, std::size_t batch);
/// ONNX Runtime's sessions, on one thread.
[[nodiscard]] std::unique_ptr<peer> make_onnxruntime(const described_network& network, std::size_t batch);
/// ncnn on one thread, in single precision.
[[nodiscard]] std::unique_ptr<peer> make_ncnn(const described_network& network, std::size_t batch);
/// oneDNN in 8 bits on one thread. `frames`, as many as it will run, set the activation ranges.
[[nodiscard]] std::unique_ptr<byte_peer> make_onednn_8bit(const described_network& network, std::size_t batch,
                                                          std::span<const std::uint8_t> frames);

/// A GRU or an LSTM by PyTorch's arrays, one after the other.
struct recurrent_layer {
    bool lstm;
    std::size_t features, hidden;
    std::span<const float> values;
};
/// It in RTNeural's back ends. Frames are a recording, logits the outputs of each of them. Null if the sizes
/// are none of those that were compiled.
[[nodiscard]] std::unique_ptr<peer> make_rtneural_eigen(const recurrent_layer& layer);
[[nodiscard]] std::unique_ptr<peer> make_rtneural_xsimd(const recurrent_layer& layer);
[[nodiscard]] std::unique_ptr<peer> make_rtneural_stl(const recurrent_layer& layer);

/// Calls with(name, make) for each library in single precision that CMake has found; make(network, batch) is
/// a peer.
template <class With>
void for_each_library([[maybe_unused]] const With& with) {
#ifdef TACTNET_BENCHMARK_ONEDNN
    with("onednn", [](const described_network& n, std::size_t batch) { return make_onednn(n, batch); });
#endif
#ifdef TACTNET_BENCHMARK_OPENCV_DNN
    with("opencv_dnn", make_opencv_dnn);
#endif
#ifdef TACTNET_BENCHMARK_LIBTORCH
    with("libtorch", make_libtorch);
#endif
#ifdef TACTNET_BENCHMARK_ONNXRUNTIME
    with("onnxruntime", make_onnxruntime);
#endif
#ifdef TACTNET_BENCHMARK_NCNN
    with("ncnn", make_ncnn);
#endif
}

} // namespace benchmark

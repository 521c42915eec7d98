// One frame through a recurrent layer with the state of the frame before, as in a control loop, and a whole
// recording of 50 frames: deploy_stream, compared with the primitives of oneDNN where CMake found it (weights
// in the layout that oneDNN prefers, one primitive for one frame and one for 50) and with the same layer
// written plainly in Eigen; and the layer in 8 bits. Times are microseconds per frame.
//
//     OMP_NUM_THREADS=1 benchmark_streams
//
// Pin it to one core that is idle. Exit status 1 if outputs differ.

#include "../support/measure.hpp"

#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/quantisation/stream_calibration.hpp>
#include <tactnet/runtime/random.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <type_traits>
#include <vector>

#ifdef TACTNET_BENCHMARK_ONEDNN
#include <dnnl.hpp>
#include <unordered_map>
#endif

namespace {

using namespace tactnet;

constexpr std::size_t frames = 50;

/// A recurrent layer by PyTorch's arrays: [gate][hidden][input], then the same for the state, and two biases.
struct layer_values {
    std::size_t gates, features, hidden;
    std::span<const float> values;

    [[nodiscard]] bool is_lstm() const { return gates == 4; }
    [[nodiscard]] std::size_t rows() const { return gates * hidden; }
    [[nodiscard]] const float* input_weights() const { return values.data(); }
    [[nodiscard]] const float* hidden_weights() const { return input_weights() + rows() * features; }
    [[nodiscard]] const float* input_biases() const { return hidden_weights() + rows() * hidden; }
    [[nodiscard]] const float* hidden_biases() const { return input_biases() + rows(); }
};

/// The layer in Eigen, as one writes it first; memory is allocated before the first step.
class eigen_layer {
    using matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    using column = Eigen::VectorXf;
    static Eigen::Index index(std::size_t n) { return static_cast<Eigen::Index>(n); }
    static column of(const float* from, std::size_t n) { return Eigen::Map<const column>(from, index(n)); }
    static matrix of(const float* from, std::size_t rows, std::size_t columns) {
        return Eigen::Map<const matrix>(from, index(rows), index(columns));
    }

public:
    explicit eigen_layer(const layer_values& l)
        : lstm_(l.is_lstm()),
          size_(index(l.hidden)),
          input_(of(l.input_weights(), l.rows(), l.features)),
          state_(of(l.hidden_weights(), l.rows(), l.hidden)),
          input_bias_(of(l.input_biases(), l.rows())),
          state_bias_(of(l.hidden_biases(), l.rows())),
          x_(index(l.rows())),
          s_(index(l.rows())) {
        reset();
    }
    void reset() { h_ = c_ = column::Zero(size_); }
    void step(const float* frame, float* to) {
        x_.noalias() = input_ * Eigen::Map<const column>(frame, input_.cols());
        s_.noalias() = state_ * h_;
        x_ += input_bias_;
        s_ += state_bias_;
        const auto gate = [&](auto& sums, Eigen::Index g) { return sums.segment(g * size_, size_).array(); };
        if (lstm_) {
            x_ += s_;
            c_.array() = gate(x_, 1).logistic() * c_.array() + gate(x_, 0).logistic() * gate(x_, 2).tanh();
            h_.array() = gate(x_, 3).logistic() * c_.array().tanh();
        } else {
            gate(s_, 0) = (gate(x_, 0) + gate(s_, 0)).logistic();
            gate(s_, 1) = (gate(x_, 1) + gate(s_, 1)).logistic();
            gate(x_, 2) = (gate(x_, 2) + gate(s_, 0) * gate(s_, 2)).tanh();
            h_.array() = gate(x_, 2) + gate(s_, 1) * (h_.array() - gate(x_, 2));
        }
        Eigen::Map<column>(to, size_) = h_;
    }

private:
    bool lstm_;
    Eigen::Index size_;
    matrix input_, state_;
    column input_bias_, state_bias_, x_, s_, h_, c_;
};

#ifdef TACTNET_BENCHMARK_ONEDNN

/// oneDNN's LSTM, or its GRU with the reset gate after the product (lbr_gru), which is PyTorch's.
class onednn_layer {
    using tag = dnnl::memory::format_tag;
    using dims = dnnl::memory::dims;
    static dnnl::memory::dim number(std::size_t n) { return static_cast<dnnl::memory::dim>(n); }
    static dnnl::memory::desc floats(const dims& extents, tag order) {
        return {extents, dnnl::memory::data_type::f32, order};
    }

public:
    onednn_layer(const layer_values& l, std::size_t at_once) : hidden_(l.hidden) {
        const auto gates = number(l.gates), size = number(l.hidden), count = number(at_once);
        const bool lstm = l.is_lstm();
        const auto frames_in = floats({count, 1, number(l.features)}, tag::tnc),
                   frames_out = floats({count, 1, size}, tag::tnc),
                   state = floats({1, 1, 1, size}, tag::ldnc);
        const dims input_dims{1, 1, number(l.features), gates, size}, state_dims{1, 1, size, gates, size};
        const auto any_input = floats(input_dims, tag::any), any_state = floats(state_dims, tag::any);
        const auto biases = floats({1, 1, 4, size}, tag::ldgo);
        constexpr auto inference = dnnl::prop_kind::forward_inference;
        constexpr auto ahead = dnnl::rnn_direction::unidirectional_left2right;
        dnnl::memory::desc input_chosen, state_chosen;
        if (lstm) {
            const dnnl::lstm_forward::primitive_desc chosen({inference, ahead, frames_in, state, state,
                                                             any_input, any_state, biases, frames_out, state,
                                                             state},
                                                            engine_);
            primitive_ = dnnl::lstm_forward(chosen);
            input_chosen = chosen.weights_layer_desc(), state_chosen = chosen.weights_iter_desc();
        } else {
            const dnnl::lbr_gru_forward::primitive_desc chosen(
                {inference, ahead, frames_in, state, any_input, any_state, biases, frames_out, state},
                engine_);
            primitive_ = dnnl::lbr_gru_forward(chosen);
            input_chosen = chosen.weights_layer_desc(), state_chosen = chosen.weights_iter_desc();
        }
        // oneDNN's gates: i, f, c, o as PyTorch's; of a GRU z, r, n in place of r, z, n.
        const auto place = [&](std::size_t gate) { return lstm || gate == 2 ? gate : 1 - gate; };
        const auto weights = [&](const float* from, std::size_t inputs, const dims& extents,
                                 const dnnl::memory::desc& wanted) {
            dnnl::memory plain(floats(extents, tag::ldigo), engine_), packed(wanted, engine_);
            auto* const to = static_cast<float*>(plain.get_data_handle());
            for (std::size_t i = 0; i < inputs; ++i)
                for (std::size_t g = 0; g < l.gates; ++g)
                    for (std::size_t h = 0; h < l.hidden; ++h)
                        to[(i * l.gates + g) * l.hidden + h] = from[(place(g) * l.hidden + h) * inputs + i];
            dnnl::reorder(plain, packed).execute(stream_, plain, packed);
            stream_.wait();
            return packed;
        };
        dnnl::memory bias(biases, engine_);
        auto* const to = static_cast<float*>(bias.get_data_handle());
        for (std::size_t g = 0; g < l.gates; ++g)
            for (std::size_t h = 0; h < l.hidden; ++h) {
                const std::size_t from = place(g) * l.hidden + h;
                const bool alone = !lstm && g == 2; // the two biases of n stay apart
                to[g * l.hidden + h] = l.input_biases()[from] + (alone ? 0 : l.hidden_biases()[from]);
                if (alone)
                    to[3 * l.hidden + h] = l.hidden_biases()[from];
            }
        in_ = dnnl::memory(frames_in, engine_), out_ = dnnl::memory(frames_out, engine_);
        for (dnnl::memory& each : states_)
            each = dnnl::memory(state, engine_);
        const dnnl::memory of_input = weights(l.input_weights(), l.features, input_dims, input_chosen),
                           of_state = weights(l.hidden_weights(), l.hidden, state_dims, state_chosen);
        // The states of one step are those before the next, which reads the other pair.
        for (std::size_t turn = 0; turn < 2; ++turn) {
            arguments_[turn] = {{DNNL_ARG_SRC_LAYER, in_},
                                {DNNL_ARG_SRC_ITER, states_[turn]},
                                {DNNL_ARG_WEIGHTS_LAYER, of_input},
                                {DNNL_ARG_WEIGHTS_ITER, of_state},
                                {DNNL_ARG_BIAS, bias},
                                {DNNL_ARG_DST_LAYER, out_},
                                {DNNL_ARG_DST_ITER, states_[1 - turn]}};
            if (lstm) {
                arguments_[turn].insert({DNNL_ARG_SRC_ITER_C, states_[2 + turn]});
                arguments_[turn].insert({DNNL_ARG_DST_ITER_C, states_[3 - turn]});
            }
        }
        reset();
    }
    void reset() {
        for (dnnl::memory& each : states_)
            std::fill_n(static_cast<float*>(each.get_data_handle()), hidden_, 0.0F);
    }
    void step(std::span<const float> features, std::span<float> to) {
        std::copy(features.begin(), features.end(), static_cast<float*>(in_.get_data_handle()));
        primitive_.execute(stream_, arguments_[turn_]);
        stream_.wait();
        turn_ = 1 - turn_;
        std::copy_n(static_cast<const float*>(out_.get_data_handle()), to.size(), to.data());
    }

private:
    std::size_t hidden_, turn_ = 0;
    dnnl::engine engine_{dnnl::engine::kind::cpu, 0};
    dnnl::stream stream_{engine_};
    dnnl::primitive primitive_;
    dnnl::memory in_, out_;
    std::array<dnnl::memory, 4> states_; // h before and after, c before and after
    std::array<std::unordered_map<int, dnnl::memory>, 2> arguments_;
};

#endif

/// Microseconds per frame, of body() for a recording.
template <class Body>
double microseconds(Body&& body) {
    constexpr std::size_t repeats = 20;
    return 1e6 / repeats / frames * benchmark::time_rounds(100, [&] {
                                        for (std::size_t r = 0; r < repeats; ++r)
                                            body();
                                    }).fastest;
}

/// The largest difference between two recordings' outputs.
double difference(std::span<const float> a, std::span<const float> b) {
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        most = std::max(most, std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])));
    return most;
}

/// Returns whether outputs agree.
template <std::size_t Features, class Layer>
bool compare() {
    using net = network<shape{frames, 1, Features}, Layer>;
    constexpr std::size_t hidden = Layer::hidden;
    net trained;
    random_stream random(1, random_purposes::order);
    for (float& value : trained.learnable_values().first(net::parameters))
        value = static_cast<float>(random.uniform(-1, 1) / std::sqrt(static_cast<double>(hidden)));
    const layer_values values{Layer::cell::gates, Features, hidden, trained.learnable_values()};
    std::vector<float> recording(frames * Features), ours(frames * hidden), theirs(frames * hidden);
    for (float& value : recording)
        value = static_cast<float>(random.uniform(-2, 2));

    const auto stream = deploy_stream(trained);
    const double own = microseconds([&] {
        typename decltype(stream)::state memory;
        (void)stream.run(recording, memory, ours);
    });
    eigen_layer plain(values);
    const double eigen = microseconds([&] {
        plain.reset();
        for (std::size_t f = 0; f < frames; ++f)
            plain.step(recording.data() + f * Features, theirs.data() + f * hidden);
    });
    // Both sides round each of 50 steps; no output is above 1.
    bool agree = difference(ours, theirs) < 1e-4;
    std::vector<float> samples(recording.size()), in_bytes(ours.size()); // feature by feature
    for (std::size_t i = 0; i < samples.size(); ++i)
        samples[i] = recording[i % frames * Features + i / frames];
    const auto byte_stream = deploy_stream<eight_bit>(trained, samples);
    const double eight = microseconds([&] {
        typename decltype(byte_stream)::state memory;
        (void)byte_stream.run(recording, memory, in_bytes);
    });
    agree = agree && difference(ours, in_bytes) < 0.1; // far more than weights and states of 8 bits lose
    std::printf("%-4s %8zu %8zu %12.3f %8.3f %6.2f %8.3f %6.2f", Layer::cell::name, Features, hidden, own,
                eight, eight / own, eigen, eigen / own);
#ifdef TACTNET_BENCHMARK_ONEDNN
    for (const std::size_t at_once : {std::size_t{1}, frames}) {
        onednn_layer peer(values, at_once);
        const double time = microseconds([&] {
            peer.reset();
            for (std::size_t f = 0; f < frames; f += at_once)
                peer.step(std::span(recording).subspan(f * Features, at_once * Features),
                          std::span(theirs).subspan(f * hidden, at_once * hidden));
        });
        agree = agree && difference(ours, theirs) < 1e-4;
        std::printf(" %14.3f %6.2f", time, time / own);
    }
#endif
    std::printf("%s\n", agree ? "" : "  outputs differ");
    return agree;
}

/// Three causal convolutions with ReLU, each frame of a recording by itself. Returns whether outputs agree.
template <std::size_t Filters>
bool compare_causal() {
    using net = network<shape{frames, 1, 6}, causal_conv1d<Filters, 3>, relu, causal_conv1d<Filters, 3, 2>,
                        relu, causal_conv1d<Filters, 3, 4>, relu>;
    net trained;
    random_stream random(2, random_purposes::order);
    trained.for_each_parameter([&](const parameter& p, std::span<float> values) {
        for (float& value : values)
            value = static_cast<float>(random.uniform(-2, 2) / std::sqrt(static_cast<double>(p.fan_in)));
    });
    std::vector<float> samples(frames * 6), recording(samples.size()), ours(frames * Filters),
        in_bytes(ours.size());
    for (std::size_t i = 0; i < samples.size(); ++i)
        recording[i % frames * 6 + i / frames] = samples[i] = static_cast<float>(random.uniform(-2, 2));
    const auto stream = deploy_stream(trained);
    const auto byte_stream = deploy_stream<eight_bit>(trained, samples);
    const auto time = [&](const auto& some, std::vector<float>& to) {
        return microseconds([&] {
            typename std::remove_cvref_t<decltype(some)>::state memory;
            (void)some.run(recording, memory, to);
        });
    };
    const double own = time(stream, ours), eight = time(byte_stream, in_bytes);
    const bool agree = difference(ours, in_bytes) < 0.1;
    std::printf("%-4s %8d %8zu %12.3f %8.3f %6.2f%s\n", "conv", 6, Filters, own, eight, eight / own,
                agree ? "" : "  outputs differ");
    return agree;
}

} // namespace

int main() {
    std::printf("%-4s %8s %8s %12s %8s %6s %8s %6s", "", "features", "hidden", "tactnet, µs", "8 bits",
                "ratio", "Eigen", "ratio");
#ifdef TACTNET_BENCHMARK_ONEDNN
    std::printf(" %14s %6s %14s %6s", "oneDNN, 1", "ratio", "oneDNN, 50", "ratio");
#endif
    std::printf("\n");
    bool agree = true;
    agree &= compare<6, gru<8>>() & compare<6, gru<16>>() & compare<6, gru<32>>() & compare<6, gru<64>>();
    agree &= compare<32, gru<32>>() & compare<64, gru<128>>();
    agree &= compare<6, lstm<8>>() & compare<6, lstm<16>>() & compare<6, lstm<32>>() & compare<6, lstm<64>>();
    agree &= compare<32, lstm<32>>() & compare<64, lstm<128>>();
    agree &= compare_causal<16>() & compare_causal<64>();
    return agree ? EXIT_SUCCESS : EXIT_FAILURE;
}

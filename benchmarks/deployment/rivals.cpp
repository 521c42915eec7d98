// tactnet and libraries of the same kind on the same numbers: networks for images in ncnn and in TinyMind,
// recurrent layers in RTNeural. Each is timed if CMake has found it, and not before both outputs are right.
//
//     taskset -c 1 benchmark_rivals > rivals.csv
//
// Both take turns, on one thread. A line has the medians of 101 rounds in microseconds per frame, and the
// median and the quartiles of the rounds' ratios, rival ÷ tactnet. Exit status 1 if outputs differ.

#include "../../examples/support/processor.hpp"
#include "../support/measure.hpp"
#include "cold.hpp"

#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/networks/tactnet6.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/runtime/random.hpp>

#ifdef TACTNET_BENCHMARK_TINYMIND
#include "../peers/tinymind.hpp"
#endif

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace {

using namespace benchmark;
using tactnet::shape;

bool all_agree = true;

/// Prints a line of two that fill a span with outputs for `frames` frames.
template <class Own, class Rival>
void compare(const char* library, const std::string& what, const std::vector<double>& expected,
             double tolerance, const Own& own, const Rival& rival, double frames = 1) {
    std::vector<float> ours(expected.size()), theirs(expected.size());
    own(std::span(ours));
    rival(std::span(theirs));
    const double error = std::max(error_of(ours, expected), error_of(theirs, expected));
    if (!(error < tolerance)) {
        std::fprintf(stderr, "%s, %s: expected errors below %g, found %g\n", library, what.c_str(), tolerance,
                     error);
        all_agree = false;
        return;
    }
    const race_result r = race([&] { own(std::span(ours)); }, [&] { rival(std::span(theirs)); });
    std::printf("%s,%s,%.4g,%.4g,%.4g,%.4g,%.4g,%s\n", library, what.c_str(), 1e6 * r.own / frames,
                1e6 * r.peer / frames, r.ratio, r.lower, r.upper, processor_name().c_str());
    std::fflush(stdout);
}

#ifdef TACTNET_BENCHMARK_NCNN
template <class Network>
void compare_ncnn(const char* what) {
    const auto given = std::make_shared<const task<Network, float>>(1, -20, 100);
    const auto theirs = make_ncnn(described_network::of(given->network), 1);
    compare("ncnn", what, given->expected, float_tolerance,
            inference_of(given, tactnet::deploy(given->network)),
            [&](std::span<float> logits) { theirs->run(given->frames, logits); });
}
#endif

#ifdef TACTNET_BENCHMARK_TINYMIND
template <class Network, std::size_t Kernel>
void compare_tinymind(const std::string& what) {
    constexpr shape in = Network::input_shape;
    const auto given = std::make_shared<const task<Network, float>>(1, -20, 100);
    const auto network = described_network::of(given->network);
    const auto theirs = std::make_unique<tinymind_tactnet4<float, in.rows, in.columns, Kernel>>(
        network, std::vector<float>(network.maps().size(), 1));
    compare("TinyMind", what, given->expected, float_tolerance,
            inference_of(given, tactnet::deploy(given->network)),
            [&](std::span<float> logits) { theirs->run(given->frames.data(), logits); });

    const auto counts = std::make_shared<const task<Network, std::uint8_t>>(1, -200, 255);
    const std::vector<std::uint8_t>& frame = counts->frames;
    double largest = 0;
    for (const double logit : counts->expected)
        largest = std::max(largest, std::abs(logit));
    const auto in_bytes = std::make_unique<tinymind_tactnet4<std::int8_t, in.rows, in.columns, Kernel>>(
        network, scales_of(network, ranges(network, frame), static_cast<float>(largest)));
    std::vector<std::int8_t> less_128;
    for (const std::uint8_t count : frame)
        less_128.push_back(static_cast<std::int8_t>(count - 128));
    const std::vector<float> mean(in.size());
    compare("TinyMind", what + " in 8 bits", counts->expected, byte_tolerance,
            inference_of(counts, tactnet::deploy<tactnet::eight_bit>(
                                     counts->network, std::span(mean).template first<in.size()>(), 1.0f,
                                     std::span(frame))),
            [&](std::span<float> logits) { in_bytes->run(less_128.data(), logits); });
}
#endif

#ifdef TACTNET_BENCHMARK_RTNEURAL
template <std::size_t Features, class Layer>
void compare_rtneural() {
    constexpr std::size_t frames = 50, hidden = Layer::hidden;
    tactnet::network<shape{frames, 1, Features}, Layer> trained;
    tactnet::random_stream random(1, tactnet::random_purposes::order);
    const auto values = trained.learnable_values().first(trained.parameters);
    for (float& value : values)
        value = static_cast<float>(random.uniform(-1, 1) / std::sqrt(static_cast<double>(hidden)));
    std::vector<float> recording(frames * Features), outputs(frames * hidden);
    for (float& value : recording)
        value = static_cast<float>(random.uniform(-2, 2));
    const auto stream = tactnet::deploy_stream(trained);
    const auto own = [&](std::span<float> to) {
        typename decltype(stream)::state memory;
        (void)stream.run(recording, memory, to);
    };
    own(outputs);
    const std::vector<double> expected(outputs.begin(), outputs.end());
    constexpr bool lstm = Layer::cell::gates == 4;
    const std::string what = (lstm ? "LSTM " : "GRU ") + std::to_string(Features) + " features " +
                             std::to_string(hidden) + " units";
    const auto with = [&](const char* library, auto* make) {
        const auto theirs = make({lstm, Features, hidden, values});
        compare(
            library, what, expected, float_tolerance, own,
            [&](std::span<float> to) { theirs->run(recording, to); }, frames);
    };
    with("RTNeural with Eigen", make_rtneural_eigen);
    with("RTNeural with xsimd", make_rtneural_xsimd);
    with("RTNeural with the STL", make_rtneural_stl);
}
#endif

} // namespace

int main() {
    std::printf("library,what,tactnet_us,library_us,ratio,lower,upper,processor\n");
#ifdef TACTNET_BENCHMARK_NCNN
    compare_ncnn<tactnet::tactnet4<shape{28, 50}, 22>>("TactNet-4 28 × 50");
    compare_ncnn<tactnet::tactnet6<shape{28, 50}, 22>>("TactNet-6 28 × 50");
    compare_ncnn<tactnet::tactnet6<shape{10, 18}, 22>>("TactNet-6 10 × 18");
#endif
#ifdef TACTNET_BENCHMARK_TINYMIND
    compare_tinymind<tactnet::tactnet4_3x3<shape{8, 16}, 22>, 3>("TactNet-4 of 3 × 3 kernels 8 × 16");
    compare_tinymind<tactnet::tactnet4<shape{24, 48}, 22>, 5>("TactNet-4 24 × 48");
#endif
#ifdef TACTNET_BENCHMARK_RTNEURAL
    compare_rtneural<6, tactnet::gru<16>>(), compare_rtneural<32, tactnet::gru<32>>();
    compare_rtneural<64, tactnet::gru<128>>(), compare_rtneural<6, tactnet::lstm<16>>();
    compare_rtneural<32, tactnet::lstm<32>>(), compare_rtneural<64, tactnet::lstm<128>>();
#endif
    return all_agree ? EXIT_SUCCESS : EXIT_FAILURE;
}

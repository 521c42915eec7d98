// Layers of small networks, one frame at a time: the deployed step compared with oneDNN's primitives.
//
//     OMP_NUM_THREADS=1 benchmark_layers [PART OF A NAME]
//
// Pin it to one core that is idle. Both take turns; each line has medians of 101 rounds in microseconds, and
// the median and the quartiles of the rounds' ratios, oneDNN ÷ tactnet. Maps lie in the layout that each side
// prefers: of oneDNN's two, pixel by pixel and in blocks of channels, the faster counts, and convolutions
// choose their own. Exit status 1 if outputs differ.

#include "../peers/onednn_chain.hpp"
#include "../support/measure.hpp"

#include <tactnet/deployment.hpp>
#include <tactnet/deployment/eight_bit/steps.hpp>
#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace benchmark {

/// Not in the unnamed namespace: GCC would see that only one place calls it, and optimise it for size.
template <class Step>
[[gnu::noinline]] void
run_step(const typename Step::format::packed_number* packed, const typename Step::format::activation* in,
         typename Step::format::activation* out, typename Step::format::activation* workspace) {
    Step::run(packed, in, out, workspace);
}

} // namespace benchmark

namespace {

using namespace tactnet;
using kernels::frame_convolution;
using floats = benchmark::onednn_chain<float>;
using whole = benchmark::onednn_chain<std::uint8_t>;
using how = dnnl::algorithm;

/// Times both in turns, and prints a line.
void race(const char* format, const char* name, const shape& size, auto&& own, auto&& peer) {
    const benchmark::race_result r = benchmark::race(own, peer);
    std::printf("| %s | %s | %zu × %zu × %zu | %.2f | %.2f | %.2f | %.2f … %.2f |\n", name, format, size.rows,
                size.columns, size.channels, 1e6 * r.own, 1e6 * r.peer, r.ratio, r.lower, r.upper);
    std::fflush(stdout);
}

bool all_agree = true;
std::string_view wanted; ///< part of the names of the layers to time

bool unwanted(std::string_view name) {
    return name.find(wanted) == std::string_view::npos;
}

void report(bool agree, const char* name, double error) {
    if (!agree)
        std::printf("%s: outputs differ by up to %g\n", name, error);
    all_agree = all_agree && agree;
}

/// A list of layers in single precision. `build(chain, network)` appends oneDNN's primitives.
template <shape Input, class... Layers>
void compare(const char* name, auto&& build) {
    if (unwanted(name))
        return;
    using net = network<Input, Layers...>;
    using lowered = lowered_network<net>;
    using step = typename lowered::step;
    net trained;
    random_stream random(1, random_purposes::order);
    trained.for_each_parameter([&](const parameter& p, auto values) {
        for (float& value : values)
            value = static_cast<float>(random.uniform(-1, 1) / std::sqrt(static_cast<double>(p.fan_in)));
    });
    std::vector<float> folded(step::folded_elements + 1), input(Input.size());
    for (float& value : input)
        value = static_cast<float>(random.uniform(-4, 4));
    lowered::fold({trained.learnable_values().data(), trained.running_statistics().data(), trained.epsilon},
                  folded.data());
    aligned_vector<float> packed(step::packed_elements + 1), in(input.begin(), input.end()),
        workspace(step::workspace_elements + 1), out(step::output.area() * step::output_stride);
    step::pack(folded.data(), packed.data());
    const auto own = [&] {
        benchmark::run_step<step>(packed.data(), in.data(), out.data(), workspace.data());
    };
    own();

    std::optional<floats> fastest;
    double least = 0;
    for (const auto layout : {floats::tag::nhwc, floats::tag::nChw8c}) {
        std::optional<floats> peer;
        try {
            peer.emplace(Input, layout);
            build(*peer, trained);
        } catch (const dnnl::error&) {
            continue; // not in this layout
        }
        peer->set_input(input);
        peer->run();
        const std::vector<float> expected = peer->output();
        double error = 0, largest = 0;
        for (std::size_t i = 0; i < expected.size(); ++i) {
            const std::size_t channels = step::output.channels;
            const float found = out[i / channels * step::output_stride + i % channels];
            error = std::max(error, std::abs(static_cast<double>(expected[i]) - static_cast<double>(found)));
            largest = std::max(largest, std::abs(static_cast<double>(expected[i])));
        }
        report(error <= 1e-5 * largest && expected.size() == step::output.size(), name, error / largest);
        std::vector<double> times;
        const std::size_t repeats = benchmark::repeats_of([&] { peer->run(); });
        for (int round = 0; round < 21; ++round)
            times.push_back(benchmark::seconds_of([&] { peer->run(); }, repeats));
        if (const double time = benchmark::quantile(times, 0.5); !fastest || time < least)
            least = time, fastest.emplace(std::move(*peer));
    }
    race("float", name, Input, own, [&] { fastest->run(); });
}

// oneDNN's side of single layers.
auto eltwise(const floats::function& function) {
    return [=](floats& chain, const auto&) { chain.eltwise(function); };
}
template <shape Input, extent2d Window, extent2d Stride, padding Padding = padding::same>
auto pool(dnnl::algorithm kind) {
    return [=](floats& chain, const auto&) {
        chain.pool(sliding_window::over(Input, Window, Stride, Padding), kind);
    };
}
template <class Layer>
void convolve(floats& chain, const sliding_window& window, extent2d dilation, std::size_t groups,
              const floats::function& after, std::span<const float>& values) {
    chain.convolution({window, Layer::output.channels, groups, dilation, after, 1},
                      values.first(Layer::parameters - Layer::output.channels),
                      values.subspan(Layer::parameters - Layer::output.channels, Layer::output.channels));
    values = values.subspan(Layer::parameters);
}

template <shape Input, std::size_t Filters, extent2d Kernel, extent2d Dilation>
void compare_dilated(const char* name) {
    using spec = dilated_conv2d<Filters, Kernel, Dilation>;
    compare<Input, spec, relu>(name, [](floats& chain, const auto& net) {
        using layer = typename spec::template layer<float, Input>;
        std::span<const float> values = net.learnable_values();
        convolve<layer>(chain, layer::window, Dilation, 1, {how::eltwise_relu}, values);
    });
}
template <shape Input, std::size_t Filters, extent2d Kernel, extent2d Stride, padding Crop>
void compare_transposed(const char* name) {
    using spec = transposed_conv2d<Filters, Kernel, Stride, Crop>;
    compare<Input, spec>(name, [](floats& chain, const auto& net) {
        using layer = typename spec::template layer<float, Input>;
        const std::span<const float> values = net.learnable_values();
        chain.deconvolution(layer::output, Kernel, Stride, Crop, values.first(layer::weights),
                            values.subspan(layer::weights, Filters));
    });
}
/// A convolution of the same size with an activation function: one step, compared with oneDNN's post-op.
template <shape Input, extent2d Kernel, class Activation>
void compare_fused(const char* name, const floats::function& after) {
    using spec = conv2d<Input.channels, Kernel>;
    compare<Input, spec, Activation>(name, [&](floats& chain, const auto& net) {
        using layer = typename spec::template layer<float, Input>;
        std::span<const float> values = net.learnable_values();
        convolve<layer>(chain, layer::window, 1, 1, after, values);
    });
}
/// A depthwise convolution of 3 × 3 and a pointwise one, each with ReLU.
template <shape Input, std::size_t Filters, extent2d Stride = 1>
void compare_pair(const char* name) {
    using depthwise = conv2d<Input.channels, 3, Stride, padding::same, in_groups(Input.channels)>;
    using pointwise = conv2d<Filters, 1>;
    compare<Input, depthwise, relu, pointwise, relu>(name, [](floats& chain, const auto& net) {
        using first = typename depthwise::template layer<float, Input>;
        using second = typename pointwise::template layer<float, first::output>;
        std::span<const float> values = net.learnable_values();
        convolve<first>(chain, first::window, 1, Input.channels, {how::eltwise_relu}, values);
        convolve<second>(chain, second::window, 1, 1, {how::eltwise_relu}, values);
    });
}

/// Convolutions in 8 bits, each with ReLU: bytes in, bytes out, which are equal to the last.
template <frame_convolution... Kernels>
void compare_bytes(const char* name) {
    if (unwanted(name))
        return;
    using steps = step_chain<convolution_step<eight_bit, Kernels>...>;
    constexpr shape input = std::array{Kernels...}[0].window.input;
    random_stream random(1, random_purposes::order);
    const auto draw = [&](double lowest, double highest) {
        return std::floor(random.uniform(lowest, highest));
    };
    std::vector<float> folded;
    whole peer(input, whole::tag::nhwc);
    const auto append = [&]<frame_convolution c>(std::type_identity<convolution_step<eight_bit, c>>) {
        using step = convolution_step<eight_bit, c>;
        // Sums of two products of bytes fit into 16 bits, so that oneDNN's saturate nowhere. Sums are as
        // large as their standard deviation, of which 32 fit into a byte.
        std::vector<std::int8_t> weights(step::weights);
        std::vector<std::int32_t> biases(c.filters);
        for (auto& w : weights)
            w = static_cast<std::int8_t>(draw(-64, 65));
        for (auto& b : biases)
            b = static_cast<std::int32_t>(draw(-999, 2000));
        const auto scale = static_cast<float>(
            std::exp2(std::round(std::log2(37 * 60 * std::sqrt(static_cast<double>(c.taps())) / 40))));
        folded.insert(folded.end(), weights.begin(), weights.end());
        folded.insert(folded.end(), biases.begin(), biases.end());
        folded.insert(folded.end(), c.filters, 1.0f);
        folded.insert(folded.end(), {1, 0, scale, 0});
        peer.convolution({c.window, c.filters, c.groups, 1, {how::eltwise_relu}, 1 / scale}, weights, biases);
    };
    (append(std::type_identity<convolution_step<eight_bit, Kernels>>{}), ...);
    aligned_vector<std::int8_t> packed(steps::packed_elements);
    aligned_vector<std::uint8_t> in(input.area() * std::array{Kernels...}[0].input_stride),
        workspace(steps::workspace_elements + 1), out(steps::output.area() * steps::output_stride);
    steps::pack(folded.data(), packed.data());
    std::vector<std::uint8_t> bytes(input.size());
    for (std::size_t i = 0; i < bytes.size(); ++i)
        in[i / input.channels * std::array{Kernels...}[0].input_stride + i % input.channels] = bytes[i] =
            static_cast<std::uint8_t>(draw(0, 256));
    const auto own = [&] {
        benchmark::run_step<steps>(packed.data(), in.data(), out.data(), workspace.data());
    };
    own();
    peer.set_input(bytes);
    peer.run();
    const std::vector<std::uint8_t> expected = peer.output();
    std::size_t different = expected.size() != steps::output.size(), zeros = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const std::size_t channels = steps::output.channels;
        different += expected[i] != out[i / channels * steps::output_stride + i % channels];
        zeros += expected[i] == 0;
    }
    report(different == 0 && zeros < expected.size(), name, static_cast<double>(different));
    race("8 bits", name, input, own, [&] { peer.run(); });
}
/// A convolution of the map that another one writes.
constexpr frame_convolution after(const frame_convolution& before, std::size_t stride, std::size_t filters,
                                  extent2d kernel, extent2d by, std::size_t groups) {
    return {.window = sliding_window::over({before.output_rows(), before.output_columns(), before.filters},
                                           kernel, by, padding::same),
            .filters = filters,
            .input_stride = stride,
            .activation = fused<relu_function>,
            .groups = groups};
}
template <frame_convolution Before>
inline constexpr std::size_t written_stride = convolution_step<eight_bit, Before>::output_stride;
template <frame_convolution Before, extent2d Stride = 1>
inline constexpr frame_convolution depthwise_after =
    after(Before, written_stride<Before>, Before.filters, 3, Stride, Before.filters);
template <frame_convolution Before, std::size_t Filters>
inline constexpr frame_convolution pointwise_after = after(Before, written_stride<Before>, Filters, 1, 1, 1);
template <shape Input, std::size_t Filters, extent2d Kernel, extent2d Stride, std::size_t Groups>
inline constexpr frame_convolution first_of{.window =
                                                sliding_window::over(Input, Kernel, Stride, padding::same),
                                            .filters = Filters,
                                            .input_stride = Input.channels,
                                            .activation = fused<relu_function>,
                                            .groups = Groups};
template <shape Input, std::size_t Filters, extent2d Stride = 1>
void compare_pair_of_bytes(const char* name) {
    constexpr frame_convolution depthwise = first_of<Input, Input.channels, 3, Stride, Input.channels>;
    compare_bytes<depthwise, pointwise_after<depthwise, Filters>>(name);
}

constexpr shape large{28, 50, 16}, small{14, 25, 32};

void compare_pools_and_sizes() {
    compare<large, max_pool<2>>("max pool 2 × 2", pool<large, 2, 2>(how::pooling_max));
    compare<large, max_pool<3, 2>>("max pool 3 × 3 by 2", pool<large, 3, 2>(how::pooling_max));
    compare<large, average_pool<2>>("average pool 2 × 2",
                                    pool<large, 2, 2>(how::pooling_avg_exclude_padding));
    compare<large, average_pool<3, 1>>("average pool 3 × 3 by 1",
                                       pool<large, 3, 1>(how::pooling_avg_exclude_padding));
    constexpr extent2d whole_map(small.rows, small.columns);
    compare<small, global_max_pool>("global max pool",
                                    pool<small, whole_map, 1, padding::valid>(how::pooling_max));
    compare<small, global_average_pool>(
        "global average pool", pool<small, whole_map, 1, padding::valid>(how::pooling_avg_exclude_padding));
    const auto resampling = [](dnnl::algorithm kind) {
        return [=](floats& chain, const auto&) {
            chain.resample({2 * small.rows, 2 * small.columns, small.channels}, kind);
        };
    };
    compare<small, upsample<2>>("upsample × 2, nearest", resampling(how::resampling_nearest));
    compare<small, upsample<2, interpolation::bilinear>>("upsample × 2, bilinear",
                                                         resampling(how::resampling_linear));
    compare_transposed<small, 16, 2, 2, padding::valid>("transposed convolution 2 × 2 by 2, 16 filters");
    compare_transposed<small, 16, 4, 2, pad(1)>("transposed convolution 4 × 4 by 2, 16 filters");
    compare_transposed<small, 16, 3, 2, pad(1, 0, 1, 0)>("transposed convolution 3 × 3 by 2, 16 filters");
}
void compare_activations() {
    compare<large, relu>("ReLU", eltwise({how::eltwise_relu}));
    compare<large, leaky_relu<>>("leaky ReLU", eltwise({how::eltwise_relu, 0.01f}));
    compare<large, relu6>("ReLU6", eltwise({how::eltwise_clip, 0, 6}));
    compare<large, hard_swish>("hard swish", eltwise({how::eltwise_hardswish}));
    compare<large, sigmoid>("sigmoid", eltwise({how::eltwise_logistic}));
    compare<large, silu>("SiLU", eltwise({how::eltwise_swish, 1}));
    compare<large, hyperbolic_tangent>("tanh", eltwise({how::eltwise_tanh}));
    compare<large, elu<>>("ELU", eltwise({how::eltwise_elu, 1}));
    compare<large, softplus>("softplus", eltwise({how::eltwise_soft_relu}));
    compare<large, gelu>("GELU", eltwise({how::eltwise_gelu_erf}));
    compare<large, parametric_relu>("parametric ReLU", [](floats& chain, const auto& net) {
        chain.prelu(std::span<const float>(net.learnable_values()).first(large.channels));
    });
}
void compare_fused_activations() {
    compare_fused<large, 3, relu>("convolution 3 × 3, ReLU", {how::eltwise_relu});
    compare_fused<large, 3, leaky_relu<>>("convolution 3 × 3, leaky ReLU", {how::eltwise_relu, 0.01f});
    compare_fused<large, 3, hard_swish>("convolution 3 × 3, hard swish", {how::eltwise_hardswish});
    compare_fused<large, 3, sigmoid>("convolution 3 × 3, sigmoid", {how::eltwise_logistic});
    compare_fused<large, 3, silu>("convolution 3 × 3, SiLU", {how::eltwise_swish, 1});
    compare_fused<large, 3, elu<>>("convolution 3 × 3, ELU", {how::eltwise_elu, 1});
    compare_fused<large, 3, gelu>("convolution 3 × 3, GELU", {how::eltwise_gelu_erf});
    compare_fused<small, 1, relu>("convolution 1 × 1, ReLU", {how::eltwise_relu});
    compare_fused<small, 1, hard_swish>("convolution 1 × 1, hard swish", {how::eltwise_hardswish});
    compare_fused<small, 1, silu>("convolution 1 × 1, SiLU", {how::eltwise_swish, 1});
    compare_fused<small, 1, gelu>("convolution 1 × 1, GELU", {how::eltwise_gelu_erf});
}
void compare_norms_and_gates() {
    constexpr auto number = [](std::size_t n) { return static_cast<dnnl::memory::dim>(n); };
    compare<small, layer_norm<norm_over::channels>>(
        "layer norm over channels", [&](floats& chain, const auto& net) {
            const std::span<const float> values = net.learnable_values();
            chain.layer_norm({1, number(small.rows), number(small.columns), number(small.channels)},
                             floats::tag::abcd, values.first(small.channels),
                             values.subspan(small.channels, small.channels), static_cast<float>(net.epsilon));
        });
    compare<small, layer_norm<norm_over::frame>>(
        "layer norm over the frame", [&](floats& chain, const auto& net) {
            // Its parameters are [channel][row][column]; here the frame lies pixel by pixel.
            const std::span<const float> values = net.learnable_values();
            std::vector<float> scales(small.size()), shifts(small.size());
            for (std::size_t i = 0; i < small.size(); ++i) {
                const std::size_t at = i % small.channels * small.area() + i / small.channels;
                scales[i] = values[at], shifts[i] = values[small.size() + at];
            }
            chain.layer_norm({1, number(small.size())}, floats::tag::ab, scales, shifts,
                             static_cast<float>(net.epsilon));
        });
    compare<small, gate<global_average_pool, sigmoid>>(
        "gate: global average pool, sigmoid, product", [](floats& chain, const auto&) {
            chain.pool(sliding_window::over(small, {small.rows, small.columns}, 1, padding::valid),
                       how::pooling_avg_exclude_padding);
            chain.eltwise({how::eltwise_logistic});
            chain.multiply_input();
        });
}
void compare_convolutions() {
    compare_dilated<large, 16, 3, 2>("dilated convolution 3 × 3, dilation 2, 16 filters");
    compare_dilated<small, 32, 3, 2>("dilated convolution 3 × 3, dilation 2, 32 filters");
    compare_dilated<small, 32, 3, 4>("dilated convolution 3 × 3, dilation 4, 32 filters");
    compare_dilated<shape{28, 50, 8}, 8, 5, 2>("dilated convolution 5 × 5, dilation 2, 8 filters");
    compare_pair<large, 32>("depthwise 3 × 3, pointwise to 32");
    compare_pair<small, 64>("depthwise 3 × 3, pointwise to 64");
    compare_pair<small, 64, 2>("depthwise 3 × 3 by 2, pointwise to 64");
    compare_pair<shape{7, 13, 64}, 64>("depthwise 3 × 3, pointwise to 64");
    compare_pair_of_bytes<large, 32>("depthwise 3 × 3, pointwise to 32");
    compare_pair_of_bytes<small, 64>("depthwise 3 × 3, pointwise to 64");
    compare_pair_of_bytes<small, 64, 2>("depthwise 3 × 3 by 2, pointwise to 64");
    compare_pair_of_bytes<shape{7, 13, 64}, 64>("depthwise 3 × 3, pointwise to 64");
    // Stem and four pairs.
    constexpr frame_convolution stem = first_of<shape{28, 50, 1}, 16, 3, 2, 1>, d1 = depthwise_after<stem>,
                                p1 = pointwise_after<d1, 32>, d2 = depthwise_after<p1, 2>,
                                p2 = pointwise_after<d2, 64>, d3 = depthwise_after<p2>,
                                p3 = pointwise_after<d3, 64>, d4 = depthwise_after<p3, 2>,
                                p4 = pointwise_after<d4, 128>;
    compare_bytes<stem, d1, p1, d2, p2, d3, p3, d4, p4>("depthwise network: stem by 2, four pairs");
}

} // namespace

int main(int count, char** arguments) {
    if (count > 1)
        wanted = arguments[1];
    std::printf("| layer | numbers | input | tactnet, µs | oneDNN, µs | ratio | quartiles |\n"
                "|---|---|---|---|---|---|---|\n");
    compare_pools_and_sizes();
    compare_activations();
    compare_fused_activations();
    compare_norms_and_gates();
    compare_convolutions();
    return all_agree ? EXIT_SUCCESS : EXIT_FAILURE;
}

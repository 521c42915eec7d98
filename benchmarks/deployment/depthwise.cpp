// Depthwise convolutions of one frame in single precision and in 8 bits: the deployed step, bias and ReLU
// included, compared with oneDNN's primitive in the layout that oneDNN prefers, without reordering.
//
//     OMP_NUM_THREADS=1 benchmark_depthwise
//
// Pin it to one core that is idle. Exit status 1 if the outputs differ.

#include "../support/measure.hpp"

#include <tactnet/deployment.hpp>
#include <tactnet/deployment/eight_bit/steps.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <dnnl.hpp>
#include <span>
#include <type_traits>
#include <unordered_map>
#include <vector>

namespace {

using namespace tactnet;
using kernels::frame_convolution;

template <shape Input, extent2d Kernel, extent2d Stride>
inline constexpr frame_convolution depthwise{.window =
                                                 sliding_window::over(Input, Kernel, Stride, padding::same),
                                             .filters = Input.channels,
                                             .input_stride = pad_to_cache_line(Input.channels),
                                             .activation = tactnet::fused<tactnet::relu_function>,
                                             .groups = Input.channels};

/// oneDNN's depthwise convolution: of floats, or of bytes with signed weights, where outputs are sum ×
/// factor.
template <class Number>
class onednn_depthwise {
    static constexpr bool bytes = std::is_same_v<Number, std::uint8_t>;

public:
    using weight = std::conditional_t<bytes, std::int8_t, float>;
    using bias = std::conditional_t<bytes, std::int32_t, float>;

    onednn_depthwise(const sliding_window& w, std::span<const weight> weights, std::span<const bias> biases,
                     float factor = 1)
        : window_(w), engine_(dnnl::engine::kind::cpu, 0), stream_(engine_) {
        const auto number = [](std::size_t n) { return static_cast<dnnl::memory::dim>(n); };
        const auto behind = [&](std::size_t end, std::size_t size) {
            return number(end > size ? end - size : 0);
        };
        const dnnl::memory::dim channels = number(w.input.channels);
        dnnl::post_ops after;
        after.append_eltwise(1.0f, dnnl::algorithm::eltwise_relu, 0.0f, 0.0f);
        dnnl::primitive_attr attributes;
        attributes.set_post_ops(after);
        if (bytes)
            attributes.set_output_scales(1 << 1, std::vector<float>(w.input.channels, factor));
        const dnnl::memory::dims kernel{channels, 1, 1, number(w.kernel.rows), number(w.kernel.columns)};
        const dnnl::convolution_forward::desc description(
            dnnl::prop_kind::forward_inference, dnnl::algorithm::convolution_auto,
            {{1, channels, number(w.input.rows), number(w.input.columns)}, of_maps, tag::any},
            {kernel, of_weights, tag::any}, {{channels}, of_biases, tag::a},
            {{1, channels, number(w.output_rows()), number(w.output_columns())}, of_maps, tag::any},
            {number(w.stride.rows), number(w.stride.columns)}, {number(w.top), number(w.left)},
            {behind((w.output_rows() - 1) * w.stride.rows + w.kernel.rows, w.input.rows + w.top),
             behind((w.output_columns() - 1) * w.stride.columns + w.kernel.columns,
                    w.input.columns + w.left)});
        const dnnl::convolution_forward::primitive_desc chosen(description, attributes, engine_);
        primitive_ = dnnl::convolution_forward(chosen);
        in_ = dnnl::memory(chosen.src_desc(), engine_), out_ = dnnl::memory(chosen.dst_desc(), engine_);
        arguments_ = {
            {DNNL_ARG_SRC, in_},
            {DNNL_ARG_WEIGHTS, reordered({kernel, of_weights, tag::goihw}, weights, chosen.weights_desc())},
            {DNNL_ARG_BIAS, reordered({{channels}, of_biases, tag::a}, biases, chosen.bias_desc())},
            {DNNL_ARG_DST, out_}};
    }
    /// Pixel by pixel, without gaps.
    void set_input(std::span<const Number> input) {
        const dnnl::memory from =
            reordered({in_.get_desc().dims(), of_maps, tag::nhwc}, input, in_.get_desc());
        dnnl::reorder(from, in_).execute(stream_, {{DNNL_ARG_FROM, from}, {DNNL_ARG_TO, in_}});
        stream_.wait();
    }
    [[nodiscard]] std::vector<Number> output() {
        dnnl::memory to({out_.get_desc().dims(), of_maps, tag::nhwc}, engine_);
        dnnl::reorder(out_, to).execute(stream_, {{DNNL_ARG_FROM, out_}, {DNNL_ARG_TO, to}});
        stream_.wait();
        const auto* const values = static_cast<const Number*>(to.get_data_handle());
        return {values, values + window_.output_rows() * window_.output_columns() * window_.input.channels};
    }
    void run() {
        primitive_.execute(stream_, arguments_);
        stream_.wait();
    }

private:
    using tag = dnnl::memory::format_tag;
    using type = dnnl::memory::data_type;
    static constexpr type of_maps = bytes ? type::u8 : type::f32, of_weights = bytes ? type::s8 : type::f32,
                          of_biases = bytes ? type::s32 : type::f32;

    template <class T>
    dnnl::memory reordered(const dnnl::memory::desc& plain, std::span<const T> values,
                           const dnnl::memory::desc& wanted) {
        dnnl::memory from(plain, engine_), to(wanted, engine_);
        std::copy(values.begin(), values.end(), static_cast<T*>(from.get_data_handle()));
        dnnl::reorder(from, to).execute(stream_, {{DNNL_ARG_FROM, from}, {DNNL_ARG_TO, to}});
        stream_.wait();
        return to;
    }

    sliding_window window_;
    dnnl::engine engine_;
    dnnl::stream stream_;
    dnnl::primitive primitive_;
    dnnl::memory in_, out_;
    std::unordered_map<int, dnnl::memory> arguments_;
};

/// Microseconds of body().
template <class Body>
double microseconds(Body&& body) {
    constexpr std::size_t repeats = 200;
    return 1e6 / repeats * benchmark::time_rounds(50, [&] {
                               for (std::size_t r = 0; r < repeats; ++r)
                                   body();
                           }).fastest;
}

/// Prints a line of the table.
void print(const char* format, const sliding_window& w, double ours, double theirs) {
    std::printf("%-6s  %3zu × %2zu × %3zu  %zu × %zu / %zu  %8.2f %8.2f %6.2f\n", format, w.input.rows,
                w.input.columns, w.input.channels, w.kernel.rows, w.kernel.columns, w.stride.rows, ours,
                theirs, theirs / ours);
}

/// Returns whether the outputs agree.
template <shape Input, extent2d Kernel, extent2d Stride = 1>
bool compare() {
    constexpr frame_convolution c = depthwise<Input, Kernel, Stride>;
    using step = convolution_step<single_precision, c>;
    random_stream random(1, random_purposes::order);
    const auto fill = [&](auto&& values) {
        for (float& value : values)
            value = static_cast<float>(random.uniform(-1, 1));
    };
    std::vector<float> folded(step::folded_elements), input(Input.size());
    fill(folded), fill(input);
    aligned_vector<float> packed(step::packed_elements), in(Input.area() * c.input_stride),
        workspace(step::workspace_elements), out(step::output.area() * step::output_stride);
    step::pack(folded.data(), packed.data());
    for (std::size_t i = 0; i < input.size(); ++i)
        in[i / Input.channels * c.input_stride + i % Input.channels] = input[i];
    const std::span<const float> parameters(folded);
    onednn_depthwise<float> peer(c.window, parameters.first(step::weights),
                                 parameters.subspan(step::weights));
    peer.set_input(input);

    const double ours =
        microseconds([&] { step::run(packed.data(), in.data(), out.data(), workspace.data()); });
    const double theirs = microseconds([&] { peer.run(); });
    print("float", c.window, ours, theirs);
    const std::vector<float> expected = peer.output();
    double error = 0;
    for (std::size_t i = 0; i < expected.size(); ++i)
        error = std::max(error,
                         std::abs(static_cast<double>(expected[i]) -
                                  static_cast<double>(
                                      out[i / Input.channels * step::output_stride + i % Input.channels])));
    return error < 1e-5;
}

/// Compares both in 8 bits, where all outputs must be equal.
template <shape Input, extent2d Kernel, extent2d Stride = 1>
bool compare_bytes() {
    constexpr frame_convolution c = depthwise<Input, Kernel, Stride>;
    using step = convolution_step<eight_bit, c>;
    random_stream random(1, random_purposes::order);
    const auto draw = [&](double lowest, double highest) {
        return std::floor(random.uniform(lowest, highest));
    };
    // Integers as they are: all scales but that of the output are 1.
    constexpr float output_scale = 256;
    std::vector<std::int8_t> weights(step::weights);
    std::vector<std::int32_t> biases(Input.channels);
    std::vector<float> folded(step::folded_elements, 1.0f);
    for (std::size_t i = 0; i < weights.size(); ++i)
        folded[i] = weights[i] = static_cast<std::int8_t>(draw(-127, 128));
    for (std::size_t f = 0; f < biases.size(); ++f)
        folded[weights.size() + f] =
            static_cast<float>(biases[f] = static_cast<std::int32_t>(draw(-999, 999)));
    float* const ranges = folded.data() + weights.size() + 2 * biases.size();
    map_range{1, 0}.write(ranges), map_range{output_scale, 0}.write(ranges + map_range::numbers);

    aligned_vector<std::int8_t> packed(step::packed_elements);
    aligned_vector<std::uint8_t> in(Input.area() * c.input_stride), workspace(step::workspace_elements),
        out(step::output.area() * step::output_stride);
    step::pack(folded.data(), packed.data());
    std::vector<std::uint8_t> input(Input.size());
    for (std::size_t i = 0; i < input.size(); ++i)
        in[i / Input.channels * c.input_stride + i % Input.channels] = input[i] =
            static_cast<std::uint8_t>(draw(0, 256));
    onednn_depthwise<std::uint8_t> peer(c.window, weights, biases, 1 / output_scale);
    peer.set_input(input);

    const double ours =
        microseconds([&] { step::run(packed.data(), in.data(), out.data(), workspace.data()); });
    const double theirs = microseconds([&] { peer.run(); });
    print("8 bits", c.window, ours, theirs);
    const std::vector<std::uint8_t> expected = peer.output();
    for (std::size_t i = 0; i < expected.size(); ++i)
        if (expected[i] != out[i / Input.channels * step::output_stride + i % Input.channels])
            return false;
    return true;
}

} // namespace

int main() {
    std::printf("numbers input            kernel / stride  ours, µs   oneDNN  ratio\n");
    const bool right[] = {compare<shape{14, 25, 64}, 3>(),       compare<shape{28, 50, 64}, 3>(),
                          compare<shape{28, 50, 64}, 3, 2>(),    compare<shape{14, 25, 64}, 5>(),
                          compare<shape{7, 13, 128}, 3>(),       compare<shape{14, 25, 24}, 3>(),
                          compare<shape{56, 56, 128}, 3>(),      compare_bytes<shape{14, 25, 64}, 3>(),
                          compare_bytes<shape{28, 50, 64}, 3>(), compare_bytes<shape{28, 50, 64}, 3, 2>(),
                          compare_bytes<shape{14, 25, 64}, 5>(), compare_bytes<shape{7, 13, 128}, 3>(),
                          compare_bytes<shape{14, 25, 24}, 3>(), compare_bytes<shape{56, 56, 128}, 3>()};
    return std::all_of(std::begin(right), std::end(right), [](bool each) { return each; }) ? EXIT_SUCCESS
                                                                                           : EXIT_FAILURE;
}

// Depthwise convolutions of one frame: the deployed step, bias and ReLU included, beside oneDNN's primitive
// in the layout that oneDNN prefers, without reordering.
//
//     OMP_NUM_THREADS=1 benchmark_depthwise
//
// Pin it to one core that is idle. Exit status 1 if the outputs differ.

#include "../support/measure.hpp"

#include <tactnet/deployment.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <dnnl.hpp>
#include <span>
#include <unordered_map>
#include <vector>

namespace {

using namespace tactnet;
using kernels::frame_convolution;

template <shape Input, extent2d Kernel, extent2d Stride>
inline constexpr frame_convolution depthwise{.window =
                                                 sliding_window::over(Input, Kernel, Stride, padding::same),
                                             .filters = Input.channels,
                                             .input_stride = whole_lines(Input.channels),
                                             .rectified = true,
                                             .groups = Input.channels};

/// oneDNN's depthwise convolution.
class onednn_depthwise {
public:
    onednn_depthwise(const sliding_window& w, std::span<const float> weights, std::span<const float> biases)
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
        const dnnl::memory::dims kernel{channels, 1, 1, number(w.kernel.rows), number(w.kernel.columns)};
        const dnnl::convolution_forward::desc description(
            dnnl::prop_kind::forward_inference, dnnl::algorithm::convolution_auto,
            {{1, channels, number(w.input.rows), number(w.input.columns)}, f32, tag::any},
            {kernel, f32, tag::any}, {{channels}, f32, tag::a},
            {{1, channels, number(w.output_rows()), number(w.output_columns())}, f32, tag::any},
            {number(w.stride.rows), number(w.stride.columns)}, {number(w.top), number(w.left)},
            {behind((w.output_rows() - 1) * w.stride.rows + w.kernel.rows, w.input.rows + w.top),
             behind((w.output_columns() - 1) * w.stride.columns + w.kernel.columns,
                    w.input.columns + w.left)});
        const dnnl::convolution_forward::primitive_desc chosen(description, attributes, engine_);
        primitive_ = dnnl::convolution_forward(chosen);
        in_ = dnnl::memory(chosen.src_desc(), engine_), out_ = dnnl::memory(chosen.dst_desc(), engine_);
        arguments_ = {
            {DNNL_ARG_SRC, in_},
            {DNNL_ARG_WEIGHTS, reordered({kernel, f32, tag::goihw}, weights, chosen.weights_desc())},
            {DNNL_ARG_BIAS, reordered({{channels}, f32, tag::a}, biases, chosen.bias_desc())},
            {DNNL_ARG_DST, out_}};
    }
    /// Pixel by pixel, without gaps.
    void set_input(std::span<const float> input) {
        const dnnl::memory from = reordered({in_.get_desc().dims(), f32, tag::nhwc}, input, in_.get_desc());
        dnnl::reorder(from, in_).execute(stream_, {{DNNL_ARG_FROM, from}, {DNNL_ARG_TO, in_}});
        stream_.wait();
    }
    [[nodiscard]] std::vector<float> output() {
        dnnl::memory to({out_.get_desc().dims(), f32, tag::nhwc}, engine_);
        dnnl::reorder(out_, to).execute(stream_, {{DNNL_ARG_FROM, out_}, {DNNL_ARG_TO, to}});
        stream_.wait();
        const auto* const values = static_cast<const float*>(to.get_data_handle());
        return {values, values + window_.output_rows() * window_.output_columns() * window_.input.channels};
    }
    void run() {
        primitive_.execute(stream_, arguments_);
        stream_.wait();
    }

private:
    using tag = dnnl::memory::format_tag;
    static constexpr auto f32 = dnnl::memory::data_type::f32;

    dnnl::memory reordered(const dnnl::memory::desc& plain, std::span<const float> values,
                           const dnnl::memory::desc& wanted) {
        dnnl::memory from(plain, engine_), to(wanted, engine_);
        std::copy(values.begin(), values.end(), static_cast<float*>(from.get_data_handle()));
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

/// Prints a line of the table. Returns whether the outputs agree.
template <shape Input, extent2d Kernel, extent2d Stride = 1>
bool compare() {
    constexpr frame_convolution c = depthwise<Input, Kernel, Stride>;
    using step = convolution_step<single_precision, c>;
    random_stream random(1, random_purposes::order);
    const auto fill = [&](auto&& values) {
        for (float& value : values)
            value = static_cast<float>(random.uniform(-1, 1));
    };
    std::vector<float> folded(step::folded), input(Input.size());
    fill(folded), fill(input);
    aligned_vector<float> packed(step::packed), in(Input.area() * c.input_stride),
        workspace(step::workspace_elements), out(step::output.area() * step::output_stride);
    step::pack(folded.data(), packed.data());
    for (std::size_t i = 0; i < input.size(); ++i)
        in[i / Input.channels * c.input_stride + i % Input.channels] = input[i];
    onednn_depthwise peer(c.window, std::span(folded).first(step::weights),
                          std::span(folded).subspan(step::weights));
    peer.set_input(input);

    const double ours =
        microseconds([&] { step::run(packed.data(), in.data(), out.data(), workspace.data()); });
    const double theirs = microseconds([&] { peer.run(); });
    std::printf("%3zu × %2zu × %3zu  %zu × %zu / %zu  %8.2f %8.2f %6.2f\n", Input.rows, Input.columns,
                Input.channels, Kernel.rows, Kernel.columns, Stride.rows, ours, theirs, theirs / ours);
    const std::vector<float> expected = peer.output();
    double error = 0;
    for (std::size_t i = 0; i < expected.size(); ++i)
        error = std::max(error,
                         std::abs(static_cast<double>(expected[i]) -
                                  static_cast<double>(
                                      out[i / Input.channels * step::output_stride + i % Input.channels])));
    return error < 1e-5;
}

} // namespace

int main() {
    std::printf("input            kernel / stride  ours, µs   oneDNN  ratio\n");
    const bool right[] = {compare<shape{14, 25, 64}, 3>(),    compare<shape{28, 50, 64}, 3>(),
                          compare<shape{28, 50, 64}, 3, 2>(), compare<shape{14, 25, 64}, 5>(),
                          compare<shape{7, 13, 128}, 3>(),    compare<shape{14, 25, 24}, 3>(),
                          compare<shape{56, 56, 128}, 3>()};
    return std::all_of(std::begin(right), std::end(right), [](bool each) { return each; }) ? EXIT_SUCCESS
                                                                                           : EXIT_FAILURE;
}

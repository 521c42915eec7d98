#pragma once

#include <tactnet/operators/convolution/training.hpp>
#include <tactnet/operators/dilated_convolution/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

template <std::size_t Filters, extent2d Kernel, extent2d Dilation, extent2d Stride, padding Padding,
          conv2d_options Options, class T, shape Input>
struct trained_layer<dilated_conv2d<Filters, Kernel, Dilation, Stride, Padding, Options>, T, Input>
    : trained_base<dilated_conv2d<Filters, Kernel, Dilation, Stride, Padding, Options>, T, Input> {
    using base = trained_base<dilated_conv2d<Filters, Kernel, Dilation, Stride, Padding, Options>, T, Input>;
    using base::output;
    using typename base::phases;
    using convolution = trained_layer<typename base::convolution_spec, T, phases::map>;
    static constexpr bool by_parts = true;

    struct memory {
        typename convolution::memory of_convolution;
        aligned_vector<T> phases, sums, gradients; // of a part
        void resize(std::size_t samples) { of_convolution.resize(samples); }
    };
    static void prepare(const execution_context& context, const T* values, const T* running, memory& m) {
        convolution::prepare(context, values, running, m.of_convolution);
    }
    static void infer(const execution_context& context, const T* values, const T* running, memory& m,
                      input_view<T, Input> in, output_view<T, output> out) {
        const auto split = split_inputs(context, m, in);
        const auto sums = part_of<convolution::output>(m.sums, in.samples());
        convolution::infer(context, values, running, m.of_convolution, split, sums);
        gather<convolution::output, output>(context, phases::rows::sum_of, phases::columns::sum_of, sums,
                                            out);
    }

    static void begin_backward(const execution_context& context, const T* values, memory& m,
                               std::size_t samples) {
        convolution::begin_backward(context, values, m.of_convolution, samples);
    }
    static void backward(const execution_context& context, const T* values, memory& m,
                         input_view<T, Input> in, input_view<T, output>, input_view<T, output> out_gradient,
                         output_view<T, Input> in_gradient, T* gradients) {
        const auto split = split_inputs(context, m, in);
        const auto sums = part_of<convolution::output>(m.sums, in.samples());
        gather<output, convolution::output>(context, phases::rows::output_at, phases::columns::output_at,
                                            out_gradient, sums);
        output_view<T, convolution::input> split_gradient(nullptr, in.samples());
        if (in_gradient.data() != nullptr)
            split_gradient = part_of<convolution::input>(m.gradients, in.samples());
        convolution::backward(context, values, m.of_convolution, split, sums, sums, split_gradient,
                              gradients);
        if (in_gradient.data() != nullptr)
            gather<convolution::input, Input>(context, phases::rows::place_of, phases::columns::place_of,
                                              split_gradient, in_gradient);
    }
    static void end_backward(memory& m, T* gradients) {
        convolution::end_backward(m.of_convolution, gradients);
    }

private:
    template <shape Map>
    static output_view<T, Map> part_of(aligned_vector<T>& memory, std::size_t samples) {
        detail::grow(memory, kernels::padded_size<T>(samples) * Map.size());
        return {memory.data(), samples};
    }
    static input_view<T, convolution::input> split_inputs(const execution_context& context, memory& m,
                                                          input_view<T, Input> in) {
        const auto to = part_of<convolution::input>(m.phases, in.samples());
        gather<Input, convolution::input>(context, phases::rows::input_at, phases::columns::input_at, in, to);
        return to;
    }
    template <shape From, shape To>
    static void gather(const execution_context& context, const auto& rows, const auto& columns,
                       input_view<T, From> in, output_view<T, To> out) {
        context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
            for (std::size_t c = 0; c < From.channels; ++c)
                kernels::gather_pixels<kernels::lanes<T>, From.columns>(
                    rows, columns, in.lane_block(b) + c * From.area() * kernels::lanes<T>, T{},
                    out.lane_block(b) + c * To.area() * kernels::lanes<T>);
        });
    }
};

namespace detail {

template <class Spec, class T, shape Input, class Layer = typename Spec::template layer<T, Input>>
using transposed_conv2d_passes =
    convolution_passes<Spec, T, Input, true,
                       kernels::batch_convolution::backward(Layer::window, Input.channels),
                       kernels::batch_convolution::forward(Layer::window, Input.channels)>;

} // namespace detail

template <std::size_t Filters, extent2d Kernel, extent2d Stride, padding Padding, bool Bias, class T,
          shape Input>
struct trained_layer<transposed_conv2d<Filters, Kernel, Stride, Padding, Bias>, T, Input>
    : detail::transposed_conv2d_passes<transposed_conv2d<Filters, Kernel, Stride, Padding, Bias>, T, Input> {
    using base =
        detail::transposed_conv2d_passes<transposed_conv2d<Filters, Kernel, Stride, Padding, Bias>, T, Input>;
    using typename base::memory;

    static void prepare(const execution_context&, const T* values, const T*, memory& m) {
        m.forward_weights.resize(base::forward_method::packed_elements);
        const auto weight = [&](auto filter, auto channel, auto row, auto column) {
            return values[at(channel, filter, Kernel.rows - 1 - row, Kernel.columns - 1 - column)];
        };
        base::forward_method::pack(weight, m.forward_weights.data());
    }

    static void begin_backward(const execution_context&, const T* values, memory& m, std::size_t) {
        base::clear_totals(m);
        m.backward_weights.resize(base::input_gradient_method::packed_elements);
        const auto weight = [&](auto channel, auto filter, auto row, auto column) {
            return values[at(channel, filter, row, column)];
        };
        base::input_gradient_method::pack(weight, m.backward_weights.data());
    }

private:
    static constexpr std::size_t at(std::size_t channel, std::size_t filter, std::size_t row,
                                    std::size_t column) {
        return ((channel * Filters + filter) * Kernel.rows + row) * Kernel.columns + column;
    }
};

}} // namespace tactnet

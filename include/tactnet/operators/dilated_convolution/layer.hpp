#pragma once

#include <tactnet/kernels/dilated_axis.hpp>
#include <tactnet/operators/convolution/layer.hpp>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

template <std::size_t DilationArea, std::size_t ReachRows, std::size_t ReachColumns, std::size_t PaddedRows,
          std::size_t PaddedColumns>
[[nodiscard]] constexpr shape dilated_conv2d_output(shape output) {
    static_assert(DilationArea > 0, "dilated_conv2d: the dilation must be at least 1");
    static_assert(kernel_fits_padded_input<ReachRows, ReachColumns, PaddedRows, PaddedColumns>,
                  "dilated_conv2d: the dilated kernel is larger than the padded input; "
                  "kernel_fits_padded_input shows its rows, its columns, padded rows, padded columns");
    return output;
}

} // namespace detail

/// Convolution whose taps are `Dilation` pixels apart: it sees a larger part of the map with the same weights
/// (Yu, Koltun, "Multi-scale context aggregation by dilated convolutions", 2016). PyTorch's
/// Conv2d(dilation=…). `padding::same` pads for the dilated kernel, whose size is (kernel − 1) × dilation
/// + 1. Everything else is as for conv2d.
template <std::size_t Filters, extent2d Kernel, extent2d Dilation = 2, extent2d Stride = 1,
          padding Padding = padding::same, conv2d_options Options = conv2d_options{}>
struct dilated_conv2d {
    static constexpr std::string_view name = "conv";
    static constexpr bool numbered = true;

private:
    /// The layer rejects zeros.
    static constexpr extent2d at_least_one(extent2d e) {
        return {e.rows > 0 ? e.rows : 1, e.columns > 0 ? e.columns : 1};
    }

public:
    static constexpr extent2d kernel = at_least_one(Kernel), dilation = at_least_one(Dilation);

    static constexpr layer_costs costs(const shape& input) {
        const sliding_window w = reach_over(input);
        const std::size_t rows = w.output_rows(), columns = w.output_columns();
        layer_costs found = conv2d<Filters, kernel, 1, padding::same, Options>::costs(input);
        const std::size_t of_tap =
            (found.parameters - (Options.bias ? Filters : 0)) / kernel.area(); // filters × channels
        const auto down = kernels::dilated_axis::of(input.rows, rows, kernel.rows, dilation.rows,
                                                    w.stride.rows, w.top),
                   along = kernels::dilated_axis::of(input.columns, columns, kernel.columns, dilation.columns,
                                                     w.stride.columns, w.left);
        found.output = {rows, columns, Filters};
        found.multiply_adds = rows * columns * kernel.area() * of_tap;
        found.multiply_adds_on_pixels = down.taps_on_pixels() * along.taps_on_pixels() * of_tap;
        return found;
    }

private:
    static constexpr sliding_window reach_over(const shape& input) {
        return sliding_window::over(
            input, {(kernel.rows - 1) * dilation.rows + 1, (kernel.columns - 1) * dilation.columns + 1},
            Stride, Padding);
    }

public:
    template <class T, shape Input>
    struct layer : layer_base<T, Input, dilated_conv2d> {
    private:
        static constexpr sliding_window reach = reach_over(Input);

    public:
        static constexpr bool by_parts = true;
        static constexpr shape output = detail::dilated_conv2d_output<
            Dilation.area(), reach.kernel.rows, reach.kernel.columns, Input.rows + reach.top + reach.bottom,
            Input.columns + reach.left + reach.right>(
            // Everything but the size of the kernel.
            detail::conv2d_output<Filters, Kernel.area(), Stride.area(), 1, 1, 1, 1, Options.groups,
                                  Input.channels>({reach.output_rows(), reach.output_columns(), Filters}));
        static constexpr extent2d dilation = dilated_conv2d::dilation;
        /// With the padding of the dilated kernel.
        static constexpr sliding_window window{Input,        kernel,     reach.stride, reach.top,
                                               reach.bottom, reach.left, reach.right};
        static constexpr extent2d outputs{output.rows, output.columns};
        /// In training one phase of the rows lies below the other: a weight gradient by tiles needs short
        /// rows of tiles.
        using phases = kernels::laid_out_phases<kernels::dilated_layout::of(
            window, dilation, outputs, kernels::phase_order::consecutive)>;

    private:
        template <class Phases>
        using convolution_of = typename conv2d<Filters, kernel, Phases::window.stride, Phases::around,
                                               Options>::template layer<T, Phases::map>;

    public:
        /// The convolution of the phases, in training and deployed.
        using convolution = convolution_of<phases>;
        using deployed_convolution = convolution_of<kernels::dilated_phases<window, dilation, outputs>>;

        struct memory {
            typename convolution::memory of_convolution;
            aligned_vector<T> phases, sums, gradients; // of a part
            void resize(std::size_t samples) { of_convolution.resize(samples); }
        };

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            convolution::describe(prefix, list);
        }
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
                             input_view<T, Input> in, input_view<T, output>,
                             input_view<T, output> out_gradient, output_view<T, Input> in_gradient,
                             T* gradients) {
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
            gather<Input, convolution::input>(context, phases::rows::input_at, phases::columns::input_at, in,
                                              to);
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
};

}} // namespace tactnet

#pragma once

#include <tactnet/kernels/batch/channel_gradient.hpp>
#include <tactnet/kernels/batch/convolution.hpp>
#include <tactnet/kernels/batch/convolution_gradient.hpp>
#include <tactnet/kernels/batch/reductions.hpp>
#include <tactnet/layers/layer.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <std::size_t KernelRows, std::size_t KernelColumns, std::size_t PaddedRows,
          std::size_t PaddedColumns>
concept kernel_fits_padded_input = (KernelRows <= PaddedRows) && (KernelColumns <= PaddedColumns);

template <std::size_t Groups, std::size_t Channels, std::size_t Filters>
concept groups_divide = (Groups > 0) && (Channels % Groups == 0) && (Filters % Groups == 0);

/// What a convolution may be besides its window.
struct conv2d_options {
    std::size_t groups = 1; ///< filters of a group see the channels of that group only
    bool bias = true;

    friend constexpr bool operator==(const conv2d_options&, const conv2d_options&) = default;
};

/// In groups, as AlexNet's on two processors (Krizhevsky, Sutskever, Hinton, 2012); as many as there are
/// channels is depthwise.
[[nodiscard]] constexpr conv2d_options in_groups(std::size_t count) {
    return {.groups = count};
}
/// Without bias: in front of a batch norm, which has one.
inline constexpr conv2d_options without_bias{.bias = false};

namespace detail {

template <std::size_t Filters, std::size_t KernelArea, std::size_t StrideArea, std::size_t KernelRows,
          std::size_t KernelColumns, std::size_t PaddedRows, std::size_t PaddedColumns, std::size_t Groups,
          std::size_t Channels>
[[nodiscard]] constexpr shape conv2d_output(shape output) {
    static_assert(groups_divide<Groups, Channels, Filters>,
                  "conv2d: groups must divide the channels of the input and the filters; groups_divide shows "
                  "groups, channels, filters");
    static_assert(Filters > 0 && KernelArea > 0 && StrideArea > 0,
                  "conv2d: filters, kernel and stride must be at least 1");
    static_assert(
        kernel_fits_padded_input<KernelRows, KernelColumns, PaddedRows, PaddedColumns>,
        "conv2d: the kernel is larger than the padded input; kernel_fits_padded_input shows kernel rows, "
        "kernel columns, padded rows, padded columns");
    return output;
}

} // namespace detail

/// Two-dimensional convolution (cross-correlation, as everywhere in the field), with bias unless the options
/// leave it out.
/// Weights are [filter][channel][row][column] (PyTorch's OIHW), the channels those of the filter's group.
template <std::size_t Filters, extent Kernel, extent Stride = 1, padding Padding = same,
          conv2d_options Options = conv2d_options{}>
struct conv2d {
    static constexpr std::string_view name = "conv";
    static constexpr bool numbered = true;

    /// None is refused by the layer.
    static constexpr std::size_t groups = Options.groups > 0 ? Options.groups : 1;

    static constexpr layer_costs costs(const shape& input) {
        const auto window = sliding_window::over(input, Kernel, Stride, Padding);
        const shape output{window.output_rows(), window.output_columns(), Filters};
        const std::size_t channels = input.channels / groups;
        const std::size_t weights = Filters * channels * Kernel.area();
        return {.output = output,
                .parameters = weights + (Options.bias ? Filters : 0),
                .multiply_adds = output.area() * weights,
                .multiply_adds_on_pixels = window.taps_on_pixels() * channels * Filters};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, conv2d> {
        static constexpr sliding_window window = sliding_window::over(Input, Kernel, Stride, Padding);
        static constexpr shape output =
            detail::conv2d_output<Filters, Kernel.area(), Stride.area(), Kernel.rows, Kernel.columns,
                                  Input.rows + window.top + window.bottom,
                                  Input.columns + window.left + window.right, Options.groups, Input.channels>(
                {window.output_rows(), window.output_columns(), Filters});
        static constexpr std::size_t groups = conv2d::groups;
        /// Of one group.
        static constexpr std::size_t channels = Input.channels / groups, filters = Filters / groups;
        static constexpr bool has_bias = Options.bias;
        static constexpr std::size_t fan_in = channels * Kernel.area();
        static constexpr std::size_t weights = Filters * fan_in;
        static constexpr bool by_parts = true;

        struct memory {
            aligned_vector<T> forward_weights, backward_weights;
            aligned_vector<double> totals;
            aligned_vector<T> turned; // of every thread
            void resize(std::size_t) {}
        };

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            describe_array(list, prefix + ".weight", role::weight,
                           {Filters, channels, Kernel.rows, Kernel.columns}, 0, fan_in);
            if constexpr (has_bias)
                describe_array(list, prefix + ".bias", role::bias, {Filters}, weights);
        }

        static void prepare(const pass&, const T* values, const T*, memory& m) {
            m.forward_weights.resize(weights);
            for (std::size_t group = 0; group < groups; ++group)
                kernels::pack_weights<ahead>(
                    m.forward_weights.data() + group * group_weights,
                    [&](auto filter, auto channel, auto row, auto column) {
                        return values[group * group_weights +
                                      ((filter * channels + channel) * Kernel.rows + row) * Kernel.columns +
                                      column];
                    });
        }

        static void infer(const pass& p, const T* values, const T*, memory& m, input_view<T, Input> in,
                          output_view<T, output> out) {
            p.threads.for_each(in.groups(), [&](std::size_t g) {
                for (std::size_t group = 0; group < groups; ++group)
                    kernels::correlate<ahead>(in.group(g) + group * group_input,
                                              m.forward_weights.data() + group * group_weights,
                                              has_bias ? values + weights + group * filters : nullptr,
                                              out.group(g) + group * group_output);
            });
        }
        static void forward(const pass& p, const T* values, T* none, memory& m, input_view<T, Input> in,
                            output_view<T, output> out) {
            infer(p, values, none, m, in, out);
        }

        static void begin_backward(const pass&, const T* values, memory& m, std::size_t) {
            m.totals.assign(weights + Filters, 0.0);
            m.backward_weights.resize(weights);
            for (std::size_t group = 0; group < groups; ++group)
                kernels::pack_weights<back>(m.backward_weights.data() + group * group_weights,
                                            [&](auto channel, auto filter, auto row, auto column) {
                                                return values[group * group_weights +
                                                              ((filter * channels + channel) * Kernel.rows +
                                                               (Kernel.rows - 1 - row)) *
                                                                  Kernel.columns +
                                                              (Kernel.columns - 1 - column)];
                                            });
        }
        static void backward(const pass& p, const T*, memory& m, input_view<T, Input> in,
                             input_view<T, output>, input_view<T, output> out_gradient,
                             output_view<T, Input> in_gradient, T*) {
            m.turned.resize(p.threads.threads() * (across_channels::fits ? across_channels::scratch : 0));
            // Threads share the weights and the biases, each adding all groups in order, and the groups of
            // the input's gradient; group by group, so that a group is fetched from memory once.
            p.threads.on_each_thread([&](thread_pool::share part) {
                for (std::size_t g = 0; g < in.groups(); ++g) {
                    for (std::size_t group = 0; group < groups; ++group) {
                        const T *const x = in.group(g) + group * group_input, *const dy =
                                                                                  out_gradient.group(g) +
                                                                                  group * group_output;
                        double* const totals = m.totals.data() + group * group_weights;
                        if constexpr (across_channels::fits)
                            kernels::add_channel_gradient<group_window, filters>(
                                x, dy, totals, m.turned.data() + part.index * across_channels::scratch,
                                part.begin(pieces), part.end(pieces));
                        else
                            kernels::add_weight_gradient<group_window, filters>(
                                x, dy, totals, part.begin(pieces), part.end(pieces));
                    }
                    for (std::size_t f = part.begin(biases); f < part.end(biases); ++f) {
                        const T* from = out_gradient.group(g) + f * output.area() * kernels::lanes<T>;
                        m.totals[weights + f] += kernels::sum_terms<1, T>(output.area(), [&](std::size_t i) {
                            return std::array<kernels::vector<T>, 1>{
                                kernels::load(from + i * kernels::lanes<T>)};
                        })[0];
                    }
                    const bool mine = g >= part.begin(in.groups()) && g < part.end(in.groups());
                    for (std::size_t group = 0; in_gradient.data() != nullptr && mine && group < groups;
                         ++group)
                        kernels::correlate<back>(out_gradient.group(g) + group * group_output,
                                                 m.backward_weights.data() + group * group_weights,
                                                 static_cast<const T*>(nullptr),
                                                 in_gradient.group(g) + group * group_input);
                }
            });
        }
        static void end_backward(memory& m, T* gradients) {
            T* to = gradients;
            for (std::size_t filter = 0; filter < Filters; ++filter)
                for (std::size_t channel = 0; channel < channels; ++channel)
                    for (std::size_t row = 0; row < Kernel.rows; ++row)
                        for (std::size_t column = 0; column < Kernel.columns; ++column)
                            *to++ = static_cast<T>(m.totals[filter / filters * group_weights +
                                                            place(filter % filters, channel, row, column)]);
            for (std::size_t filter = 0; filter < biases; ++filter)
                *to++ = static_cast<T>(m.totals[weights + filter]);
        }

    private:
        // Groups lie one behind the other: in maps, in weights and in their gradients.
        static constexpr sliding_window group_window = [] {
            sliding_window one = window;
            one.input.channels = channels;
            return one;
        }();
        static constexpr std::size_t biases = has_bias ? Filters : 0;
        static constexpr std::size_t group_weights = weights / groups,
                                     group_input = Input.size() / groups * kernels::lanes<T>,
                                     group_output = output.size() / groups * kernels::lanes<T>;

        using across_channels = kernels::channel_gradient_plan<group_window, filters, T>;
        using across_samples = kernels::weight_gradient_plan<group_window, filters, T>;
        static constexpr std::size_t pieces =
            across_channels::fits ? across_channels::pieces : across_samples::pieces;

        /// Where the total of a weight lies in those of its group.
        static constexpr std::size_t place(std::size_t filter, std::size_t channel, std::size_t row,
                                           std::size_t column) {
            if constexpr (across_channels::fits)
                return across_channels::place(filter, channel, row, column);
            else
                return ((filter * channels + channel) * Kernel.rows + row) * Kernel.columns + column;
        }
        static constexpr kernels::correlation ahead = kernels::correlation::forward(group_window, filters);
        static constexpr kernels::correlation back = kernels::correlation::backward(group_window, filters);
    };
};

} // namespace TACTNET_ARCH
} // namespace tactnet

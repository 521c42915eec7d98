#pragma once

#include <tactnet/kernels/batch/methods.hpp>
#include <tactnet/kernels/batch/reductions.hpp>
#include <tactnet/layers/layer.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

template <std::size_t KernelRows, std::size_t KernelColumns, std::size_t PaddedRows,
          std::size_t PaddedColumns>
concept kernel_fits_padded_input = (KernelRows <= PaddedRows) && (KernelColumns <= PaddedColumns);

template <std::size_t Groups, std::size_t Channels, std::size_t Filters>
concept groups_divide = (Groups > 0) && (Channels % Groups == 0) && (Filters % Groups == 0);

/// Options of a convolution besides its window.
struct conv2d_options {
    std::size_t groups = 1; ///< the filters of a group see its channels only
    bool bias = true;

    friend constexpr bool operator==(const conv2d_options&, const conv2d_options&) = default;
};

/// Grouped convolution, as in AlexNet (Krizhevsky, Sutskever, Hinton, 2012). With as many groups as channels
/// it is depthwise.
[[nodiscard]] constexpr conv2d_options in_groups(std::size_t count) {
    return {.groups = count};
}
/// For convolutions before a batch norm, which has a bias of its own.
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

/// Two-dimensional convolution (cross-correlation), with bias unless the options leave it out.
/// Weights are [filter][channel][row][column] (PyTorch's OIHW), the channels those of the filter's group.
template <std::size_t Filters, extent2d Kernel, extent2d Stride = 1, padding Padding = padding::same,
          conv2d_options Options = conv2d_options{}>
struct conv2d {
    static constexpr std::string_view name = "conv";
    static constexpr bool numbered = true;

    /// The layer rejects zero groups.
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
        /// In one group.
        static constexpr std::size_t channels = Input.channels / groups, filters = Filters / groups;
        static constexpr bool has_bias = Options.bias;
        static constexpr std::size_t fan_in = channels * Kernel.area();
        static constexpr std::size_t weights = Filters * fan_in;
        static constexpr bool by_parts = true;

        struct memory {
            aligned_vector<T> forward_weights, backward_weights;
            aligned_vector<double> totals;
            aligned_vector<T> scratch; // of every thread
            void resize(std::size_t) {}
        };

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            describe_array(list, prefix, "weight", parameter_role::weight,
                           {Filters, channels, Kernel.rows, Kernel.columns}, 0, fan_in);
            if constexpr (has_bias)
                describe_array(list, prefix, "bias", parameter_role::bias, {Filters}, weights);
        }

        static void prepare(const execution_context&, const T* values, const T*, memory& m) {
            m.forward_weights.resize(forward_method::packed_elements);
            const auto weight = [&](auto filter, auto channel, auto row, auto column) {
                return values[((filter * channels + channel) * Kernel.rows + row) * Kernel.columns + column];
            };
            forward_method::pack(weight, m.forward_weights.data());
        }

        static void infer(const execution_context& context, const T* values, const T*, memory& m,
                          input_view<T, Input> in, output_view<T, output> out) {
            detail::grow(m.scratch, context.threads.threads() * forward_method::workspace_elements);
            context.threads.on_each_share(in.lane_blocks(), [&](thread_pool::share part) {
                for (std::size_t b = part.begin(in.lane_blocks()); b < part.end(in.lane_blocks()); ++b)
                    forward_method::run(m.forward_weights.data(), has_bias ? values + weights : nullptr,
                                        in.lane_block(b), out.lane_block(b),
                                        m.scratch.data() + part.index * forward_method::workspace_elements);
            });
        }

        static void begin_backward(const execution_context&, const T* values, memory& m, std::size_t) {
            m.totals.assign(weight_gradient_method::totals + biases, 0.0);
            m.backward_weights.resize(input_gradient_method::packed_elements);
            const auto weight = [&](auto channel, auto filter, auto row, auto column) {
                const std::size_t group = channel / channels;
                return values[(((group * filters + filter) * channels + channel % channels) * Kernel.rows +
                               (Kernel.rows - 1 - row)) *
                                  Kernel.columns +
                              (Kernel.columns - 1 - column)];
            };
            input_gradient_method::pack(weight, m.backward_weights.data());
        }
        static void backward(const execution_context& context, const T*, memory& m, input_view<T, Input> in,
                             input_view<T, output>, input_view<T, output> out_gradient,
                             output_view<T, Input> in_gradient, T*) {
            constexpr std::size_t needed = std::max(weight_gradient_method::workspace_elements,
                                                    input_gradient_method::workspace_elements);
            detail::grow(m.scratch, context.threads.threads() * needed);
            // Threads share the weights and the biases, each adding all lane blocks in order, and the lane
            // blocks of the input gradient. Lane block by lane block, so that each is fetched from memory
            // once.
            context.threads.on_each_thread([&](thread_pool::share part) {
                T* const scratch = m.scratch.data() + part.index * needed;
                for (std::size_t b = 0; b < in.lane_blocks(); ++b) {
                    weight_gradient_method::add(in.lane_block(b), out_gradient.lane_block(b), m.totals.data(),
                                                scratch, part.begin(weight_gradient_method::pieces),
                                                part.end(weight_gradient_method::pieces));
                    for (std::size_t f = part.begin(biases); f < part.end(biases); ++f) {
                        const T* from = out_gradient.lane_block(b) + f * output.area() * kernels::lanes<T>;
                        m.totals[weight_gradient_method::totals + f] +=
                            kernels::sum_terms<1, T>(output.area(), [&](std::size_t i) {
                                return std::array<kernels::vector<T>, 1>{
                                    kernels::load(from + i * kernels::lanes<T>)};
                            })[0];
                    }
                    if (in_gradient.data() != nullptr && b >= part.begin(in.lane_blocks()) &&
                        b < part.end(in.lane_blocks()))
                        input_gradient_method::run(m.backward_weights.data(), nullptr,
                                                   out_gradient.lane_block(b), in_gradient.lane_block(b),
                                                   scratch);
                }
            });
        }
        static void end_backward(memory& m, T* gradients) {
            weight_gradient_method::finish(m.totals.data(), gradients);
            for (std::size_t filter = 0; filter < biases; ++filter)
                gradients[weights + filter] =
                    static_cast<T>(m.totals[weight_gradient_method::totals + filter]);
        }

    private:
        static constexpr std::size_t biases = has_bias ? Filters : 0;
        // At least one filter: of none, the sentence above is the only error.
        static constexpr std::size_t computed = Filters > 0 ? Filters : 1;
        static constexpr auto description = kernels::batch_convolution::forward(window, computed, groups);

        using forward_method = kernels::lane_convolution<description, T>;
        using input_gradient_method =
            kernels::lane_convolution<kernels::batch_convolution::backward(window, computed, groups), T>;
        using weight_gradient_method = kernels::weight_gradient<description, T>;
    };
};

}} // namespace tactnet

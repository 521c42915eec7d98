#pragma once

#include <tactnet/kernels/batch/normalisation.hpp>
#include <tactnet/operators/activations/layer.hpp>
#include <tactnet/operators/batch_norm/training.hpp>
#include <tactnet/operators/concatenation/layer.hpp>
#include <tactnet/operators/pooling/layer.hpp>
#include <tactnet/operators/residual/layer.hpp>
#include <tactnet/operators/sequence/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Batch norm, ReLU and max pooling as one layer, with the same results and the arrays of the batch norm. A
/// window of one pixel means no pooling. Lists are written with the three, and `with_fused_norms` joins them.
/// If the norm rounds different elements of a window to the same number, the gradient goes to the largest of
/// them and not to the first.
template <extent2d Window, extent2d Stride = Window, padding Padding = padding::same>
struct norm_relu_pool {
    static constexpr std::string_view name = batch_norm::name;
    static constexpr bool numbered = batch_norm::numbered;

    static constexpr layer_costs costs(const shape& input) {
        layer_costs all = batch_norm::costs(input);
        all.output = max_pool<Window, Stride, Padding>::costs(input).output;
        all.keeps_output = true;
        return all;
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, norm_relu_pool> {
        using pool = typename max_pool<Window, Stride, Padding>::template layer<T, Input>;
        static constexpr sliding_window window = pool::window;
        static constexpr shape output = pool::output; // which refuses a window that does not fit

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            batch_norm::layer<T, Input>::describe(prefix, list);
        }
    };
};

template <extent2d Window, extent2d Stride, padding Padding, class T, shape Input>
struct trained_layer<norm_relu_pool<Window, Stride, Padding>, T, Input>
    : trained_base<norm_relu_pool<Window, Stride, Padding>, T, Input> {
    using base = trained_base<norm_relu_pool<Window, Stride, Padding>, T, Input>;
    using base::output, base::window;
    using norm = trained_layer<batch_norm, T, Input>;
    static constexpr bool by_parts = true, observes = true;
    static constexpr bool pools = Window.area() > 1 || Stride.area() > 1;

    struct memory : norm::memory {
        aligned_vector<T> chosen;           // by each window of the batch
        std::array<T, Input.channels> sign; // of the slope of each channel's norm
        void resize(std::size_t samples) {
            norm::memory::resize(samples);
            if (pools)
                detail::grow(chosen, kernels::padded_size<T>(samples) * output.size());
        }
    };

    static void prepare(const execution_context&, const T* values, const T*, memory& m) {
        for (std::size_t c = 0; c < Input.channels; ++c)
            m.sign[c] = static_cast<T>((values[c] > T{}) - (values[c] < T{}));
    }
    static void infer(const execution_context& context, const T* values, const T* running, memory& m,
                      input_view<T, Input> in, output_view<T, output> out) {
        norm::use_running(context, running, m);
        norm::each_channel(context, in.lane_blocks(), [&](std::size_t b, std::size_t c) {
            kernels::normalised_pool_forward<window>(norm::rule(values, m, c), in.lane_block(b) + c * plane,
                                                     out.lane_block(b) + c * pooled);
        });
    }

    /// Chooses the element of each window here, while the map is in the caches: when the moments of a
    /// large batch are known, it is in memory.
    static void observe_forward(const execution_context& context, memory& m, input_view<T, Input> in) {
        norm::each_channel(context, in.lane_blocks(), [&](std::size_t b, std::size_t c) {
            norm::observe_input(m, in, context.first_lane_block, b, c);
            if constexpr (pools)
                kernels::choose_for_pool<window>(m.sign[c], in.lane_block(b) + c * plane,
                                                 chosen_by(context, m, b, c));
        });
    }
    static void begin_forward(const execution_context& context, T* running, memory& m, std::size_t samples) {
        norm::begin_forward(context, running, m, samples);
    }
    static void forward(const execution_context& context, const T* values, T*, memory& m,
                        input_view<T, Input> in, output_view<T, output> out) {
        norm::each_channel(context, in.lane_blocks(), [&](std::size_t b, std::size_t c) {
            kernels::normalise_and_rectify(norm::rule(values, m, c), chosen_inputs(context, m, in, b, c),
                                           out.lane_block(b) + c * pooled, pooled);
        });
    }

    static void observe_backward(const execution_context& context, memory& m, input_view<T, Input> in,
                                 input_view<T, output> out, input_view<T, output> out_gradient) {
        const kernels::vector<T> zero(T{});
        norm::each_channel(context, in.lane_blocks(), [&](std::size_t b, std::size_t c) {
            const T *x = chosen_inputs(context, m, in, b, c), *y = out.lane_block(b) + c * pooled,
                    *dy = out_gradient.lane_block(b) + c * pooled;
            norm::observe_channel(m, context.first_lane_block + b, c, output.area(), [&](std::size_t i) {
                const kernels::vector<T> passed =
                    kernels::choose<T>(kernels::load(y + i) > zero, kernels::load(dy + i), zero);
                return std::array<kernels::vector<T>, 2>{kernels::load(x + i), passed};
            });
        });
    }
    static void begin_backward(const execution_context& context, const T* values, memory& m,
                               std::size_t samples) {
        norm::begin_backward(context, values, m, samples);
    }
    static void backward(const execution_context& context, const T* values, memory& m,
                         input_view<T, Input> in, input_view<T, output> out,
                         input_view<T, output> out_gradient, output_view<T, Input> in_gradient, T*) {
        if (in_gradient.data() == nullptr)
            return;
        norm::each_channel(context, in.lane_blocks(), [&](std::size_t b, std::size_t c) {
            kernels::normalised_pool_backward<window>(
                norm::gradient_rule(values, m, c), kernels::lanes_in_use<T>(in.samples_in(b)),
                in.lane_block(b) + c * plane, out.lane_block(b) + c * pooled,
                chosen_inputs(context, m, in, b, c), out_gradient.lane_block(b) + c * pooled,
                in_gradient.lane_block(b) + c * plane);
        });
    }
    static void end_backward(memory& m, T* gradients) { norm::end_backward(m, gradients); }

private:
    static constexpr std::size_t plane = Input.area() * kernels::lanes<T>,
                                 pooled = output.area() * kernels::lanes<T>;

    static T* chosen_by(const execution_context& context, memory& m, std::size_t b, std::size_t c) {
        return m.chosen.data() + ((context.first_lane_block + b) * Input.channels + c) * pooled;
    }
    /// The input that each output of a channel comes from.
    static const T* chosen_inputs(const execution_context& context, const memory& m, input_view<T, Input> in,
                                  std::size_t b, std::size_t c) {
        if constexpr (pools)
            return m.chosen.data() + ((context.first_lane_block + b) * Input.channels + c) * pooled;
        else
            return in.lane_block(b) + c * plane;
    }
};

namespace detail {

template <class Spec>
struct fused_norms {
    using type = Spec;
};

/// `Done` are the layers so far.
template <class Done, class... Specs>
struct fused_norms_list;
template <class... Done>
struct fused_norms_list<sequence<Done...>> {
    using type = sequence<Done...>;
};
template <class... Done, class Spec, class... Rest>
struct fused_norms_list<sequence<Done...>, Spec, Rest...>
    : fused_norms_list<sequence<Done..., typename fused_norms<Spec>::type>, Rest...> {};
template <class... Done, class... Rest>
struct fused_norms_list<sequence<Done...>, batch_norm, relu, Rest...>
    : fused_norms_list<sequence<Done..., norm_relu_pool<1>>, Rest...> {};
template <class... Done, extent2d Window, extent2d Stride, padding Padding, class... Rest>
struct fused_norms_list<sequence<Done...>, batch_norm, relu, max_pool<Window, Stride, Padding>, Rest...>
    : fused_norms_list<sequence<Done..., norm_relu_pool<Window, Stride, Padding>>, Rest...> {};

template <class... Specs>
struct fused_norms<sequence<Specs...>> : fused_norms_list<sequence<>, tactnet::without_name<Specs>...> {};
template <class Main, class Skip>
struct fused_norms<residual<Main, Skip>> {
    using type = residual<typename fused_norms<tactnet::without_name<Main>>::type,
                          typename fused_norms<tactnet::without_name<Skip>>::type>;
};

template <class... Branches>
struct fused_norms<concatenation<Branches...>> {
    using type = concatenation<typename fused_norms<tactnet::without_name<Branches>>::type...>;
};

} // namespace detail

/// The list to train: the same results and the same arrays in the same order, but each batch norm is fused
/// with the ReLU and max pool after it, which are bound by memory. Names are left out.
template <class List>
using with_fused_norms = typename detail::fused_norms<List>::type;

}} // namespace tactnet

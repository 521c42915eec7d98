#pragma once

#include <tactnet/kernels/batch/normalisation.hpp>
#include <tactnet/layers/batch_norm.hpp>
#include <tactnet/layers/max_pool.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Batch norm, ReLU and max pooling as one layer, with the same results and the arrays of the batch norm; a
/// window of one pixel stands for no pooling. Lists are written with the three: `fused` joins them. Of
/// different elements of a window that the norm rounds to the same number, the gradient goes to the largest
/// of them and not to the first.
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
        using norm = typename batch_norm::layer<T, Input>;
        using pool = typename max_pool<Window, Stride, Padding>::template layer<T, Input>;
        static constexpr shape output = pool::output; // which refuses a window that does not fit
        static constexpr bool by_parts = true, observes = true;
        static constexpr bool pools = Window.area() > 1 || Stride.area() > 1;

        struct memory : norm::memory {
            aligned_vector<T> chosen;           // by each window of the batch
            std::array<T, Input.channels> sign; // of the slope of each channel's norm
            void resize(std::size_t samples) {
                norm::memory::resize(samples);
                const std::size_t room = groups_of<T>(samples) * kernels::lanes<T> * output.size();
                if (pools && chosen.size() < room)
                    chosen.resize(room);
            }
        };

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            norm::describe(prefix, list);
        }
        static void prepare(const execution_context&, const T* values, const T*, memory& m) {
            for (std::size_t c = 0; c < Input.channels; ++c)
                m.sign[c] = static_cast<T>((values[c] > T{}) - (values[c] < T{}));
        }
        static void infer(const execution_context& p, const T* values, const T* running, memory& m,
                          input_view<T, Input> in, output_view<T, output> out) {
            norm::use_running(p, running, m);
            each_channel(p, in.lane_blocks(), [&](std::size_t g, std::size_t c) {
                kernels::normalised_pool_forward<window>(
                    norm::rule(values, m, c), in.lane_block(g) + c * plane, out.lane_block(g) + c * pooled);
            });
        }

        /// Windows choose here, while the map is still in the caches: of a large batch it is in memory when
        /// the moments are known.
        static void observe_forward(const execution_context& p, memory& m, input_view<T, Input> in) {
            each_channel(p, in.lane_blocks(), [&](std::size_t g, std::size_t c) {
                norm::observe_input(m, in, p.first_group, g, c);
                if constexpr (pools)
                    kernels::choose_for_pool<window>(m.sign[c], in.lane_block(g) + c * plane,
                                                     chosen_by(p, m, g, c));
            });
        }
        static void begin_forward(const execution_context& p, T* running, memory& m, std::size_t samples) {
            norm::begin_forward(p, running, m, samples);
        }
        static void forward(const execution_context& p, const T* values, T*, memory& m,
                            input_view<T, Input> in, output_view<T, output> out) {
            each_channel(p, in.lane_blocks(), [&](std::size_t g, std::size_t c) {
                kernels::normalise_and_rectify(norm::rule(values, m, c), inputs_behind(p, m, in, g, c),
                                               out.lane_block(g) + c * pooled, pooled);
            });
        }

        static void observe_backward(const execution_context& p, memory& m, input_view<T, Input> in,
                                     input_view<T, output> out, input_view<T, output> out_gradient) {
            const kernels::vector<T> zero(T{});
            each_channel(p, in.lane_blocks(), [&](std::size_t g, std::size_t c) {
                const T *x = inputs_behind(p, m, in, g, c), *y = out.lane_block(g) + c * pooled,
                        *dy = out_gradient.lane_block(g) + c * pooled;
                norm::observe_channel(m, p.first_group + g, c, output.area(), [&](std::size_t i) {
                    const kernels::vector<T> passed =
                        kernels::choose<T>(kernels::load(y + i) > zero, kernels::load(dy + i), zero);
                    return std::array<kernels::vector<T>, 2>{kernels::load(x + i), passed};
                });
            });
        }
        static void begin_backward(const execution_context& p, const T* values, memory& m,
                                   std::size_t samples) {
            norm::begin_backward(p, values, m, samples);
        }
        static void backward(const execution_context& p, const T* values, memory& m, input_view<T, Input> in,
                             input_view<T, output> out, input_view<T, output> out_gradient,
                             output_view<T, Input> in_gradient, T*) {
            if (in_gradient.data() == nullptr)
                return;
            each_channel(p, in.lane_blocks(), [&](std::size_t g, std::size_t c) {
                kernels::normalised_pool_backward<window>(
                    norm::gradient_rule(values, m, c), kernels::lanes_in_use<T>(in.samples_in(g)),
                    in.lane_block(g) + c * plane, out.lane_block(g) + c * pooled,
                    inputs_behind(p, m, in, g, c), out_gradient.lane_block(g) + c * pooled,
                    in_gradient.lane_block(g) + c * plane);
            });
        }
        static void end_backward(memory& m, T* gradients) { norm::end_backward(m, gradients); }

    private:
        static constexpr sliding_window window = pool::window;
        static constexpr std::size_t plane = Input.area() * kernels::lanes<T>,
                                     pooled = output.area() * kernels::lanes<T>;

        /// body(group, channel)
        template <class Body>
        static void each_channel(const execution_context& p, std::size_t groups, const Body& body) {
            p.threads.for_each(groups, [&](std::size_t g) {
                for (std::size_t c = 0; c < Input.channels; ++c)
                    body(g, c);
            });
        }
        static T* chosen_by(const execution_context& p, memory& m, std::size_t g, std::size_t c) {
            return m.chosen.data() + ((p.first_group + g) * Input.channels + c) * pooled;
        }
        /// Of each output of a channel the input that it was made of.
        static const T* inputs_behind(const execution_context& p, const memory& m, input_view<T, Input> in,
                                      std::size_t g, std::size_t c) {
            if constexpr (pools)
                return m.chosen.data() + ((p.first_group + g) * Input.channels + c) * pooled;
            else
                return in.lane_block(g) + c * plane;
        }
    };
};

} // namespace TACTNET_ARCH
} // namespace tactnet

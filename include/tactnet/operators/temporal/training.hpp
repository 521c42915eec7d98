#pragma once

#include <tactnet/kernels/batch/lane_products.hpp>
#include <tactnet/operators/temporal/cells.hpp>
#include <tactnet/operators/temporal/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

template <class Cell, std::size_t Hidden, class T, shape Input>
struct trained_layer<recurrent<Cell, Hidden>, T, Input> : trained_base<recurrent<Cell, Hidden>, T, Input> {
    using base = trained_base<recurrent<Cell, Hidden>, T, Input>;
    using base::features;
    using base::frames;
    using base::hidden_biases;
    using base::hidden_weights;
    using base::input_biases;
    using base::output;
    static constexpr std::size_t rows = recurrent<Cell, Hidden>::rows;
    /// For each lane block. Inference uses those of the first line, for one frame at a time.
    struct memory {
        aligned_vector<T> inputs, sums, states, kept; // states before the first frame, too
        aligned_vector<T> input_gates, hidden_gates;  // gradients
        aligned_vector<double> totals;
        void resize(std::size_t samples) {
            const std::size_t blocks = lane_blocks_of<T>(samples);
            detail::grow(inputs, blocks * input_size);
            detail::grow(sums, blocks * 2 * gate_size);
            detail::grow(states, blocks * state_size);
            detail::grow(kept, blocks * kept_size);
        }
    };

    static void infer(const execution_context& context, const T* values, const T*, memory& m,
                      input_view<T, Input> in, output_view<T, output> out) {
        context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
            T* const state = m.states.data() + b * state_size;
            T* const x = m.inputs.data() + b * input_size;
            std::fill_n(state, state_size, T{});
            for (std::size_t frame = 0; frame < frames; ++frame) {
                detail::read_frame<Input>(in.lane_block(b), frame, x);
                update_state(values, x, m.sums.data() + b * 2 * gate_size, state,
                             m.kept.data() + b * kept_size);
                detail::write_frame<output>(state, frame, out.lane_block(b));
            }
        });
    }
    static void forward(const execution_context& context, const T* values, T*, memory& m,
                        input_view<T, Input> in, output_view<T, output> out) {
        const std::size_t all = in.lane_blocks() * frames;
        detail::grow(m.inputs, all * input_size);
        detail::grow(m.states, (all + in.lane_blocks()) * state_size);
        detail::grow(m.kept, all * kept_size);
        context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
            T* state = m.states.data() + b * (frames + 1) * state_size;
            std::fill_n(state, state_size, T{});
            for (std::size_t frame = 0; frame < frames; ++frame, state += state_size) {
                T* const x = m.inputs.data() + (b * frames + frame) * input_size;
                detail::read_frame<Input>(in.lane_block(b), frame, x);
                std::copy_n(state, state_size, state + state_size);
                update_state(values, x, m.sums.data() + b * 2 * gate_size, state + state_size,
                             m.kept.data() + (b * frames + frame) * kept_size);
                detail::write_frame<output>(state + state_size, frame, out.lane_block(b));
            }
        });
    }
    /// Back-propagation through time, from the last frame to the first.
    static void backward(const execution_context& context, const T* values, memory& m,
                         input_view<T, Input> in, input_view<T, output>, input_view<T, output> out_gradient,
                         output_view<T, Input> in_gradient, T* gradients) {
        const std::size_t blocks = in.lane_blocks();
        detail::grow(m.input_gates, blocks * frames * gate_size);
        detail::grow(m.hidden_gates, blocks * frames * gate_size);
        context.threads.for_each(blocks, [&](std::size_t b) {
            T* const to = in_gradient.data() ? in_gradient.lane_block(b) : nullptr;
            go_back(values, m, b, out_gradient.lane_block(b), to);
        });
        const auto inputs = [&](std::size_t i) { return m.inputs.data() + i * input_size; };
        const auto states_before = [&](std::size_t i) {
            return m.states.data() + (i + i / frames) * state_size;
        };
        const auto of_inputs = [&](std::size_t i) { return m.input_gates.data() + i * gate_size; };
        const auto of_states = [&](std::size_t i) { return m.hidden_gates.data() + i * gate_size; };
        kernels::sum_weight_gradients<rows, features>(context.threads, blocks * frames, inputs, of_inputs,
                                                      gradients, gradients + input_biases, m.totals);
        kernels::sum_weight_gradients<rows, Hidden>(context.threads, blocks * frames, states_before,
                                                    of_states, gradients + hidden_weights,
                                                    gradients + hidden_biases, m.totals);
    }

private:
    static constexpr std::size_t lanes = kernels::lanes<T>, units = Hidden * lanes;
    static constexpr std::size_t input_size = features * lanes, gate_size = Cell::gates * units,
                                 state_size = Cell::states * units, kept_size = Cell::kept_count * units;

    /// Updates the state of a lane block by one frame.
    static void update_state(const T* values, const T* x, T* sums, T* state, T* kept) {
        const auto put = [&](T* to, const T* biases) {
            return [=](std::size_t row, const kernels::vector<T>& sum) {
                kernels::store(to + row * lanes, sum + kernels::vector<T>(biases[row]));
            };
        };
        kernels::lane_product<rows, features, kernels::matrix_layout{features, 1}>(
            values, x, put(sums, values + input_biases));
        kernels::lane_product<rows, Hidden, kernels::matrix_layout{Hidden, 1}>(
            values + hidden_weights, state, put(sums + gate_size, values + hidden_biases));
        detail::update_cells<Cell>(units, sums, sums + gate_size, state, kept);
    }

    static void go_back(const T* values, memory& m, std::size_t block, const T* out_gradient,
                        T* in_gradient) {
        // The sums of the forward pass are no longer needed: there is room for the gradient of the state.
        static_assert(Cell::states <= 2 * Cell::gates);
        T* const gradient = m.sums.data() + block * 2 * gate_size;
        std::fill_n(gradient, state_size, T{});
        for (std::size_t frame = frames; frame-- > 0;) {
            const std::size_t at = block * frames + frame;
            const T* const kept = m.kept.data() + at * kept_size;
            const T* const before = m.states.data() + (at + block) * state_size;
            T* const of_inputs = m.input_gates.data() + at * gate_size;
            T* const of_states = m.hidden_gates.data() + at * gate_size;
            for (std::size_t h = 0; h < Hidden; ++h)
                kernels::store(gradient + h * lanes,
                               kernels::load(gradient + h * lanes) +
                                   kernels::load(out_gradient + (h * frames + frame) * lanes));
            for (std::size_t i = 0; i < units; i += detail::cell_lanes<T>) {
                auto state = detail::load_cell<Cell::states>(gradient + i, units);
                std::array<detail::cell_number<T>, Cell::gates> input_gates, hidden_gates;
                Cell::backward(detail::load_cell<Cell::kept_count>(kept + i, units),
                               detail::load_cell<Cell::states>(before + i, units), state, input_gates,
                               hidden_gates);
                detail::store_cell(state, gradient + i, units);
                detail::store_cell(input_gates, of_inputs + i, units);
                detail::store_cell(hidden_gates, of_states + i, units);
            }
            kernels::lane_product<Hidden, rows, kernels::matrix_layout{1, Hidden}>(
                values + hidden_weights, of_states, [&](std::size_t h, const kernels::vector<T>& sum) {
                    kernels::store(gradient + h * lanes, kernels::load(gradient + h * lanes) + sum);
                });
            if (in_gradient)
                kernels::lane_product<features, rows, kernels::matrix_layout{1, features}>(
                    values, of_inputs, [&](std::size_t f, const kernels::vector<T>& sum) {
                        kernels::store(in_gradient + (f * frames + frame) * lanes, sum);
                    });
        }
    }
};

template <class T, shape Input>
struct trained_layer<last_frame, T, Input> : lane_block_layer<last_frame, T, Input> {
    static void forward_block(const T* in, T* out) { detail::read_frame<Input>(in, Input.rows - 1, out); }
    static void backward_block(const T*, const T*, const T* out_gradient, T* in_gradient) {
        std::fill_n(in_gradient, Input.size() * kernels::lanes<T>, T{});
        detail::write_frame<Input>(out_gradient, Input.rows - 1, in_gradient);
    }
};

template <std::size_t Filters, std::size_t Taps, std::size_t Dilation, class T, shape Input>
struct trained_layer<causal_conv1d<Filters, Taps, Dilation>, T, Input>
    : trained_base<causal_conv1d<Filters, Taps, Dilation>, T, Input> {
    using base = trained_base<causal_conv1d<Filters, Taps, Dilation>, T, Input>;
    using base::biases;
    using base::features;
    using base::frames;
    using base::inputs;
    using base::output;
    /// For each lane block: the inputs of an output, in training of each frame, and gradients.
    struct memory {
        aligned_vector<T> inputs, gradients;
        aligned_vector<double> totals;
        void resize(std::size_t samples) { detail::grow(inputs, lane_blocks_of<T>(samples) * input_size); }
    };

    static void infer(const execution_context& context, const T* values, const T*, memory& m,
                      input_view<T, Input> in, output_view<T, output> out) {
        compute(context, values, m, 1, in, out);
    }
    static void forward(const execution_context& context, const T* values, T*, memory& m,
                        input_view<T, Input> in, output_view<T, output> out) {
        detail::grow(m.inputs, in.lane_blocks() * frames * input_size);
        compute(context, values, m, frames, in, out);
    }
    static void backward(const execution_context& context, const T* values, memory& m,
                         input_view<T, Input> in, input_view<T, output>, input_view<T, output> out_gradient,
                         output_view<T, Input> in_gradient, T* gradients) {
        const std::size_t blocks = in.lane_blocks();
        detail::grow(m.gradients, blocks * frames * output_size);
        context.threads.for_each(blocks, [&](std::size_t b) {
            T* const to = in_gradient.data() ? in_gradient.lane_block(b) : nullptr;
            if (to)
                std::fill_n(to, in_gradient.lane_block_size, T{});
            for (std::size_t frame = 0; frame < frames; ++frame) {
                T* const of_outputs = m.gradients.data() + (b * frames + frame) * output_size;
                detail::read_frame<output>(out_gradient.lane_block(b), frame, of_outputs);
                if (to)
                    add_input_gradients(values, of_outputs, frame, to);
            }
        });
        kernels::sum_weight_gradients<Filters, inputs>(
            context.threads, blocks * frames, [&](std::size_t i) { return m.inputs.data() + i * input_size; },
            [&](std::size_t i) { return m.gradients.data() + i * output_size; }, gradients,
            gradients + biases, m.totals);
    }

private:
    static constexpr std::size_t lanes = kernels::lanes<T>, input_size = inputs * lanes,
                                 output_size = Filters * lanes;

    /// Keeps the inputs of `kept` frames of each lane block.
    static void compute(const execution_context& context, const T* values, memory& m, std::size_t kept,
                        input_view<T, Input> in, output_view<T, output> out) {
        context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
            for (std::size_t frame = 0; frame < frames; ++frame) {
                T* const x = m.inputs.data() + (b * kept + frame % kept) * input_size;
                gather(in.lane_block(b), frame, x);
                kernels::lane_product<Filters, inputs, kernels::matrix_layout{inputs, 1}>(
                    values, x, [&](std::size_t o, const kernels::vector<T>& sum) {
                        kernels::store(out.lane_block(b) + (o * frames + frame) * lanes,
                                       sum + kernels::vector<T>(values[biases + o]));
                    });
            }
        });
    }
    /// Calls body(index of feature and tap, frame) for all inputs of a frame's output. A frame from
    /// `frames` on lies before the first.
    static void for_each_input(std::size_t frame, const auto& body) {
        for (std::size_t feature = 0; feature < features; ++feature)
            for (std::size_t tap = 0; tap < Taps; ++tap)
                body(feature * Taps + tap, feature, frame - (Taps - 1 - tap) * Dilation);
    }
    static void gather(const T* in, std::size_t frame, T* to) {
        for_each_input(frame, [&](std::size_t i, std::size_t feature, std::size_t from) {
            kernels::store(to + i * lanes, from < frames
                                               ? kernels::load(in + (feature * frames + from) * lanes)
                                               : kernels::vector<T>(T{}));
        });
    }
    static void add_input_gradients(const T* values, const T* of_outputs, std::size_t frame, T* to) {
        kernels::lane_product<inputs, Filters, kernels::matrix_layout{1, inputs}>(
            values, of_outputs, [&](std::size_t i, const kernels::vector<T>& sum) {
                const std::size_t from = frame - (Taps - 1 - i % Taps) * Dilation;
                if (from < frames) {
                    T* const at = to + (i / Taps * frames + from) * lanes;
                    kernels::store(at, kernels::load(at) + sum);
                }
            });
    }
};

}} // namespace tactnet

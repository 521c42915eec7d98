#pragma once

#include <tactnet/detail/indices.hpp>
#include <tactnet/operators/sequence/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace tactnet { inline namespace TACTNET_ARCH {

// In training, the layers of a list form stages, divided where a layer must see the whole batch. Within a
// stage the batch is processed in parts, a lane block for each thread, so that each layer finds the output of
// the one before in the caches. Sums over the batch add one lane block after the other in any case, so
// results do not depend on the parts.

namespace detail {

/// Where the stages of a list begin and end. Forward, a stage is the layers begin … end − 1 in this order; in
/// the backward pass, end − 1 … begin.
template <class List>
class stages {
    static constexpr std::size_t size = List::size;
    struct flags {
        bool by_parts, observes;
    };
    static constexpr auto layers = []<std::size_t... I>(std::index_sequence<I...>) {
        return std::array<flags, size>{{{List::template at<I>::by_parts, List::template at<I>::observes}...}};
    }(std::make_index_sequence<size>{});

    /// Whether one of layer i and its predecessor must finish a batch before `next`, the other one, begins.
    static constexpr bool waits(std::size_t i, std::size_t next) {
        return layers[next].observes || !layers[i].by_parts || !layers[i - 1].by_parts;
    }

public:
    static constexpr bool starts_forward(std::size_t begin) { return begin == 0 || waits(begin, begin); }
    static constexpr std::size_t forward_end(std::size_t begin) {
        std::size_t end = begin + 1;
        while (end < size && !starts_forward(end))
            ++end;
        return end;
    }
    /// Whether a stage of the backward pass begins with layer end − 1.
    static constexpr bool starts_backward(std::size_t end) { return end == size || waits(end, end - 1); }
    static constexpr std::size_t backward_begin(std::size_t end) {
        std::size_t begin = end - 1;
        while (begin > 0 && !starts_backward(begin))
            --begin;
        return begin;
    }
};

} // namespace detail

/// Calls body(context, first, last) for the lane blocks first … last − 1 of each part of a batch, or once for
/// all of them.
template <bool ByParts, class Body>
void for_each_part(const execution_context& context, std::size_t lane_blocks, const Body& body) {
    if constexpr (!ByParts)
        return body(context, 0, lane_blocks);
    const std::size_t most = context.threads.threads();
    for (std::size_t first = 0; first < lane_blocks; first += most) {
        execution_context part = context;
        part.first_lane_block = first;
        body(part, first, std::min(first + most, lane_blocks));
    }
}

template <class... Specs, class T, shape Input>
struct trained_layer<sequence<Specs...>, T, Input> : trained_base<sequence<Specs...>, T, Input> {
private:
    using list = trained_base<sequence<Specs...>, T, Input>;
    using staged = detail::stages<trained_layer>;
    template <std::size_t I>
    using spec = typename decltype(detail::type_at<I>(
        std::declval<detail::indexed_leaves<std::type_identity<detail::checked<Specs>>...>>()))::type;

public:
    using list::output, list::size;
    template <std::size_t I>
    using at = trained_layer<spec<I>, T, list::template at<I>::input>;

    struct memory {
        std::array<aligned_vector<T>, size> outputs;
        std::array<aligned_vector<T>, 2> stage_gradients; // of whole batches, from stage to stage
        std::array<aligned_vector<T>, 2> gradients;       // of a part of a batch, from layer to layer
        std::size_t samples = 0;
        template <std::size_t... I>
        static auto inner_of(std::index_sequence<I...>) -> detail::indexed_leaves<typename at<I>::memory...>;
        /// The memory of the layers inside.
        decltype(inner_of(std::make_index_sequence<size>{})) inner;

        /// Keeps the contents when it shrinks.
        void resize(std::size_t count) {
            samples = count;
            kernels::unroll<size>([&](auto i) {
                if constexpr (list::source(i) == i && !list::is_last(i))
                    detail::grow(outputs[i], kernels::padded_size<T>(count) * at<i>::output.size());
                detail::get<i>(inner).resize(count);
            });
        }
        void make_room_for_gradients(std::size_t lane_blocks, std::size_t threads) {
            const std::size_t at_once = std::min(lane_blocks, threads);
            kernels::unroll<size>([&](auto i) {
                for (aligned_vector<T>& g : gradients)
                    detail::grow(g, at_once * kernels::lanes<T> * at<i>::input.size());
                if constexpr (i > 0)
                    if constexpr (staged::starts_backward(i))
                        for (aligned_vector<T>& g : stage_gradients)
                            detail::grow(g, lane_blocks * kernels::lanes<T> * at<i>::input.size());
            });
        }
    };

    static void prepare(const execution_context& context, const T* values, const T* running, memory& m) {
        kernels::unroll<size>([&](auto i) {
            static_assert(
                batch_layer<at<i>>,
                "network: a layer of this kind has no functions for batches: include "
                "tactnet/training.hpp, or "
                "specialise trained_layer for a layer of your own; batch_layer shows what is missing");
            static_assert(!batch_layer<at<i>> || listed_layer<at<i>>,
                          "sequence: expected a layer that works by parts or on whole batches; part_layer "
                          "shows what is missing");
            at<i>::prepare(context, values + list::template parameter_offset<i>,
                           running + list::template statistic_offset<i>, detail::get<i>(m.inner));
        });
    }
    static void infer(const execution_context& context, const T* values, const T* running, memory& m,
                      input_view<T, Input> in, output_view<T, output> out) {
        if constexpr (size == 0)
            copy(context, in, out);
        kernels::unroll<size>([&](auto i) {
            at<i>::infer(context.of_inner(i), values + list::template parameter_offset<i>,
                         running + list::template statistic_offset<i>, detail::get<i>(m.inner),
                         input_of<i>(m, in, out), output_of<i>(m, out));
        });
    }
    static void forward(const execution_context& context, const T* values, T* running, memory& m,
                        input_view<T, Input> in, output_view<T, output> out) {
        if constexpr (size == 0)
            copy(context, in, out);
        else if constexpr (at<0>::observes)
            forward_stage<0, 0>(context, values, running, m, in, out);
        kernels::unroll<size>([&](auto begin) {
            if constexpr (staged::starts_forward(begin))
                forward_stage<begin, staged::forward_end(begin)>(context, values, running, m, in, out);
        });
    }
    static void backward(const execution_context& context, const T* values, memory& m,
                         input_view<T, Input> in, input_view<T, output> out,
                         input_view<T, output> out_gradient, output_view<T, Input> in_gradient,
                         T* gradients) {
        m.make_room_for_gradients(in.lane_blocks(), context.threads.threads());
        const T* from = out_gradient.data();
        if constexpr (size == 0) {
            if (in_gradient.data() != nullptr)
                copy(context, out_gradient, in_gradient);
        } else if constexpr (at<size - 1>::observes) {
            backward_stage<size, size>(context, values, m, in, out, from, nullptr, gradients);
        }
        std::size_t stages = 0;
        kernels::unroll<size>([&](auto reversed) {
            constexpr std::size_t end = size - reversed;
            if constexpr (staged::starts_backward(end)) {
                constexpr std::size_t begin = staged::backward_begin(end);
                T* to = begin == 0 ? in_gradient.data() : m.stage_gradients[stages++ % 2].data();
                backward_stage<begin, end>(context, values, m, in, out, from, to, gradients);
                from = to;
            }
        });
    }

private:
    template <std::size_t Begin, std::size_t End, class Body>
    static void for_each_part_layer(const Body& body) {
        kernels::unroll<End - Begin>([&](auto offset) {
            if constexpr (at<Begin + offset>::by_parts)
                body(kernels::constant<Begin + offset>{});
        });
    }

    /// Computes the layers Begin … End − 1, and shows layer End each part that it must see. A stage
    /// without layers only shows.
    template <std::size_t Begin, std::size_t End>
    static void forward_stage(const execution_context& context, const T* values, T* running, memory& m,
                              input_view<T, Input> in, output_view<T, output> out) {
        for_each_part_layer<Begin, End>([&](auto i) {
            at<i>::begin_forward(context, running + list::template statistic_offset<i>,
                                 detail::get<i>(m.inner), in.samples());
        });
        for_each_part<at<Begin>::by_parts>(
            context, in.lane_blocks(),
            [&](const execution_context& part, std::size_t first, std::size_t last) {
                kernels::unroll<End - Begin>([&](auto offset) {
                    constexpr std::size_t i = Begin + offset;
                    at<i>::forward(part.of_inner(i), values + list::template parameter_offset<i>,
                                   running + list::template statistic_offset<i>, detail::get<i>(m.inner),
                                   input_of<i>(m, in, out).part(first, last),
                                   output_of<i>(m, out).part(first, last));
                });
                if constexpr (End < size)
                    if constexpr (at<End>::observes)
                        at<End>::observe_forward(part, detail::get<End>(m.inner),
                                                 input_of<End>(m, in, out).part(first, last));
            });
    }
    /// Computes the backward pass of the layers End − 1 … Begin, and shows layer Begin − 1 each part that
    /// it must see. `from` and `to` are gradients of whole batches.
    template <std::size_t Begin, std::size_t End>
    static void backward_stage(const execution_context& context, const T* values, memory& m,
                               input_view<T, Input> in, input_view<T, output> out, const T* from, T* to,
                               T* gradients) {
        for_each_part_layer<Begin, End>([&](auto i) {
            at<i>::begin_backward(context, values + list::template parameter_offset<i>,
                                  detail::get<i>(m.inner), in.samples());
        });
        for_each_part<at<End - 1>::by_parts>(
            context, in.lane_blocks(),
            [&](const execution_context& part, std::size_t first, std::size_t last) {
                input_view<T, at<End - 1>::output> whole(from, in.samples());
                const std::size_t samples = whole.part(first, last).samples();
                const T* above = whole.part(first, last).data();
                kernels::unroll<End - Begin>([&](auto offset) {
                    constexpr std::size_t i = End - 1 - offset;
                    output_view<T, at<i>::input> below(m.gradients[i % 2].data(), samples);
                    if constexpr (i == Begin)
                        below = output_view<T, at<i>::input>(to, in.samples()).part(first, last);
                    at<i>::backward(part.of_inner(i), values + list::template parameter_offset<i>,
                                    detail::get<i>(m.inner), input_of<i>(m, in, out).part(first, last),
                                    output_of<i>(m, out).part(first, last),
                                    input_view<T, at<i>::output>(above, samples), below,
                                    gradients + list::template parameter_offset<i>);
                    above = below.data();
                });
                if constexpr (Begin > 0)
                    if constexpr (at<Begin - 1>::observes)
                        at<Begin - 1>::observe_backward(part, detail::get<Begin - 1>(m.inner),
                                                        input_of<Begin - 1>(m, in, out).part(first, last),
                                                        output_of<Begin - 1>(m, out).part(first, last),
                                                        {above, samples});
            });
        for_each_part_layer<Begin, End>([&](auto i) {
            at<i>::end_backward(detail::get<i>(m.inner), gradients + list::template parameter_offset<i>);
        });
    }

    template <shape Shape>
    static void copy(const execution_context& context, input_view<T, Shape> from, output_view<T, Shape> to) {
        context.threads.for_each(from.lane_blocks(), [&](std::size_t b) {
            std::copy_n(from.lane_block(b), from.lane_block_size, to.lane_block(b));
        });
    }
    /// The output of layer I, to write or to read as `out`, the output of the list.
    template <std::size_t I, template <class, shape> class View>
    static View<T, at<I>::output> output_of(memory& m, View<T, output> out) {
        if constexpr (list::is_last(I))
            return {out.data(), out.samples()};
        else
            return {m.outputs[list::source(I)].data(), out.samples()};
    }
    template <std::size_t I, template <class, shape> class View>
    static input_view<T, at<I>::input> input_of(memory& m, input_view<T, Input> in, View<T, output> out) {
        if constexpr (I == 0)
            return in;
        else
            return output_of<I - 1>(m, out);
    }
};

template <name_text Name, class Spec, class T, shape Input>
struct trained_layer<named<Name, Spec>, T, Input> : trained_layer<Spec, T, Input> {};

}} // namespace tactnet

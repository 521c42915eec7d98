#pragma once

#include <tactnet/kernels/unroll.hpp>
#include <tactnet/layers/chain.hpp>
#include <tactnet/layers/layer.hpp>

#include <algorithm>
#include <array>
#include <string>

namespace tactnet::inline TACTNET_ARCH {

/// Layers one after the other, as one layer. Without any it passes its input on.
///
/// In training, layers form stages between those that must see the whole batch. Within a stage the batch
/// passes by parts, a group of samples for each thread: what a layer writes the next one finds in the caches.
/// Sums over the batch are added group after group in any case, so results do not depend on the parts.
template <class... Specs>
struct sequence {
    static constexpr std::string_view name = "";
    static constexpr bool numbered = true;
    static constexpr std::size_t size = sizeof...(Specs);

    template <class T, shape Input>
    class layer {
        using chained = detail::chain<T, Input, detail::indexed_leaves<>, Specs...>;
        template <std::size_t I>
        using place = decltype(detail::type_at<I>(std::declval<typename chained::layers>()));

    public:
        template <std::size_t I>
        using at = typename place<I>::type;
        /// Where the arrays of layer I begin in those of the list.
        template <std::size_t I>
        static constexpr std::size_t parameter_offset = place<I>::parameter_offset;
        template <std::size_t I>
        static constexpr std::size_t statistic_offset = place<I>::statistic_offset;

        using value_type = T;
        static constexpr shape input = Input, output = chained::output;
        static constexpr bool in_place = false, by_parts = false, observes = false;
        static constexpr bool keeps_output = [] {
            if constexpr (size > 0)
                return at<size - 1>::keeps_output;
            else
                return false;
        }();

    private:
        template <class Value>
        static constexpr std::size_t sum_of(Value value) {
            std::size_t sum = 0;
            unroll<size>([&](auto i) { sum += value(i); });
            return sum;
        }
        /// Whether layer I may write over its input: it must be the list's own, and not needed behind it.
        template <std::size_t I>
        static constexpr bool overwrites() {
            if constexpr (I == 0)
                return false;
            else
                return at<I>::in_place && !at<I - 1>::keeps_output;
        }
        template <std::size_t I>
        static constexpr std::size_t source() { // the layer whose buffer holds the output of layer I
            if constexpr (overwrites<I>())
                return source<I - 1>();
            else
                return I;
        }
        /// Outputs of the list are the caller's memory, all others its own.
        template <std::size_t I>
        static constexpr bool is_last() {
            return source<I>() == source<size - 1>();
        }

    public:
        static constexpr std::size_t parameters = sum_of([](auto i) { return at<i>::parameters; });
        static constexpr std::size_t statistics = sum_of([](auto i) { return at<i>::statistics; });
        static constexpr std::size_t multiply_adds = sum_of([](auto i) { return at<i>::multiply_adds; });
        static constexpr std::size_t multiply_adds_on_pixels =
            sum_of([](auto i) { return at<i>::multiply_adds_on_pixels; });
        /// Elements that must be held at once while one sample passes layer by layer, beside input and
        /// output.
        static constexpr std::size_t inner_activations = [] {
            std::size_t most = 0;
            unroll<size>([&](auto i) {
                const std::size_t before = i == 0 ? 0 : at<i>::input.size();
                const std::size_t after = is_last<i>() ? 0 : overwrites<i>() ? 0 : at<i>::output.size();
                most = std::max(most, before + after + at<i>::inner_activations);
            });
            return most;
        }();

        struct memory {
            std::array<aligned_vector<T>, size> outputs;
            std::array<aligned_vector<T>, 2> stage_gradients; // of whole batches, from stage to stage
            std::array<aligned_vector<T>, 2> gradients;       // of a part of a batch, from layer to layer
            std::size_t samples = 0;
            template <std::size_t... I>
            static auto inner_of(std::index_sequence<I...>)
                -> detail::indexed_leaves<typename at<I>::memory...>;
            decltype(inner_of(std::make_index_sequence<size>{})) inner;

            /// Keeps what is there when it gets less.
            void resize(std::size_t count) {
                samples = count;
                unroll<size>([&](auto i) {
                    if constexpr (source<i>() == i && !is_last<i>())
                        grow(outputs[i], groups_of<T>(count) * lanes<T> * at<i>::output.size());
                    detail::get<i>(inner).resize(count);
                });
            }
            void make_room_for_gradients(std::size_t threads) {
                const std::size_t groups = groups_of<T>(samples), at_once = std::min(groups, threads);
                unroll<size>([&](auto i) {
                    for (aligned_vector<T>& g : gradients)
                        grow(g, at_once * lanes<T> * at<i>::input.size());
                    if constexpr (i > 0)
                        if constexpr (starts_backward_stage<i>())
                            for (aligned_vector<T>& g : stage_gradients)
                                grow(g, groups * lanes<T> * at<i>::input.size());
                });
            }

        private:
            static void grow(aligned_vector<T>& elements, std::size_t count) {
                if (elements.size() < count)
                    elements.resize(count);
            }
        };

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            std::array<std::string_view, size> kinds{};
            unroll<size>([&](auto i) { kinds[i] = spec_name<i>; });
            unroll<size>([&](auto i) {
                const auto before = std::count(kinds.begin(), kinds.begin() + i, kinds[i]);
                const auto all = std::count(kinds.begin(), kinds.end(), kinds[i]);
                std::string full =
                    prefix.empty() ? std::string(kinds[i]) : prefix + "." + std::string(kinds[i]);
                if (spec_numbered<i> || all > 1)
                    full += std::to_string(before + 1);
                const std::size_t first = list.size();
                at<i>::describe(full, list);
                for (std::size_t p = first; p < list.size(); ++p)
                    list[p].offset +=
                        learnable(list[p].what) ? place<i>::parameter_offset : place<i>::statistic_offset;
            });
        }

        static void prepare(const pass& p, const T* values, const T* running, memory& m) {
            unroll<size>([&](auto i) {
                at<i>::prepare(p, values + place<i>::parameter_offset, running + place<i>::statistic_offset,
                               detail::get<i>(m.inner));
            });
        }
        static void infer(const pass& p, const T* values, const T* running, memory& m,
                          input_view<T, Input> in, output_view<T, output> out) {
            if constexpr (size == 0)
                copy(p, in, out);
            unroll<size>([&](auto i) {
                at<i>::infer(at_depth(p, i), values + place<i>::parameter_offset,
                             running + place<i>::statistic_offset, detail::get<i>(m.inner),
                             input_of<i>(m, in, out), output_of<i>(m, out));
            });
        }
        static void forward(const pass& p, const T* values, T* running, memory& m, input_view<T, Input> in,
                            output_view<T, output> out) {
            if constexpr (size == 0)
                copy(p, in, out);
            else if constexpr (at<0>::observes)
                forward_stage<0, 0>(p, values, running, m, in, out);
            unroll<size>([&](auto begin) {
                if constexpr (starts_forward_stage<begin>())
                    forward_stage<begin, forward_stage_end<begin>()>(p, values, running, m, in, out);
            });
        }
        static void backward(const pass& p, const T* values, memory& m, input_view<T, Input> in,
                             input_view<T, output> out, input_view<T, output> out_gradient,
                             output_view<T, Input> in_gradient, T* gradients) {
            m.make_room_for_gradients(p.threads.threads());
            const output_view<T, output> result(const_cast<T*>(out.data()),
                                                out.samples()); // only read from here on
            const T* from = out_gradient.data();
            if constexpr (size == 0) {
                if (in_gradient.data() != nullptr)
                    copy(p, out_gradient, in_gradient);
            } else if constexpr (at<size - 1>::observes) {
                backward_stage<size, size>(p, values, m, in, result, from, nullptr, gradients);
            }
            std::size_t stages = 0;
            unroll<size>([&](auto reversed) {
                constexpr std::size_t end = size - reversed;
                if constexpr (starts_backward_stage<end>()) {
                    constexpr std::size_t begin = backward_stage_begin<end>();
                    T* to = begin == 0 ? in_gradient.data() : m.stage_gradients[stages++ % 2].data();
                    backward_stage<begin, end>(p, values, m, in, result, from, to, gradients);
                    from = to;
                }
            });
        }

    private:
        /// Whether all of a batch must be through one of layer I and its predecessor before any of it goes to
        /// `Next`, the other one.
        template <std::size_t I, std::size_t Next>
        static constexpr bool waits() {
            return at<Next>::observes || !at<I>::by_parts || !at<I - 1>::by_parts;
        }
        template <std::size_t Begin>
        static constexpr bool starts_forward_stage() {
            if constexpr (Begin == 0)
                return true;
            else
                return waits<Begin, Begin>();
        }
        template <std::size_t Begin>
        static constexpr std::size_t forward_stage_end() {
            if constexpr (Begin + 1 == size)
                return size;
            else if constexpr (starts_forward_stage<Begin + 1>())
                return Begin + 1;
            else
                return forward_stage_end<Begin + 1>();
        }
        /// Whether the way back begins a stage with layer End − 1.
        template <std::size_t End>
        static constexpr bool starts_backward_stage() {
            if constexpr (End == size)
                return true;
            else
                return waits<End, End - 1>();
        }
        template <std::size_t End>
        static constexpr std::size_t backward_stage_begin() {
            if constexpr (End == 1)
                return 0;
            else if constexpr (starts_backward_stage<End - 1>())
                return End - 1;
            else
                return backward_stage_begin<End - 1>();
        }

        /// body(pass, first, last) for the parts of a batch.
        template <bool ByParts, class Body>
        static void for_each_part(const pass& p, std::size_t groups, const Body& body) {
            const std::size_t most = ByParts ? p.threads.threads() : std::max<std::size_t>(groups, 1);
            for (std::size_t first = 0; first < groups; first += most) {
                pass part = p;
                part.first_group = first;
                body(part, first, std::min(first + most, groups));
            }
        }
        template <std::size_t Begin, std::size_t End, class Body>
        static void for_each_part_layer(const Body& body) {
            unroll<End - Begin>([&](auto offset) {
                if constexpr (at<Begin + offset>::by_parts)
                    body(constant<Begin + offset>{});
            });
        }

        /// Layers Begin … End − 1, and what layer End must see of each part. Stages without a layer only
        /// show.
        template <std::size_t Begin, std::size_t End>
        static void forward_stage(const pass& p, const T* values, T* running, memory& m,
                                  input_view<T, Input> in, output_view<T, output> out) {
            for_each_part_layer<Begin, End>([&](auto i) {
                at<i>::begin_forward(p, running + place<i>::statistic_offset, detail::get<i>(m.inner),
                                     in.samples());
            });
            for_each_part<at<Begin>::by_parts>(
                p, in.groups(), [&](const pass& part, std::size_t first, std::size_t last) {
                    unroll<End - Begin>([&](auto offset) {
                        constexpr std::size_t i = Begin + offset;
                        at<i>::forward(at_depth(part, i), values + place<i>::parameter_offset,
                                       running + place<i>::statistic_offset, detail::get<i>(m.inner),
                                       input_of<i>(m, in, out).part(first, last),
                                       output_of<i>(m, out).part(first, last));
                    });
                    if constexpr (End < size)
                        if constexpr (at<End>::observes)
                            at<End>::observe_forward(part, detail::get<End>(m.inner),
                                                     input_of<End>(m, in, out).part(first, last));
                });
        }
        /// Layers End − 1 … Begin, and what layer Begin − 1 must see of each part. `from` and `to` are
        /// gradients of whole batches.
        template <std::size_t Begin, std::size_t End>
        static void backward_stage(const pass& p, const T* values, memory& m, input_view<T, Input> in,
                                   output_view<T, output> out, const T* from, T* to, T* gradients) {
            for_each_part_layer<Begin, End>([&](auto i) {
                at<i>::begin_backward(p, values + place<i>::parameter_offset, detail::get<i>(m.inner),
                                      in.samples());
            });
            for_each_part<at<End - 1>::by_parts>(
                p, in.groups(), [&](const pass& part, std::size_t first, std::size_t last) {
                    input_view<T, at<End - 1>::output> whole(from, in.samples());
                    const std::size_t samples = whole.part(first, last).samples();
                    const T* above = whole.part(first, last).data();
                    unroll<End - Begin>([&](auto offset) {
                        constexpr std::size_t i = End - 1 - offset;
                        output_view<T, at<i>::input> below(m.gradients[i % 2].data(), samples);
                        if constexpr (i == Begin)
                            below = output_view<T, at<i>::input>(to, in.samples()).part(first, last);
                        at<i>::backward(at_depth(part, i), values + place<i>::parameter_offset,
                                        detail::get<i>(m.inner), input_of<i>(m, in, out).part(first, last),
                                        output_of<i>(m, out).part(first, last),
                                        input_view<T, at<i>::output>(above, samples), below,
                                        gradients + place<i>::parameter_offset);
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
                at<i>::end_backward(detail::get<i>(m.inner), gradients + place<i>::parameter_offset);
            });
        }

        template <std::size_t I>
        static constexpr auto spec_name = std::array<std::string_view, size>{Specs::name...}[I];
        template <std::size_t I>
        static constexpr bool spec_numbered = std::array<bool, size>{Specs::numbered...}[I];

        template <shape Shape>
        static void copy(const pass& p, input_view<T, Shape> from, output_view<T, Shape> to) {
            p.threads.for_each(from.groups(), [&](std::size_t g) {
                std::copy_n(from.group(g), from.group_size, to.group(g));
            });
        }
        static pass at_depth(const pass& p, std::size_t index) {
            pass inner = p;
            inner.depth = p.depth * 64 + static_cast<std::uint32_t>(index) + 1;
            return inner;
        }
        template <std::size_t I>
        static output_view<T, at<I>::output> output_of(memory& m, output_view<T, output> out) {
            if constexpr (is_last<I>())
                return {out.data(), out.samples()};
            else
                return {m.outputs[source<I>()].data(), out.samples()};
        }
        template <std::size_t I>
        static input_view<T, at<I>::input> input_of(memory& m, input_view<T, Input> in,
                                                    output_view<T, output> out) {
            if constexpr (I == 0)
                return in;
            else
                return output_of<I - 1>(m, out);
        }
    };
};

namespace detail {

template <class Spec>
struct as_sequence {
    using type = sequence<Spec>;
};
template <class... Specs>
struct as_sequence<sequence<Specs...>> {
    using type = sequence<Specs...>;
};

} // namespace detail

/// A list of layers as it is, and a single layer as a list of one.
template <class Spec>
using as_sequence = typename detail::as_sequence<Spec>::type;

} // namespace tactnet

#pragma once

#include <tactnet/detail/indexed_leaves.hpp>
#include <tactnet/layers/layer.hpp>

#include <algorithm>
#include <array>
#include <string>

namespace tactnet::inline TACTNET_ARCH {

namespace detail {

/// A layer at its place in a list. Offsets count from the start of the list's arrays.
template <class Layer, std::size_t Parameters, std::size_t Statistics>
struct placed {
    using type = Layer;
    static constexpr std::size_t parameter_offset = Parameters, statistic_offset = Statistics;
};

/// Lets shapes and offsets flow through the list.
template <class T, shape Input, class Placed, class... Specs>
struct chain {
    using layers = Placed;
    static constexpr shape output = Input;
};
template <class T, shape Input, class... Placed, class Spec, class... Rest>
struct chain<T, Input, indexed_leaves<Placed...>, Spec, Rest...> {
    using here = typename Spec::template layer<T, Input>;
    static constexpr std::size_t parameters = (std::size_t{0} + ... + Placed::type::parameters);
    static constexpr std::size_t statistics = (std::size_t{0} + ... + Placed::type::statistics);
    using next =
        chain<T, here::output, indexed_leaves<Placed..., placed<here, parameters, statistics>>, Rest...>;
    using layers = typename next::layers;
    static constexpr shape output = next::output;
};

} // namespace detail

/// Layers one after the other, as one layer. Without any it passes its input on.
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
        static constexpr bool in_place = false;
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
            std::array<aligned_vector<T>, 2> gradients;
            std::size_t samples = 0;
            template <std::size_t... I>
            static auto inner_of(std::index_sequence<I...>)
                -> detail::indexed_leaves<typename at<I>::memory...>;
            decltype(inner_of(std::make_index_sequence<size>{})) inner;

            void resize(std::size_t count) {
                samples = count;
                const std::size_t groups = (count + lanes<T> - 1) / lanes<T>;
                std::size_t largest = 0;
                unroll<size>([&](auto i) {
                    largest = std::max(largest, at<i>::input.size());
                    if constexpr (source<i>() == i && !is_last<i>())
                        outputs[i].resize(groups * lanes<T> * at<i>::output.size());
                    detail::get<i>(inner).resize(count);
                });
                gradient_size = groups * lanes<T> * largest;
            }
            std::size_t gradient_size = 0;
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
            unroll<size>([&](auto i) {
                at<i>::forward(at_depth(p, i), values + place<i>::parameter_offset,
                               running + place<i>::statistic_offset, detail::get<i>(m.inner),
                               input_of<i>(m, in, out), output_of<i>(m, out));
            });
        }
        static void backward(const pass& p, const T* values, memory& m, input_view<T, Input> in,
                             input_view<T, output> out, input_view<T, output> out_gradient,
                             output_view<T, Input> in_gradient, T* gradients) {
            if constexpr (size == 0)
                if (in_gradient.data() != nullptr)
                    copy(p, out_gradient, in_gradient);
            for (aligned_vector<T>& g : m.gradients)
                if (g.size() < m.gradient_size)
                    g.resize(m.gradient_size);
            const output_view<T, output> result(const_cast<T*>(out.data()),
                                                out.samples()); // only read from here on
            const T* from = out_gradient.data();
            unroll<size>([&](auto reversed) {
                constexpr std::size_t i = size - 1 - reversed;
                T* to = i == 0 ? in_gradient.data() : m.gradients[i % 2].data();
                at<i>::backward(at_depth(p, i), values + place<i>::parameter_offset, detail::get<i>(m.inner),
                                input_of<i>(m, in, result), output_of<i>(m, result),
                                input_view<T, at<i>::output>(from, in.samples()),
                                output_view<T, at<i>::input>(to, in.samples()),
                                gradients + place<i>::parameter_offset);
                from = to;
            });
        }

    private:
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
                return {out.data(), m.samples};
            else
                return {m.outputs[source<I>()].data(), m.samples};
        }
        template <std::size_t I>
        static input_view<T, at<I>::input> input_of(memory& m, input_view<T, Input> in,
                                                    output_view<T, output> out) {
            if constexpr (I == 0)
                return {in.data(), m.samples};
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

#pragma once

#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/operators/sequence/layer.hpp>
#include <tactnet/operators/sequence/named.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

template <std::size_t Rows, std::size_t Columns, std::size_t FirstRows, std::size_t FirstColumns>
concept maps_agree = (Rows == FirstRows) && (Columns == FirstColumns);

namespace detail {

template <class First, class... Branches>
[[nodiscard]] constexpr shape concatenation_output() {
    static_assert((maps_agree<Branches::output.rows, Branches::output.columns, First::output.rows,
                              First::output.columns> &&
                   ...),
                  "concatenation: all branches must give the same rows and columns; maps_agree shows those "
                  "of a branch, then those of the first");
    return {First::output.rows, First::output.columns,
            (First::output.channels + ... + Branches::output.channels)};
}

/// The costs of branches side by side, each with memory of its own for its output.
template <std::size_t Size>
[[nodiscard]] constexpr layer_costs costs_side_by_side(const std::array<layer_costs, Size>& branches) {
    layer_costs all{.output = {branches[0].output.rows, branches[0].output.columns, 0}};
    for (const layer_costs& branch : branches) {
        all.add(branch);
        all.output.channels += branch.output.channels;
        all.inner_activations = std::max(all.inner_activations, branch.inner_activations);
    }
    all.inner_activations += all.output.size();
    return all;
}

} // namespace detail

/// The channels of several branches over the same input, one branch after the other (Szegedy et al., 2015). A
/// branch is a list of layers or a single one; `identity_layer` passes the input on. The arrays of the
/// branches begin with "branch1", "branch2" …, or with the names that branches are given.
template <class... Branches>
struct concatenation {
    static_assert(sizeof...(Branches) > 0, "concatenation: there must be at least one branch");
    static constexpr std::string_view name = "concat";
    static constexpr bool numbered = true;
    static constexpr std::size_t size = sizeof...(Branches);

    static constexpr layer_costs costs(const shape& input) {
        return detail::costs_side_by_side(std::array{as_sequence<Branches>::costs(input)...});
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, concatenation> { // branches have stages of their own
        template <std::size_t I>
        using at = typename decltype(detail::type_at<I>(
            std::declval<detail::indexed_leaves<
                std::type_identity<typename as_sequence<Branches>::template layer<T, Input>>...>>()))::type;

        static constexpr shape output =
            detail::concatenation_output<typename as_sequence<Branches>::template layer<T, Input>...>();
        /// The channels of the output, parameters and statistics before those of each branch.
        static constexpr std::array<detail::layer_offset, size> offsets =
            detail::offsets_of(std::array{as_sequence<Branches>::costs(Input)...});

        struct memory {
            detail::indexed_leaves<typename as_sequence<Branches>::template layer<T, Input>::memory...> inner;
            std::array<aligned_vector<T>, size> outputs;
            aligned_vector<T> out_gradient, in_gradient; // of one branch
            std::size_t samples = 0;
            void resize(std::size_t count) {
                samples = count;
                kernels::unroll<size>([&](auto i) {
                    detail::get<i>(inner).resize(count);
                    outputs[i].resize(kernels::padded_size<T>(count) * at<i>::output.size());
                });
            }
        };

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            constexpr std::array<std::string_view, size> given{given_name<Branches>()...};
            constexpr std::array<bool, size> has_name{detail::has_given_name<Branches>...};
            kernels::unroll<size>([&](auto i) {
                const std::string own =
                    has_name[i] ? std::string(given[i]) : "branch" + std::to_string(i + 1);
                detail::describe_inner(at<i>::describe, joined_name(prefix, own), offsets[i], list);
            });
        }
        static void prepare(const execution_context& context, const T* values, const T* running, memory& m) {
            kernels::unroll<size>([&](auto i) {
                at<i>::prepare(context, values + offsets[i].parameters, running + offsets[i].statistics,
                               detail::get<i>(m.inner));
            });
        }
        static void infer(const execution_context& context, const T* values, const T* running, memory& m,
                          input_view<T, Input> in, output_view<T, output> out) {
            run<false>(context, values, running, m, in, out);
        }
        static void forward(const execution_context& context, const T* values, T* running, memory& m,
                            input_view<T, Input> in, output_view<T, output> out) {
            run<true>(context, values, running, m, in, out);
        }
        static void backward(const execution_context& context, const T* values, memory& m,
                             input_view<T, Input> in, input_view<T, output>,
                             input_view<T, output> out_gradient, output_view<T, Input> in_gradient,
                             T* gradients) {
            detail::grow(m.in_gradient, in.lane_blocks() * in.lane_block_size);
            kernels::unroll<size>([&](auto i) {
                constexpr shape own = at<i>::output;
                detail::grow(m.out_gradient, in.lane_blocks() * kernels::lanes<T> * own.size());
                copy<own, false>(context, m.out_gradient.data(), out_gradient.data(), in.lane_blocks(),
                                 offsets[i].channels);
                // The first branch sets the gradient of the input, the others add to it.
                T* const to =
                    in_gradient.data() == nullptr || i == 0 ? in_gradient.data() : m.in_gradient.data();
                at<i>::backward(context.of_inner(i), values + offsets[i].parameters, detail::get<i>(m.inner),
                                in, {m.outputs[i].data(), in.samples()},
                                {m.out_gradient.data(), in.samples()}, {to, in.samples()},
                                gradients + offsets[i].parameters);
                if (i > 0 && to != nullptr)
                    context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
                        T* const sum = in_gradient.lane_block(b);
                        kernels::add(sum, to + b * in.lane_block_size, sum, in.lane_block_size);
                    });
            });
        }

    private:
        template <class Branch>
        static constexpr std::string_view given_name() {
            if constexpr (detail::has_given_name<Branch>)
                return Branch::name;
            else
                return "";
        }
        template <bool Training, class Statistic>
        static void run(const execution_context& context, const T* values, Statistic* running, memory& m,
                        input_view<T, Input> in, output_view<T, output> out) {
            kernels::unroll<size>([&](auto i) {
                const output_view<T, at<i>::output> own(m.outputs[i].data(), in.samples());
                detail::run<Training, at<i>>(context.of_inner(i), values + offsets[i].parameters,
                                             running + offsets[i].statistics, detail::get<i>(m.inner), in,
                                             own);
                copy<at<i>::output, true>(context, own.data(), out.data(), in.lane_blocks(),
                                          offsets[i].channels);
            });
        }
        /// Copies between the map of a branch and its channels of the whole map.
        template <shape Branch, bool ToWhole, class BranchElement, class WholeElement>
        static void copy(const execution_context& context, BranchElement* branch, WholeElement* whole,
                         std::size_t lane_blocks, std::size_t first_channel) {
            context.threads.for_each(lane_blocks, [&](std::size_t b) {
                constexpr std::size_t count = Branch.size() * kernels::lanes<T>;
                WholeElement* const place =
                    whole + (b * output.size() + first_channel * output.area()) * kernels::lanes<T>;
                if constexpr (ToWhole)
                    std::copy_n(branch + b * count, count, place);
                else
                    std::copy_n(place, count, branch + b * count);
            });
        }
    };
};

}} // namespace tactnet

#pragma once

#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/operators/concatenation/layer.hpp>
#include <tactnet/operators/sequence/training.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace tactnet { inline namespace TACTNET_ARCH {

template <class... Branches, class T, shape Input>
struct trained_layer<concatenation<Branches...>, T, Input>
    : trained_base<concatenation<Branches...>, T, Input> {
    using base = trained_base<concatenation<Branches...>, T, Input>;
    using base::offsets;
    using base::output;
    static constexpr std::size_t size = sizeof...(Branches);
    template <std::size_t I>
    using at = typename decltype(detail::type_at<I>(
        std::declval<detail::indexed_leaves<
            std::type_identity<trained_layer<as_sequence<Branches>, T, Input>>...>>()))::type;

    struct memory {
        detail::indexed_leaves<typename trained_layer<as_sequence<Branches>, T, Input>::memory...> inner;
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
                         input_view<T, Input> in, input_view<T, output>, input_view<T, output> out_gradient,
                         output_view<T, Input> in_gradient, T* gradients) {
        detail::grow(m.in_gradient, in.lane_blocks() * in.lane_block_size);
        kernels::unroll<size>([&](auto i) {
            constexpr shape own = at<i>::output;
            detail::grow(m.out_gradient, in.lane_blocks() * kernels::lanes<T> * own.size());
            copy<own, false>(context, m.out_gradient.data(), out_gradient.data(), in.lane_blocks(),
                             offsets[i].channels);
            // The first branch sets the gradient of the input, the others add to it.
            T* const to = in_gradient.data() == nullptr || i == 0 ? in_gradient.data() : m.in_gradient.data();
            at<i>::backward(context.of_inner(i), values + offsets[i].parameters, detail::get<i>(m.inner), in,
                            {m.outputs[i].data(), in.samples()}, {m.out_gradient.data(), in.samples()},
                            {to, in.samples()}, gradients + offsets[i].parameters);
            if (i > 0 && to != nullptr)
                context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
                    T* const sum = in_gradient.lane_block(b);
                    kernels::add(sum, to + b * in.lane_block_size, sum, in.lane_block_size);
                });
        });
    }

private:
    template <bool Training, class Statistic>
    static void run(const execution_context& context, const T* values, Statistic* running, memory& m,
                    input_view<T, Input> in, output_view<T, output> out) {
        kernels::unroll<size>([&](auto i) {
            const output_view<T, at<i>::output> own(m.outputs[i].data(), in.samples());
            detail::run<Training, at<i>>(context.of_inner(i), values + offsets[i].parameters,
                                         running + offsets[i].statistics, detail::get<i>(m.inner), in, own);
            copy<at<i>::output, true>(context, own.data(), out.data(), in.lane_blocks(), offsets[i].channels);
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

}} // namespace tactnet

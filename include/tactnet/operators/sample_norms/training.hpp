#pragma once

#include <tactnet/kernels/batch/normalisation.hpp>
#include <tactnet/operators/sample_norms/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

template <class Spec, class T, shape Input>
struct trained_sample_norm : trained_base<Spec, T, Input> {
    using base = trained_base<Spec, T, Input>;
    using base::groups, base::weights;
    static constexpr bool by_parts = true;

    struct memory {
        aligned_vector<double> moments; // [lane block][group][mean, inverse deviation][sample]
        aligned_vector<double> totals;  // [lane block][weight][weight, bias][lane of double]
        void resize(std::size_t) {}
    };

    static void infer(const execution_context& context, const T* values, const T*, memory&,
                      input_view<T, Input> in, output_view<T, Input> out) {
        normalise(context, values, in, out, [](std::size_t, const kernels::group_moments&) {});
    }
    static void begin_forward(const execution_context&, T*, memory& m, std::size_t samples) {
        grow(m.moments, lane_blocks_of<T>(samples) * moments_of_block);
    }
    static void forward(const execution_context& context, const T* values, T*, memory& m,
                        input_view<T, Input> in, output_view<T, Input> out) {
        double* const moments = m.moments.data() + context.first_lane_block * moments_of_block;
        normalise(context, values, in, out, [&](std::size_t place, const kernels::group_moments& of_group) {
            of_group.write<kernels::lanes<T>>(moments + place);
        });
    }

    static void begin_backward(const execution_context&, const T*, memory& m, std::size_t samples) {
        m.totals.assign(lane_blocks_of<T>(samples) * totals_of_block, 0.0);
    }
    static void backward(const execution_context& context, const T* values, memory& m,
                         input_view<T, Input> in, input_view<T, Input>, input_view<T, Input> out_gradient,
                         output_view<T, Input> in_gradient, T*) {
        for_each_group(context, in.lane_blocks(), [&](const group_place& at) {
            const std::size_t block = context.first_lane_block + at.lane_block;
            kernels::normalise_group_backward(
                groups,
                kernels::group_moments::read<kernels::lanes<T>>(m.moments.data() + block * moments_of_block +
                                                                at.moments),
                values + at.weight, in.lane_block(at.lane_block) + at.element,
                out_gradient.lane_block(at.lane_block) + at.element,
                in_gradient.data() == nullptr ? nullptr : in_gradient.lane_block(at.lane_block) + at.element,
                m.totals.data() + block * totals_of_block + 2 * at.weight * kernels::lanes<double>);
        });
    }
    static void end_backward(memory& m, T* gradients) {
        for (std::size_t w = 0; w < weights; ++w)
            for (const std::size_t which : {std::size_t{0}, std::size_t{1}}) {
                double sum = 0;
                for (std::size_t at = (2 * w + which) * kernels::lanes<double>; at < m.totals.size();
                     at += totals_of_block)
                    for (std::size_t lane = 0; lane < kernels::lanes<double>; ++lane)
                        sum += m.totals[at + lane];
                gradients[which * weights + w] = static_cast<T>(sum);
            }
    }

private:
    static constexpr std::size_t moments_of_block = groups.count * 2 * kernels::lanes<T>,
                                 totals_of_block = weights * 2 * kernels::lanes<double>;

    /// One group of `lanes<double>` samples of a lane block, and where its numbers begin.
    struct group_place {
        std::size_t lane_block, element, moments, weight;
    };
    template <class Body>
    static void for_each_group(const execution_context& context, std::size_t lane_blocks, const Body& body) {
        context.threads.for_each(lane_blocks, [&](std::size_t b) {
            for (std::size_t g = 0; g < groups.count; ++g)
                for (std::size_t s = 0; s < kernels::lanes<T>; s += kernels::lanes<double>)
                    body(group_place{b, g * groups.distance * kernels::lanes<T> + s,
                                     g * 2 * kernels::lanes<T> + s, g * groups.weight_distance});
        });
    }
    /// `keep(place, moments)` gets the moments of each group.
    template <class Keep>
    static void normalise(const execution_context& context, const T* values, input_view<T, Input> in,
                          output_view<T, Input> out, const Keep& keep) {
        for_each_group(context, in.lane_blocks(), [&](const group_place& at) {
            const T* const from = in.lane_block(at.lane_block) + at.element;
            const kernels::group_moments moments = kernels::moments_of_group(groups, context.epsilon, from);
            keep(at.lane_block * moments_of_block + at.moments, moments);
            kernels::normalise_group(groups, moments, values + at.weight, values + weights + at.weight, from,
                                     out.lane_block(at.lane_block) + at.element);
        });
    }
};

} // namespace detail

template <std::size_t Groups, class T, shape Input>
struct trained_layer<group_norm<Groups>, T, Input>
    : detail::trained_sample_norm<group_norm<Groups>, T, Input> {};
template <class T, shape Input>
struct trained_layer<instance_norm, T, Input> : detail::trained_sample_norm<instance_norm, T, Input> {};
template <norm_over Over, class T, shape Input>
struct trained_layer<layer_norm<Over>, T, Input> : detail::trained_sample_norm<layer_norm<Over>, T, Input> {};

template <std::size_t Size, class Alpha, class Beta, class K, class T, shape Input>
struct trained_layer<local_response_norm<Size, Alpha, Beta, K>, T, Input>
    : lane_block_layer<local_response_norm<Size, Alpha, Beta, K>, T, Input> {
    using rule = typename local_response_norm<Size, Alpha, Beta, K>::rule;

    static void forward_block(const T* in, T* out) {
        kernels::normalise_responses<rule>(Input.channels, Input.area(), in, out);
    }
    static void backward_block(const T* in, const T*, const T* out_gradient, T* in_gradient) {
        kernels::normalise_responses_backward<rule>(Input.channels, Input.area(), in, out_gradient,
                                                    in_gradient);
    }
};

}} // namespace tactnet

#pragma once

#include <tactnet/deployment/streaming/stream_step.hpp>
#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/layers/composition/named.hpp>
#include <tactnet/layers/composition/residual.hpp>
#include <tactnet/layers/composition/sequence.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// Rejects a layer that does not run frame by frame, and replaces it by the identity, so that no further
/// errors follow.
template <class Spec, shape Input>
auto check_stream_step() {
    static_assert(runs_in_streams<Spec, Input>,
                  "deploy_stream: this layer does not run frame by frame; runs_in_streams shows it and its "
                  "input. Dense layers come after last_frame; for each frame, use causal_conv1d<outputs, 1>");
    return copying_step<Input>{};
}
template <class Spec, shape Input>
struct checked_stream_step : decltype(check_stream_step<Spec, Input>()) {};
template <class Spec, shape Input>
    requires runs_in_streams<Spec, Input>
struct checked_stream_step<Spec, Input> : stream_step<Spec, Input> {
};

/// The steps of a list, one after the other. An empty list is the identity.
template <shape Input, class... Specs>
struct stream_list : copying_step<Input> {};
template <shape Input, class Spec, class... Rest>
struct stream_list<Input, Spec, Rest...> {
    using here = checked_stream_step<Spec, Input>;
    static constexpr layer_costs costs = Spec::costs(Input);
    using next = stream_list<costs.output, Rest...>;
    static constexpr std::size_t packed_elements = here::packed_elements + next::packed_elements;

    struct state {
        typename here::state first;
        typename next::state rest;
    };

    static void pack(const float* values, float* packed) {
        here::pack(values, packed);
        next::pack(values + costs.parameters, packed + here::packed_elements);
    }
    static void run(const float* packed, const float* in, state& s, float* out) noexcept {
        if constexpr (sizeof...(Rest) == 0) {
            here::run(packed, in, s.first, out);
        } else {
            alignas(vector_alignment) std::array<float, kernels::padded_size<float>(costs.output.channels)>
                between;
            here::run(packed, in, s.first, between.data());
            next::run(packed + here::packed_elements, between.data(), s.rest, out);
        }
    }
    [[nodiscard]] static double output_bound(const float* values, double input) {
        const double bound = here::output_bound(values, input);
        return std::max(bound, next::output_bound(values + costs.parameters, bound));
    }
};

} // namespace detail

/// A list, whatever the names of its layers.
template <class... Specs, shape Input>
struct stream_step<sequence<Specs...>, Input> : detail::stream_list<Input, without_name<Specs>...> {};

/// The sum of two branches.
template <class Main, class Skip, shape Input>
struct stream_step<residual<Main, Skip>, Input> {
    using main = stream_step<as_sequence<Main>, Input>;
    using skip = stream_step<as_sequence<Skip>, Input>;
    static constexpr std::size_t packed_elements = main::packed_elements + skip::packed_elements;
    static constexpr std::size_t skip_parameters = as_sequence<Main>::costs(Input).parameters;

    struct state {
        typename main::state of_main;
        typename skip::state of_skip;
    };

    static void pack(const float* values, float* packed) {
        main::pack(values, packed);
        skip::pack(values + skip_parameters, packed + main::packed_elements);
    }
    static void run(const float* packed, const float* in, state& s, float* out) noexcept {
        constexpr std::size_t count =
            kernels::padded_size<float>(as_sequence<Main>::costs(Input).output.channels);
        alignas(vector_alignment) std::array<float, count> added;
        main::run(packed, in, s.of_main, out);
        skip::run(packed + main::packed_elements, in, s.of_skip, added.data());
        kernels::add(out, added.data(), out, count);
    }
    [[nodiscard]] static double output_bound(const float* values, double input) {
        return main::output_bound(values, input) + skip::output_bound(values + skip_parameters, input);
    }
};

}} // namespace tactnet

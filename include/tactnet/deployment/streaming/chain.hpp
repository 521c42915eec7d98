#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/lowering/stream_step.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Steps of a stream, one after the other, as one step.
template <class... Steps>
struct stream_chain;

namespace detail {

/// The numbers of a sum of two branches.
template <class Main, class Skip>
struct residual_sizes {
    static constexpr std::size_t features = Main::features, outputs = Main::outputs,
                                 parameters = Main::parameters + Skip::parameters;
};

/// The members of a chain of two steps. In 8 bits, formats differ from step to step.
template <class First, class Rest>
struct stream_pair {
    using format = typename First::format;
    using element = typename First::element;
    using packed_number = typename format::packed_number;
    static constexpr std::size_t features = First::features, outputs = Rest::outputs,
                                 map_elements = Rest::map_elements;
    static constexpr std::size_t parameters = First::parameters + Rest::parameters,
                                 folded_elements = First::folded_elements + Rest::folded_elements,
                                 packed_elements = First::packed_elements + Rest::packed_elements,
                                 workspace_elements =
                                     std::max(First::workspace_elements, Rest::workspace_elements);

    struct state {
        [[no_unique_address]] typename First::state first;
        [[no_unique_address]] typename Rest::state rest;
    };

    static void fold(const float* values, float* folded) {
        First::fold(values, folded);
        Rest::fold(values + First::parameters, folded + First::folded_elements);
    }
    static constexpr void pack(const float* folded, packed_number* packed) {
        First::pack(folded, packed);
        Rest::pack(folded + First::folded_elements, packed + First::packed_elements);
    }
    static void run(const packed_number* packed, const element* in, state& s, element* out,
                    element* memory) noexcept {
        alignas(vector_alignment) std::array<element, First::map_elements> between;
        if constexpr (sizeof(element) == 1) // products of bytes read beyond the last feature
            between.fill(0);
        First::run(packed, in, s.first, between.data(), memory);
        Rest::run(packed + First::packed_elements, between.data(), s.rest, out, memory);
    }
    /// In single precision.
    [[nodiscard]] static double output_bound(const float* folded, double input) {
        const double bound = First::output_bound(folded, input);
        return std::max(bound, Rest::output_bound(folded + First::folded_elements, bound));
    }
    /// In 8 bits: the ranges of maps, of which observed ones are read from `next`. Returns that of the
    /// output.
    static auto set_ranges(float* folded, const auto& input, auto& next) {
        return Rest::set_ranges(folded + First::folded_elements, First::set_ranges(folded, input, next),
                                next);
    }
};

} // namespace detail

template <class Step>
struct stream_chain<Step> : Step {};
template <class First, class... Rest>
struct stream_chain<First, Rest...> : detail::stream_pair<First, stream_chain<Rest...>> {
    using output_number = typename stream_chain<Rest...>::output_number;
};

template <class... Steps>
struct step_description<stream_chain<Steps...>> {
    static constexpr void visit(auto&& to) {
        to("tactnet::stream_chain", "Chain", inner_step<Steps, step_composition::wrapper>{"step"}...);
    }
};

}} // namespace tactnet

#pragma once

#include <tactnet/deployment/eight_bit/streaming/causal_convolution.hpp>
#include <tactnet/deployment/eight_bit/streaming/recurrent.hpp>
#include <tactnet/deployment/lowering/sequence.hpp>
#include <tactnet/deployment/streaming/stream_list.hpp>
#include <tactnet/kernels/integer/elementwise.hpp>
#include <tactnet/layers/composition/named.hpp>
#include <tactnet/layers/composition/residual.hpp>
#include <tactnet/layers/composition/sequence.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// A layer that changes nothing in a stream, which has one frame at a time.
template <class Spec>
concept changes_nothing_in_streams = inference_no_op<Spec> || std::is_same_v<Spec, last_frame>;

/// A step that is the identity.
template <shape Input, class Number>
struct copying_byte_step {
    struct state {};
    using output_number = Number;
    static constexpr std::size_t folded_elements = 0, packed_elements = 0, workspace_elements = 0;

    static void fold(const float*, float*) {}
    static map_range set_ranges(float*, const map_range& input, const map_range*&) { return input; }
    static void append_arrays(folded_layout&, const std::string&) {}
    static void pack(const float*, std::int8_t*) {}
    static void run(const std::int8_t*, const std::uint8_t* in, state&, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        std::copy_n(in, Input.channels * sizeof(Number), out);
    }
    static std::vector<float> observe(const float*, const std::vector<float>& in, stream_observation&) {
        return in;
    }
};

/// Rejects a layer that does not run frame by frame in 8 bits, and replaces it by the identity, so that no
/// further errors follow.
template <class Spec, shape Input, class Format>
auto check_byte_step() {
    static_assert(runs_in_streams<Spec, Input, Format>,
                  "deploy_stream: in 8 bits this layer does not run frame by frame here; runs_in_streams "
                  "shows it, its input and the format of numbers. The first layer reads words of 16 bits: it "
                  "must be gru, lstm, causal_conv1d or dense. Dense layers come after last_frame");
    return copying_byte_step<Input, std::uint8_t>{};
}
template <class Spec, shape Input, class Format>
struct checked_byte_step : decltype(check_byte_step<Spec, Input, Format>()) {};
template <class Spec, shape Input, class Format>
    requires runs_in_streams<Spec, Input, Format>
struct checked_byte_step<Spec, Input, Format> : stream_step<Spec, Input, Format> {
};

/// The steps of a list, one after the other, from numbers `In` to bytes, or to floats if `Out` is float and
/// the last step writes them. An empty list is the identity.
template <shape Input, class In, class Out, class... Specs>
struct byte_stream_list : copying_byte_step<Input, In> {};
/// A layer, and the list of the others.
template <shape Input, class In, class Out, class Spec, class... Rest>
struct byte_stream_chain {
    static constexpr layer_costs costs = Spec::costs(Input);
    static constexpr bool last = (changes_nothing_in_streams<Rest> && ...);
    using here =
        checked_byte_step<Spec, Input, eight_bit_between<In, std::conditional_t<last, Out, std::uint8_t>>>;
    using next = byte_stream_list<costs.output, typename here::output_number, Out, Rest...>;
    using output_number = typename next::output_number;
    static constexpr std::size_t folded_elements = here::folded_elements + next::folded_elements,
                                 packed_elements = here::packed_elements + next::packed_elements,
                                 workspace_elements =
                                     std::max(here::workspace_elements, next::workspace_elements);

    struct state {
        [[no_unique_address]] typename here::state first;
        [[no_unique_address]] typename next::state rest;
    };

    static void fold(const float* values, float* folded) {
        here::fold(values, folded);
        next::fold(values + costs.parameters, folded + here::folded_elements);
    }
    static map_range set_ranges(float* folded, const map_range& input, const map_range*& ranges) {
        const map_range between = here::set_ranges(folded, input, ranges);
        return next::set_ranges(folded + here::folded_elements, between, ranges);
    }
    /// Steps are counted from `first` on.
    static void append_arrays(folded_layout& to, const std::string& name, std::size_t first = 1) {
        here::append_arrays(to, part_name(name, "step", first));
        if constexpr (!last)
            next::append_arrays(to, name, first + 1);
    }
    static void pack(const float* folded, std::int8_t* packed) {
        here::pack(folded, packed);
        next::pack(folded + here::folded_elements, packed + here::packed_elements);
    }
    static void run(const std::int8_t* packed, const std::uint8_t* in, state& s, std::uint8_t* out,
                    std::uint8_t* memory) noexcept {
        if constexpr (last) {
            here::run(packed, in, s.first, out, memory);
        } else {
            constexpr std::size_t bytes =
                pad_to_cache_line(costs.output.channels) * sizeof(typename here::output_number);
            alignas(vector_alignment) std::array<std::uint8_t, round_up(bytes, cache_line)> between{};
            here::run(packed, in, s.first, between.data(), memory);
            next::run(packed + here::packed_elements, between.data(), s.rest, out, memory);
        }
    }
    static std::vector<float> observe(const float* values, const std::vector<float>& in,
                                      stream_observation& found) {
        return next::observe(values + costs.parameters, here::observe(values, in, found), found);
    }
};
template <shape Input, class In, class Out, class Spec, class... Rest>
struct byte_stream_list<Input, In, Out, Spec, Rest...> : byte_stream_chain<Input, In, Out, Spec, Rest...> {};
template <shape Input, class In, class Out, class Spec, class... Rest>
    requires(changes_nothing_in_streams<Spec>)
struct byte_stream_list<Input, In, Out, Spec, Rest...>
    : byte_stream_list<Spec::costs(Input).output, In, Out, Rest...> {};
/// A product takes the ReLU after it.
template <shape Input, class In, class Out, class Spec, class Function, class... Rest>
    requires(is_relu<Function>() && runs_in_streams<rectified<Spec>, Input, eight_bit_between<In, Out>>)
struct byte_stream_list<Input, In, Out, Spec, activation<Function>, Rest...>
    : byte_stream_chain<Input, In, Out, rectified<Spec>, Rest...> {};

} // namespace detail

/// A list, whatever the names of its layers.
template <class... Specs, shape Input, class In, class Out>
struct stream_step<sequence<Specs...>, Input, eight_bit_between<In, Out>>
    : detail::byte_stream_list<Input, In, Out, without_name<Specs>...> {};

/// The sum of two branches, whose bytes are multiplied by integers of 15 bits and requantised.
template <class Main, class Skip, shape Input, class Out>
struct stream_step<residual<Main, Skip>, Input, eight_bit_between<std::uint8_t, Out>> {
private:
    using main = stream_step<as_sequence<Main>, Input, eight_bit>;
    using skip = stream_step<as_sequence<Skip>, Input, eight_bit>;
    static constexpr std::size_t main_parameters = as_sequence<Main>::costs(Input).parameters,
                                 channels = as_sequence<Main>::costs(Input).output.channels;
    static constexpr std::size_t skip_offset = main::packed_elements,
                                 sum_offset = skip_offset + skip::packed_elements,
                                 inner_folded = main::folded_elements + skip::folded_elements;
    static constexpr folded_arrays arrays{range_array("input"), range_array("added"), range_array("output")};

public:
    using output_number = std::uint8_t;
    static constexpr std::size_t folded_elements = inner_folded + arrays.numbers(),
                                 packed_elements =
                                     sum_offset + pad_to_cache_line<std::int8_t>(sizeof(kernels::byte_sum)),
                                 workspace_elements =
                                     std::max(main::workspace_elements, skip::workspace_elements);

    struct state {
        [[no_unique_address]] typename main::state of_main;
        [[no_unique_address]] typename skip::state of_skip;
    };

    static void fold(const float* values, float* folded) {
        main::fold(values, folded);
        skip::fold(values + main_parameters, folded + main::folded_elements);
    }
    static map_range set_ranges(float* folded, const map_range& input, const map_range*& ranges) {
        step_ranges own;
        own.input = main::set_ranges(folded, input, ranges);
        own.added = skip::set_ranges(folded + main::folded_elements, input, ranges);
        own.output = *ranges++;
        arrays.write_ranges(folded + inner_folded, own);
        return own.output;
    }
    static void append_arrays(folded_layout& to, const std::string& name) {
        main::append_arrays(to, name + ".main");
        skip::append_arrays(to, name + ".skip");
        detail::append_step(to, name, arrays, 0);
        to.steps.back().adds = true;
    }
    static void pack(const float* folded, std::int8_t* packed) {
        main::pack(folded, packed);
        skip::pack(folded + main::folded_elements, packed + skip_offset);
        const auto [input, added, result] = arrays.read_ranges(folded + inner_folded);
        const double unit =
            static_cast<double>(std::max(input.scale, added.scale)) / kernels::byte_sum::most_weight;
        const auto weight = [&](const map_range& range) {
            return static_cast<std::int32_t>(detail::nearest_even(static_cast<double>(range.scale) / unit));
        };
        kernels::byte_sum sum{{weight(input), weight(added)}, 0, 0, 0};
        sum.start = -static_cast<std::int32_t>(input.zero_point) * sum.weights[0] -
                    static_cast<std::int32_t>(added.zero_point) * sum.weights[1];
        sum.factor = static_cast<float>(unit / static_cast<double>(result.scale));
        sum.zero = static_cast<std::int32_t>(result.zero_point);
        const auto bytes = detail::bits_as<std::array<std::int8_t, sizeof(sum)>>(sum);
        std::copy(bytes.begin(), bytes.end(), packed + sum_offset);
    }
    static void run(const std::int8_t* packed, const std::uint8_t* in, state& s, std::uint8_t* out,
                    std::uint8_t* memory) noexcept {
        alignas(vector_alignment) std::array<std::uint8_t, pad_to_cache_line<std::uint8_t>(channels)> added{};
        main::run(packed, in, s.of_main, out, memory);
        skip::run(packed + skip_offset, in, s.of_skip, added.data(), memory);
        kernels::load_bytes_as<kernels::byte_sum>(packed + sum_offset).add<channels>(added.data(), out);
    }
    static std::vector<float> observe(const float* values, const std::vector<float>& in,
                                      detail::stream_observation& found) {
        std::vector<float> out = main::observe(values, in, found);
        const std::vector<float> added = skip::observe(values + main_parameters, in, found);
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] += added[i];
        found.observe(out);
        return out;
    }
};

}} // namespace tactnet

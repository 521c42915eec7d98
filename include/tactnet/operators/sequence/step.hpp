#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/lowering/batch_executor.hpp>
#include <tactnet/lowering/step.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A sequence of steps as one step. The maps between them alternate between two buffers. In a stream its
/// state is that of its steps.
template <class... Steps>
struct step_chain : step_defaults, detail::joined_state<Steps...> {
    static constexpr std::size_t size = sizeof...(Steps);
    static_assert(size > 0, "step_chain: there must be at least one step");
    template <std::size_t I>
    using at = typename decltype(detail::type_at<I>(
        std::declval<detail::indexed_leaves<std::type_identity<Steps>...>>()))::type;

    using format = typename at<0>::format;
    static_assert((std::is_same_v<typename Steps::format, format> && ...),
                  "step_chain: all steps must have the same number format");
    static_assert((deployed_step<Steps> && ...),
                  "step_chain: every type in the list must satisfy deployed_step");
    /// The last step may write only some channels of a wider map, which a step around this one owns.
    static constexpr bool fills_map = at<size - 1>::fills_map;
    static_assert((std::size_t{0} + ... + !Steps::fills_map) == !fills_map,
                  "step_chain: a step that writes among the channels of a wider map cannot stand by itself");
    using activation = typename format::activation;
    using packed_number = typename format::packed_number;

    static constexpr shape output = at<size - 1>::output;
    static constexpr std::size_t output_stride = at<size - 1>::output_stride;
    /// Elements that a number of the last map takes.
    static constexpr std::size_t number_elements = at<size - 1>::number_elements;
    static constexpr std::size_t folded_elements = (Steps::folded_elements + ...),
                                 packed_elements = (Steps::packed_elements + ...);
    /// Elements of the largest map between two steps.
    static constexpr std::size_t buffer = [] {
        std::size_t most = 0;
        kernels::unroll<size - 1>([&](auto i) {
            most = std::max(most, pad_to_cache_line<activation>(at<i>::output.area() * at<i>::output_stride));
        });
        return most;
    }();
    static constexpr std::size_t buffers = std::min<std::size_t>(size - 1, 2);
    /// Which of them a step writes to.
    static constexpr std::size_t buffer_index(std::size_t step) { return step % 2; }
    static constexpr std::size_t workspace_elements =
        buffers * buffer + std::max({Steps::workspace_elements...});

    /// The step whose map the last one reads, and where `run` leaves this map in its memory.
    using penultimate = at<(size > 1 ? size - 2 : 0)>;
    static constexpr std::size_t before_last_map = size > 1 ? buffer_index(size - 2) * buffer : 0;

    static constexpr bool gives_probabilities = at<size - 1>::gives_probabilities;
    static constexpr const kernels::fused_activation* after_sum = at<size - 1>::after_sum;
    /// The bound of the last step that computes values.
    static constexpr double largest_output = [] {
        double largest = step_defaults::largest_output;
        kernels::unroll<size>([&](auto i) {
            if (!at<i>::keeps_values)
                largest = at<i>::largest_output;
        });
        return largest;
    }();
    static constexpr bool layerwise = (Steps::layerwise || ...);

    /// Runs once, so that it is not worth the time to compile it for speed.
    [[gnu::cold]] static constexpr void pack(const float* from, packed_number* to) {
        ((Steps::pack(from, to), from += Steps::folded_elements, to += Steps::packed_elements), ...);
    }
    /// The largest bound of all steps: maps between them must stay finite as well.
    static double output_bound(const float* from, double input) {
        double most = input;
        ((input = Steps::output_bound(from, input), most = std::max(most, input),
          from += Steps::folded_elements),
         ...);
        return most;
    }
    static void visit_inputs(const float* from, double input, const auto& visit) {
        ((detail::visit_inputs<Steps>(from, input, visit), input = Steps::output_bound(from, input),
          from += Steps::folded_elements),
         ...);
    }
    [[gnu::always_inline]] static void run(const packed_number* packed_values, const activation* in,
                                           activation* out, activation* memory, auto&... states) noexcept {
        activation* const inner = memory + buffers * buffer;
        kernels::unroll<size>([&](auto i) {
            activation* const to = i + 1 == size ? out : memory + buffer_index(i) * buffer;
            detail::run_step<i, at<i>>(packed_values, in, to, inner, states...);
            packed_values += at<i>::packed_elements;
            in = to;
        });
    }
    /// As `run`, for frames whose inputs lie `in_distance` elements apart.
    template <class Executor>
    static void run_batch(const packed_number* packed_values, const activation* in, std::size_t in_distance,
                          activation* out, activation* memory, const Executor& executor) {
        const std::size_t turn = buffer * executor.copies();
        activation* const inner = memory + buffers * turn;
        kernels::unroll<size>([&](auto i) {
            activation* const to = i + 1 == size ? out : memory + buffer_index(i) * turn;
            detail::run_batch<at<i>>(packed_values, in, in_distance, to, inner, executor);
            packed_values += at<i>::packed_elements;
            in = to, in_distance = detail::map_distance<at<i>>;
        });
    }
};
/// Describes the steps of a chain in order.
template <class... Steps>
struct step_description<step_chain<Steps...>> {
    static constexpr void visit(auto&& to) {
        to("tactnet::step_chain", "One after the other",
           inner_step<Steps, step_composition::chain>{"step"}...);
    }
};

/// Writes the outputs of a stream as floats after a step that cannot, for number formats whose maps hold
/// something else.
template <class Format, shape Map, std::size_t Stride>
struct float_output_step;
template <class Format, shape Map, std::size_t Stride>
struct step_description<float_output_step<Format, Map, Stride>> {
    static constexpr const char* header = "tactnet/operators/sequence/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::float_output_step", "Outputs", std::type_identity<Format>{}, Map,
           input_stride_argument{});
    }
};

}} // namespace tactnet

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// The steps of a deployed network or of a stream over packed weights that someone else keeps: the base of
/// both views. `Input` is the input stage.
template <class Input, class Steps>
class packed_steps {
protected:
    using format = typename Steps::format;
    using packed_number = typename format::packed_number;
    using input = Input;
    static constexpr std::size_t output_map = map_distance<Steps>; ///< elements of the last map

public:
    using steps = Steps;
    using input_type = Input;
    using activation = typename format::activation; ///< an element of the maps between layers
    static constexpr std::size_t outputs = Steps::output.size();

    /// Folded numbers are those of the input, then the parameters once batch norms are folded in. They are
    /// the same on every machine.
    static constexpr std::size_t steps_folded = input::folded_elements,
                                 folded_elements = steps_folded + Steps::folded_elements;
    /// Packed weights are the folded numbers in the order of use, for one instruction set.
    static constexpr std::size_t packed_elements = input::packed_elements + Steps::packed_elements;
    static constexpr std::size_t weight_bytes = packed_elements * sizeof(packed_number);
    /// Elements that a call needs: the first map, the last one, then the memory of the steps.
    static constexpr std::size_t workspace_elements = input::map + output_map + Steps::workspace_elements;

    /// Packed weights as a value, for a constant of a program.
    struct packed_weights {
        alignas(vector_alignment) std::array<packed_number, packed_elements> elements{};
    };
    /// Packs folded_elements numbers. `packed` holds packed_elements zeros.
    static constexpr void pack(const float* folded, packed_number* packed) {
        input::pack(folded, packed);
        Steps::pack(folded + input::folded_elements, packed + input::packed_elements);
    }
    [[nodiscard]] static constexpr packed_weights pack(const std::array<float, folded_elements>& folded) {
        packed_weights result;
        pack(folded.data(), result.elements.data());
        return result;
    }

    /// `packed` must outlive the view and be aligned to `vector_alignment`. Only the first `classes` outputs
    /// stand for a class. Logits are divided by the temperature for probabilities.
    constexpr explicit packed_steps(const packed_number* packed, std::size_t classes = outputs,
                                    double temperature = 1) noexcept
        : packed_(packed), classes_(classes), temperature_(temperature) {}
    constexpr explicit packed_steps(const packed_weights& weights, std::size_t classes = outputs,
                                    double temperature = 1) noexcept
        : packed_steps(weights.elements.data(), classes, temperature) {}
    explicit packed_steps(const packed_weights&&, std::size_t = outputs,
                          double = 1) = delete; // they must outlive the view

    /// How many outputs stand for a class: the first ones.
    [[nodiscard]] constexpr std::size_t class_count() const noexcept { return classes_; }

protected:
    const packed_number* packed_;
    std::size_t classes_;
    double temperature_;
};

}}} // namespace tactnet::detail

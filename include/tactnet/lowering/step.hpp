#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/fused_activation.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <utility>

// What a deployed network does, step by step. A step stands for one or several layers and knows only sizes.
// Its constants:
//   output, output_stride   the map that it writes, pixel by pixel, and elements from one pixel to the next
//   folded_elements         numbers that remain of the layers' parameters once batch norms are folded in
//                           ([output][channel][row][column], then biases), in single precision
//   packed_elements         the same numbers in the order of use, padded to whole vectors, in the format
//   workspace_elements      elements of memory that it needs while it runs, in whole cache lines
// and its functions:
//   pack                    writes packed numbers from folded ones into zeros; constexpr
//   run                     computes one map from another
//   output_bound            in single precision: the largest magnitude of an output if inputs have at most
//                           `input`
// Members with a default in step_defaults:
//   layerwise               whether to prefer layer-wise batching, and all threads for one frame
//   fills_map               false if it writes only some channels of a map that other steps write to
//   gives_probabilities     true if its outputs are probabilities
//   number_elements         elements of the map that a number of its output takes, if not one
//   largest_output          a bound of the magnitude of its outputs, whatever the input
//   keeps_values            whether it only puts its inputs in other places
//   after_sum               the activation function that it applies after adding to what its output holds
//   largest_input           in 8 bits, with weights: the largest magnitude of an input, in its steps
// Optional functions:
//   run_share               computes the share of one thread in several frames
//   run_batch               computes several frames on an executor (batch_executor.hpp)
// A step with neither run_share nor run_batch computes one frame at a time. In every map of floats, lanes
// beyond the last channel of a pixel hold zeros; in 8 bits they hold anything.
//
// In a stream, whose frames are maps {1, 1, features}, a step may remember something from frame to frame: its
// `state`, a plain struct, whose initial value begins a recording. `run` then has it as one more argument,
// the last.
//
// The headers in this folder need neither exceptions nor run-time type information nor files.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The number format of single precision: maps and packed weights are floats. Each step is a template on a
/// number format and is defined by its specialisations. A further format is a further set of specialisations.
struct single_precision {
    using activation = float;                        ///< an element of a map
    using packed_number = float;                     ///< an element of the packed weights
    using input_format = single_precision;           ///< format of the step that reads the frame
    using hidden_format = single_precision;          ///< format of steps that read the map of another
    using output_format = single_precision;          ///< format of the step that writes the outputs
    static constexpr bool has_output_format = false; ///< whether the last step has a format of its own
    static constexpr bool fuses_functions = true; ///< whether convolutions fuse other functions than a ReLU
};

/// A format of steps that read the map of another: not that of the frame, if it holds other numbers.
template <class Format>
concept format_of_maps = std::same_as<Format, typename Format::hidden_format>;

/// Reads a frame into the map of the first step. Specialised for each number format.
template <class Format, shape Input>
struct input_stage;
/// Reads a frame of a stream whose steps have so many states.
template <class Format, std::size_t Features, std::size_t States>
struct stream_input_stage;
/// Writes the map of the last step as outputs. Specialised for each number format.
template <class Format, shape Output, std::size_t Stride>
struct output_stage;

/// The optional members of a step, as most steps have them. Derive from it, and hide what differs.
struct step_defaults {
    static constexpr std::size_t folded_elements = 0, packed_elements = 0, workspace_elements = 0;
    static constexpr bool layerwise = false, fills_map = true, gives_probabilities = false;
    static constexpr bool keeps_values = false;
    static constexpr const kernels::fused_activation* after_sum = &kernels::no_activation;
    static constexpr std::size_t number_elements = 1;
    static constexpr double largest_output = std::numeric_limits<double>::infinity(), largest_input = 0;
};

/// A step that remembers something from frame to frame of a stream.
template <class Step>
concept has_state = requires { typename Step::state; };

namespace detail {

template <class Step, class... State>
concept runs =
    requires(const typename Step::format::packed_number* packed, const typename Step::format::activation* in,
             typename Step::format::activation* out, State&... state) {
        { Step::run(packed, in, out, out, state...) } noexcept;
    };
template <class Step>
concept runs_with_state = runs<Step, typename Step::state>;

} // namespace detail

/// The requirements on a step, as above.
template <class Step>
concept deployed_step =
    requires(const float* folded, typename Step::format::packed_number* to) {
        { Step::output } -> std::convertible_to<shape>;
        {
            Step::output_stride + Step::folded_elements + Step::packed_elements + Step::workspace_elements
        } -> std::convertible_to<std::size_t>;
        { Step::layerwise || Step::fills_map || Step::gives_probabilities } -> std::convertible_to<bool>;
        Step::pack(folded, to);
    } &&
    (detail::runs_with_state<Step> || detail::runs<Step>)&&(
        !std::same_as<typename Step::format, single_precision> || requires(const float* folded) {
            { Step::output_bound(folded, 1.0) } -> std::same_as<double>;
        });

namespace detail {

template <std::size_t I, class Step>
struct state_of_step {};
template <std::size_t I, has_state Step>
struct state_of_step<I, Step> {
    [[no_unique_address]] typename Step::state value{};
};
template <class Indices, class... Steps>
struct states_of_steps;
template <std::size_t... I, class... Steps>
struct states_of_steps<std::index_sequence<I...>, Steps...> : state_of_step<I, Steps>... {
    /// Calls visit(state) for each step that has one, in order. `all` is one of these, constant or not.
    static constexpr void visit_states(auto& all, const auto& visit) {
        (visit_one<I, Steps>(all, visit), ...);
    }

private:
    template <std::size_t J, class Step>
    static constexpr void visit_one(auto& all, const auto& visit) {
        using part [[maybe_unused]] = state_of_step<J, Step>;
        if constexpr (has_state<Step>)
            visit(all.part::value);
    }
};

/// The base of steps that consist of these ones: its state is theirs.
template <class... Steps>
struct joined_state {};
template <class... Steps>
    requires(has_state<Steps> || ...)
struct joined_state<Steps...> {
    struct state : states_of_steps<std::index_sequence_for<Steps...>, Steps...> {};
};
/// Calls visit(largest magnitude of its input) for each state of a step or of those inside, in the order of
/// visit_states, if inputs have at most `input`.
template <class Step>
void visit_inputs(const float* folded, double input, const auto& visit) {
    if constexpr (requires { Step::visit_inputs(folded, input, visit); })
        Step::visit_inputs(folded, input, visit);
    else if constexpr (has_state<Step>)
        visit(input);
}
/// Runs step I of those. `states` is their joined state, or nothing if they have none.
template <std::size_t I, class Step>
[[gnu::always_inline]] inline void run_step(const auto* packed, const auto* in, auto* out, auto* memory,
                                            auto&... states) noexcept {
    if constexpr (has_state<Step>)
        Step::run(packed, in, out, memory, static_cast<state_of_step<I, Step>&>(states).value...);
    else
        Step::run(packed, in, out, memory);
}

} // namespace detail

/// The base of steps that write a map of this shape. It has no parameters: steps with parameters hide its
/// members. A step whose outputs can exceed its inputs defines an output_bound of its own.
template <class Format, shape Output, std::size_t Stride>
struct step_base : step_defaults {
    using format = Format;
    static constexpr shape output = Output;
    static constexpr std::size_t output_stride = Stride;
    static constexpr void pack(const float*, typename Format::packed_number*) {}
    static double output_bound(const float*, double input) { return input; }
};

namespace detail {

/// The largest |bias| + input · Σ |weight| of all outputs. `weights` holds [output][weight].
[[nodiscard]] inline double largest_sum(const float* weights, const float* biases, std::size_t outputs,
                                        std::size_t of_one, double input) {
    double most = 0;
    for (std::size_t o = 0; o < outputs; ++o) {
        double sum = 0;
        for (std::size_t i = 0; i < of_one; ++i)
            sum += std::abs(static_cast<double>(weights[o * of_one + i]));
        most = std::max(most, sum * input + std::abs(static_cast<double>(biases[o])));
    }
    return most;
}
/// As above, with the biases after the weights.
[[nodiscard]] inline double largest_sum(const float* weights, std::size_t outputs, std::size_t of_one,
                                        double input) {
    return largest_sum(weights, weights + outputs * of_one, outputs, of_one, input);
}

} // namespace detail

// Each step describes itself once, in the file that declares it, for all that read the description: the
// export of headers, the layout of weight files and the graph for calibration. A description is a list of
// constants, without strings on the heap, so that targets without files may include it:
//
//     template <class Format, shape Map, std::size_t Stride>
//     struct tactnet::step_description<my_step<Format, Map, Stride>> {
//         static constexpr const char* header = "my/step.hpp"; // that declares it, unless the library does
//         static constexpr void visit(auto&& to) {
//             to("my_step", "My layer", std::type_identity<Format>{}, Map, tactnet::input_stride_argument{});
//         }
//     };
//
// The visitor gets the template's name, a human-readable title, and the template's arguments in order: values
// as they are, types as std::type_identity, and the two kinds below.

/// The description of a step, specialised next to the step.
template <class Step>
struct step_description;

/// The argument for the elements from one pixel of the step's input to the next. They depend on the
/// instruction set.
struct input_stride_argument {};

/// How a step is composed of others.
enum class step_composition { chain, sum, product, concatenation, wrapper };

/// The argument for a step inside another one.
template <class Step, step_composition How>
struct inner_step {
    using step = Step;
    const char* name;       ///< its part in the outer step: "main"; numbered in chains and concatenations
    std::size_t offset = 0; ///< of a branch of a concatenation: its first channel
    static constexpr bool numbered = How == step_composition::chain || How == step_composition::concatenation;
};

namespace detail {

/// Whether an argument of a description is a step inside.
template <class Argument>
inline constexpr bool is_inner_step = false;
template <class Step, step_composition How>
inline constexpr bool is_inner_step<inner_step<Step, How>> = true;

} // namespace detail

/// The identity, as the skip of a residual block or a branch of a concatenation.
struct no_step : step_defaults {
    static constexpr void pack(const float*, auto*) {}
    static double output_bound(const float*, double input) { return input; }
};
template <>
struct step_description<no_step> {
    static constexpr void visit(auto&& to) { to("tactnet::no_step", "Nothing"); }
};

}} // namespace tactnet

#pragma once

#include <tactnet/tensor/alignment.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>

// What a deployed network does, step by step. A step stands for one or several layers, and knows sizes only.
// Its constants:
//   output, output_stride   the map it writes, pixel by pixel, and elements from one pixel to the next
//   folded                  numbers that remain of the layers' parameters once batch norms are folded in
//                           ([output][channel][row][column], then biases), in single precision
//   packed                  the same in the order of use, padded to whole vectors, in the number format
//   workspace_elements                 elements of memory it needs while it runs, whole cache lines
// and its functions:
//   pack                    from folded to packed numbers, into zeros; usable when compiling
//   run                     from one map to the next
//   output_bound            the largest magnitude that an output can have where inputs have at most `input`
// It may say besides:
//   large                   whether frames had better pass it together, and one frame occupy all threads
//   fills_map               false if it writes only some channels of a map that others write to as well
//   run_share               the share of one thread in frames that pass together
//   run_batch            how frames pass it together, or the steps inside it, on the threads of a executor
//   gives_probabilities     whether its outputs are probabilities
//   number_elements         elements of the map that a number of its output takes, if not one
// A step that says neither run_share nor run_batch takes such frames one by one (batch_executor.hpp).
// Lanes behind the last channel of a pixel hold zeros in every map.
//
// The headers in this folder need neither exceptions nor run-time type information nor files.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The number format of single precision: maps and packed weights are floats. Each step is a template over a
/// number format, defined where it is specialised for one: another format is another set of specialisations,
/// with the same plan.
struct single_precision {
    using activation = float;                        ///< an element of a map
    using packed = float;                            ///< an element of the packed weights
    using input_format = single_precision;           ///< of the step that reads the frame
    using hidden_format = single_precision;          ///< of steps that read what another step has written
    using output_format = single_precision;          ///< of the step that writes the outputs
    static constexpr bool has_output_format = false; ///< whether that step is written otherwise than others
};

/// How a frame comes into a deployed network, and how its outputs leave it, specialised for each number
/// format.
template <class Format, shape Input>
struct input_stage;
template <class Format, shape Output, std::size_t Stride>
struct output_stage;

namespace detail {

/// Elements of a map that one number of a step's output takes: one, unless the step says otherwise.
template <class Step>
inline constexpr std::size_t number_elements = 1;
template <class Step>
    requires requires {
        Step::number_elements;
    }
inline constexpr std::size_t number_elements<Step> = Step::number_elements;

} // namespace detail

/// What a plan is made of.
template <class Step>
concept deployed_step = requires(const float* folded, typename Step::format::packed* to,
                                 const typename Step::format::packed* packed,
                                 const typename Step::format::activation* in,
                                 typename Step::format::activation* out) {
    { Step::output } -> std::convertible_to<shape>;
    {
        Step::output_stride + Step::folded + Step::packed + Step::workspace_elements
        } -> std::convertible_to<std::size_t>;
    Step::pack(folded, to);
    { Step::output_bound(folded, 1.0) } -> std::same_as<double>;
    { Step::run(packed, in, out, out) }
    noexcept;
};

/// What steps without parameters have in common. They must not enlarge what passes, or say so by a
/// `output_bound` of their own.
template <class Format, shape Output, std::size_t Stride>
struct step_without_parameters {
    using format = Format;
    static constexpr shape output = Output;
    static constexpr std::size_t output_stride = Stride;
    static constexpr std::size_t folded = 0, packed = 0, workspace_elements = 0;
    static constexpr void pack(const float*, typename Format::packed*) {}
    static double output_bound(const float*, double input) { return input; }
};

namespace detail {

/// Whether a step writes all of its map.
template <class Step>
inline constexpr bool fills_map = [] {
    if constexpr (requires { Step::fills_map; })
        return Step::fills_map;
    else
        return true;
}();

/// Whether the outputs of a step are probabilities, as those of a softmax.
template <class Step>
inline constexpr bool gives_probabilities = [] {
    if constexpr (requires { Step::gives_probabilities; })
        return Step::gives_probabilities;
    else
        return false;
}();

/// For [output][weights of one], then biases: the largest |bias| + input · Σ |weight|.
[[nodiscard]] inline double largest_sum(const float* weights, std::size_t outputs, std::size_t of_one,
                                        double input) {
    double most = 0;
    for (std::size_t o = 0; o < outputs; ++o) {
        double sum = 0;
        for (std::size_t i = 0; i < of_one; ++i)
            sum += std::abs(static_cast<double>(weights[o * of_one + i]));
        most = std::max(most, sum * input + std::abs(static_cast<double>(weights[outputs * of_one + o])));
    }
    return most;
}

} // namespace detail
} // namespace TACTNET_ARCH
} // namespace tactnet

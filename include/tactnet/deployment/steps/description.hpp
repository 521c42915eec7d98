#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>

// Each step describes itself beside its declaration, once for all who need to know what a step is: the export
// of headers, the layout of weight files and the graph for calibration. A description is a list of constants,
// without strings on the heap, so that targets without files may include it:
//
//     template <class Format, shape Map, std::size_t Stride>
//     struct tactnet::step_description<my_step<Format, Map, Stride>> {
//         static constexpr const char* header = "my/step.hpp"; // that declares it, unless the library does
//         static constexpr void visit(auto&& to) {
//             to("my_step", "My layer", std::type_identity<Format>{}, Map, tactnet::input_stride{});
//         }
//     };
//
// The visitor gets the template's name, a title for people, and the template's arguments in order: values as
// they are, types as std::type_identity, and the two kinds below.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The description of a step, specialised beside it.
template <class Step>
struct step_description;

/// The argument for the elements from one pixel of the step's input to the next. They depend on the
/// instruction set.
struct input_stride {};

/// How a step is composed of others.
enum class composition { chain, sum, concatenation, wrapper };

/// The argument for a step inside another one.
template <class Step, composition How>
struct inner_step {
    using step = Step;
    const char* name;       ///< its part in the outer step: "main"; numbered in chains and concatenations
    std::size_t offset = 0; ///< of a branch of a concatenation: its first channel
    static constexpr bool numbered = How == composition::chain || How == composition::concatenation;
};

namespace detail {

/// Whether an argument of a description is a step inside.
template <class Argument>
inline constexpr bool is_inner_step = false;
template <class Step, composition How>
inline constexpr bool is_inner_step<inner_step<Step, How>> = true;

} // namespace detail
} // namespace TACTNET_ARCH
} // namespace tactnet

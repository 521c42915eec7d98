#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/deployment/export/header_description.hpp>
#include <tactnet/deployment/export/literals.hpp>
#include <tactnet/deployment/export/step_text.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

// Writes a deployed network as a C++ header, for targets without files. A header compiles for any instruction
// set, whichever wrote it; only the outputs of its self-test may differ in their last bits.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// The template of an exported header: deployed_header replaces each @name@.
inline constexpr std::string_view header_form =
    R"(// @network@ for frames of @size@ (rows × columns × channels), @outputs@ outputs,
// @parameters@ parameters, of which @folded@ numbers remain once batch norms are folded in. Generated: do not edit.
//
// recogniser.classify(counts@memory@) returns the class of a frame, recogniser.infer(counts, outputs@memory@) writes
// its outputs. They need no files, no heap, no exceptions and no run-time type information.
#pragma once

#include <tactnet/deployment/deployed_view.hpp>
@includes@
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace @namespace@ {
inline namespace TACTNET_ARCH {

@steps@
using recogniser_type = tactnet::deployed_view<tactnet::shape{.rows = @rows@, .columns = @columns@, .channels = @channels@}, @chain@>;

/// Names of the first outputs, in order. Further outputs are unused.
inline constexpr std::array<std::string_view, @class count@> classes{
@classes@};

/// The mean frame, the scale, the largest input, then weights and biases step by step.
inline constexpr std::array<float, recogniser_type::folded_elements> folded{
@numbers@};
static_assert(folded.size() == @count@, "this header does not fit this version of tactnet");

@packed@
inline constexpr recogniser_type recogniser(packed@known@);

/// A frame and what it gives.
inline constexpr std::array<std::uint8_t, recogniser_type::input_shape.size()> selftest_frame{
@frame@};
inline constexpr std::array<float, recogniser_type::outputs> selftest_outputs{
@frame outputs@};

/// Whether this build reproduces the recorded outputs of the frame.
inline bool passes_selftest(@memory parameter@) noexcept {
    std::array<float, recogniser_type::outputs> outputs;
    if (recogniser.infer(selftest_frame, outputs@memory@) != tactnet::frame_status::ok)
        return false;
    float largest = 0, difference = 0;
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        const float expected = selftest_outputs[i], found = outputs[i] - expected;
        largest = largest > expected ? largest : expected;
        largest = largest > -expected ? largest : -expected;
        difference = difference > found ? difference : found;
        difference = difference > -found ? difference : -found;
    }
    return difference <= largest * 1e-4f;
}

} // namespace TACTNET_ARCH
} // namespace @namespace@
)";

inline constexpr std::string_view packed_when_compiling =
    R"(/// In the order of use, for the instruction set that this is compiled for.
inline constexpr recogniser_type::packed_weights packed = recogniser_type::pack(folded);)";

inline constexpr std::string_view packed_at_start =
    R"(/// In the order of use, for the instruction set that this is compiled for. At the latest packed before main: not for
/// use by what else happens then.
inline const recogniser_type::packed_weights packed = recogniser_type::pack(folded);)";

} // namespace detail

/// Returns the text of a header that holds a deployed network. The header includes deployed_view.hpp and
/// compiles without exceptions and run-time type information. In the chosen namespace it defines
///   recogniser      the network, a deployed_view
///   classes         names of its first outputs, in order; further outputs are unused
///   passes_selftest whether `frame`, some counts, still gives the outputs that it gives here, to 1e-4 of the
///                   largest
/// A network that needs more workspace than a stack should hold takes it as a last argument, in calls of
/// both. Throws std::invalid_argument if a name is not allowed or the frame gives outputs that are not
/// finite.
template <class Network, class Format>
[[nodiscard]] std::string deployed_header(const deployed<Network, Format>& network,
                                          const header_description& description,
                                          std::span<const std::uint8_t, Network::input_shape.size()> frame) {
    using deployed_type = deployed<Network, Format>;
    using view = typename deployed_type::view_type;
    constexpr shape input = Network::input_shape;
    if (!is_namespace_name(description.namespace_name))
        throw std::invalid_argument(
            "deployed_header: expected a namespace such as gripper::tactile, found '" +
            description.namespace_name + "'");
    if (description.classes.size() > deployed_type::outputs)
        throw std::invalid_argument("deployed_header: expected at most " +
                                    std::to_string(deployed_type::outputs) + " class names, found " +
                                    std::to_string(description.classes.size()));
    std::array<float, deployed_type::outputs> outputs;
    const auto memory = std::make_unique<typename view::workspace>(); // may be more than a stack holds
    if (network.infer(frame, outputs, *memory) != frame_status::ok)
        throw std::invalid_argument("deployed_header: expected a frame that gives finite outputs for the "
                                    "self-test, found one that does not");

    step_text steps;
    const std::string chain =
        steps.template define<typename view::steps>(input, std::to_string(input.channels));
    std::string includes, classes;
    if constexpr (requires { Format::steps_header; })
        steps.include(Format::steps_header);
    for (const std::string& header : steps.includes())
        includes += "#include <" + header + ">\n";
    for (const std::string& name : description.classes)
        classes += "    " + detail::string_literal(name) + ",\n";
    const bool on_stack = view::workspace_bytes <= view::max_stack_bytes;
    const bool when_compiling =
        description.when.value_or(usual_packing(view::folded_elements)) == header_packing::when_compiling;
    return detail::filled(
        detail::header_form,
        {{"network", detail::one_line(description.network)},
         {"size", detail::size_of(input)},
         {"outputs", std::to_string(deployed_type::outputs)},
         {"parameters", std::to_string(Network::parameters)},
         {"folded", std::to_string(view::folded_elements - view::steps_folded)},
         {"namespace", description.namespace_name},
         {"includes", includes},
         {"steps", steps.definitions()},
         {"rows", std::to_string(input.rows)},
         {"columns", std::to_string(input.columns)},
         {"channels", std::to_string(input.channels)},
         {"chain", chain},
         {"class count", std::to_string(description.classes.size())},
         {"known", description.classes.empty() ? "" : ", classes.size()"},
         {"classes", classes},
         {"numbers", detail::number_lines<float>(network.folded(), detail::float_literal)},
         {"count", std::to_string(view::folded_elements)},
         {"packed", std::string(when_compiling ? detail::packed_when_compiling : detail::packed_at_start)},
         {"memory", on_stack ? "" : ", memory"},
         {"memory parameter", on_stack ? "" : "recogniser_type::workspace& memory"},
         {"frame", detail::number_lines<std::uint8_t>(
                       frame, [](std::uint8_t count) { return std::to_string(count); })},
         {"frame outputs", detail::number_lines<float>(outputs, detail::float_literal)}});
}

}} // namespace tactnet

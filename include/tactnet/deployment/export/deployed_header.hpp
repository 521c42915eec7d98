#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/deployment/export/header_description.hpp>
#include <tactnet/deployment/export/header_form.hpp>
#include <tactnet/deployment/export/literals.hpp>
#include <tactnet/deployment/export/step_text.hpp>
#include <tactnet/text/message.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Writes a deployed network as a C++ header, for targets without files. A header compiles for any instruction
// set, whichever wrote it; only the outputs of its self-test may differ in their last bits.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// The parts of a header of its own: deployed_header puts header_beginning and header_end around them.
inline constexpr std::string_view network_comment =
    R"(// @network@ for frames of @size@ (rows × columns × channels), @outputs@ outputs,
// @parameters@ parameters, of which @remaining@ numbers remain once batch norms are folded in. Generated: do not edit.
//
// recogniser.classify(counts@memory@) returns the class of a frame, recogniser.infer(counts, outputs@memory@) writes
// its outputs. They need no files, no heap, no exceptions and no run-time type information.
)";
inline constexpr std::string_view network_selftest =
    R"(/// A frame and what it gives.
inline constexpr std::array<std::uint8_t, recogniser_type::input_shape.size()> selftest_frame{
@frame@};
inline constexpr std::array<float, recogniser_type::outputs> selftest_outputs{
@frame outputs@};

/// Whether this build reproduces the recorded outputs of the frame.
inline bool passes_selftest(@memory parameter@) noexcept {
    std::array<float, recogniser_type::outputs> outputs;
    if (recogniser.infer(selftest_frame, outputs@memory@) != tactnet::frame_status::ok)
        return false;
)";

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
    detail::require_names(description, deployed_type::outputs);
    std::array<float, deployed_type::outputs> outputs;
    const auto memory = std::make_unique<typename view::workspace>(); // may be more than a stack holds
    if (network.infer(frame, outputs, *memory) != frame_status::ok)
        detail::throw_invalid_argument({"deployed_header: expected a frame that gives finite outputs for the "
                                        "self-test, found one that does not"});

    step_text steps;
    const std::string chain =
        steps.template define<typename view::steps>(input, std::to_string(input.channels));
    if constexpr (requires { Format::steps_header; })
        steps.include(Format::steps_header);
    const bool on_stack = view::workspace_bytes <= view::max_stack_bytes;
    std::vector<detail::replacement> fields =
        detail::common_fields(description, steps, network.folded(), usual_packing(view::folded_elements));
    fields.insert(
        fields.end(),
        {{"view header", "tactnet/deployment/deployed_view.hpp"},
         {"type", "tactnet::deployed_view<" + detail::text_of(input) + ", " + chain + ">"},
         {"contents", "The mean frame, the scale, the largest input, then weights and biases step by step."},
         {"size", detail::size_of(input)},
         {"outputs", std::to_string(deployed_type::outputs)},
         {"parameters", std::to_string(Network::parameters)},
         {"remaining", std::to_string(view::folded_elements - view::steps_folded)},
         {"known",
          (description.classes.empty() ? network.temperature() == 1 ? "" : ", recogniser_type::outputs"
                                       : ", classes.size()") +
              (network.temperature() == 1 ? "" : ", " + detail::literal(network.temperature()))},
         {"memory", on_stack ? "" : ", memory"},
         {"memory parameter", on_stack ? "" : "recogniser_type::workspace& memory"},
         {"frame", detail::number_lines<std::uint8_t>(
                       frame, [](std::uint8_t count) { return std::to_string(count); })},
         {"frame outputs", detail::number_lines<float>(outputs, detail::literal<float>)}});
    return detail::filled(
        {detail::network_comment, detail::header_beginning, detail::network_selftest, detail::header_end},
        fields);
}

}} // namespace tactnet

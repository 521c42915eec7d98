#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/deployment/export/header_description.hpp>
#include <tactnet/deployment/export/header_form.hpp>
#include <tactnet/deployment/export/step_text.hpp>
#include <tactnet/deployment/stream.hpp>
#include <tactnet/text/message.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

// Writes a deployed network or a stream as a C++ header, for targets without files. A header compiles for any
// instruction set, whichever wrote it; only the outputs of its self-test may differ in their last bits.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

// The parts of both kinds of headers: detail::header_text puts header_beginning and header_end around them.

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
@on a stack@inline bool passes_selftest(recogniser_type::workspace& memory) noexcept {
    std::array<float, recogniser_type::outputs> outputs;
    if (recogniser.infer(selftest_frame, outputs, memory) != tactnet::frame_status::ok)
        return false;
)";

inline constexpr const char* selftest_on_stack =
    R"(inline bool passes_selftest(recogniser_type::workspace& memory) noexcept;
inline bool passes_selftest() noexcept {
    recogniser_type::workspace memory;
    return passes_selftest(memory);
}
)";

inline constexpr std::string_view stream_comment =
    R"(// @network@ for frames of @features@ features, one after the other, @outputs@ outputs after each frame,
// @parameters@ parameters. Generated: do not edit.
//
// recogniser.step(features, state, outputs) takes one frame and writes the outputs after it; recogniser.classify(features,
// state) returns the class. recogniser_type::state is yours: state{} begins a recording. They need no files, no heap, no
// exceptions and no run-time type information.
)";
inline constexpr std::string_view stream_selftest =
    R"(/// A recording, frame by frame, and the outputs after its last frame.
inline constexpr std::array<float, @recorded frames@ * recogniser_type::features> selftest_recording{
@recording@};
inline constexpr std::array<float, recogniser_type::outputs> selftest_outputs{
@frame outputs@};

/// Whether this build reproduces the outputs of the recording.
inline bool passes_selftest() noexcept {
    recogniser_type::state state;
    std::array<float, recogniser_type::features> frame;
    std::array<float, recogniser_type::outputs> outputs{};
    for (std::size_t first = 0; first < selftest_recording.size(); first += frame.size()) {
        for (std::size_t f = 0; f < frame.size(); ++f)
            frame[f] = selftest_recording[first + f];
        if (recogniser.step(frame, state, outputs) != tactnet::frame_status::ok)
            return false;
    }
)";

/// The text of a header for a view of this type, whose first template argument is `input`.
template <class Network, class Format, class View>
[[nodiscard]] std::string header_text(const header_description& description, std::span<const float> folded,
                                      const shape& input, const char* name, const std::string& first_argument,
                                      std::span<const float> outputs, header_packing usual,
                                      std::array<std::string_view, 2> parts, std::vector<replacement> own) {
    step_text steps;
    const std::string chain =
        steps.template define<typename View::steps>(input, std::to_string(input.channels));
    if constexpr (requires { Format::steps_header; })
        steps.include(Format::steps_header);
    std::vector<replacement> fields = common_fields(description, steps, folded, usual);
    fields.insert(fields.end(),
                  {{"view header", std::string("tactnet/deployment/") + name + ".hpp"},
                   {"type", std::string("tactnet::") + name + "<" + first_argument + ", " + chain + ">"},
                   {"outputs", std::to_string(outputs.size())},
                   {"parameters", std::to_string(Network::parameters)},
                   {"frame outputs", number_lines<float>(outputs, literal<float>)}});
    fields.insert(fields.end(), own.begin(), own.end());
    return filled({parts[0], header_beginning, parts[1], header_end}, fields);
}

/// The arguments of a view after its packed weights, if they differ from the defaults.
[[nodiscard]] inline std::string known_arguments(const header_description& description, double temperature,
                                                 const input_function& function = {},
                                                 const reflection_rule& rule = reflection_rule::all()) {
    const std::string classes = description.classes.empty() ? "recogniser_type::outputs" : "classes.size()";
    const auto axis = [](const reflection_rule::axis& a, const char* partners) {
        return std::string(a.reflects ? "{true, {" : "{false, {") + (a.partners.empty() ? "" : partners) +
               "}}";
    };
    if (!function.identity() || rule != reflection_rule::all())
        return ", " + classes + ", " + literal(temperature) +
               ", tactnet::input_function{static_cast<tactnet::count_rule>(" +
               std::to_string(static_cast<int>(function.rule)) + "), " + literal(function.knee) +
               "}, tactnet::reflection_rule_view{" + axis(rule.rows, "row_partners") + ", " +
               axis(rule.columns, "column_partners") + "}";
    if (temperature != 1)
        return ", " + classes + ", " + literal(temperature);
    return description.classes.empty() ? "" : ", " + classes;
}

/// The partners of classes along the axes that have some.
[[nodiscard]] inline std::string partner_arrays(const reflection_rule& rule) {
    std::string arrays;
    for (const auto& [name, axis] :
         {std::pair("row_partners", &rule.rows), std::pair("column_partners", &rule.columns)})
        if (!axis->partners.empty())
            arrays += joined(
                {"inline constexpr std::array<std::size_t, ", axis->partners.size(), "> ", name, "{\n",
                 number_lines<std::size_t>(axis->partners, [](std::size_t p) { return std::to_string(p); }),
                 "};\n"});
    return arrays;
}

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

    const bool on_stack = view::workspace_bytes <= view::max_stack_bytes;
    return detail::header_text<Network, Format, view>(
        description, network.folded(), input, "deployed_view", detail::text_of(input), outputs,
        usual_packing(view::folded_elements), {detail::network_comment, detail::network_selftest},
        {{"contents", "The mean frame, the scale, the largest input, then weights and biases step by step."},
         {"size", detail::size_of(input)},
         {"remaining", std::to_string(view::folded_elements - view::steps_folded)},
         {"known", detail::known_arguments(description, network.temperature(), network.function(),
                                           network.reflections())},
         {"partners", detail::partner_arrays(network.reflections())},
         {"on a stack", on_stack ? detail::selftest_on_stack : ""},
         {"frame", detail::number_lines<std::uint8_t>(
                       frame, [](std::uint8_t count) { return std::to_string(count); })}});
}

/// As above for a deployed stream: `recogniser` is a stream_view, and `passes_selftest` runs `recording`,
/// some whole frames. Throws std::invalid_argument if a name is not allowed, if the recording does not
/// consist of whole frames, or if the stream refuses one of them.
template <class Network, class Format>
[[nodiscard]] std::string deployed_header(const deployed_stream<Network, Format>& stream,
                                          const header_description& description,
                                          std::span<const float> recording) {
    using view = typename deployed_stream<Network, Format>::view_type;
    detail::require_names(description, view::outputs);
    if (recording.empty() || recording.size() % view::features != 0)
        detail::throw_invalid_argument({"deployed_header: expected a recording of one or more frames of ",
                                        view::features, " features, found ", recording.size(), " numbers"});
    const std::size_t frames = recording.size() / view::features;
    typename view::state state;
    std::vector<float> outputs(frames * view::outputs);
    if (stream.run(recording, state, outputs) != frames)
        detail::throw_invalid_argument({"deployed_header: expected a recording that the stream takes for the "
                                        "self-test, found a frame that it refuses"});
    // Rows are padded to whole vectors, which in 8 bits are four times as long.
    constexpr std::size_t packed_steps = std::is_same_v<Format, single_precision> ? 1 : 4;
    const std::string features = std::to_string(view::features);
    return detail::header_text<Network, Format, view>(
        description, stream.folded(), {1, 1, view::features}, "stream_view", features,
        std::span(outputs).last(view::outputs), usual_packing(packed_steps * view::folded_elements),
        {detail::stream_comment, detail::stream_selftest},
        {{"contents", "What the input needs, then weights and biases step by step."},
         {"features", features},
         {"known", detail::known_arguments(description, stream.temperature())},
         {"recorded frames", std::to_string(frames)},
         {"recording", detail::number_lines<float>(recording, detail::literal<float>)}});
}

}} // namespace tactnet

#pragma once

#include <tactnet/deployment/export/header_description.hpp>
#include <tactnet/deployment/export/header_form.hpp>
#include <tactnet/deployment/export/step_text.hpp>
#include <tactnet/deployment/stream.hpp>
#include <tactnet/text/message.hpp>

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

// Writes a deployed stream as a C++ header, as deployed_header.hpp writes a network of images.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// The parts of a header of its own: deployed_header puts header_beginning and header_end around them.
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
@recorded outputs@};

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

} // namespace detail

/// Returns the text of a header that holds a deployed stream. The header includes stream_view.hpp and
/// compiles without exceptions and run-time type information. In the chosen namespace it defines
///   recogniser      the stream, a stream_view
///   classes         names of its first outputs, in order; further outputs are unused
///   passes_selftest whether `recording`, some whole frames, still gives the outputs that it gives here, to
///                   1e-4 of the largest
/// Throws std::invalid_argument if a name is not allowed, if the recording does not consist of whole frames,
/// or if the stream refuses one of them.
template <class Network, class Format>
[[nodiscard]] std::string deployed_header(const deployed_stream<Network, Format>& stream,
                                          const header_description& description,
                                          std::span<const float> recording) {
    using view = typename deployed_stream<Network, Format>::view_type;
    detail::require_names(description, view::outputs);
    if (recording.empty() || recording.size() % view::features != 0)
        detail::throw_invalid_argument({"deployed_header: expected a recording of one or more frames of ",
                                        view::features, " features, found ", recording.size(), " numbers"});
    typename view::state state;
    std::array<float, view::outputs> outputs{};
    for (std::size_t first = 0; first < recording.size(); first += view::features)
        if (stream.step(recording.subspan(first).template first<view::features>(), state, outputs) !=
            frame_status::ok)
            detail::throw_invalid_argument({"deployed_header: expected a recording that the stream takes for "
                                            "the self-test, found a frame that it refuses"});

    // Rows are padded to whole vectors, which in 8 bits are four times as long.
    constexpr std::size_t packed_steps = std::is_same_v<Format, single_precision> ? 1 : 4;
    step_text steps;
    const std::string chain = steps.template define<typename view::steps>({1, 1, view::features}, "");
    if constexpr (!std::is_same_v<Format, single_precision>)
        steps.include(Format::stream_steps_header);
    std::vector<detail::replacement> fields = detail::common_fields(
        description, steps, stream.folded(), usual_packing(packed_steps * stream.folded().size()));
    fields.insert(fields.end(),
                  {{"view header", "tactnet/deployment/stream_view.hpp"},
                   {"type", "tactnet::stream_view<" + chain + ">"},
                   {"contents", "What the input needs, then weights and biases step by step."},
                   {"features", std::to_string(view::features)},
                   {"outputs", std::to_string(view::outputs)},
                   {"parameters", std::to_string(Network::parameters)},
                   {"known", description.classes.empty() ? "" : ", classes.size()"},
                   {"recorded frames", std::to_string(recording.size() / view::features)},
                   {"recording", detail::number_lines<float>(recording, detail::literal<float>)},
                   {"recorded outputs", detail::number_lines<float>(outputs, detail::literal<float>)}});
    return detail::filled(
        {detail::stream_comment, detail::header_beginning, detail::stream_selftest, detail::header_end},
        fields);
}

}} // namespace tactnet

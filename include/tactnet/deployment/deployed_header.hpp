#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/deployment/header_description.hpp>
#include <tactnet/deployment/step_text.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

// A deployed network as the text of a C++ header, for targets without files. Whatever instruction set it is
// written with, it can be compiled for any; only the outputs of its self-test may differ in their last bits.

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

/// As a string literal, bytes beyond ASCII and all that means something in it as octal numbers.
inline std::string string_literal(std::string_view text) {
    std::string literal = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\' || c == '?') // ?: trigraphs
            (literal += '\\') += c;
        else if (code >= 0x20 && code < 0x7f)
            literal += c;
        else
            for (literal += '\\'; const int shift : {6, 3, 0})
                literal += static_cast<char>('0' + ((code >> shift) & 7));
    }
    return literal + '"';
}

/// For a comment of one line: nothing that could end it.
inline std::string one_line(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == '\\')
            c = ' ';
    return text;
}

/// In hexadecimal: exact by its form, and compilers read it as fast as decimal numbers.
inline std::string float_literal(float value) {
    char text[32];
    const float magnitude = std::abs(value);
    const auto end = std::to_chars(text, text + sizeof(text), magnitude, std::chars_format::hex);
    return (std::signbit(value) ? "-0x" : "0x") + std::string(text, end.ptr) + "f";
}

/// All numbers with commas between, in lines of about a hundred characters.
template <class Numbers, class Text>
std::string number_lines(const Numbers& numbers, Text&& text_of) {
    std::string lines, line = "   ";
    for (const auto& number : numbers) {
        const std::string text = text_of(number);
        if (line.size() + text.size() > 108) {
            lines += line + "\n";
            line = "   ";
        }
        line += " " + text + ",";
    }
    return lines + line + "\n";
}

/// A text with every @name@ replaced by what belongs to it.
using replacement = std::pair<std::string_view, std::string>;
inline std::string filled(std::string_view text, std::initializer_list<replacement> values) {
    std::string result;
    while (true) {
        const std::size_t begin = text.find('@');
        result += text.substr(0, begin);
        if (begin == std::string_view::npos)
            return result;
        const std::size_t end = text.find('@', begin + 1);
        const std::string_view name = text.substr(begin + 1, end - begin - 1);
        for (const replacement& value : values)
            if (value.first == name)
                result += value.second;
        text.remove_prefix(end + 1);
    }
}

inline constexpr std::string_view header_form =
    R"(// @network@ for frames of @size@ (rows × columns × channels), @outputs@ outputs,
// @parameters@ parameters, of which @folded@ numbers remain once batch norms are folded in. Generated: do not edit.
//
// recogniser(counts, outputs) recognises a frame. It needs no files, no heap, no exceptions and no run-time
// type information.
#pragma once

#include <tactnet/deployment/deployed_view.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace @namespace@::inline TACTNET_ARCH {

@steps@
using recogniser_type = tactnet::deployed_view<tactnet::shape{.rows = @rows@, .columns = @columns@, .channels = @channels@}, @chain@>;

/// Names of the first outputs, in order. Outputs behind them stand for nothing.
inline constexpr std::array<std::string_view, @class count@> classes{
@classes@};

/// The mean frame, the scale, the largest input, then weights and biases step by step.
inline constexpr std::array<float, recogniser_type::folded_elements> folded{
@numbers@};
static_assert(folded.size() == @count@, "this header does not fit this version of tactnet");

@packed@
inline constexpr recogniser_type recogniser(packed);

/// A frame and what it gives.
inline constexpr std::array<std::uint8_t, recogniser_type::input_shape.size()> selftest_frame{
@frame@};
inline constexpr std::array<float, recogniser_type::outputs> selftest_outputs{
@frame outputs@};

/// Whether compiler and processor still make of the frame what they should.
inline bool passes_selftest() noexcept {
    std::array<float, recogniser_type::outputs> outputs;
    if (recogniser(selftest_frame, outputs) != tactnet::frame_status::recognised)
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

/// The text of a header that holds a deployed network: includes deployed_view.hpp, compiles without
/// exceptions and run-time type information. In the chosen namespace it defines
///   recogniser      the network, to be called as a deployed_view
///   classes         names of its first outputs, in order; outputs behind them stand for nothing
///   passes_selftest whether `frame`, some counts, still gives the outputs that it gives here, to 1e-4 of the
///                   largest
/// Throws std::invalid_argument for names that cannot be and for a frame that is not recognised.
template <class Network>
[[nodiscard]] std::string deployed_header(const deployed<Network>& network, const header_description& says,
                                          std::span<const std::uint8_t, Network::input_shape.size()> frame) {
    using deployed_type = deployed<Network>;
    using view = typename deployed_type::view_type;
    constexpr shape input = Network::input_shape;
    if (!is_namespace_name(says.namespace_name))
        throw std::invalid_argument(
            "deployed_header: expected a namespace such as gripper::tactile, found '" + says.namespace_name +
            "'");
    if (says.classes.size() > deployed_type::outputs)
        throw std::invalid_argument("deployed_header: expected at most " +
                                    std::to_string(deployed_type::outputs) + " class names, found " +
                                    std::to_string(says.classes.size()));
    std::array<float, deployed_type::outputs> outputs;
    if (network(tensor_view<const std::uint8_t, input>(frame), outputs) != frame_status::recognised)
        throw std::invalid_argument("deployed_header: expected a frame that gives finite outputs for the "
                                    "self-test, found one that does not");

    step_text steps;
    const std::string chain =
        steps.template define<typename view::steps>(input, std::to_string(input.channels));
    std::string classes;
    for (const std::string& name : says.classes)
        classes += "    " + detail::string_literal(name) + ",\n";
    const bool when_compiling =
        says.when.value_or(usual_packing(view::folded_elements)) == packing::when_compiling;
    return detail::filled(
        detail::header_form,
        {{"network", detail::one_line(says.network)},
         {"size", step_text::size(input)},
         {"outputs", std::to_string(deployed_type::outputs)},
         {"parameters", std::to_string(Network::parameters)},
         {"folded", std::to_string(view::folded_elements - view::steps_folded)},
         {"namespace", says.namespace_name},
         {"steps", steps.definitions()},
         {"rows", std::to_string(input.rows)},
         {"columns", std::to_string(input.columns)},
         {"channels", std::to_string(input.channels)},
         {"chain", chain},
         {"class count", std::to_string(says.classes.size())},
         {"classes", classes},
         {"numbers", detail::number_lines(network.folded(), detail::float_literal)},
         {"count", std::to_string(view::folded_elements)},
         {"packed", std::string(when_compiling ? detail::packed_when_compiling : detail::packed_at_start)},
         {"frame", detail::number_lines(frame, [](std::uint8_t count) { return std::to_string(count); })},
         {"frame outputs", detail::number_lines(outputs, detail::float_literal)}});
}

} // namespace TACTNET_ARCH
} // namespace tactnet

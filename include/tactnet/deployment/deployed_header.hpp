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

namespace tactnet::inline TACTNET_ARCH {

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
    const std::string first_stride = std::to_string(input.channels);
    const std::string chain = steps.template define<typename view::steps>(input, first_stride);
    const std::string folded_count = std::to_string(view::folded_elements);
    const auto count_text = [](std::uint8_t count) { return std::to_string(count); };

    std::string text = "// " + detail::one_line(says.network) + " for frames of " + step_text::size(input) +
                       " (rows × columns × channels), " + std::to_string(deployed_type::outputs) +
                       " outputs,\n// " + std::to_string(Network::parameters) + " parameters, of which " +
                       std::to_string(view::folded_elements - view::steps_folded) +
                       " numbers remain once batch norms are folded in. Generated: do not edit.\n"
                       "//\n"
                       "// recogniser(counts, outputs) recognises a frame. It needs no files, no heap, no "
                       "exceptions and no run-time\n// type information.\n"
                       "#pragma once\n\n"
                       "#include <tactnet/deployment/deployed_view.hpp>\n\n"
                       "#include <array>\n#include <cstddef>\n#include <cstdint>\n#include <string_view>\n\n"
                       "namespace " +
                       says.namespace_name + "::inline TACTNET_ARCH {\n\n" + steps.definitions() +
                       "\nusing recogniser_type = tactnet::deployed_view<tactnet::shape{.rows = " +
                       std::to_string(input.rows) + ", .columns = " + std::to_string(input.columns) +
                       ", .channels = " + std::to_string(input.channels) + "}, " + chain + ">;\n\n";

    text += "/// Names of the first outputs, in order. Outputs behind them stand for nothing.\n"
            "inline constexpr std::array<std::string_view, " +
            std::to_string(says.classes.size()) + "> classes{\n";
    for (const std::string& name : says.classes)
        text += "    " + detail::string_literal(name) + ",\n";
    text += "};\n\n"
            "/// The mean frame, the scale, the largest input, then weights and biases step by step.\n"
            "inline constexpr std::array<float, recogniser_type::folded_elements> folded{\n" +
            detail::number_lines(network.folded(), detail::float_literal) +
            "};\nstatic_assert(folded.size() == " + folded_count +
            ", \"this header does not fit this version of tactnet\");\n\n";

    text += says.when.value_or(usual_packing(view::folded_elements)) == packing::when_compiling
                ? "/// In the order of use, for the instruction set that this is compiled for.\n"
                  "inline constexpr recogniser_type::packed_weights packed = recogniser_type::pack(folded);\n"
                : "/// In the order of use, for the instruction set that this is compiled for. At the latest "
                  "packed before main: not for\n/// use by what else happens then.\n"
                  "inline const recogniser_type::packed_weights packed = recogniser_type::pack(folded);\n";
    text += "inline constexpr recogniser_type recogniser(packed);\n\n";

    text += "/// A frame and what it gives.\n"
            "inline constexpr std::array<std::uint8_t, recogniser_type::input_shape.size()> "
            "selftest_frame{\n" +
            detail::number_lines(frame, count_text) +
            "};\n"
            "inline constexpr std::array<float, recogniser_type::outputs> selftest_outputs{\n" +
            detail::number_lines(outputs, detail::float_literal) +
            "};\n\n"
            "/// Whether compiler and processor still make of the frame what they should.\n"
            "inline bool passes_selftest() noexcept {\n"
            "    std::array<float, recogniser_type::outputs> outputs;\n"
            "    if (recogniser(selftest_frame, outputs) != tactnet::frame_status::recognised)\n"
            "        return false;\n"
            "    float largest = 0, difference = 0;\n"
            "    for (std::size_t i = 0; i < outputs.size(); ++i) {\n"
            "        const float expected = selftest_outputs[i], found = outputs[i] - expected;\n"
            "        largest = largest > expected ? largest : expected;\n"
            "        largest = largest > -expected ? largest : -expected;\n"
            "        difference = difference > found ? difference : found;\n"
            "        difference = difference > -found ? difference : -found;\n"
            "    }\n"
            "    return difference <= largest * 1e-4f;\n"
            "}\n\n"
            "} // namespace " +
            says.namespace_name + "\n";
    return text;
}

} // namespace tactnet

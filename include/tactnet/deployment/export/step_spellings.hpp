#pragma once

#include <tactnet/deployment/export/step_text.hpp>
#include <tactnet/deployment/steps.hpp>

#include <cstddef>
#include <initializer_list>
#include <string>
#include <type_traits>

// How the library's own steps are spelled.

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

/// For people.
[[nodiscard]] inline std::string by(const extent2d& e) {
    return std::to_string(e.rows) + " × " + std::to_string(e.columns);
}
template <class Format>
inline constexpr const char* format_name = nullptr;
template <>
inline constexpr const char* format_name<single_precision> = "tactnet::single_precision";
/// `name`: the header that declares the steps of a format other than single precision.
template <class Format>
struct format_header;

/// An axis of average windows, and all of them, as C++.
[[nodiscard]] inline std::string spelling_of(const average_axis& a) {
    std::string text = "{"; // appended: GCC 12 warns of a sum that begins with so short a literal
    for (const std::size_t number : {a.size, a.outputs, a.kernel, a.stride, a.before, a.after})
        text += (text.size() > 1 ? ", " : "") + std::to_string(number);
    return text + "}";
}
[[nodiscard]] inline std::string spelling_of(const average_windows& w) {
    return "tactnet::average_windows{.rows = " + spelling_of(w.rows) +
           ", .columns = " + spelling_of(w.columns) + ", .counts_padding = " + text_of(w.counts_padding) +
           "}";
}
template <class Ratio>
[[nodiscard]] std::string spelling_of_ratio() {
    return "std::ratio<" + std::to_string(Ratio::num) + ", " + std::to_string(Ratio::den) + ">";
}
template <class Rule>
struct rule_spelling;
template <std::size_t Size, class Alpha, class Beta, class K>
struct rule_spelling<kernels::response_rule<Size, Alpha, Beta, K>> {
    static std::string of() {
        return "tactnet::kernels::response_rule<" + std::to_string(Size) + ", " + spelling_of_ratio<Alpha>() +
               ", " + spelling_of_ratio<Beta>() + ", " + spelling_of_ratio<K>() + ">";
    }
};

/// tactnet::name<format, argument, …>
[[nodiscard]] inline std::string step_type(const char* name, const char* format,
                                           std::initializer_list<std::string> arguments) {
    std::string text = "tactnet::" + std::string(name) + "<" + format;
    for (const std::string& argument : arguments)
        text += ", " + argument;
    return text + ">";
}
template <class Format>
[[nodiscard]] std::string step_type(const char* name, std::initializer_list<std::string> arguments) {
    return step_type(name, format_name<Format>, arguments);
}

// Not templates, so that what spells them is compiled once for all steps of a network.
[[nodiscard]] inline std::string spelling_of(const kernels::frame_convolution& c, const std::string& stride) {
    std::string text = "tactnet::kernels::frame_convolution{\n    .window = " + text_of(c.window) +
                       ",\n    .filters = " + std::to_string(c.filters) + ", .input_stride = " + stride +
                       ", .pool = " + text_of(c.pool) + ", .pooled_rows = " + std::to_string(c.pooled_rows) +
                       ", .pooled_columns = " + std::to_string(c.pooled_columns) +
                       ", .rectified = " + text_of(c.rectified);
    if (c.adds)
        text += ", .adds = true";
    if (c.groups > 1)
        text += ", .groups = " + std::to_string(c.groups);
    if (c.map_stride > 0)
        text += ", .map_stride = " + std::to_string(c.map_stride) +
                ", .map_offset = " + std::to_string(c.map_offset);
    return text + "}";
}
[[nodiscard]] inline std::string spelling_of(const kernels::frame_dense& d, const std::string& stride) {
    return "tactnet::kernels::frame_dense{.input = " + text_of(d.input) + ", .input_stride = " + stride +
           ", .outputs = " + std::to_string(d.outputs) + "}";
}
[[nodiscard]] inline std::string description_of(const kernels::frame_convolution& c) {
    std::string what = "Convolution " + by(c.window.kernel);
    if (c.window.stride != extent2d(1))
        what += " by steps of " + by(c.window.stride);
    if (c.adds)
        what += ", sum with the other branch";
    if (c.groups > 1)
        what += " in " + std::to_string(c.groups) + " groups";
    if (c.pool != extent2d(1))
        what += ", max pool " + by(c.pool);
    if (c.rectified)
        what += ", ReLU";
    return what;
}

} // namespace detail

template <class Format, kernels::frame_convolution Kernel>
struct step_spelling<convolution_step<Format, Kernel>> {
    static spelled_step of(step_text&, const shape&, const std::string& stride) {
        return {detail::description_of(Kernel),
                detail::step_type<Format>("convolution_step", {detail::spelling_of(Kernel, stride)})};
    }
};
template <class Format, kernels::frame_dense Kernel>
struct step_spelling<dense_step<Format, Kernel>> {
    static spelled_step of(step_text&, const shape&, const std::string& stride) {
        return {"Dense", detail::step_type<Format>("dense_step", {detail::spelling_of(Kernel, stride)})};
    }
};
template <class Format, shape Map, std::size_t Stride, bool Rectified>
struct step_spelling<norm_step<Format, Map, Stride, Rectified>> {
    static spelled_step of(step_text&, const shape&, const std::string& stride) {
        return {Rectified ? "Batch norm, ReLU" : "Batch norm",
                detail::step_type<Format>("norm_step", {text_of(Map), stride, text_of(Rectified)})};
    }
};
template <class Format, shape Map, std::size_t Stride>
struct step_spelling<relu_step<Format, Map, Stride>> {
    static spelled_step of(step_text&, const shape&, const std::string& stride) {
        return {"ReLU", detail::step_type<Format>("relu_step", {text_of(Map), stride})};
    }
};
template <class Format, shape Map, std::size_t Stride, class Offset>
struct step_spelling<square_root_step<Format, Map, Stride, Offset>> {
    static spelled_step of(step_text&, const shape&, const std::string& stride) {
        return {"Square root",
                detail::step_type<Format>("square_root_step",
                                          {text_of(Map), stride, detail::spelling_of_ratio<Offset>()})};
    }
};
template <class Format, sliding_window Window, std::size_t Stride>
struct step_spelling<pool_step<Format, Window, Stride>> {
    static spelled_step of(step_text&, const shape&, const std::string& stride) {
        return {"Max pool " + detail::by(Window.kernel) + " by steps of " + detail::by(Window.stride),
                detail::step_type<Format>("pool_step", {text_of(Window), stride})};
    }
};
template <class Format, average_windows Windows, std::size_t Channels, std::size_t Stride>
struct step_spelling<average_pool_step<Format, Windows, Channels, Stride>> {
    static spelled_step of(step_text&, const shape&, const std::string& stride) {
        return {"Average pool",
                detail::step_type<Format>("average_pool_step",
                                          {detail::spelling_of(Windows), std::to_string(Channels), stride})};
    }
};
template <class Format, shape Map, std::size_t Stride, class Rule>
struct step_spelling<local_response_norm_step<Format, Map, Stride, Rule>> {
    static spelled_step of(step_text&, const shape&, const std::string& stride) {
        return {"Local response normalisation",
                detail::step_type<Format>("local_response_norm_step",
                                          {text_of(Map), stride, detail::rule_spelling<Rule>::of()})};
    }
};
template <class Format, shape Map, std::size_t Stride>
struct step_spelling<softmax_step<Format, Map, Stride>> {
    static spelled_step of(step_text&, const shape&, const std::string& stride) {
        return {"Softmax", detail::step_type<Format>("softmax_step", {text_of(Map), stride})};
    }
};
template <class Step>
struct step_spelling<step_with_softmax<Step>> {
    static spelled_step of(step_text& text, const shape& input, const std::string& stride) {
        return {"Softmax of what that leaves",
                "tactnet::step_with_softmax<" + text.define<Step>(input, stride) + ">"};
    }
};
template <>
struct step_spelling<no_step> {
    static spelled_step of(step_text&, const shape&, const std::string&) {
        return {"Nothing", "tactnet::no_step"};
    }
};
template <class Main, class Skip, std::size_t InputStride>
struct step_spelling<residual_step<Main, Skip, InputStride>> {
    static spelled_step of(step_text& text, const shape& input, const std::string& stride) {
        const std::string main = text.define<Main>(input, stride), skip = text.define<Skip>(input, stride);
        return {"Both branches of a residual block",
                "tactnet::residual_step<" + main + ", " + skip + ", " + stride + ">"};
    }
};
template <class Format, shape Input, std::size_t InputStride, std::size_t Stride, class... Branches>
struct step_spelling<concatenation_step<Format, Input, InputStride, Stride, Branches...>> {
    static spelled_step of(step_text& text, const shape& input, const std::string& stride) {
        std::string type = "tactnet::concatenation_step<" + std::string(detail::format_name<Format>) + ", " +
                           text_of(Input) + ", " + stride + ", " + std::to_string(Stride);
        ((type += ", tactnet::branch_step<" + text.define<typename Branches::step>(input, stride) + ", " +
                  std::to_string(Branches::offset) + ">"),
         ...);
        return {"Branches side by side", type + ">"};
    }
};
template <class... Steps>
struct step_spelling<step_chain<Steps...>> {
    static spelled_step of(step_text& text, shape input, std::string stride) {
        std::string names;
        const auto append_name = [&](const std::string& name, const shape& output) {
            names += (names.empty() ? "" : ", ") + name;
            input = output;
            stride = name + "::output_stride";
        };
        const auto append = [&]<class Step>(std::type_identity<Step>) {
            append_name(text.define<Step>(input, stride), Step::output);
        };
        (append(std::type_identity<Steps>{}), ...);
        return {"One after the other", "tactnet::step_chain<" + names + ">"};
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet

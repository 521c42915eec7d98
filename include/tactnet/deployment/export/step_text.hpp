#pragma once

#include <tactnet/kernels/frame/dense.hpp>
#include <tactnet/kernels/norms.hpp>
#include <tactnet/kernels/sampling_axis.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/operators/activations/function.hpp>
#include <tactnet/tensor/pooling_windows.hpp>
#include <tactnet/tensor/shape.hpp>
#include <tactnet/text/message.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <ratio>
#include <set>
#include <string>
#include <type_traits>

// Steps as C++ text, for headers that hold a deployed network or a stream. Each step gets one definition;
// later ones refer to earlier ones, since the distance between pixels depends on the instruction set that a
// header is compiled for.

namespace tactnet { inline namespace TACTNET_ARCH {
namespace detail {

// Values as C++. They are not templates, so that each is compiled once for all steps of a network. A
// description is first taken apart into all of its members: one that gains a member does not compile until
// its text has it.
[[nodiscard]] inline std::string text_of(std::unsigned_integral auto value) {
    if constexpr (std::is_same_v<decltype(value), bool>)
        return value ? "true" : "false";
    else
        return std::to_string(value);
}
[[nodiscard]] inline std::string text_of(const shape& s) {
    return joined(
        {"tactnet::shape{.rows = ", s.rows, ", .columns = ", s.columns, ", .channels = ", s.channels, "}"});
}
/// Numbers in braces.
[[nodiscard]] inline std::string list_of(std::initializer_list<std::size_t> numbers) {
    std::string text = "{"; // appended: GCC 12 warns of a sum that begins with so short a literal
    for (const std::size_t number : numbers)
        text += (text.size() > 1 ? ", " : "") + std::to_string(number);
    return text + "}";
}
[[nodiscard]] inline std::string list_of(const extent2d& e) {
    return list_of({e.rows, e.columns});
}
[[nodiscard]] inline std::string text_of(const extent2d& e) {
    return "tactnet::extent2d" + list_of(e);
}
[[nodiscard]] inline std::string text_of(interpolation mode) {
    return std::string("tactnet::interpolation::") +
           (mode == interpolation::nearest ? "nearest" : "bilinear");
}
[[nodiscard]] inline std::string text_of(const sliding_window& w) {
    const auto& [input, kernel, stride, top, bottom, left, right] = w;
    return joined({"tactnet::sliding_window{.input = ", text_of(input), ", .kernel = ", list_of(kernel),
                   ", .stride = ", list_of(stride), ", .top = ", top, ", .bottom = ", bottom,
                   ", .left = ", left, ", .right = ", right, "}"});
}
[[nodiscard]] inline std::string text_of(const pooling_windows& w) {
    const auto axis = [](const pooling_axis& a) {
        const auto& [size, outputs, kernel, stride, before, after] = a;
        return list_of({size, outputs, kernel, stride, before, after});
    };
    const auto& [rows, columns, counts_padding] = w;
    return "tactnet::pooling_windows{.rows = " + axis(rows) + ", .columns = " + axis(columns) +
           ", .counts_padding = " + text_of(counts_padding) + "}";
}
/// A type with its unsigned template arguments.
[[nodiscard]] inline std::string type_text(const char* type, const unsigned* arguments, std::size_t count) {
    std::string text = type;
    for (std::size_t i = 0; i < count; ++i)
        text += (i == 0 ? "<" : ", ") + std::to_string(arguments[i]);
    return count == 0 ? text : text + ">";
}
[[nodiscard]] inline std::string text_of(const kernels::fused_activation& f) {
    return "tactnet::fused<" + type_text(f.type, f.arguments, f.argument_count) + ">";
}
[[nodiscard]] inline std::string text_of(const kernels::frame_convolution& c, const std::string& stride) {
    // The stride of the input is the exported one, and the last two concern a group of several alone.
    const auto& [window, filters, input_stride, pool, pooled_rows, pooled_columns, activation, accumulates,
                 groups, map_stride, map_offset, map_offset_multiple, input_offset_multiple] = c;
    std::string text =
        joined({"tactnet::kernels::frame_convolution{\n    .window = ", text_of(window),
                ",\n    .filters = ", filters, ", .input_stride = ", stride, ", .pool = ", list_of(pool),
                ", .pooled_rows = ", pooled_rows, ", .pooled_columns = ", pooled_columns});
    if (activation->exists)
        text += ", .activation = " + text_of(*activation);
    if (accumulates)
        text += ", .accumulates = true";
    if (groups > 1)
        text += joined({", .groups = ", groups});
    if (map_stride > 0)
        text += joined({", .map_stride = ", map_stride, ", .map_offset = ", map_offset});
    return text + "}";
}
[[nodiscard]] inline std::string text_of(const kernels::frame_dense& d, const std::string& stride) {
    const auto& [input, input_stride, outputs] = d;
    return joined({"tactnet::kernels::frame_dense{.input = ", text_of(input), ", .input_stride = ", stride,
                   ", .outputs = ", outputs, "}"});
}

/// Types as C++.
[[nodiscard]] inline std::string text_of(std::type_identity<float>) {
    return "float";
}
[[nodiscard]] inline std::string text_of(std::type_identity<std::uint8_t>) {
    return "std::uint8_t";
}
[[nodiscard]] inline std::string text_of(std::type_identity<std::int16_t>) {
    return "std::int16_t";
}
[[nodiscard]] inline std::string text_of(std::type_identity<single_precision>) {
    return "tactnet::single_precision";
}
template <class Input, class Output>
[[nodiscard]] std::string text_of(std::type_identity<eight_bit_between<Input, Output>>) {
    return "tactnet::eight_bit_between<" + text_of(std::type_identity<Input>{}) + ", " +
           text_of(std::type_identity<Output>{}) + ">";
}
template <std::intmax_t Numerator, std::intmax_t Denominator>
[[nodiscard]] std::string text_of(std::type_identity<std::ratio<Numerator, Denominator>>) {
    return "std::ratio<" + std::to_string(Numerator) + ", " + std::to_string(Denominator) + ">";
}
template <std::size_t Size, class Alpha, class Beta, class K>
[[nodiscard]] std::string text_of(std::type_identity<kernels::response_rule<Size, Alpha, Beta, K>>) {
    return joined({"tactnet::kernels::response_rule<", Size, ", ", text_of(std::type_identity<Alpha>{}), ", ",
                   text_of(std::type_identity<Beta>{}), ", ", text_of(std::type_identity<K>{}), ">"});
}

template <activation_function Function>
[[nodiscard]] std::string text_of(std::type_identity<Function>) {
    if constexpr (requires { Function::arguments; })
        return type_text(Function::type, Function::arguments.data(), Function::arguments.size());
    else
        return Function::type;
}

/// The cell of a recurrent layer.
template <class Cell>
    requires requires { Cell::gates; }
[[nodiscard]] std::string text_of(std::type_identity<Cell>) {
    return Cell::type;
}

// Details of an argument for the title of its step, for people.
[[nodiscard]] inline std::string size_of(const extent2d& e) {
    return joined({e.rows, " × ", e.columns});
}
[[nodiscard]] inline std::string size_of(const shape& s) {
    return joined({s.rows, " × ", s.columns, " × ", s.channels});
}
[[nodiscard]] inline std::string details_of(const sliding_window& w) {
    return joined({" ", size_of(w.kernel), " by steps of ", size_of(w.stride)});
}
[[nodiscard]] inline std::string details_of(const kernels::frame_convolution& c) {
    std::string what = " ";
    what += size_of(c.window.kernel);
    if (c.window.stride != extent2d(1))
        what += " by steps of " + size_of(c.window.stride);
    if (c.accumulates)
        what += ", sum with the other branch";
    if (c.groups > 1)
        what += joined({" in ", c.groups, " groups"});
    if (c.pool != extent2d(1))
        what += ", max pool " + size_of(c.pool);
    if (c.activation->exists)
        what += joined({", ", c.activation->title});
    return what;
}

} // namespace detail

/// Collects definitions `using step_1 = …;` and the headers that they need.
class step_text {
public:
    /// All definitions so far.
    [[nodiscard]] const std::string& definitions() const { return definitions_; }
    /// The headers, in angle brackets, that declare what deployed_view.hpp or stream_view.hpp does not.
    [[nodiscard]] const std::set<std::string>& includes() const { return includes_; }
    /// Adds such a header, unless it is empty.
    void include(const std::string& header) {
        if (!header.empty())
            includes_.insert(header);
    }

    /// Defines a step and all steps inside by their descriptions, and returns its name. `stride` is the text
    /// of the elements from one pixel of the input to the next.
    template <class Step>
    [[gnu::cold]] std::string define(const shape& input, const std::string& stride) {
        using description = step_description<Step>;
        static_assert(
            requires { sizeof(description); },
            "deployed_header: this step cannot be spelled; specialise step_description for it");
        if constexpr (requires { description::header; })
            include(description::header);
        spelling spelled(*this, input, stride);
        description::visit(spelled);
        if constexpr (requires { Step::output; })
            return defined(spelled, detail::size_of(input), detail::size_of(Step::output));
        else
            return spelled.type; // what makes no map needs no name
    }

private:
    /// Visits the description of a step. What is no template is compiled once for all steps.
    struct spelling {
        step_text& all;
        shape input;
        std::string stride, title, type;

        spelling(step_text& text, const shape& step_input, const std::string& input_stride_text)
            : all(text), input(step_input), stride(input_stride_text) {}

        template <class... Arguments>
        [[gnu::cold]] void operator()(const char* name, const char* what, const Arguments&... arguments) {
            title = what, type = name;
            (append(arguments), ...);
            if constexpr (sizeof...(Arguments) > 0)
                type += '>';
        }

    private:
        [[gnu::cold, gnu::noinline]] void append_text(const std::string& text) {
            type += (first_ ? "<" : ", ") + text;
            first_ = false;
        }
        template <class Value>
        [[gnu::cold]] void append(const Value& value) {
            if constexpr (requires { Value::type::header; })
                all.include(Value::type::header);
            append_text(detail::text_of(value));
        }
        [[gnu::cold, gnu::noinline]] void append(input_stride_argument) { append_text(stride); }
        [[gnu::cold, gnu::noinline]] void append(const sliding_window& window) {
            title += detail::details_of(window);
            append_text(detail::text_of(window));
        }
        [[gnu::cold, gnu::noinline]] void append(const kernels::frame_convolution& c) {
            title += detail::details_of(c);
            if (c.activation->exists)
                all.include(c.activation->header);
            append_text(detail::text_of(c, stride));
        }
        [[gnu::cold, gnu::noinline]] void append(const kernels::frame_dense& d) {
            append_text(detail::text_of(d, stride));
        }
        template <class Step, step_composition How>
        [[gnu::cold]] void append(const inner_step<Step, How>& inner) {
            const std::string name = all.define<Step>(input, stride);
            if constexpr (How == step_composition::chain)
                input = Step::output, stride = name + "::output_stride";
            if constexpr (How == step_composition::concatenation)
                append_text(detail::joined({"tactnet::branch_step<", name, ", ", inner.offset, ">"}));
            else
                append_text(name);
        }

        bool first_ = true;
    };
    [[gnu::cold, gnu::noinline]] std::string defined(const spelling& spelled, const std::string& from,
                                                     const std::string& to) {
        std::string name = "step_" + std::to_string(++count_);
        definitions_ += detail::joined(
            {"// ", spelled.title, ": ", from, " → ", to, "\nusing ", name, " = ", spelled.type, ";\n"});
        return name;
    }

    std::string definitions_;
    std::set<std::string> includes_;
    std::size_t count_ = 0;
};

}} // namespace tactnet

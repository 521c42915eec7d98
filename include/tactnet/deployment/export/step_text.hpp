#pragma once

#include <tactnet/tensor/shape.hpp>

#include <cstddef>
#include <set>
#include <string>
#include <type_traits>

// Steps spelled out as C++, for headers that hold a deployed network. One definition a step; later ones speak
// of earlier ones, since how far pixels lie apart depends on the instruction set that a header is compiled
// for.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// How a step is spelled, said in a file of its own, as its form is: `of(text, input, stride)` gives a
/// spelled_step. `input` is the shape of the step's input, `stride` the text of the elements from one pixel
/// of it to the next; `text` spells steps inside and takes the header that declares the step, unless it is
/// among the library's:
///
///     template <shape Map, std::size_t Stride>
///     struct tactnet::step_spelling<my_step<Map, Stride>> {
///         static spelled_step of(step_text& text, const shape&, const std::string& stride) {
///             text.include("my/step.hpp");
///             return {"My layer", "my_step<" + text_of(Map) + ", " + stride + ">"};
///         }
///     };
template <class Step>
struct step_spelling;

struct spelled_step {
    std::string what; ///< for the comment above the definition
    std::string type; ///< with all its arguments
};

/// Collects definitions `using step_1 = …;` and the headers that they need.
class step_text {
public:
    /// All definitions so far, and the headers in angle brackets that declare what is not the library's.
    [[nodiscard]] const std::string& definitions() const { return definitions_; }
    [[nodiscard]] const std::set<std::string>& includes() const { return includes_; }
    void include(const std::string& header) { includes_.insert(header); }

    /// Spells a step out, with all that is inside, and returns its name.
    template <class Step>
    std::string define(const shape& input, const std::string& stride) {
        static_assert(
            requires { sizeof(step_spelling<Step>); },
            "deployed_header: this step cannot be spelled; specialise step_spelling for it");
        const spelled_step spelled = step_spelling<Step>::of(*this, input, stride);
        if constexpr (requires { Step::output; })
            return defined(spelled, input, Step::output);
        else
            return spelled.type; // what makes no map needs no name
    }

    /// rows × columns × channels, for people.
    [[nodiscard]] static std::string size(const shape& s) {
        return std::to_string(s.rows) + " × " + std::to_string(s.columns) + " × " +
               std::to_string(s.channels);
    }

private:
    std::string defined(const spelled_step& spelled, const shape& input, const shape& output) {
        std::string name = "step_" + std::to_string(++count_);
        definitions_ += "// " + spelled.what + ": " + size(input) + " → " + size(output) + "\n";
        definitions_ += "using " + name + " = " + spelled.type + ";\n";
        return name;
    }

    std::string definitions_;
    std::set<std::string> includes_;
    std::size_t count_ = 0;
};

/// Values as C++.
[[nodiscard]] inline std::string text_of(const shape& s) {
    return "tactnet::shape{.rows = " + std::to_string(s.rows) + ", .columns = " + std::to_string(s.columns) +
           ", .channels = " + std::to_string(s.channels) + "}";
}
[[nodiscard]] inline std::string text_of(const extent2d& e) {
    std::string text = "{"; // appended: GCC 12 warns of a sum that begins with so short a literal
    text += std::to_string(e.rows) + ", " + std::to_string(e.columns) + "}";
    return text;
}
[[nodiscard]] inline std::string text_of(bool value) {
    return value ? "true" : "false";
}
[[nodiscard]] inline std::string text_of(const sliding_window& w) {
    return "tactnet::sliding_window{.input = " + text_of(w.input) + ", .kernel = " + text_of(w.kernel) +
           ", .stride = " + text_of(w.stride) + ", .top = " + std::to_string(w.top) +
           ", .bottom = " + std::to_string(w.bottom) + ", .left = " + std::to_string(w.left) +
           ", .right = " + std::to_string(w.right) + "}";
}

} // namespace TACTNET_ARCH
} // namespace tactnet

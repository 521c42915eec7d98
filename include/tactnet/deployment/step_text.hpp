#pragma once

#include <tactnet/deployment/step_chain.hpp>

#include <cstddef>
#include <string>
#include <type_traits>

// Steps spelled out as C++, for headers that hold a deployed network. One definition a step; later ones speak
// of earlier ones, since how far pixels lie apart depends on the instruction set that a header is compiled
// for.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Collects definitions `using step_1 = …;`. Each call of `define` spells a step out, with all that is
/// inside, and returns its name.
class step_text {
public:
    /// All definitions so far.
    [[nodiscard]] const std::string& definitions() const { return definitions_; }

    /// `stride` is the text of the elements from one pixel of the step's input to the next.
    template <class Step>
    std::string define(const shape& input, const std::string& stride) {
        return spell(std::type_identity<Step>{}, input, stride);
    }

    /// rows × columns × channels, for people.
    [[nodiscard]] static std::string size(const shape& s) {
        return number(s.rows) + " × " + number(s.columns) + " × " + number(s.channels);
    }

private:
    static std::string number(std::size_t n) { return std::to_string(n); }
    static std::string braces(const shape& s) {
        return "{.rows = " + number(s.rows) + ", .columns = " + number(s.columns) +
               ", .channels = " + number(s.channels) + "}";
    }
    static std::string braces(const extent& e) {
        return "{" + number(e.rows) + ", " + number(e.columns) + "}";
    }
    static std::string braces(const sliding_window& w) {
        return "{.input = " + braces(w.input) + ", .kernel = " + braces(w.kernel) +
               ", .stride = " + braces(w.stride) + ", .top = " + number(w.top) +
               ", .bottom = " + number(w.bottom) + ", .left = " + number(w.left) +
               ", .right = " + number(w.right) + "}";
    }
    static std::string by(const extent& e) { return number(e.rows) + " × " + number(e.columns); }

    std::string add(const std::string& what, const shape& input, const shape& output,
                    const std::string& type) {
        std::string name = "step_" + number(++count_);
        definitions_ += "// " + what + ": " + size(input) + " → " + size(output) + "\n";
        definitions_ += "using " + name + " = tactnet::" + type + ";\n";
        return name;
    }

    template <kernels::frame_convolution Kernel>
    std::string spell(std::type_identity<convolution_step<Kernel>>, const shape& input,
                      const std::string& stride) {
        constexpr kernels::frame_convolution c = Kernel;
        std::string what = "Convolution " + by(c.window.kernel);
        std::string rest;
        if (c.window.stride != extent(1))
            what += " by steps of " + by(c.window.stride);
        if (c.adds) {
            what += ", sum with the other branch";
            rest += ", .adds = true";
        }
        if (c.pool != extent(1))
            what += ", max pool " + by(c.pool);
        if (c.rectified)
            what += ", ReLU";
        return add(
            what, input, convolution_step<Kernel>::output,
            "convolution_step<tactnet::kernels::frame_convolution{\n    .window = " + braces(c.window) +
                ",\n    .filters = " + number(c.filters) + ", .input_stride = " + stride +
                ", .pool = " + braces(c.pool) + ", .pooled_rows = " + number(c.pooled_rows) +
                ", .pooled_columns = " + number(c.pooled_columns) +
                ", .rectified = " + (c.rectified ? "true" : "false") + rest + "}>");
    }
    template <kernels::frame_dense Kernel>
    std::string spell(std::type_identity<dense_step<Kernel>>, const shape& input, const std::string& stride) {
        return add("Dense", input, dense_step<Kernel>::output,
                   "dense_step<tactnet::kernels::frame_dense{.input = " + braces(Kernel.input) +
                       ", .input_stride = " + stride + ", .outputs = " + number(Kernel.outputs) + "}>");
    }
    template <shape Map, std::size_t Stride, bool Rectified>
    std::string spell(std::type_identity<norm_step<Map, Stride, Rectified>>, const shape& input,
                      const std::string& stride) {
        return add(Rectified ? "Batch norm, ReLU" : "Batch norm", input, Map,
                   "norm_step<tactnet::shape" + braces(Map) + ", " + stride + ", " +
                       (Rectified ? "true" : "false") + ">");
    }
    template <shape Map, std::size_t Stride>
    std::string spell(std::type_identity<relu_step<Map, Stride>>, const shape& input,
                      const std::string& stride) {
        return add("ReLU", input, Map, "relu_step<tactnet::shape" + braces(Map) + ", " + stride + ">");
    }
    template <sliding_window Window, std::size_t Stride>
    std::string spell(std::type_identity<pool_step<Window, Stride>>, const shape& input,
                      const std::string& stride) {
        return add("Max pool " + by(Window.kernel) + " by steps of " + by(Window.stride), input,
                   pool_step<Window, Stride>::output,
                   "pool_step<tactnet::sliding_window" + braces(Window) + ", " + stride + ">");
    }
    template <shape Map, std::size_t Stride>
    std::string spell(std::type_identity<softmax_step<Map, Stride>>, const shape& input,
                      const std::string& stride) {
        return add("Softmax", input, Map, "softmax_step<tactnet::shape" + braces(Map) + ", " + stride + ">");
    }
    std::string spell(std::type_identity<no_step>, const shape&, const std::string&) {
        return "tactnet::no_step";
    }
    template <class Main, class Skip, std::size_t InputStride>
    std::string spell(std::type_identity<residual_step<Main, Skip, InputStride>>, const shape& input,
                      const std::string& stride) {
        const std::string main = define<Main>(input, stride), skip = define<Skip>(input, stride);
        return add("Both branches of a residual block", input, Main::output,
                   "residual_step<" + main + ", " + skip + ", " + stride + ">");
    }
    template <class... Steps>
    std::string spell(std::type_identity<step_chain<Steps...>>, shape input, std::string stride) {
        const shape first = input;
        std::string names;
        const auto append = [&]<class Step>(std::type_identity<Step>) {
            const std::string name = define<Step>(input, stride);
            names += (names.empty() ? "" : ", ") + name;
            input = Step::output;
            stride = name + "::output_stride";
        };
        (append(std::type_identity<Steps>{}), ...);
        return add("One after the other", first, input, "step_chain<" + names + ">");
    }

    std::string definitions_;
    std::size_t count_ = 0;
};

} // namespace TACTNET_ARCH
} // namespace tactnet

#pragma once

#include "compiled.hpp"

#include <tactnet/io/eight_bit_file.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace tactnet_python {

/// A network in its fastest form.
class deployed {
public:
    shared_code code;
    std::unique_ptr<any_deployed> own;
    std::vector<std::string> classes;
    double temperature = 1;
    int bits = 32;
    tactnet::reflection_rule reflections = tactnet::reflection_rule::all(); ///< kept for files
    tactnet::input_function function{};                                     ///< as well

    py::array_t<float> scores(const py::array& x, std::size_t threads) const {
        const frames_argument frames = frames_of(x, code->facts().input);
        auto result = array_for<float>(frames.single, frames.view.count, {code->outputs()});
        infer(frames.view, to_fill(result), threads);
        return result;
    }
    /// Returns the probability of each class, as classify_logits and classify_probabilities compute it for
    /// the most likely one.
    py::array_t<double> probabilities(const py::array& x, std::size_t threads) const {
        const frames_argument frames = frames_of(x, code->facts().input);
        const std::size_t named = classes.size();
        auto result = array_for<double>(frames.single, frames.view.count, {named});
        double* to = result.mutable_data();
        const py::gil_scoped_release released;
        std::vector<float> outputs(frames.view.count * code->outputs());
        require_finite(frames.view, outputs, threads);
        for (std::size_t i = 0; i < frames.view.count; ++i, to += named)
            probabilities_of(std::span(outputs).subspan(i * code->outputs(), named), to);
        return result;
    }
    /// What the last layer reads.
    py::array_t<float> features(const py::array& x) const {
        const frames_argument frames = frames_of(x, code->facts().input);
        if (own->features == 0)
            throw_invalid_argument({"features: expected a network of several layers, found one whose last "
                                    "layer reads the frame"});
        auto result = array_for<float>(frames.single, frames.view.count, {own->features});
        const std::span to = to_fill(result);
        const py::gil_scoped_release released;
        if (own->read_features(frames.view, to) != tactnet::frame_status::ok) {
            std::vector<float> outputs(frames.view.count * code->outputs());
            require_finite(frames.view, outputs, 1);
        }
        return result;
    }
    /// The most likely class of a frame and its probability, or None.
    std::optional<std::pair<std::string, double>> classify(const py::array& x) const {
        const frames_argument frames = frames_of(x, code->facts().input);
        if (frames.view.count != 1)
            throw_invalid_argument({"classify: expected one frame, found ", frames.view.count});
        const py::gil_scoped_release released;
        std::vector<float> outputs(code->outputs());
        if (own->infer(frames.view, outputs, 1) != tactnet::frame_status::ok)
            return std::nullopt;
        const auto found = code->facts().ends_in_softmax
                               ? tactnet::classify_probabilities(outputs, classes.size(), temperature)
                               : tactnet::classify_logits(outputs, classes.size(), temperature);
        return found ? std::optional(std::pair(classes[found->index], found->probability)) : std::nullopt;
    }
    std::string header(const std::string& network, const std::string& name,
                       const bytes_of_counts& frame) const {
        if (static_cast<std::size_t>(frame.size()) != code->pixels())
            throw_invalid_argument({"header: expected a frame of ", code->pixels(), " counts, found ",
                                    static_cast<std::size_t>(frame.size())});
        return own->header({.network = network, .namespace_name = name, .classes = classes}, temperature,
                           reflections, elements_of<std::uint8_t>(frame));
    }
    /// The bytes of a file of a network in 8 bits.
    py::bytes file(const std::string& network, const bytes_of_counts& selftest) const {
        tactnet::safetensors_writer writer;
        writer.metadata["network"] = network;
        tactnet::add_deployed(
            writer, code->call(&network_code::layout)(), own->folded(), classes,
            elements_of<std::uint8_t>(selftest),
            [&](std::span<const std::uint8_t> images) { return logits_of(images); }, temperature, function,
            reflections);
        return to_python(writer.to_bytes());
    }
    std::vector<float> logits_of(std::span<const std::uint8_t> images) const {
        std::vector<float> outputs(images.size() / code->pixels() * code->outputs()), logits;
        static_cast<void>(own->infer({images.data(), true, images.size() / code->pixels()}, outputs, 1));
        for (std::size_t i = 0; i < outputs.size(); i += code->outputs())
            logits.insert(logits.end(), outputs.begin() + static_cast<std::ptrdiff_t>(i),
                          outputs.begin() + static_cast<std::ptrdiff_t>(i + classes.size()));
        return logits;
    }

private:
    void infer(const frames_view& frames, std::span<float> to, std::size_t threads) const {
        const py::gil_scoped_release released;
        require_finite(frames, to, threads);
    }
    void require_finite(const frames_view& frames, std::span<float> to, std::size_t threads) const {
        if (own->infer(frames, to, threads) == tactnet::frame_status::ok)
            return;
        const std::size_t size = code->pixels() * (frames.are_counts ? 1 : sizeof(float));
        for (std::size_t i = 0; i < frames.count; ++i)
            if (own->infer({static_cast<const std::byte*>(frames.elements) + i * size, frames.are_counts, 1},
                           to.subspan(i * code->outputs()), 1) != tactnet::frame_status::ok)
                throw_invalid_argument({"expected finite counts that give finite outputs, found NaN, inf "
                                        "(infinity) or numbers too large in frame ",
                                        i});
    }
    void probabilities_of(std::span<const float> outputs, double* to) const {
        const auto largest = static_cast<double>(outputs[tactnet::first_largest(outputs)]);
        double sum = 0;
        for (std::size_t c = 0; c < outputs.size(); ++c) {
            const auto output = static_cast<double>(outputs[c]);
            to[c] = !code->facts().ends_in_softmax ? std::exp((output - largest) / temperature)
                    : temperature == 1             ? output
                                                   : std::pow(output / largest, 1 / temperature);
            sum += to[c];
        }
        for (std::size_t c = 0; c < outputs.size(); ++c)
            to[c] /= sum;
    }
};

inline void bind_deployed(py::module_& m) {
    py::class_<deployed>(m, "Deployed")
        .def(
            "scores", &deployed::scores, py::arg("frames"), py::arg("threads") = 1,
            "The outputs as float32, (outputs,) of a frame or (n, outputs): logits, or probabilities after a "
            "softmax.")
        .def("predict_proba", &deployed::probabilities, py::arg("frames"), py::arg("threads") = 1,
             "The probability of each class as float64, (classes,) of a frame or (n, classes).")
        .def("features", &deployed::features, py::arg("frames"),
             "What the last layer reads, as float32, (features,) of a frame or (n, features): in 8 bits "
             "whole\n"
             "numbers. For `Discriminant`.")
        .def("classify", &deployed::classify, py::arg("frame"),
             "(class, probability), or None for a broken frame.")
        .def("header", &deployed::header)
        .def("file", &deployed::file)
        .def_readonly("classes", &deployed::classes)
        .def_readonly("temperature", &deployed::temperature)
        .def_readonly("bits", &deployed::bits)
        .def_property_readonly("weight_bytes", [](const deployed& d) { return d.own->weight_bytes; })
        .def_property_readonly("workspace_bytes", [](const deployed& d) { return d.own->workspace_bytes; });
}

} // namespace tactnet_python

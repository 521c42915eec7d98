#pragma once

#include "compiled.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace tactnet_python {

/// A network of sequences, with the state of one recording.
class stream {
public:
    std::unique_ptr<any_stream> own;
    std::vector<std::string> classes;

    py::array_t<float> step(const converted_floats& frames) {
        const auto features = static_cast<py::ssize_t>(own->features);
        const bool single = frames.ndim() == 1;
        if (frames.ndim() < 1 || frames.ndim() > 2 || frames.shape(frames.ndim() - 1) != features)
            throw_invalid_argument({"expected frames of ", own->features,
                                    " features, found an array of shape ", shape_of(frames)});
        const std::size_t count = single ? 1 : static_cast<std::size_t>(frames.shape(0));
        auto result = array_for<float>(single, count, {own->outputs});
        const std::span from = elements_of<float>(frames);
        const std::span to = to_fill(result);
        const py::gil_scoped_release released;
        if (const std::size_t taken = own->run(from, to); taken != count)
            throw_invalid_argument(
                {"expected finite features, found NaN, inf (infinity) or a number too large in frame ", taken,
                 "; the state is that before it"});
        return result;
    }
    std::string header(const std::string& network, const std::string& name, const floats& recording) const {
        return own->header({.network = network, .namespace_name = name, .classes = classes},
                           elements_of<float>(recording));
    }
};

inline void bind_stream(py::module_& m) {
    py::class_<stream>(
        m, "Stream",
        "A network of sequences that takes one frame after the other. Its state is that of one recording.")
        .def("step", &stream::step, py::arg("frames"),
             "Takes a frame (features,) or several (n, features); returns the outputs after each.")
        .def(
            "reset", [](stream& s) { s.own->reset(); }, "Begins a new recording.")
        .def("header", &stream::header, py::arg("network"), py::arg("namespace"), py::arg("recording"))
        .def_readonly("classes", &stream::classes)
        .def_property(
            "state", [](const stream& s) { return to_python(s.own->state()); },
            [](stream& s, const py::bytes& state) {
                if (!s.own->restore(to_vector(state)))
                    throw std::invalid_argument(
                        "state: expected bytes of a state of this stream, found others");
            },
            "Bytes with a checksum; assign them to go on from there.");
}

} // namespace tactnet_python

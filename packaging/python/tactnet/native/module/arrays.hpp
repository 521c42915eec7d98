#pragma once

#include "../interface.hpp"

#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Frames of NumPy, which are read where they are.

namespace tactnet_python {

namespace py = pybind11;
using tactnet::detail::throw_invalid_argument;

using floats = py::array_t<float, py::array::c_style>;
using bytes_of_counts = py::array_t<std::uint8_t, py::array::c_style>;
using indices = py::array_t<std::size_t, py::array::c_style | py::array::forcecast>;

struct frames_argument {
    py::array kept;
    frames_view view;
    bool single;
};

inline std::string shape_of(const py::array& x) {
    return py::str(x.attr("shape"));
}

/// A frame or a batch of frames: bytes and floats as they lie in memory, everything else as floats.
inline frames_argument frames_of(py::array x, const tactnet::shape& input) {
    const auto dimensions = static_cast<std::size_t>(x.ndim());
    const auto matches = [&](std::initializer_list<std::size_t> frame) {
        const bool fits = dimensions == frame.size() || dimensions == frame.size() + 1;
        return fits && std::equal(frame.begin(), frame.end(), x.shape() + (dimensions - frame.size()),
                                  [](std::size_t expected, py::ssize_t found) {
                                      return static_cast<py::ssize_t>(expected) == found;
                                  });
    };
    const bool planar = (input.channels == 1 && matches({input.rows, input.columns}));
    const bool flat = !planar && matches({input.size()});
    if (!planar && !flat && !matches({input.channels, input.rows, input.columns}))
        throw_invalid_argument({"expected frames of ", input.rows, " x ", input.columns,
                                input.channels > 1 ? ", channels before rows," : "",
                                " or one after the other, found an array of shape ", shape_of(x)});
    const std::size_t of_frame = planar ? 2 : flat ? 1 : 3;
    const bool are_counts = py::isinstance<bytes_of_counts>(x);
    if (!are_counts && !py::isinstance<floats>(x))
        x = x.dtype().kind() == 'u' && x.itemsize() == 1
                ? py::array(bytes_of_counts::ensure(x))
                : py::array(py::array_t<float, py::array::c_style | py::array::forcecast>::ensure(x));
    if (!x)
        throw py::error_already_set();
    return {x,
            {x.data(), py::isinstance<bytes_of_counts>(x), static_cast<std::size_t>(x.size()) / input.size()},
            dimensions == of_frame};
}

inline std::vector<std::byte> to_vector(const py::bytes& data) {
    const std::string_view text = data;
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}
inline py::bytes to_python(std::span<const std::byte> data) {
    return {reinterpret_cast<const char*>(data.data()), data.size()};
}

} // namespace tactnet_python

#pragma once

#include "../interface.hpp"

#include <tactnet/runtime/saved_state.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Frames of NumPy, which are read where they are.

namespace tactnet_python {

namespace py = pybind11;
using tactnet::detail::throw_invalid_argument;

using floats = py::array_t<float, py::array::c_style>;
using bytes_of_counts = py::array_t<std::uint8_t, py::array::c_style>;
using converted_floats = py::array_t<float, py::array::c_style | py::array::forcecast>;
using indices = py::array_t<std::size_t, py::array::c_style | py::array::forcecast>;

inline std::string shape_of(const py::array& x) {
    return py::str(x.attr("shape"));
}

/// Whether an array holds one frame and not several. Throws for frames of another size.
inline bool is_single(const py::array& x, const tactnet::shape& input) {
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
    return dimensions == (planar ? 2U : flat ? 1U : 3U);
}

/// Elements of exactly these types, in this machine's order of bytes, as they lie in memory; all others as
/// floats.
template <class... Kept>
py::array as_stored(py::array x) {
    if (!(py::isinstance<py::array_t<Kept, py::array::c_style>>(x) || ...)) {
        const bool kept = (py::isinstance<py::array_t<Kept, 0>>(x) || ...);
        x = kept ? py::array::ensure(x, py::array::c_style) : py::array(converted_floats::ensure(x));
    }
    if (!x)
        throw_invalid_argument({"expected frames of real numbers"});
    return x;
}

struct frames_argument {
    py::array kept;
    frames_view view;
    bool single;
};

/// A frame or a batch of frames.
inline frames_argument frames_of(const py::array& x, const tactnet::shape& input) {
    const bool single = is_single(x, input);
    const py::array kept = as_stored<std::uint8_t, float>(x);
    return {kept,
            {kept.data(), kept.itemsize() == 1, static_cast<std::size_t>(kept.size()) / input.size()},
            single};
}

template <class Element>
std::span<const Element> elements_of(const py::array& x) {
    return {static_cast<const Element*>(x.data()), static_cast<std::size_t>(x.size())};
}

/// Whole numbers from 0 on, of any type: no others, which would be rounded or wrapped.
inline indices indices_of(const py::object& given) {
    const auto found = py::array::ensure(given);
    if (!found)
        throw_invalid_argument({"expected whole numbers from 0 on, found no array"});
    const char kind = found.dtype().kind();
    bool whole = found.size() == 0 || kind == 'i' || kind == 'u' || kind == 'b';
    const indices numbers = whole ? indices(found) : indices();
    for (const std::size_t number : elements_of<std::size_t>(numbers))
        whole = whole && (kind != 'i' || static_cast<std::ptrdiff_t>(number) >= 0);
    if (!whole)
        throw_invalid_argument({"expected whole numbers from 0 on, found ",
                                std::string(py::str(found.dtype())), " of shape ", shape_of(found),
                                kind == 'i' ? ", some below 0" : ""});
    return numbers;
}

template <class Element>
std::span<Element> to_fill(py::array_t<Element>& x) {
    return {x.mutable_data(), static_cast<std::size_t>(x.size())};
}

/// A new array for a frame, or for each of `count`.
template <class Element>
py::array_t<Element> array_for(bool single, std::size_t count, std::vector<std::size_t> extents) {
    if (!single)
        extents.insert(extents.begin(), count);
    return py::array_t<Element>(std::move(extents));
}

inline std::vector<std::byte> to_vector(const py::bytes& data) {
    const std::string_view text = data;
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}
inline py::bytes to_python(std::span<const std::byte> data) {
    return {reinterpret_cast<const char*>(data.data()), data.size()};
}
/// Throws for bytes that are no state.
inline void require_restored(tactnet::restore_status status) {
    if (status != tactnet::restore_status::ok)
        throw std::invalid_argument("state: " + std::string(tactnet::describe(status)));
}

} // namespace tactnet_python

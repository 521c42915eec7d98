#pragma once

#include "../objects.hpp"
#include "compiled.hpp"

#include <tactnet/decision/fitting.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace tactnet_python {

/// The nearest class in an array: index -1, and infinitely far, if there is none.
struct nearest_found {
    std::int64_t index = -1;
    double squared_distance = std::numeric_limits<double>::infinity();
    double relative_distance = std::numeric_limits<double>::infinity();
};

/// The rows of an array (numbers,) or (n, numbers).
struct rows_argument {
    std::span<const float> all;
    std::size_t width, count;
    bool single;

    rows_argument(const converted_floats& x, std::size_t numbers)
        : all(elements_of<float>(x)), width(numbers), count(all.size() / numbers), single(x.ndim() == 1) {
        if (x.ndim() < 1 || x.ndim() > 2 ||
            x.shape(x.ndim() - 1) != static_cast<py::ssize_t>(numbers)) // (1, numbers) is a batch
            throw_invalid_argument(
                {"expected rows of ", numbers, " numbers, found an array of shape ", shape_of(x)});
    }
    std::span<const float> operator[](std::size_t i) const { return all.subspan(i * width, width); }
};

inline py::array_t<float> project(const any_discriminant& map, const converted_floats& features) {
    const rows_argument rows(features, map.features);
    auto points = array_for<float>(rows.single, rows.count, {map.dimensions});
    const std::span to = to_fill(points);
    const py::gil_scoped_release released;
    for (std::size_t i = 0; i < rows.count; ++i)
        map.project(rows[i], to.subspan(i * map.dimensions, map.dimensions));
    return points;
}

/// Returns how many points were learnt.
inline std::size_t learn(any_means& means, const py::object& given, const converted_floats& points) {
    const rows_argument rows(points, means.dimensions);
    const indices classes = indices_of(given);
    const auto of_each = elements_of<std::size_t>(classes);
    if (of_each.size() != rows.count && classes.ndim() != 0)
        throw_invalid_argument(
            {"learn: expected a class, or one for each of ", rows.count, " points, found ", of_each.size()});
    const py::gil_scoped_release released;
    std::size_t learnt = 0;
    for (std::size_t i = 0; i < rows.count; ++i)
        learnt += means.learn(of_each[of_each.size() == 1 ? 0 : i], rows[i]) ? 1U : 0U;
    return learnt;
}

inline py::array_t<nearest_found> nearest(const any_means& means, const converted_floats& points) {
    const rows_argument rows(points, means.dimensions);
    auto found = array_for<nearest_found>(rows.single, rows.count, {});
    nearest_found* const to = found.mutable_data();
    const py::gil_scoped_release released;
    for (std::size_t i = 0; i < rows.count; ++i) {
        to[i] = {};
        if (const auto one = means.nearest(rows[i]))
            to[i] = {static_cast<std::int64_t>(one->index), one->squared_distance, one->relative_distance};
    }
    return found;
}

template <class Object>
void bind_state(py::class_<Object>& object) {
    object.def_property(
        "state", [](const Object& own) { return to_python(own.state()); },
        [](Object& own, const py::bytes& state) { require_restored(own.restore(to_vector(state))); },
        "What was learnt, as bytes with a checksum, which C++ reads and writes too.");
}

inline void bind_objects(py::module_& m) {
    PYBIND11_NUMPY_DTYPE(nearest_found, index, squared_distance, relative_distance);
    py::class_<any_discriminant> map(m, "Discriminant",
                                     "Maps features of a network to few dimensions, in which classes lie far "
                                     "apart: fit_discriminant.");
    map.def(py::init([](const shared_code& code) { return code->call(&network_code::discriminant)(); }))
        .def_readonly("features", &any_discriminant::features)
        .def_readonly("dimensions", &any_discriminant::dimensions)
        .def(
            "fit",
            [](any_discriminant& own, const converted_floats& features, const py::object& labels,
               std::size_t classes, double shrinkage) {
                const rows_argument rows(features, own.features);
                const indices of_each = indices_of(labels);
                const auto numbers = elements_of<std::size_t>(of_each);
                const py::gil_scoped_release released;
                own.fit(rows.all, numbers, classes, shrinkage);
            },
            py::arg("features"), py::arg("labels"), py::arg("classes"), py::arg("shrinkage") = 0.5)
        .def("project", &project, py::arg("features"),
             "The points as float32, (dimensions,) of features (features,) or (n, dimensions).");
    bind_state(map);
    py::class_<any_means> means(
        m, "ClassMeans",
        "Recognises touches by the nearest class mean, and learns new classes: points\n"
        "are (dimensions,) or (n, dimensions). For one thread at a time.");
    means.def(py::init([](const shared_code& code) { return code->call(&network_code::means)(); }))
        .def_readonly("dimensions", &any_means::dimensions)
        .def_readonly("most_classes", &any_means::most_classes)
        .def("learn", &learn, py::arg("classes"), py::arg("points"),
             "Adds touches to a class, or each to its own of (n,). Returns how many were learnt: not those\n"
             "beyond the most classes, nor points that are not finite.")
        .def("forget", &any_means::forget, py::arg("index"), "Forgets all touches of a class.")
        .def("touches", &any_means::touches, py::arg("index"), "How many touches of a class were learnt.")
        .def("spread", &any_means::spread, py::arg("index"),
             "The mean squared distance of a class's touches from their mean, drawn to that of all classes.")
        .def("nearest", &nearest, py::arg("points"),
             "The nearest class of each point: an array with the fields index, squared_distance and\n"
             "relative_distance, in units of the class's spread. Index -1 and infinite distances without\n"
             "classes, and for a point that is not finite.");
    bind_state(means);
    m.def(
        "fit_largest_distance",
        [](const py::array_t<double, py::array::c_style | py::array::forcecast>& distances,
           double false_alarms) {
            return tactnet::fit_largest_distance(elements_of<double>(distances), false_alarms);
        },
        py::arg("distances"), py::arg("false_alarms") = 0.05,
        "The largest distance of known objects, found from relative distances (n,) of held-out touches:\n"
        "at most a share `false_alarms` of further known touches is farther.");
}

} // namespace tactnet_python

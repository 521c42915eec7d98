#pragma once

#include "arrays.hpp"

#include <tactnet/decision/fitting.hpp>
#include <tactnet/decision/touch_evidence.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

namespace tactnet_python {

inline constexpr std::size_t most_classes = 1024;
using any_evidence = tactnet::touch_evidence<most_classes>;

/// touch_evidence of a number of classes that is known when it runs.
class evidence {
public:
    evidence(std::size_t classes, double temperature, double frames, double grasps)
        : classes_(classes),
          own_(std::make_unique<any_evidence>(
              classes, tactnet::temperature_scaling{temperature},
              tactnet::touch_correlation{.frames = frames, .grasps = grasps})) {
        if (classes == 0 || classes > most_classes)
            throw_invalid_argument({"expected 1 to ", most_classes, " classes, found ", classes});
        tactnet::detail::check_temperature("Evidence", temperature);
    }
    std::size_t add(const converted_floats& logits) {
        static_cast<void>(is_single(logits, {1, classes_}));
        std::size_t added = 0;
        std::array<float, most_classes> row{};
        for (auto all = elements_of<float>(logits); !all.empty(); all = all.subspan(classes_)) {
            std::copy_n(all.begin(), classes_, row.begin());
            added += own_->add_frame(row) ? 1U : 0U;
        }
        return added;
    }
    any_evidence& own() const { return *own_; }

private:
    std::size_t classes_;
    std::unique_ptr<any_evidence> own_;
};

inline std::optional<std::pair<std::size_t, double>>
as_pair(const std::optional<tactnet::recognition>& found) {
    return found ? std::optional(std::pair(found->index, static_cast<double>(found->probability)))
                 : std::nullopt;
}

inline void bind_decisions(py::module_& m) {
    py::class_<evidence>(m, "Evidence",
                         "What the frames of a grasp, and several grasps of the same object, say together.\n"
                         "`frames` and `grasps` are how much they err together, 0 to 1.")
        .def(py::init<std::size_t, double, double, double>(), py::arg("classes"),
             py::arg("temperature") = 1.0, py::arg("frames") = tactnet::touch_correlation{}.frames,
             py::arg("grasps") = tactnet::touch_correlation{}.grasps)
        .def("add", &evidence::add, py::arg("logits"),
             "Adds frames of a grasp, logits (classes,) or (n, classes). Returns how many were finite.")
        .def("end_grasp", [](evidence& e) { e.own().end_grasp(); })
        .def(
            "clear", [](evidence& e) { e.own().clear(); }, "What comes next is another object.")
        .def_property_readonly("grasps", [](const evidence& e) { return e.own().grasps(); })
        .def(
            "most_likely", [](const evidence& e) { return as_pair(e.own().most_likely()); },
            "(class, probability), or None without frames.")
        .def(
            "decide", [](const evidence& e, double rate) { return as_pair(e.own().decide(rate)); },
            py::arg("error_rate"), "The same, once its probability is at least 1 - error_rate; else None.");
    py::class_<tactnet::prediction_set>(
        m, "PredictionSet",
        "Sets of classes that hold the right one in a share `coverage` of frames, found from held-out\n"
        "logits (n, classes) and labels.")
        .def(py::init([](const floats& logits, const indices& labels, double coverage, double temperature) {
                 const std::size_t classes =
                     logits.ndim() == 2 ? static_cast<std::size_t>(logits.shape(1)) : 0;
                 return tactnet::fit_prediction_set({temperature}, coverage, elements_of<float>(logits),
                                                    classes, elements_of<std::size_t>(labels), classes);
             }),
             py::arg("logits"), py::arg("labels"), py::arg("coverage") = 0.95, py::arg("temperature") = 1.0)
        .def(
            "predict",
            [](const tactnet::prediction_set& set, const converted_floats& logits) {
                const auto classes =
                    static_cast<std::size_t>(logits.ndim() > 0 ? logits.shape(logits.ndim() - 1) : 0);
                py::array_t<bool> members(
                    std::vector<py::ssize_t>(logits.shape(), logits.shape() + logits.ndim()));
                const std::span to(members.mutable_data(), static_cast<std::size_t>(members.size()));
                for (std::size_t i = 0; i < to.size(); i += classes)
                    set.predict(elements_of<float>(logits).subspan(i, classes), to.subspan(i, classes));
                return members;
            },
            py::arg("logits"),
            "Whether each class is in the set, as bool of the shape of logits; none of logits that are "
            "not\nfinite.");
}

} // namespace tactnet_python

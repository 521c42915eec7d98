#pragma once

#include "arrays.hpp"

#include <tactnet/decision/contact_detector.hpp>
#include <tactnet/decision/fitting.hpp>
#include <tactnet/decision/gain_monitor.hpp>
#include <tactnet/decision/touch_evidence.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
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
        const py::gil_scoped_release released;
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

inline void bind_gain(py::module_& m) {
    using tactnet::gain_monitor;
    m.def(
        "force_statistics",
        [](const bytes_of_counts& images, std::uint8_t pressed) {
            if (images.ndim() < 3 || images.size() == 0)
                throw_invalid_argument(
                    {"force_statistics: expected images (n, rows, columns), found ", shape_of(images)});
            const auto found = tactnet::force_statistics::of(
                elements_of<std::uint8_t>(images), static_cast<std::size_t>(images.size() / images.shape(0)),
                pressed);
            return std::pair(found.mean, found.deviation);
        },
        py::arg("images"), py::arg("pressed") = tactnet::contact_settings{}.pressed,
        "Mean and deviation of the logarithm of the forces of training images (n, rows, columns) of uint8:\n"
        "the sums of their counts from `pressed` on. (0, 0), by which no gain is found, without touches.");
    py::class_<gain_monitor>(
        m, "GainMonitor",
        "Estimates the gain of a sensor, compared with that of training images, from the\n"
        "forces of many touches. `trained` is what force_statistics returns; the estimate\n"
        "forgets over `memory` touches, and shrinks towards 1 by `gain_deviation`, that of\n"
        "the logarithms of expected gains, while few are known. For one thread at a time.")
        .def(py::init([](const std::pair<double, double>& trained, double memory, double gain_deviation) {
                 return gain_monitor({trained.first, trained.second}, memory, gain_deviation);
             }),
             py::arg("trained"), py::arg("memory") = 50.0, py::arg("gain_deviation") = 0.3)
        .def("add_touch", &gain_monitor::add_touch, py::arg("force"),
             "Adds the force of a touch, a sum of counts: of its strongest frame. Ignores what is no "
             "positive\n"
             "finite number.")
        .def_property_readonly("gain", &gain_monitor::gain, "1 as in the training, 0.5 for half the counts.")
        .def_property_readonly("uncertainty", &gain_monitor::uncertainty,
                               "The deviation of the gain's logarithm, by the scatter of forces alone.")
        .def_property_readonly("drifted", &gain_monitor::drifted,
                               "Whether the gain differs from 1 by more than three deviations.");
}

inline void bind_decisions(py::module_& m) {
    const auto without_lock = py::call_guard<py::gil_scoped_release>();
    bind_gain(m);
    py::class_<evidence>(
        m, "Evidence",
        "What the frames of a grasp, and several grasps of the same object, say together.\n"
        "`frames` and `grasps` are how much they err together, 0 to 1. For one thread at a time.")
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
            "most_likely", [](const evidence& e) { return as_pair(e.own().most_likely()); }, without_lock,
            "(class, probability), or None without frames.")
        .def(
            "decide", [](const evidence& e, double rate) { return as_pair(e.own().decide(rate)); },
            without_lock, py::arg("error_rate"),
            "The same, once its probability is at least 1 - error_rate; else None.");
    py::class_<tactnet::prediction_set>(
        m, "PredictionSet",
        "Sets of classes that hold the right one in a share `coverage` of frames, found from held-out\n"
        "logits (n, classes) and labels.")
        .def(py::init([](const floats& logits, const py::object& given, double coverage, double temperature) {
                 const std::size_t classes =
                     logits.ndim() == 2 ? static_cast<std::size_t>(logits.shape(1)) : 0;
                 const auto rows = elements_of<float>(logits);
                 const indices labels = indices_of(given);
                 const auto of_each = elements_of<std::size_t>(labels);
                 const py::gil_scoped_release released;
                 return tactnet::fit_prediction_set({temperature}, coverage, rows, classes, of_each, classes);
             }),
             py::arg("logits"), py::arg("labels"), py::arg("coverage") = 0.95, py::arg("temperature") = 1.0)
        .def(
            "predict",
            [](const tactnet::prediction_set& set, const converted_floats& logits) {
                if (logits.ndim() == 0)
                    throw_invalid_argument({"expected logits (classes,) or (n, classes), found a number"});
                const auto classes = static_cast<std::size_t>(logits.shape(logits.ndim() - 1));
                py::array_t<bool> members(
                    std::vector<py::ssize_t>(logits.shape(), logits.shape() + logits.ndim()));
                const std::span to = to_fill(members);
                const auto rows = elements_of<float>(logits);
                const py::gil_scoped_release released;
                for (std::size_t i = 0; i < to.size(); i += classes)
                    set.predict(rows.subspan(i, classes), to.subspan(i, classes));
                return members;
            },
            py::arg("logits"),
            "Whether each class is in the set, as bool of the shape of logits; none of logits that are "
            "not\nfinite.");
}

} // namespace tactnet_python

#pragma once

#include "../sensing.hpp"
#include "compiled.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

namespace tactnet_python {

/// Health and contacts of an array.
class sensor_array {
public:
    sensor_array(const shared_code& code, const tactnet::shape& array, const sensor_settings& settings)
        : array_(array), own_(code->call(&network_code::sensor)(settings)) {}

    void learn(const py::array& air) {
        static_cast<void>(is_single(air, array_));
        const py::array kept = as_stored<std::uint8_t, std::uint16_t, float>(air);
        const raw_frames raw = frames_in(kept);
        const py::gil_scoped_release released;
        own_->learn(raw);
    }
    py::tuple update(const py::array& frames) {
        const bool single = is_single(frames, array_);
        const py::array kept = as_stored<std::uint8_t, std::uint16_t, float>(frames);
        const std::size_t count = static_cast<std::size_t>(kept.size()) / array_.size();
        const raw_frames raw = frames_in(kept);
        auto clean = array_for<float>(single, count, {array_.rows, array_.columns});
        auto contacts = array_for<tactnet::contact_state>(single, count, {});
        float* const clean_to = clean.mutable_data();
        tactnet::contact_state* const contacts_to = contacts.mutable_data();
        {
            const py::gil_scoped_release released;
            own_->update(raw, clean_to, contacts_to);
        }
        return py::make_tuple(clean, contacts);
    }
    py::list faults() const {
        py::list found;
        for (const tactnet::tactel_fault& fault : own_->faults())
            found.append(py::make_tuple(fault.row, fault.column, tactnet::name_of(fault.kind), fault.since));
        return found;
    }
    bool worn_out() const { return own_->worn_out(); }
    std::uint8_t pressed() const { return own_->pressed(); }
    py::bytes state() const { return to_python(own_->state()); }
    void restore(const py::bytes& state) { require_restored(own_->restore(to_vector(state))); }

private:
    static raw_frames frames_in(const py::array& x) {
        return x.itemsize() == 1   ? raw_frames(elements_of<std::uint8_t>(x))
               : x.itemsize() == 2 ? raw_frames(elements_of<std::uint16_t>(x))
                                   : raw_frames(elements_of<float>(x));
    }
    tactnet::shape array_;
    std::unique_ptr<any_sensor> own_;
};

/// Simulates frames of an object, one after the other.
inline py::tuple touch(any_scene& scene, const converted_floats& heights, std::optional<double> newtons,
                       std::optional<double> metres, std::uint64_t seed, std::uint32_t frame, double seconds,
                       double interval) {
    using tactnet::simulation::pressing;
    if (newtons && metres)
        throw std::invalid_argument("touch: expected newtons or metres, found both");
    const bool single = is_single(heights, scene.surface);
    const std::size_t count = static_cast<std::size_t>(heights.size()) / scene.surface.size();
    auto measured = array_for<float>(single, count, {scene.output.rows, scene.output.columns});
    auto clean = array_for<float>(single, count, {scene.tactels.rows, scene.tactels.columns});
    auto contacts = array_for<tactnet::simulation::contact_report>(single, count, {});
    const float* const from = heights.data();
    float *const clean_to = clean.mutable_data(), *const measured_to = measured.mutable_data();
    tactnet::simulation::contact_report* const contacts_to = contacts.mutable_data();
    {
        const py::gil_scoped_release released;
        for (std::size_t i = 0; i < count; ++i)
            contacts_to[i] =
                scene.touch(from + i * scene.surface.size(),
                            metres ? pressing::to_depth(*metres) : pressing::to_force(newtons.value_or(10)),
                            {.seed = seed,
                             .frame = frame + static_cast<std::uint32_t>(i),
                             .seconds = seconds + static_cast<double>(i) * interval},
                            clean_to + i * scene.tactels.size(), measured_to + i * scene.output.size());
    }
    return py::make_tuple(measured, clean, contacts);
}

inline void bind_sensing(py::module_& m) {
    using tactnet::contact_state, tactnet::simulation::contact_report;
    using area = std::optional<std::uint16_t>;
    PYBIND11_NUMPY_DTYPE(contact_state, touching, began, ended, firm, area, force, frames);
    PYBIND11_NUMPY_DTYPE(contact_report, converged, iterations, force, depth, cells);
    const tactnet::count_scale scale;
    const tactnet::health_settings health;
    const tactnet::contact_settings contact;
    py::class_<sensor_array>(m, "Sensor")
        .def(py::init([](const shared_code& code, std::size_t rows, std::size_t columns, float untouched,
                         float full, float broken, std::uint8_t pressed, area begin_area, area end_area,
                         std::uint8_t frames_to_fault) {
                 sensor_settings settings{.scale = {untouched, full, broken}, .health = {}, .contact = {}};
                 settings.health.frames_to_fault = frames_to_fault;
                 settings.health.pressed = settings.contact.pressed = pressed;
                 settings.contact.begin_area = begin_area, settings.contact.end_area = end_area;
                 return sensor_array(code, {rows, columns}, settings);
             }),
             py::arg("code"), py::arg("rows"), py::arg("columns"), py::kw_only(),
             py::arg("untouched") = scale.untouched, py::arg("full") = scale.full,
             py::arg("broken") = scale.broken, py::arg("pressed") = contact.pressed,
             py::arg("begin_area") = py::none(), py::arg("end_area") = py::none(),
             py::arg("frames_to_fault") = health.frames_to_fault)
        .def("learn", &sensor_array::learn, py::arg("air"),
             "Learns from frames of air, some 50: (rows, columns), or (n, rows, columns).")
        .def(
            "update", &sensor_array::update, py::arg("frames"),
            "Returns clean frames as float32 on the scale 0 to 255, and for each its contact: an array with\n"
            "the fields touching, began, ended, firm, area (tactels), force (sum of counts) and frames.\n"
            "Frames of air are followed.")
        .def_property_readonly("faults", &sensor_array::faults,
                               "(row, column, 'stuck', 'dead' or 'broken', the frame it was found in).")
        .def_property_readonly("worn_out", &sensor_array::worn_out,
                               "Whether more tactels are faulty than can be replaced.")
        .def_property_readonly("pressed", &sensor_array::pressed,
                               "The least count of a touched tactel, 0 to 255, which learning air may raise.")
        .def_property(
            "state", &sensor_array::state, &sensor_array::restore,
            "What was learnt of the sensor, as bytes with a checksum; assign them after a restart.");
    py::class_<any_scene>(m, "Scene")
        .def(py::init([](const shared_code& code, double pitch, std::uint64_t unit) {
                 return code->call(&network_code::scene)(pitch, unit);
             }),
             py::arg("code"), py::arg("pitch"), py::arg("unit"))
        .def("touch", &touch, py::arg("heights"), py::kw_only(), py::arg("newtons") = py::none(),
             py::arg("metres") = py::none(), py::arg("seed") = 1, py::arg("frame") = 0,
             py::arg("seconds") = 0.0, py::arg("interval") = 0.01,
             "Presses an object with its underside at `heights` (rows, columns) metres, infinite where there "
             "is\nnone, with a force in newtons, 10 by default, or to a depth in metres. Returns what is\n"
             "measured, the pascals on each tactel, and the contact: an array with the fields converged,\n"
             "iterations, force (newtons), depth (metres) and cells. Of (n, rows, columns), n frames that\n"
             "follow each other after `interval` seconds.")
        .def("reset", &any_scene::reset, "Begins a new touch: forgets earlier frames.")
        .def_property_readonly(
            "surface",
            [](const any_scene& scene) { return std::tuple(scene.surface.rows, scene.surface.columns); },
            "Rows and columns of heights.");
}

} // namespace tactnet_python

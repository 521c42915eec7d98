#pragma once

#include "arrays.hpp"

#include <tactnet/sensors/described/description_file.hpp>
#include <tactnet/sensors/recording.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace tactnet_python {

/// Bytes as they lie in memory.
class bytes_argument {
public:
    explicit bytes_argument(const py::buffer& data) {
        if (PyObject_GetBuffer(data.ptr(), &view_, PyBUF_SIMPLE) != 0)
            throw py::error_already_set();
    }
    bytes_argument(const bytes_argument&) = delete;
    bytes_argument& operator=(const bytes_argument&) = delete;
    ~bytes_argument() { PyBuffer_Release(&view_); }
    std::span<const std::byte> bytes() const {
        return {static_cast<const std::byte*>(view_.buf), static_cast<std::size_t>(view_.len)};
    }

private:
    Py_buffer view_{};
};

inline tactnet::any_recording decoder_for(const std::optional<std::string>& sensor,
                                          std::vector<std::uint8_t> mask = {}) {
    return sensor ? tactnet::any_recording(tactnet::parse_sensor(*sensor, "sensor"))
                  : tactnet::any_recording(std::move(mask));
}

inline tactnet::recording decode(const py::buffer& data, const std::optional<std::string>& sensor,
                                 std::vector<std::uint8_t> mask, bool keep_damaged, const std::string& name) {
    const bytes_argument kept(data);
    const py::gil_scoped_release released;
    tactnet::recording found = tactnet::decode_all(decoder_for(sensor, std::move(mask)), kept.bytes());
    if (found.damage && (!keep_damaged || found.description.format.empty()))
        throw tactnet::file_error(name, found.damage->place(), found.damage->expected,
                                  found.damage->outcome());
    return found;
}

/// An array of frames that lie in an object of the module.
inline py::array frames_within(const float* cells, std::size_t count, std::size_t rows, std::size_t columns,
                               const py::object& owner) {
    py::array_t<float> frames({count, rows, columns}, cells, owner);
    frames.attr("setflags")(py::arg("write") = false);
    return frames;
}

/// Decodes bytes as they come.
class decoder {
public:
    explicit decoder(const std::optional<std::string>& sensor) : own_(decoder_for(sensor)) {
        if (sensor) {
            const tactnet::sensor_description described = tactnet::parse_sensor(*sensor, "sensor");
            rows_ = described.frame_rows(), columns_ = described.frame_columns();
        }
    }
    py::array push(const py::buffer& data) {
        const bytes_argument kept(data);
        return frames([&](const auto& sink) { return own_.push(kept.bytes(), sink); });
    }
    py::array finish() {
        return frames([&](const auto& sink) { return own_.finish(sink); });
    }
    std::optional<std::string> error() const {
        return damaged_ ? std::optional(own_.error().message()) : std::nullopt;
    }

private:
    template <class Call>
    py::array frames(const Call& call) {
        auto cells = std::make_unique<std::vector<float>>();
        std::size_t count = 0;
        {
            const py::gil_scoped_release released;
            damaged_ = call([&](const tactnet::frame_view& frame) {
                           cells->insert(cells->end(), frame.cells.begin(), frame.cells.end());
                           ++count;
                       }) == tactnet::decode_status::damaged;
        }
        const std::vector<float>& kept = *cells;
        const py::capsule owner(cells.release(), [](void* p) { delete static_cast<std::vector<float>*>(p); });
        if (count > 0)
            rows_ = own_.description().rows, columns_ = own_.description().columns;
        return frames_within(kept.data(), count, rows_, columns_, owner);
    }
    tactnet::any_recording own_;
    std::size_t rows_ = 0, columns_ = 0; ///< of a frame, once they are known
    bool damaged_ = false;
};

inline void bind_recordings(py::module_& m) {
    using tactnet::recording;
    py::class_<recording, std::shared_ptr<recording>>(m, "Recording", "The frames of a recording.")
        .def_property_readonly(
            "frames",
            [](const py::object& self) {
                const auto& r = self.cast<const recording&>();
                return frames_within(r.size() > 0 ? r[0].cells.data() : nullptr, r.size(), r.description.rows,
                                     r.description.columns, self);
            },
            "(n, rows, columns) of float32: counts or pascals, NaN of a broken cell. Not a copy, and not "
            "writable.")
        .def_property_readonly(
            "seconds",
            [](const recording& r) {
                py::array_t<double> seconds(static_cast<py::ssize_t>(r.size()));
                for (std::size_t i = 0; i < r.size(); ++i)
                    seconds.mutable_data()[i] =
                        r[i].seconds.value_or(std::numeric_limits<double>::quiet_NaN());
                return seconds;
            },
            "(n,) since the start; NaN where unknown.")
        .def_property_readonly(
            "description",
            [](const recording& r) {
                const tactnet::recording_description& d = r.description;
                py::dict found;
                found["format"] = d.format, found["version"] = d.version, found["rows"] = d.rows;
                found["columns"] = d.columns, found["row_spacing"] = d.row_spacing;
                found["column_spacing"] = d.column_spacing, found["cell_area"] = d.cell_area;
                found["unit"] = d.unit == tactnet::pressure_unit::raw ? "raw" : "pascal";
                found["full_scale"] = d.full_scale, found["saturation_pressure"] = d.saturation_pressure;
                found["noise_threshold"] = d.noise_threshold, found["mask"] = d.mask;
                found["seconds_per_frame"] = d.seconds_per_frame, found["header"] = d.header;
                return found;
            },
            "What the recording states about itself; None or empty where it does not. Metres, pascals, "
            "seconds.")
        .def_readonly("certain_frames", &recording::certain_frames)
        .def_property_readonly(
            "damage",
            [](const recording& r) { return r.damage ? std::optional(r.damage->message()) : std::nullopt; })
        .def_property_readonly("warnings", [](const recording& r) {
            std::vector<std::string> found;
            for (const tactnet::decoding_warning& warning : r.warnings.kept())
                found.push_back(warning.message());
            return found;
        });
    m.def("decode", &decode, py::arg("data"), py::arg("sensor"), py::arg("mask"), py::arg("keep_damaged"),
          py::arg("name"));
    py::class_<decoder>(m, "Decoder",
                        "Decodes bytes as they come, split anywhere: a recording, or the stream of a device\n"
                        "that `sensor` describes (JSON).")
        .def(py::init<const std::optional<std::string>&>(), py::arg("sensor") = py::none())
        .def("push", &decoder::push, py::arg("data"),
             "Returns the frames that are complete with these bytes, (n, rows, columns) of float32.")
        .def("finish", &decoder::finish, "Returns the last frames; no more bytes come.")
        .def_property_readonly("error", &decoder::error,
                               "What was wrong with the last bytes, as a sentence; None if nothing was.");
}

} // namespace tactnet_python

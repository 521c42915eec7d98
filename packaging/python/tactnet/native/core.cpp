// The Python module tactnet._core: what does not depend on a network's type, and the network's shared
// libraries behind one interface. The rest of the package is in Python.

#include "module/decisions.hpp"
#include "module/deployed.hpp"
#include "module/model.hpp"
#include "module/objects.hpp"
#include "module/recordings.hpp"
#include "module/sensing.hpp"
#include "module/stream.hpp"
#include "module/training.hpp"

#include <tactnet/io/file_error.hpp>

#include <string>

PYBIND11_MODULE(_core, m) {
    using namespace tactnet_python;
    py::register_exception<tactnet::file_error>(m, "FileError", PyExc_ValueError);
    py::register_exception<tactnet::training_diverged>(m, "TrainingDiverged", PyExc_RuntimeError);
    m.attr("instruction_set") = std::string(tactnet::instruction_set);
    bind_code(m);
    bind_deployed(m);
    bind_stream(m);
    bind_model(m);
    bind_training(m);
    bind_recordings(m);
    bind_sensing(m);
    bind_decisions(m);
    bind_objects(m);
}

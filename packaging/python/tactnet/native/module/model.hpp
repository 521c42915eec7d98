#pragma once

#include "deployed.hpp"
#include "stream.hpp"

#include <tactnet/io/eight_bit_file.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/save_model.hpp>
#include <tactnet/training/loop.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace tactnet_python {

/// The numbers of a trained network, with the names of its classes.
class model {
public:
    shared_code code;
    trained_numbers numbers;
    std::vector<std::string> classes;
    double temperature = 1;
    tactnet::reflection_rule reflections = tactnet::reflection_rule::all(); ///< kept for files

    /// Reads a file. Runs its self-test as the deployed network, or, if that gives probabilities, as it is
    /// trained.
    static model load(shared_code code, const py::bytes& data, const std::string& name) {
        const tactnet::safetensors file = tactnet::safetensors::parse(to_vector(data), name);
        const tactnet::shape input = code->facts().input;
        tactnet::stored_model stored = tactnet::read_model(file, input, code->arrays());
        stored.mean.resize(input.size());
        for (std::size_t i = 0; i < stored.arrays.size(); ++i)
            stored.arrays[i].resize(code->facts().arrays[i].size);
        model m{
            std::move(code),
            {std::move(stored.arrays), stored.epsilon, std::move(stored.mean), stored.scale, stored.function},
            std::move(stored.classes),
            stored.temperature,
            std::move(stored.reflections)};
        tactnet::check_selftest(file, input, m.classes.size(),
                                [&](std::span<const std::uint8_t> images) { return m.logits_of(images); });
        return m;
    }
    py::bytes file(const std::string& network, const bytes_of_counts& selftest) const {
        tactnet::model_parts parts{.input = code->facts().input,
                                   .arrays = code->arrays(),
                                   .values = {numbers.arrays.begin(), numbers.arrays.end()},
                                   .epsilon = numbers.epsilon,
                                   .mean = numbers.mean,
                                   .scale = numbers.scale,
                                   .classes = classes,
                                   .temperature = temperature,
                                   .function = numbers.function,
                                   .reflections = reflections};
        tactnet::safetensors_writer writer;
        writer.metadata["network"] = network;
        tactnet::add_model(writer, parts, elements_of<std::uint8_t>(selftest),
                           [&](std::span<const std::uint8_t> images) { return logits_of(images); });
        return to_python(writer.to_bytes());
    }
    deployed deploy() const {
        const py::gil_scoped_release released;
        return {code,
                code->call(&network_code::deploy)(numbers),
                classes,
                temperature,
                32,
                reflections,
                numbers.function};
    }
    deployed deploy_in_8_bits(const py::array& images) const {
        const frames_argument frames = frames_of(images, code->facts().input);
        const py::gil_scoped_release released;
        return {code,
                code->call(&network_code::deploy_folded)(
                    code->call(&network_code::calibrate)(numbers, frames.view), numbers.function),
                classes,
                temperature,
                8,
                reflections,
                numbers.function};
    }
    py::dict arrays() const {
        py::dict named;
        for (std::size_t i = 0; i < numbers.arrays.size(); ++i)
            named[py::str(code->facts().arrays[i].name)] =
                py::array_t<float>(code->facts().arrays[i].extents, numbers.arrays[i].data());
        return named;
    }

private:
    std::vector<float> logits_of(std::span<const std::uint8_t> images) const {
        if (!code->facts().ends_in_softmax && code->deploys())
            return deploy().logits_of(images);
        const auto network = code->call(&network_code::trainable)();
        for (std::size_t i = 0; i < numbers.arrays.size(); ++i)
            std::copy(numbers.arrays[i].begin(), numbers.arrays[i].end(),
                      network->values_of(code->facts().arrays[i]).begin());
        network->epsilon() = numbers.epsilon;
        const std::size_t count = images.size() / code->pixels();
        const std::vector<std::size_t> labels(count);
        std::vector<std::size_t> all(count);
        for (std::size_t i = 0; i < count; ++i)
            all[i] = i;
        tactnet::thread_pool alone;
        return tactnet::evaluate(*network, numbers.mean, numbers.scale,
                                 tactnet::labelled_images{images, labels, classes.size()}, all, alone, {},
                                 numbers.function)
            .logits;
    }
};

/// A network in 8 bits of the numbers of its steps, each by their names: weights that are whole multiples of
/// their scales, and ranges.
inline deployed deploy_steps(shared_code code, const std::vector<py::dict>& steps,
                             std::vector<std::string> classes) {
    const tactnet::folded_layout layout = code->call(&network_code::layout)();
    std::vector<float> folded(layout.numbers);
    folded[code->pixels()] = 128, folded[code->pixels() + 1] = 255; // steps per count of the frame's words
    if (steps.size() != layout.steps.size())
        throw_invalid_argument(
            {"deploy: expected numbers of ", layout.steps.size(), " steps, found ", steps.size()});
    for (std::size_t i = 0; i < steps.size(); ++i)
        for (const auto& array : layout.steps[i].arrays) {
            const std::string name = array.name.substr(array.name.rfind('.') + 1);
            const auto numbers = steps[i].contains(name) ? converted_floats::ensure(steps[i][name.c_str()])
                                                         : converted_floats();
            if (static_cast<std::size_t>(numbers.size()) != array.size)
                throw_invalid_argument({"deploy: expected ", array.size, " numbers of ", array.name,
                                        ", found ", static_cast<std::size_t>(numbers.size())});
            std::copy_n(numbers.data(), array.size,
                        folded.begin() + static_cast<std::ptrdiff_t>(array.offset));
        }
    if (const auto problem = tactnet::detail::find_problem(layout, folded))
        throw_invalid_argument(
            {"deploy: ", problem->array, ": expected ", problem->expected, ", found ", problem->found});
    return {code, code->call(&network_code::deploy_folded)(folded, {}), std::move(classes), 1, 8};
}

inline deployed load_8_bits(shared_code code, const py::bytes& data, const std::string& name) {
    const tactnet::safetensors file = tactnet::safetensors::parse(to_vector(data), name);
    tactnet::stored_deployed stored = tactnet::read_deployed(file, code->call(&network_code::layout)());
    deployed found{code,
                   code->call(&network_code::deploy_folded)(stored.folded, stored.function),
                   std::move(stored.classes),
                   stored.temperature,
                   8,
                   std::move(stored.reflections),
                   stored.function};
    tactnet::check_deployed(file, code->facts().input, found.classes.size(),
                            [&](std::span<const std::uint8_t> images) { return found.logits_of(images); });
    return found;
}

inline void bind_model(py::module_& m) {
    py::class_<model>(m, "Model")
        .def_static("load", &model::load)
        .def("file", &model::file)
        .def("deploy", &model::deploy)
        .def("deploy_in_8_bits", &model::deploy_in_8_bits)
        .def("stream",
             [](const model& own) {
                 return stream{own.code->call(&network_code::stream)(own.numbers), own.classes};
             })
        .def("stream_in_8_bits",
             [](const model& own, const floats& sequences) {
                 return stream{own.code->call(&network_code::stream_in_8_bits)(own.numbers,
                                                                               elements_of<float>(sequences)),
                               own.classes};
             })
        .def_property_readonly("arrays", &model::arrays)
        .def_readwrite("classes", &model::classes)
        .def_readwrite("temperature", &model::temperature);
    m.def("load_8_bits", &load_8_bits);
    m.def("deploy_steps", &deploy_steps);
}

} // namespace tactnet_python

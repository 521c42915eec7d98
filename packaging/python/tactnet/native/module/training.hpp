#pragma once

#include "model.hpp"

#include <tactnet/decision/fitting.hpp>
#include <tactnet/training/loop.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace tactnet_python {

inline tactnet::recipe recipe_named(const std::string& name, std::size_t rows, std::size_t columns) {
    if (name == "features")
        return tactnet::recipe::on_features();
    const tactnet::recipe usual = tactnet::recipe::default_for(rows, columns);
    if (name != "default" && name != "thorough")
        throw_invalid_argument(
            {"recipe: expected 'default', 'thorough' or 'features', found ", tactnet::detail::quoted{name}});
    return name == "default" ? usual : usual.thorough();
}

inline void bind_recipe(py::module_& m) {
    using tactnet::recipe;
    py::enum_<tactnet::input_rule>(m, "input")
        .value("mean", tactnet::input_rule::subtract_mean)
        .value("scale", tactnet::input_rule::scale)
        .value("counts", tactnet::input_rule::counts);
    py::enum_<tactnet::augmentation_rule>(m, "augmentation")
        .value("none", tactnet::augmentation_rule::none)
        .value("each_epoch", tactnet::augmentation_rule::each_epoch)
        .value("sixfold", tactnet::augmentation_rule::sixfold);
    py::class_<recipe> own(m, "Recipe");
    own.def(py::init(&recipe_named))
        .def_readwrite("epochs", &recipe::epochs)
        .def_readwrite("batch", &recipe::batch)
        .def_readwrite("rate", &recipe::rate)
        .def_readwrite("input", &recipe::input)
        .def_readwrite("augmentation", &recipe::augmentation)
        .def_readwrite("label_smoothing", &recipe::label_smoothing)
        .def_readwrite("sharpness_radius", &recipe::sharpness_radius)
        .def_readwrite("averaging", &recipe::averaging)
        .def_readwrite("epsilon", &recipe::epsilon)
        .def_readwrite("validate_every", &recipe::validate_every)
        .def_readwrite("patience", &recipe::patience)
        .def_readwrite("keeps_last", &recipe::keeps_last);
    using ranges = tactnet::augmentation_ranges;
    const std::pair<const char*, double ranges::*> each[] = {{"reflect_rows", &ranges::reflect_rows},
                                                             {"reflect_columns", &ranges::reflect_columns},
                                                             {"translation", &ranges::translation},
                                                             {"rotation", &ranges::rotation},
                                                             {"scale", &ranges::scale},
                                                             {"pressure", &ranges::pressure},
                                                             {"shear", &ranges::shear},
                                                             {"erase", &ranges::erase}};
    for (const auto& [name, member] : each)
        own.def_property(
            name, [member = member](const recipe& r) { return r.ranges.*member; },
            [member = member](recipe& r, double value) { r.ranges.*member = value; });
}

/// Trains a network. `report(epoch of epochs, loss, validation accuracy or NaN)` is called after each epoch.
inline model train(shared_code code, const py::array& x, const indices& labels,
                   std::vector<std::string> classes, const indices& training, const indices& validation,
                   const tactnet::recipe& recipe, std::uint64_t seed, std::size_t threads, const model* start,
                   const py::function& report) {
    const frames_argument frames = frames_of(x, code->facts().input);
    const auto list = [](const indices& a) {
        return std::vector<std::size_t>(a.data(), a.data() + a.size());
    };
    const std::vector<std::size_t> of_each = list(labels);
    tactnet::data_split split{list(training), list(validation), {}};
    const std::size_t numbers = frames.view.count * code->pixels();
    tactnet::thread_pool pool(threads);
    const py::gil_scoped_release released;
    const tactnet::labelled_samples samples = [&]() -> tactnet::labelled_samples {
        if (frames.view.are_counts)
            return tactnet::labelled_images{
                std::span(static_cast<const std::uint8_t*>(frames.view.elements), numbers), of_each,
                classes.size()};
        return tactnet::labelled_features{std::span(static_cast<const float*>(frames.view.elements), numbers),
                                          of_each, classes.size()};
    }();
    tactnet::training_loop loop(code->call(&network_code::trainable)(), recipe, samples, split, seed, pool);
    const std::vector<tactnet::parameter>& arrays = code->facts().arrays;
    if (start != nullptr) {
        const auto from = code->call(&network_code::trainable)();
        for (std::size_t i = 0; i < arrays.size(); ++i)
            std::copy(start->numbers.arrays[i].begin(), start->numbers.arrays[i].end(),
                      from->values_of(arrays[i]).begin());
        loop.start_from(from->learnable_values(), from->running_statistics());
    }
    while (!loop.finished()) {
        const tactnet::epoch_report& done = loop.run_epoch();
        const py::gil_scoped_acquire held;
        report(done.epoch, recipe.epochs, done.loss, done.validation_accuracy);
        if (PyErr_CheckSignals() != 0)
            throw py::error_already_set();
    }
    const auto best = loop.best().copy();
    model m{code,
            {{}, best->epsilon(), {loop.mean().begin(), loop.mean().end()}, loop.scale()},
            std::move(classes),
            1,
            loop.reflections()};
    for (const tactnet::parameter& p : arrays) {
        const std::span<const float> values = best->values_of(p);
        m.numbers.arrays.emplace_back(values.begin(), values.end());
    }
    // As the program does: probabilities are calibrated with what the network has not learnt from.
    if (!split.validation.empty()) {
        const tactnet::evaluation found =
            tactnet::evaluate(*best, loop.mean(), loop.scale(), samples, split.validation, pool);
        std::vector<std::size_t> expected;
        for (const std::size_t i : split.validation)
            expected.push_back(of_each[i]);
        if (std::isfinite(found.loss))
            m.temperature =
                tactnet::fit_temperature(found.logits, m.classes.size(), expected, m.classes.size())
                    .temperature;
    }
    return m;
}

inline void bind_training(py::module_& m) {
    bind_recipe(m);
    m.def("train", &train);
    m.def("split", [](const indices& labels, std::size_t classes, bool blocked, std::uint64_t seed,
                      double validation, double test) {
        const auto split = tactnet::split_data(
            std::span(labels.data(), static_cast<std::size_t>(labels.size())), classes,
            blocked ? tactnet::split_rule::blocked : tactnet::split_rule::random, seed, {validation, test});
        const auto array = [](const std::vector<std::size_t>& list) {
            return py::array_t<std::size_t>(static_cast<py::ssize_t>(list.size()), list.data());
        };
        return py::make_tuple(array(split.training), array(split.validation), array(split.test));
    });
}

} // namespace tactnet_python

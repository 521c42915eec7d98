#pragma once

#include "model.hpp"

#include <tactnet/decision/fitting.hpp>
#include <tactnet/training/choose_augmentation.hpp>
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

/// The recipe for so many training frames, if the number is known.
inline tactnet::recipe recipe_named(const std::string& name, std::size_t rows, std::size_t columns,
                                    std::size_t training_frames) {
    if (name == "features")
        return tactnet::recipe::on_features();
    const tactnet::recipe usual = tactnet::recipe::default_for(rows, columns);
    if (name != "default" && name != "thorough")
        throw_invalid_argument(
            {"recipe: expected 'default', 'thorough' or 'features', found ", tactnet::detail::quoted{name}});
    const tactnet::recipe named = name == "default" ? usual : usual.thorough();
    return training_frames > 0 ? named.suited_to(training_frames) : named;
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
    own.def(py::init(&recipe_named), py::arg("name"), py::arg("rows"), py::arg("columns"),
            py::arg("training_frames") = 0)
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

inline std::vector<std::size_t> list_of(const indices& a) {
    return {a.data(), a.data() + a.size()};
}

/// Frames with their labels, as the library reads them.
class samples_argument {
public:
    samples_argument(const py::array& x, const tactnet::shape& input, const indices& labels)
        : frames_(frames_of(x, input)),
          numbers_(frames_.view.count * input.size()),
          labels_(list_of(labels)) {}
    tactnet::labelled_samples of(std::size_t classes) const {
        if (frames_.view.are_counts)
            return tactnet::labelled_images{all<std::uint8_t>(), labels_, classes};
        return tactnet::labelled_features{all<float>(), labels_, classes};
    }
    std::size_t label(std::size_t i) const { return labels_[i]; }

private:
    template <class Element>
    std::span<const Element> all() const {
        return {static_cast<const Element*>(frames_.view.elements), numbers_};
    }
    frames_argument frames_;
    std::size_t numbers_;
    std::vector<std::size_t> labels_;
};

/// The recipe with the augmentation that suits the training frames, as the program chooses it. What the
/// caller has set stays: reflections of rows or columns, and movement.
inline tactnet::augmentation_choice choose(const shared_code& code, const py::array& x, const indices& labels,
                                           const std::vector<std::string>& classes, const indices& training,
                                           const indices& groups, const tactnet::recipe& recipe,
                                           std::uint64_t seed, std::size_t threads, bool rows, bool columns,
                                           bool movement) {
    const samples_argument given(x, code->facts().input, labels);
    const tactnet::labelled_samples samples = given.of(classes.size());
    samples.check(code->facts().input, code->outputs()); // the search counts by labels before it trains
    const std::vector<std::size_t> learnt = list_of(training), group_of = list_of(groups);
    bool stopped = false;
    tactnet::augmentation_choice found;
    {
        const py::gil_scoped_release released;
        tactnet::thread_pool pool(threads);
        found = tactnet::choose_augmentation(*code->call(&network_code::trainable)(), recipe, samples, learnt,
                                             group_of, seed, pool, classes,
                                             [&](std::size_t, std::size_t) {
                                                 const py::gil_scoped_acquire held;
                                                 return stopped = stopped || PyErr_CheckSignals() != 0;
                                             },
                                             220, {.rows = rows, .columns = columns, .movement = movement});
    }
    if (stopped)
        throw py::error_already_set();
    return found;
}

inline void bind_choice(py::module_& m) {
    using tactnet::augmentation_choice;
    py::class_<augmentation_choice>(m, "AugmentationChoice", "What augmentation=\"auto\" chose, and why.")
        .def_readonly("recipe", &augmentation_choice::chosen, "The recipe that was trained with.")
        .def_readonly("reasons", &augmentation_choice::reasons, "Sentences.")
        .def_property_readonly(
            "function",
            [](const augmentation_choice& c) {
                return tactnet::count_rule_names[static_cast<std::size_t>(c.chosen.function.rule)];
            },
            "The function that compresses counts: 'identity' or 'root'.")
        .def_property_readonly(
            "reflections",
            [](const augmentation_choice& c) {
                const auto partners = [&](const tactnet::reflection_rule::axis& axis) {
                    return axis.reflects ? py::object(py::cast(axis.partners)) : py::none();
                };
                const tactnet::reflection_rule learnt = c.chosen.learnt_reflections();
                return std::pair(partners(learnt.rows), partners(learnt.columns));
            },
            "Of rows and of columns: the class that each class shows when reflected, an empty list if its "
            "own;\n"
            "None without reflections.")
        .def_property_readonly(
            "trials",
            [](const augmentation_choice& c) {
                py::list found;
                for (const tactnet::augmentation_trial& t : c.trials)
                    found.append(py::make_tuple(t.what, t.gain, t.error, t.adopted));
                return found;
            },
            "Of each short training (what, gain, standard error, adopted): of the probability of the right\n"
            "class, 0 to 1.");
    m.def("choose", &choose);
}

/// Trains a network. `report(epoch of epochs, loss, validation accuracy or NaN)` is called after each epoch.
inline model train(shared_code code, const py::array& x, const indices& labels,
                   std::vector<std::string> classes, const indices& training, const indices& validation,
                   const tactnet::recipe& recipe, std::uint64_t seed, std::size_t threads, const model* start,
                   const py::function& report) {
    const samples_argument given(x, code->facts().input, labels);
    tactnet::data_split split{list_of(training), list_of(validation), {}};
    tactnet::thread_pool pool(threads);
    const py::gil_scoped_release released;
    const tactnet::labelled_samples samples = given.of(classes.size());
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
            {{}, best->epsilon(), {loop.mean().begin(), loop.mean().end()}, loop.scale(), loop.function()},
            std::move(classes),
            1,
            loop.reflections()};
    for (const tactnet::parameter& p : arrays) {
        const std::span<const float> values = best->values_of(p);
        m.numbers.arrays.emplace_back(values.begin(), values.end());
    }
    // As the program does: probabilities are calibrated with what the network has not learnt from.
    if (!split.validation.empty()) {
        const tactnet::evaluation found = tactnet::evaluate(*best, loop.mean(), loop.scale(), samples,
                                                            split.validation, pool, {}, loop.function());
        std::vector<std::size_t> expected;
        for (const std::size_t i : split.validation)
            expected.push_back(given.label(i));
        if (std::isfinite(found.loss))
            m.temperature =
                tactnet::fit_temperature(found.logits, m.classes.size(), expected, m.classes.size())
                    .temperature;
    }
    return m;
}

inline void bind_training(py::module_& m) {
    bind_recipe(m);
    bind_choice(m);
    m.def("train", &train);
    m.def("split", [](const indices& labels, std::size_t classes, bool blocked, std::uint64_t seed,
                      double validation, double test) {
        const auto split = tactnet::split_data(
            elements_of<std::size_t>(labels), classes,
            blocked ? tactnet::split_rule::blocked : tactnet::split_rule::random, seed, {validation, test});
        const auto array = [](const std::vector<std::size_t>& list) {
            return py::array_t<std::size_t>(static_cast<py::ssize_t>(list.size()), list.data());
        };
        return py::make_tuple(array(split.training), array(split.validation), array(split.test));
    });
}

} // namespace tactnet_python

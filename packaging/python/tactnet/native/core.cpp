// The Python module tactnet._core: what does not depend on a network's type, and the network's shared
// libraries behind one interface. The rest of the package is in Python.

#include "interface.hpp"

#include <tactnet/decision/fitting.hpp>
#include <tactnet/deployment/eight_bit/layout.hpp>
#include <tactnet/io/eight_bit_file.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/save_model.hpp>
#include <tactnet/training/loop.hpp>

#include <algorithm>
#include <cmath>
#include <dlfcn.h>
#include <limits>
#include <optional>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <stdexcept>
#include <utility>

namespace py = pybind11;
using namespace tactnet_python;
using tactnet::detail::throw_invalid_argument;

namespace {

using floats = py::array_t<float, py::array::c_style>;
using bytes_of_counts = py::array_t<std::uint8_t, py::array::c_style>;
using indices = py::array_t<std::size_t, py::array::c_style | py::array::forcecast>;

/// A network's type: what has been compiled for it so far.
class compiled {
public:
    /// Adds what a shared library has. It stays loaded for as long as the program runs.
    void add(const std::string& path) {
        void* const library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
        const auto fill = library == nullptr
                              ? nullptr
                              : reinterpret_cast<void (*)(network_code*)>(dlsym(library, "tactnet_code"));
        if (fill == nullptr)
            throw std::runtime_error(path +
                                     ": expected a network that tactnet has compiled, found: " + dlerror());
        network_code more;
        fill(&more);
        if (more.instruction_set != tactnet::instruction_set)
            throw std::runtime_error(path + ": expected a network for " +
                                     std::string(tactnet::instruction_set) + ", found one for " +
                                     std::string(more.instruction_set) +
                                     ": compile the module and the network with the same CXXFLAGS");
        const auto merge = [&](auto network_code::*member) {
            if (more.*member != nullptr)
                code_.*member = more.*member;
        };
        merge(&network_code::facts), merge(&network_code::trainable), merge(&network_code::deploy);
        merge(&network_code::layout), merge(&network_code::calibrate), merge(&network_code::deploy_folded);
        merge(&network_code::stream), merge(&network_code::stream_in_8_bits);
        facts_ = code_.facts();
    }
    const network_facts& facts() const { return facts_; }
    /// A function of the network's type, which the package has compiled before it calls.
    template <class Function>
    Function call(Function network_code::*member) const {
        if (code_.*member == nullptr)
            throw std::logic_error("tactnet._core: this part of the network has not been compiled");
        return code_.*member;
    }
    bool deploys() const { return code_.deploy != nullptr; }
    std::size_t pixels() const { return facts_.input.size(); }
    std::size_t outputs() const { return facts_.output.size(); }
    tactnet::stored_arrays arrays() const { return tactnet::stored_arrays_of(facts_.arrays, outputs()); }

private:
    network_code code_;
    network_facts facts_;
};
using shared_code = std::shared_ptr<const compiled>;

/// Networks here have no input function: such a file would be read as another network.
void refuse_function(const tactnet::safetensors& file, const tactnet::input_function& function) {
    if (!function.identity())
        throw tactnet::file_error(file.file(), "metadata 'input_function'", "a network without one",
                                  "one with");
}

struct frames_argument {
    py::array kept;
    frames_view view;
    bool single;
};

std::string shape_of(const py::array& x) {
    return py::str(x.attr("shape"));
}

/// A frame or a batch of frames: bytes and floats as they lie in memory, everything else as floats.
frames_argument frames_of(py::array x, const tactnet::shape& input) {
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
    const std::size_t of_frame = planar ? 2 : flat ? 1 : 3;
    const bool are_counts = py::isinstance<bytes_of_counts>(x);
    if (!are_counts && !py::isinstance<floats>(x))
        x = x.dtype().kind() == 'u' && x.itemsize() == 1
                ? py::array(bytes_of_counts::ensure(x))
                : py::array(py::array_t<float, py::array::c_style | py::array::forcecast>::ensure(x));
    if (!x)
        throw py::error_already_set();
    return {x,
            {x.data(), py::isinstance<bytes_of_counts>(x), static_cast<std::size_t>(x.size()) / input.size()},
            dimensions == of_frame};
}

std::vector<std::byte> to_vector(const py::bytes& data) {
    const std::string_view text = data;
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}
py::bytes to_python(std::span<const std::byte> data) {
    return {reinterpret_cast<const char*>(data.data()), data.size()};
}

/// A network in its fastest form.
class deployed {
public:
    shared_code code;
    std::unique_ptr<any_deployed> own;
    std::vector<std::string> classes;
    double temperature = 1;
    int bits = 32;
    tactnet::reflection_rule reflections = tactnet::reflection_rule::all(); ///< kept for files

    py::array_t<float> scores(const py::array& x, std::size_t threads) const {
        const frames_argument frames = frames_of(x, code->facts().input);
        py::array_t<float> result = frames.single
                                        ? py::array_t<float>(static_cast<py::ssize_t>(code->outputs()))
                                        : py::array_t<float>({frames.view.count, code->outputs()});
        const std::span to(result.mutable_data(), static_cast<std::size_t>(result.size()));
        infer(frames.view, to, threads);
        return result;
    }
    /// Of each class; as classify_logits and classify_probabilities compute that of the most likely.
    py::array_t<double> probabilities(const py::array& x, std::size_t threads) const {
        const frames_argument frames = frames_of(x, code->facts().input);
        const std::size_t named = classes.size();
        py::array_t<double> result = frames.single ? py::array_t<double>(static_cast<py::ssize_t>(named))
                                                   : py::array_t<double>({frames.view.count, named});
        double* to = result.mutable_data();
        const py::gil_scoped_release released;
        std::vector<float> outputs(frames.view.count * code->outputs());
        require_finite(frames.view, outputs, threads);
        for (std::size_t i = 0; i < frames.view.count; ++i, to += named)
            probabilities_of(std::span(outputs).subspan(i * code->outputs(), named), to);
        return result;
    }
    /// The most likely class of a frame and its probability, or None.
    std::optional<std::pair<std::string, double>> classify(const py::array& x) const {
        const frames_argument frames = frames_of(x, code->facts().input);
        if (frames.view.count != 1)
            throw_invalid_argument({"classify: expected one frame, found ", frames.view.count});
        const py::gil_scoped_release released;
        std::vector<float> outputs(code->outputs());
        if (own->infer(frames.view, outputs, 1) != tactnet::frame_status::ok)
            return std::nullopt;
        const auto found = code->facts().ends_in_softmax
                               ? tactnet::classify_probabilities(outputs, classes.size(), temperature)
                               : tactnet::classify_logits(outputs, classes.size(), temperature);
        return found ? std::optional(std::pair(classes[found->index], found->probability)) : std::nullopt;
    }
    std::string header(const std::string& network, const std::string& name,
                       const bytes_of_counts& frame) const {
        if (static_cast<std::size_t>(frame.size()) != code->pixels())
            throw_invalid_argument({"header: expected a frame of ", code->pixels(), " counts, found ",
                                    static_cast<std::size_t>(frame.size())});
        if (reflections != tactnet::reflection_rule::all())
            throw_invalid_argument(
                {"header: expected a network with all reflections, found one with its own, "
                 "which `tactnet export` writes"});
        return own->header({.network = network, .namespace_name = name, .classes = classes},
                           std::span(frame.data(), code->pixels()));
    }
    /// The bytes of a file of a network in 8 bits.
    py::bytes file(const std::string& network, const bytes_of_counts& selftest) const {
        tactnet::safetensors_writer writer;
        writer.metadata["network"] = network;
        tactnet::add_deployed(
            writer, code->call(&network_code::layout)(), own->folded(), classes,
            std::span(selftest.data(), static_cast<std::size_t>(selftest.size())),
            [&](std::span<const std::uint8_t> images) { return logits_of(images); }, temperature, {},
            reflections);
        return to_python(writer.to_bytes());
    }
    std::vector<float> logits_of(std::span<const std::uint8_t> images) const {
        std::vector<float> outputs(images.size() / code->pixels() * code->outputs()), logits;
        static_cast<void>(own->infer({images.data(), true, images.size() / code->pixels()}, outputs, 1));
        for (std::size_t i = 0; i < outputs.size(); i += code->outputs())
            logits.insert(logits.end(), outputs.begin() + static_cast<std::ptrdiff_t>(i),
                          outputs.begin() + static_cast<std::ptrdiff_t>(i + classes.size()));
        return logits;
    }

private:
    void infer(const frames_view& frames, std::span<float> to, std::size_t threads) const {
        const py::gil_scoped_release released;
        require_finite(frames, to, threads);
    }
    void require_finite(const frames_view& frames, std::span<float> to, std::size_t threads) const {
        if (own->infer(frames, to, threads) == tactnet::frame_status::ok)
            return;
        const std::size_t size = code->pixels() * (frames.are_counts ? 1 : sizeof(float));
        for (std::size_t i = 0; i < frames.count; ++i)
            if (own->infer({static_cast<const std::byte*>(frames.elements) + i * size, frames.are_counts, 1},
                           to.subspan(i * code->outputs()), 1) != tactnet::frame_status::ok)
                throw_invalid_argument({"expected finite counts that give finite outputs, found NaN, inf "
                                        "(infinity) or numbers too large in frame ",
                                        i});
    }
    void probabilities_of(std::span<const float> outputs, double* to) const {
        const auto largest = static_cast<double>(outputs[tactnet::first_largest(outputs)]);
        double sum = 0;
        for (std::size_t c = 0; c < outputs.size(); ++c) {
            const auto output = static_cast<double>(outputs[c]);
            to[c] = !code->facts().ends_in_softmax ? std::exp((output - largest) / temperature)
                    : temperature == 1             ? output
                                                   : std::pow(output / largest, 1 / temperature);
            sum += to[c];
        }
        for (std::size_t c = 0; c < outputs.size(); ++c)
            to[c] /= sum;
    }
};

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
        refuse_function(file, stored.function);
        stored.mean.resize(input.size());
        for (std::size_t i = 0; i < stored.arrays.size(); ++i)
            stored.arrays[i].resize(code->facts().arrays[i].size);
        model m{std::move(code),
                {std::move(stored.arrays), stored.epsilon, std::move(stored.mean), stored.scale},
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
                                   .reflections = reflections};
        tactnet::safetensors_writer writer;
        writer.metadata["network"] = network;
        tactnet::add_model(writer, parts,
                           std::span(selftest.data(), static_cast<std::size_t>(selftest.size())),
                           [&](std::span<const std::uint8_t> images) { return logits_of(images); });
        return to_python(writer.to_bytes());
    }
    deployed deploy() const {
        const py::gil_scoped_release released;
        return {code, code->call(&network_code::deploy)(numbers), classes, temperature, 32, reflections};
    }
    deployed deploy_in_8_bits(const py::array& images) const {
        const frames_argument frames = frames_of(images, code->facts().input);
        const py::gil_scoped_release released;
        return {
            code,
            code->call(&network_code::deploy_folded)(code->call(&network_code::calibrate)(numbers, frames.view)),
            classes,
            temperature,
            8,
            reflections};
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
            return deployed{code,       code->call(&network_code::deploy)(numbers), classes, temperature, 32,
                            reflections}
                .logits_of(images);
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
                                 tactnet::labelled_images{images, labels, classes.size()}, all, alone)
            .logits;
    }
};

deployed load_8_bits(shared_code code, const py::bytes& data, const std::string& name) {
    const tactnet::safetensors file = tactnet::safetensors::parse(to_vector(data), name);
    tactnet::stored_deployed stored = tactnet::read_deployed(file, code->call(&network_code::layout)());
    refuse_function(file, stored.function);
    deployed found{code,
                   code->call(&network_code::deploy_folded)(stored.folded),
                   std::move(stored.classes),
                   stored.temperature,
                   8,
                   std::move(stored.reflections)};
    tactnet::check_deployed(file, code->facts().input, found.classes.size(),
                            [&](std::span<const std::uint8_t> images) { return found.logits_of(images); });
    return found;
}

tactnet::recipe recipe_named(const std::string& name, std::size_t rows, std::size_t columns) {
    if (name == "features")
        return tactnet::recipe::on_features();
    const tactnet::recipe usual = tactnet::recipe::default_for(rows, columns);
    if (name != "default" && name != "thorough")
        throw_invalid_argument(
            {"recipe: expected 'default', 'thorough' or 'features', found ", tactnet::detail::quoted{name}});
    return name == "default" ? usual : usual.thorough();
}

void bind_recipe(py::module_& m) {
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
model train(shared_code code, const py::array& x, const indices& labels, std::vector<std::string> classes,
            const indices& training, const indices& validation, const tactnet::recipe& recipe,
            std::uint64_t seed, std::size_t threads, const model* start, const py::function& report) {
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
            std::move(classes)};
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

/// A network of sequences, with the state of one recording.
class stream {
public:
    std::unique_ptr<any_stream> own;
    std::vector<std::string> classes;

    py::array_t<float> step(const py::array_t<float, py::array::c_style | py::array::forcecast>& frames) {
        const auto features = static_cast<py::ssize_t>(own->features);
        const bool single = frames.ndim() == 1;
        if (frames.ndim() < 1 || frames.ndim() > 2 || frames.shape(frames.ndim() - 1) != features)
            throw_invalid_argument({"expected frames of ", own->features,
                                    " features, found an array of shape ", shape_of(frames)});
        const std::size_t count = single ? 1 : static_cast<std::size_t>(frames.shape(0));
        py::array_t<float> result = single ? py::array_t<float>(static_cast<py::ssize_t>(own->outputs))
                                           : py::array_t<float>({count, own->outputs});
        const std::span from(frames.data(), static_cast<std::size_t>(frames.size()));
        const std::span to(result.mutable_data(), static_cast<std::size_t>(result.size()));
        const py::gil_scoped_release released;
        if (const std::size_t taken = own->run(from, to); taken != count)
            throw_invalid_argument(
                {"expected finite features, found NaN, inf (infinity) or a number too large in frame ", taken,
                 "; the state is that before it"});
        return result;
    }
    std::string header(const std::string& network, const std::string& name, const floats& recording) const {
        return own->header({.network = network, .namespace_name = name, .classes = classes},
                           std::span(recording.data(), static_cast<std::size_t>(recording.size())));
    }
};

} // namespace

PYBIND11_MODULE(_core, m) {
    py::register_exception<tactnet::file_error>(m, "FileError", PyExc_ValueError);
    py::register_exception<tactnet::training_diverged>(m, "TrainingDiverged", PyExc_RuntimeError);
    m.attr("instruction_set") = std::string(tactnet::instruction_set);

    const auto shape = [](const tactnet::shape& s) { return std::array{s.rows, s.columns, s.channels}; };
    py::class_<compiled, std::shared_ptr<compiled>> code(m, "Code");
    code.def(py::init()).def("add", &compiled::add);
    code.def_property_readonly(
        "input_shape", [=](const compiled& c) { return py::tuple(py::cast(shape(c.facts().input))); });
    code.def_property_readonly(
        "output_shape", [=](const compiled& c) { return py::tuple(py::cast(shape(c.facts().output))); });
    for (const auto& [name, member] :
         {std::pair("parameters", &network_facts::parameters),
          std::pair("statistics", &network_facts::statistics),
          std::pair("multiply_adds", &network_facts::multiply_adds),
          std::pair("multiply_adds_on_pixels", &network_facts::multiply_adds_on_pixels),
          std::pair("activation_bytes", &network_facts::activation_bytes)})
        code.def_property_readonly(name, [member = member](const compiled& c) { return c.facts().*member; });
    code.def_property_readonly("ends_in_softmax",
                               [](const compiled& c) { return c.facts().ends_in_softmax; });
    code.def_property_readonly("needs_counts", [](const compiled& c) { return c.facts().needs_counts; });

    py::class_<deployed>(m, "Deployed")
        .def("scores", &deployed::scores, py::arg("frames"), py::arg("threads") = 1)
        .def("predict_proba", &deployed::probabilities, py::arg("frames"), py::arg("threads") = 1)
        .def("classify", &deployed::classify, py::arg("frame"))
        .def("header", &deployed::header)
        .def("file", &deployed::file)
        .def_readonly("classes", &deployed::classes)
        .def_readonly("temperature", &deployed::temperature)
        .def_readonly("bits", &deployed::bits)
        .def_property_readonly("weight_bytes", [](const deployed& d) { return d.own->weight_bytes; })
        .def_property_readonly("workspace_bytes", [](const deployed& d) { return d.own->workspace_bytes; });

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
                 return stream{own.code->call(&network_code::stream_in_8_bits)(
                                   own.numbers,
                                   std::span(sequences.data(), static_cast<std::size_t>(sequences.size()))),
                               own.classes};
             })
        .def_property_readonly("arrays", &model::arrays)
        .def_readwrite("classes", &model::classes)
        .def_readwrite("temperature", &model::temperature);

    py::class_<stream>(
        m, "Stream",
        "A network of sequences that takes one frame after the other. Its state is that of one recording.")
        .def("step", &stream::step, py::arg("frames"),
             "Takes a frame (features,) or several (n, features); returns the outputs after each.")
        .def(
            "reset", [](stream& s) { s.own->reset(); }, "Begins a new recording.")
        .def("header", &stream::header, py::arg("network"), py::arg("namespace"), py::arg("recording"))
        .def_readonly("classes", &stream::classes)
        .def_property(
            "state", [](const stream& s) { return to_python(s.own->state()); },
            [](stream& s, const py::bytes& state) {
                if (!s.own->restore(to_vector(state)))
                    throw std::invalid_argument(
                        "state: expected bytes of a state of this stream, found others");
            },
            "Bytes with a checksum; assign them to go on from there.");
    bind_recipe(m);
    m.def("load_8_bits", &load_8_bits);
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

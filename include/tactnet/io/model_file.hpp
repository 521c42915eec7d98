#pragma once

#include <tactnet/detail/function_ref.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/model_description.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/stored_arrays.hpp>
#include <tactnet/networks/model.hpp>
#include <tactnet/tensor/shape.hpp>
#include <tactnet/text/numbers.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

// Reads a network's arrays from weight files, under PyTorch's names; save_model.hpp writes them. A network is
// any type that describes its arrays as tactnet::basic_network does; all that does not need its type compiles
// once per unit.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// Reads arrays from a file, in order. The output layer has a row per class, in the file and in the result.
/// Throws as `load_parameters`.
[[nodiscard]] [[gnu::cold]] inline std::vector<std::vector<float>>
read_arrays(const safetensors& file, const stored_arrays& arrays, std::size_t classes) {
    check_classes("load_parameters", classes, arrays.outputs);
    require_arrays(file, arrays, classes);
    std::vector<std::vector<float>> values(arrays.list.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::string& name = arrays.list[i].name;
        values[i] = file.values<float>(name);
        check_values(file, name, values[i]);
    }
    return values;
}

/// Fills a network with the result of `read_arrays`. Rows that were not stored become zero.
template <class Network>
[[gnu::cold]] void set_parameters(Network& network, const std::vector<std::vector<float>>& values) {
    std::size_t index = 0;
    network.for_each_parameter([&](const auto&, auto to) {
        const std::vector<float>& from = values.at(index++);
        std::copy(from.begin(), from.end(), to.begin());
        std::fill(to.begin() + static_cast<std::ptrdiff_t>(from.size()), to.end(), 0);
    });
}

} // namespace detail

/// Fills a network from a file. With fewer `classes` than outputs the file holds only as many rows of the
/// output layer; the others become zero. The weights of a dense layer may be stored as [outputs, inputs] or
/// as [outputs, channels, rows, columns] of its input. `input_mean`, `selftest.*` and PyTorch's
/// `num_batches_tracked` are ignored. Throws file_error when an array is missing, has other extents or is not
/// finite, when a variance is negative, or when there is a tensor that the network does not have; the network
/// is then unchanged. Throws std::invalid_argument unless there are 1 to Network::outputs classes.
template <class Network>
void load_parameters(Network& network, const safetensors& file, std::size_t classes = Network::outputs) {
    detail::set_parameters(network, detail::read_arrays(file, stored_arrays_of<Network>(), classes));
}

// A trained network as one file: arrays, the mean of its inputs, and in the metadata what it is and how its
// inputs are meant. A file may carry inputs and their logits; loading then checks them, so that no mistake of
// a compiler, a processor or a format goes unnoticed. This header reads such files; save_model.hpp writes
// them.
//
// What does not depend on the network's type works on stored_model: programs of many networks
// may call it in one place.

/// A model as read from a file, without the network's type.
struct stored_model {
    std::vector<std::vector<float>> arrays; ///< the values of each array, in order
    double epsilon = 1e-5;                  ///< of batch norms
    std::vector<float> mean;                ///< of the input; empty where none is subtracted
    float scale = 1;
    std::vector<std::string> classes;
    double temperature = 1; ///< of probabilities
    input_function function{};
    reflection_rule reflections = reflection_rule::all();
};

/// model::logits of any network, as an argument: a reference, which must not outlive what it refers to.
using logits_function = detail::function_ref<std::vector<float>(std::span<const std::uint8_t>)>;

namespace detail {

/// Self-tests compare with what another machine has computed in float.
inline constexpr float selftest_tolerance = 1e-4F;

/// The extents of images in a file: [rows, columns], with the channels before them where there are several,
/// and the count before those if given.
[[gnu::cold, gnu::noinline]] inline std::vector<std::size_t>
image_extents(shape image, std::optional<std::size_t> count = std::nullopt) {
    std::vector<std::size_t> extents;
    if (count)
        extents.push_back(*count);
    if (image.channels > 1)
        extents.push_back(image.channels);
    extents.push_back(image.rows);
    extents.push_back(image.columns);
    return extents;
}

/// Throws unless the file states the network's size, or none.
[[gnu::cold]] inline void require_size(const safetensors_index& file, const model_description& d,
                                       shape input) {
    const auto text = [](std::optional<std::size_t> extent) {
        return extent ? std::to_string(*extent) : std::string("?");
    };
    if (d.rows.value_or(input.rows) != input.rows || d.columns.value_or(input.columns) != input.columns)
        throw_file_error(file.file(), {"metadata"}, {"a network for ", input.rows, " x ", input.columns},
                         {"one for ", text(d.rows), " x ", text(d.columns)});
}

/// The names that a file gives, or class_00, class_01, … without any.
[[gnu::cold]] inline std::vector<std::string>
class_names(const safetensors_index& file, std::vector<std::string> names, std::size_t classes) {
    if (!names.empty() && names.size() != classes)
        throw_file_error(file.file(), {"metadata 'classes'"}, {classes, " names, as there are logits"},
                         {names.size()});
    for (std::size_t c = names.size(); c < classes; ++c)
        names.push_back(joined({c < 10 ? "class_0" : "class_", c}));
    return names;
}

} // namespace detail

/// Reads a model for a network of these arrays and this input shape; `load_model` describes the rest.
/// `check_selftest` runs the self-test.
[[nodiscard]] [[gnu::cold]] inline stored_model read_model(const safetensors& file, shape input,
                                                           const stored_arrays& arrays,
                                                           std::optional<double> epsilon = std::nullopt) {
    model_description d = describe_model(file);
    if (d.bits)
        detail::throw_file_error(file.file(), {"metadata 'bits'"}, {"weights in single precision"},
                                 {"'8': a network in 8 bits, which load_deployed<network, eight_bit> reads"});
    detail::require_size(file, d, input);
    stored_model m;
    const std::size_t classes = stored_classes(file, arrays);
    m.classes = detail::class_names(file, std::move(d.classes), classes);
    m.epsilon = epsilon ? *epsilon : d.epsilon.value_or(1e-5);
    m.arrays = detail::read_arrays(file, arrays, classes);
    if (!detail::any_weight(arrays, m.arrays))
        detail::throw_file_error(file.file(), {}, {"a trained network"}, {detail::untrained});
    if (d.subtracts_mean.value_or(file.contains("input_mean"))) {
        file.require_extents("input_mean", detail::image_extents(input));
        m.mean = file.values<float>("input_mean");
        detail::check_values(file, "input_mean", m.mean);
    }
    m.scale = d.scale.value_or(1.0F);
    m.temperature = d.temperature.value_or(1.0);
    m.function = d.function.value_or(input_function{});
    m.reflections = d.reflections.value_or(reflection_rule::all());
    return m;
}

/// Throws file_error unless the self-test's images in the file still give their logits, a row of `classes`
/// each, up to `tolerance` times the largest logit. A file may have no self-test; a self-test without images,
/// or with logits that are not finite and could not be compared, throws.
[[gnu::cold]] inline void check_selftest(const safetensors& file, shape input, std::size_t classes,
                                         const logits_function& logits,
                                         float tolerance = detail::selftest_tolerance) {
    constexpr const char *images = "selftest.input", *outputs = "selftest.logits";
    if (!file.contains(images) && !file.contains(outputs))
        return;
    const auto& extents = file.at(images).extents;
    const std::size_t count = extents.empty() ? 0 : extents.front();
    file.require_extents(images, detail::image_extents(input, count));
    file.require_extents(outputs, std::vector{count, classes});
    if (count == 0)
        detail::throw_tensor_error(file.file(), images, {"one image or more"}, {"none"});
    const std::vector<float> expected = file.values<float>(outputs);
    detail::check_values(file, outputs, expected);
    const std::vector<float> found = logits(file.values<std::uint8_t>(images));
    // Weights that were rounded since.
    std::string reason;
    for (const auto& [name, tensor] : file.tensors())
        if (tensor.type == element_type::float16 || tensor.type == element_type::bfloat16)
            reason =
                detail::joined({": weights are stored as ", element_type_name(tensor.type),
                                ", with fewer digits than when the self-test was made; load them without "
                                "the tensors selftest.input and selftest.logits, and save the model again"});
    float largest = 0;
    for (const float value : expected)
        largest = std::max(largest, std::abs(value));
    for (std::size_t i = 0; i < expected.size(); ++i)
        if (!(std::abs(found[i] - expected[i]) <= tolerance * largest))
            detail::throw_file_error(file.file(), {"self-test, image ", i / classes, ", class ", i % classes},
                                     {"the logit ", shortest_number(expected[i])},
                                     {shortest_number(found[i]), reason});
}

/// Makes a model of the content of a file. `check_selftest` runs the self-test.
template <class Network>
[[nodiscard]] [[gnu::cold]] model<Network> make_model(stored_model stored) {
    model<Network> m;
    detail::set_parameters(m.network, stored.arrays);
    m.network.epsilon = stored.epsilon;
    std::copy(stored.mean.begin(), stored.mean.end(), m.normalise.mean.begin());
    m.normalise.scale = stored.scale;
    m.classes = std::move(stored.classes);
    m.temperature = stored.temperature;
    m.normalise.function = stored.function;
    m.reflections = std::move(stored.reflections);
    return m;
}

namespace detail {

/// The logits of the classes, which a file holds, without the other outputs.
/// `Pool` is a parameter so that this header compiles without thread_pool.hpp.
template <class Network, class Pool = thread_pool>
[[nodiscard]] [[gnu::cold]] std::vector<float> class_logits(const model<Network>& m,
                                                            std::span<const std::uint8_t> images) {
    // Says which header is missing before the pool does.
    static_assert(sizeof(typename Network::workspace) > 0);
    Pool alone;
    std::vector<float> logits = m.logits(images, alone);
    const std::size_t count = logits.size() / Network::outputs, classes = m.classes.size();
    for (std::size_t i = 1; i < count; ++i)
        std::copy_n(logits.begin() + static_cast<std::ptrdiff_t>(i * Network::outputs), classes,
                    logits.begin() + static_cast<std::ptrdiff_t>(i * classes));
    logits.resize(count * classes);
    return logits;
}

} // namespace detail

/// Loads a model from a file. Without metadata epsilon is 1e-5, inputs are counts minus `input_mean` where
/// there is one, and classes are named class_00, class_01, …. `epsilon` overrides the file's. Throws
/// file_error, also when a self-test in the file does not give its logits.
template <class Network>
[[nodiscard]] [[gnu::cold]] model<Network> load_model(const safetensors& file,
                                                      std::optional<double> epsilon = std::nullopt) {
    model<Network> m =
        make_model<Network>(read_model(file, Network::input_shape, stored_arrays_of<Network>(), epsilon));
    check_selftest(file, Network::input_shape, m.classes.size(),
                   [&](std::span<const std::uint8_t> images) { return detail::class_logits(m, images); });
    return m;
}
/// Reads the model from a file.
template <class Network>
[[nodiscard]] [[gnu::cold]] model<Network> load_model(const file_name& path,
                                                      std::optional<double> epsilon = std::nullopt) {
    return load_model<Network>(safetensors::read(path), epsilon);
}

}} // namespace tactnet

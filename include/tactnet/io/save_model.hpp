#pragma once

#include <tactnet/io/model_file.hpp>
#include <tactnet/io/safetensors/writer.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

// Writes trained networks to the files that model_file.hpp reads. A header of its own, so that programs that
// only read files do not compile the writer.

namespace tactnet { inline namespace TACTNET_ARCH {

/// A view of a model to be written, without the network's type.
struct model_parts {
    shape input;
    stored_arrays arrays;
    std::vector<std::span<const float>> values; ///< of each array
    double epsilon = 1e-5;
    std::span<const float> mean; ///< of the input, one per pixel
    float scale = 1;
    std::span<const std::string> classes;
    double temperature = 1; ///< of probabilities
    input_function function{};
    reflection_rule reflections = reflection_rule::all();
};

namespace detail {

/// What a file says of a temperature: nothing of 1, so that what the caller says in the metadata remains.
[[nodiscard]] inline std::optional<double> to_store(double temperature) {
    return temperature == 1 ? std::nullopt : std::optional(temperature);
}
/// Nor of counts as they are, nor where each class is its own partner in all reflections.
[[nodiscard]] inline std::optional<input_function> to_store(const input_function& function) {
    return function.identity() ? std::nullopt : std::optional(function);
}
[[nodiscard]] inline std::optional<reflection_rule> to_store(const reflection_rule& rule) {
    return rule == reflection_rule::all() ? std::nullopt : std::optional(rule);
}

[[gnu::cold]] inline std::string json_array(std::span<const std::string> texts) {
    std::string json = "[";
    for (const std::string& text : texts)
        json += joined({json.size() > 1 ? "," : "", json_string(text)});
    return json + "]";
}

/// Adds the array at `index`, whose elements are `values`; of the output layer the rows of the first classes.
[[gnu::cold]] inline void add_array(safetensors_writer& writer, const stored_arrays& arrays,
                                    std::size_t index, std::span<const float> values, std::size_t classes) {
    const named_array& a = arrays.list[index];
    std::vector<std::size_t> extents = arrays.extents(a, classes);
    const std::size_t size = values.size() / a.extents.front() * extents.front();
    writer.add(a.name, std::move(extents), values.first(size));
}

/// Adds images to a file, with their logits of `classes` each, if there are any.
[[gnu::cold]] inline void add_selftest(safetensors_writer& writer, shape input, std::size_t classes,
                                       std::span<const std::uint8_t> images, const logits_function& logits) {
    if (images.empty())
        return;
    const std::size_t count = images.size() / input.size();
    writer.add("selftest.logits", {count, classes}, std::span<const float>(logits(images)));
    writer.add("selftest.input", image_extents(input, count), images);
}

} // namespace detail

/// Adds a description to the metadata of a file, in version 1 of the format. It must state size, classes and
/// whether a mean is subtracted; the caller adds the name of the network under "network". Throws
/// std::invalid_argument for a name that could not be read again.
[[gnu::cold]] inline void add_description(file_metadata& metadata, const model_description& d) {
    if (const auto name = metadata.find("network");
        name != metadata.end() && name->second.size() > detail::longest_name)
        detail::throw_invalid_argument(
            {"network: expected ", detail::short_name, ", found ", name->second.size()});
    metadata["format"] = "tactnet";
    metadata["version"] = "1";
    metadata["rows"] = std::to_string(d.rows.value());
    metadata["columns"] = std::to_string(d.columns.value());
    if (const std::string problem = detail::problem_of_names(d.classes); !problem.empty())
        detail::throw_invalid_argument({"classes: expected ", detail::expected_names, ", found ", problem});
    metadata["classes"] = detail::json_array(d.classes);
    metadata["input"] = d.subtracts_mean.value() ? "mean" : "scale";
    if (d.epsilon)
        metadata["epsilon"] = shortest_number(*d.epsilon);
    if (d.scale)
        metadata["input_scale"] = shortest_number(*d.scale);
    if (d.bits)
        metadata["bits"] = std::to_string(*d.bits);
    if (d.temperature)
        metadata["temperature"] = shortest_number(*d.temperature);
    if (d.function) {
        metadata["input_function"] = count_rule_names[static_cast<std::size_t>(d.function->rule)];
        metadata["input_knee"] = shortest_number(d.function->knee);
    }
    if (!d.reflections)
        return;
    const auto& [rows, columns] = *d.reflections;
    metadata["reflected_axes"] = rows.reflects      ? columns.reflects ? "both" : "rows"
                                 : columns.reflects ? "columns"
                                                    : "none";
    for (const auto& [key, axis] : {std::pair("row_partners", &rows), std::pair("column_partners", &columns)})
        if (!axis->partners.empty()) {
            std::vector<std::string> names;
            for (std::size_t c = 0; c < d.classes.size(); ++c)
                names.push_back(d.classes.at(axis->partner(c)));
            metadata[key] = detail::json_array(names);
        }
}

/// Adds all arrays of a network in single precision; of its output layer the rows of the first `classes`
/// outputs. Throws std::invalid_argument unless there are 1 to Network::outputs of them.
template <class Network>
void add_parameters(safetensors_writer& writer, const Network& network,
                    std::size_t classes = Network::outputs) {
    detail::check_classes("add_parameters", classes, Network::outputs);
    const stored_arrays arrays = stored_arrays_of<Network>();
    std::size_t index = 0;
    network.for_each_parameter([&](const auto&, auto from) {
        std::vector<float> values(from.size());
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = static_cast<float>(from[i]);
        detail::add_array(writer, arrays, index++, values, classes);
    });
}

/// A view of a model, which must outlive it.
template <class Network>
[[nodiscard]] [[gnu::cold]] model_parts model_parts_of(const model<Network>& m) {
    model_parts parts{.input = Network::input_shape,
                      .arrays = stored_arrays_of<Network>(),
                      .values = {},
                      .epsilon = m.network.epsilon,
                      .mean = m.normalise.mean.view().elements(),
                      .scale = m.normalise.scale,
                      .classes = m.classes,
                      .temperature = m.temperature,
                      .function = m.normalise.function,
                      .reflections = m.reflections};
    m.network.for_each_parameter(
        [&](const auto&, std::span<const float> values) { parts.values.push_back(values); });
    return parts;
}

/// Adds a model to a file: its arrays, and its description to the metadata. `selftest` holds images to store
/// with their logits, which `logits` computes. Throws std::invalid_argument unless there are 1 to as many
/// classes as outputs, a weight that is not zero, and the temperature is one.
[[gnu::cold]] inline void add_model(safetensors_writer& writer, const model_parts& m,
                                    std::span<const std::uint8_t> selftest, const logits_function& logits) {
    const std::size_t classes = m.classes.size();
    detail::check_classes("model", classes, m.arrays.outputs);
    if (!detail::any_weight(m.arrays, m.values))
        detail::throw_invalid_argument({"model: expected a trained network, found ", detail::untrained});
    bool subtracts = false;
    for (const float mean : m.mean)
        subtracts = subtracts || mean != 0;
    detail::check_temperature("model", m.temperature);
    add_description(writer.metadata, {.network = {},
                                      .rows = m.input.rows,
                                      .columns = m.input.columns,
                                      .classes = {m.classes.begin(), m.classes.end()},
                                      .epsilon = m.epsilon,
                                      .subtracts_mean = subtracts,
                                      .scale = m.scale,
                                      .bits = {},
                                      .temperature = detail::to_store(m.temperature),
                                      .function = detail::to_store(m.function),
                                      .reflections = detail::to_store(m.reflections)});
    for (std::size_t i = 0; i < m.values.size(); ++i)
        detail::add_array(writer, m.arrays, i, m.values[i], classes);
    if (subtracts)
        writer.add("input_mean", detail::image_extents(m.input), m.mean);
    detail::add_selftest(writer, m.input, classes, selftest, logits);
}

/// Writes a model, all or nothing. `metadata` should state the "network" and may state more. Throws
/// file_error, and as `add_model`.
[[gnu::cold]] inline void save_model(const std::filesystem::path& path, const model_parts& m,
                                     file_metadata metadata, std::span<const std::uint8_t> selftest,
                                     const logits_function& logits) {
    safetensors_writer writer;
    writer.metadata = std::move(metadata);
    add_model(writer, m, selftest, logits);
    writer.write(path);
}
/// Writes the model to a file.
template <class Network>
[[gnu::cold]] void save_model(const std::filesystem::path& path, const model<Network>& m,
                              file_metadata metadata = {}, std::span<const std::uint8_t> selftest = {}) {
    save_model(path, model_parts_of(m), std::move(metadata), selftest,
               [&](std::span<const std::uint8_t> images) { return detail::class_logits(m, images); });
}

}} // namespace tactnet

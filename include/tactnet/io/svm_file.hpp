#pragma once

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/model_description.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/svm/kernel/space.hpp>
#include <tactnet/svm/kernel_machine.hpp>
#include <tactnet/svm/linear_machine.hpp>
#include <tactnet/text/message.hpp>

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Trained support vector machines as files: arrays by name, and their kind in the metadata. A saved and
// loaded machine is bit-identical. Not part of io.hpp: programs that use only networks do not include it.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

inline constexpr std::string_view one_versus_one_text = "one versus one",
                                  one_versus_rest_text = "one versus rest";

/// The value under a key of the metadata; throws file_error unless it is one of those expected.
[[gnu::cold]] inline std::string_view metadata_choice(const safetensors& file, std::string_view key,
                                                      std::initializer_list<std::string_view> choices) {
    const std::string* const found = file.find_metadata(key);
    std::string expected;
    for (const std::string_view choice : choices) {
        if (found != nullptr && *found == choice)
            return choice;
        expected += joined({expected.empty() ? "" : " or ", in_quotes(choice)});
    }
    throw_metadata_error(file, key, expected, found);
}

/// A matrix of finite numbers of these extents; throws file_error.
template <class T>
std::vector<T> svm_values(const safetensors& file, std::string_view name, std::vector<std::size_t> extents) {
    file.require_extents(name, extents);
    std::vector<T> values = file.values<T>(name);
    for (const T value : values)
        if (!std::isfinite(value))
            throw_tensor_error(file.file(), name, {"finite numbers"}, {std::to_string(value)});
    return values;
}
inline std::size_t first_extent(const safetensors& file, std::string_view name) {
    const auto& extents = file.at(name).extents;
    return extents.empty() ? 0 : extents.front();
}

inline void add_counts(safetensors_writer& writer, const std::string& name,
                       std::span<const std::size_t> counts) {
    const std::vector<std::int64_t> signed_counts(counts.begin(), counts.end());
    writer.add(name, {counts.size()}, std::span<const std::int64_t>(signed_counts));
}
inline std::vector<std::size_t> stored_counts(const safetensors& file, std::string_view name) {
    std::vector<std::size_t> counts;
    for (const std::int64_t value : file.values<std::int64_t>(name)) {
        if (value < 0)
            throw_tensor_error(file.file(), name, {"numbers of 0 or more"}, {std::to_string(value)});
        counts.push_back(static_cast<std::size_t>(value));
    }
    return counts;
}

inline void add_standardisation(safetensors_writer& writer,
                                const std::optional<standardisation>& standardise) {
    if (!standardise)
        return;
    writer.add("standardise.mean", {standardise->mean.size()}, std::span<const float>(standardise->mean));
    writer.add("standardise.deviation", {standardise->mean.size()},
               std::span<const float>(standardise->deviation));
}
inline std::optional<standardisation> stored_standardisation(const safetensors& file, std::size_t features) {
    if (!file.contains("standardise.mean"))
        return std::nullopt;
    standardisation result{svm_values<float>(file, "standardise.mean", {features}),
                           svm_values<float>(file, "standardise.deviation", {features})};
    for (const float deviation : result.deviation)
        if (!(deviation > 0))
            throw_tensor_error(file.file(), "standardise.deviation", {"positive numbers"},
                               {std::to_string(deviation)});
    return result;
}

inline void describe_machine(safetensors_writer& writer, std::string_view name) {
    writer.metadata["format"] = "tactnet";
    writer.metadata["version"] = "1";
    writer.metadata["machine"] = name;
}
inline void require_machine(const safetensors& file, std::string_view name) {
    metadata_choice(file, "format", {"tactnet"});
    metadata_choice(file, "version", {"1"});
    metadata_choice(file, "machine", {name});
}
/// Makes the machine; throws file_error where its parts throw std::invalid_argument.
template <class Machine, class Parameters>
Machine machine_of(const safetensors& file, Parameters parts, std::size_t features) {
    if (features != dynamic_features && features != parts.features)
        throw_file_error(file.file(), {}, {features, " features"}, {parts.features});
    try {
        return Machine(std::move(parts));
    } catch (const std::invalid_argument& error) {
        throw_file_error(file.file(), {}, {"parts that fit each other"}, {error.what()});
    }
}

} // namespace detail

/// Adds a machine to a file, which may hold more, such as the network that computes its features. Throws
/// std::invalid_argument when the name of one of its arrays is taken.
template <svm_kernel Kernel, std::size_t Features>
void add_machine(safetensors_writer& writer, const kernel_machine<Kernel, Features>& machine) {
    const kernel_machine_parameters<Kernel>& parts = machine.parameters();
    const std::size_t vectors = machine.support_vectors();
    detail::describe_machine(writer, "kernel");
    writer.metadata["kernel"] = Kernel::name;
    if constexpr (std::same_as<Kernel, rbf_kernel>)
        writer.add("gamma", {}, std::span<const double>(&*parts.kernel.gamma, 1));
    writer.metadata["multiclass"] = parts.scheme == multiclass::one_versus_one ? detail::one_versus_one_text
                                                                               : detail::one_versus_rest_text;
    detail::add_counts(writer, "labels", parts.labels);
    detail::add_counts(writer, "support_counts", parts.support_counts);
    writer.add("support_vectors", {vectors, parts.features}, std::span<const float>(parts.support_vectors));
    writer.add("coefficients", {vectors, parts.coefficients_each()},
               std::span<const double>(parts.coefficients));
    writer.add("offsets", {parts.offsets.size()}, std::span<const double>(parts.offsets));
    std::vector<double> sigmoids;
    for (const platt_sigmoid& s : parts.sigmoids)
        sigmoids.insert(sigmoids.end(), {s.slope, s.offset});
    if (!sigmoids.empty())
        writer.add("sigmoids", {parts.sigmoids.size(), 2}, std::span<const double>(sigmoids));
    detail::add_standardisation(writer, parts.standardise);
}
/// Adds a linear machine.
template <std::size_t Features>
void add_machine(safetensors_writer& writer, const linear_machine<Features>& machine) {
    const linear_machine_parameters& parts = machine.parameters();
    detail::describe_machine(writer, "linear");
    detail::add_counts(writer, "labels", parts.labels);
    writer.add("weights", {parts.labels.size(), parts.features}, std::span<const float>(parts.weights));
    writer.add("offsets", {parts.offsets.size()}, std::span<const double>(parts.offsets));
    detail::add_standardisation(writer, parts.standardise);
}

/// Writes a machine of either kind, all or nothing. `metadata` may state more, such as the names of the
/// classes. Throws file_error.
template <class Machine>
void save_machine(const std::filesystem::path& path, const Machine& machine, file_metadata metadata = {}) {
    safetensors_writer writer;
    writer.metadata = std::move(metadata);
    add_machine(writer, machine);
    writer.write(path);
}

/// Reads a kernel machine. Throws file_error for a file of another kernel or number of features, and for
/// parts that do not fit each other.
template <svm_kernel Kernel, std::size_t Features = dynamic_features>
[[nodiscard]] kernel_machine<Kernel, Features> load_kernel_machine(const safetensors& file) {
    detail::require_machine(file, "kernel");
    detail::metadata_choice(file, "kernel", {Kernel::name});
    kernel_machine_parameters<Kernel> parts;
    if constexpr (std::same_as<Kernel, rbf_kernel>) {
        parts.kernel.gamma = detail::svm_values<double>(file, "gamma", {}).front();
        if (*parts.kernel.gamma < 0)
            detail::throw_tensor_error(file.file(), "gamma", {"a number of 0 or more"},
                                       {std::to_string(*parts.kernel.gamma)});
    }
    parts.scheme = detail::metadata_choice(file, "multiclass",
                                           {detail::one_versus_one_text, detail::one_versus_rest_text}) ==
                           detail::one_versus_one_text
                       ? multiclass::one_versus_one
                       : multiclass::one_versus_rest;
    const auto& extents = file.at("support_vectors").extents;
    const std::size_t vectors = detail::first_extent(file, "support_vectors");
    parts.features = extents.size() == 2 ? extents[1] : 0;
    parts.support_vectors = detail::svm_values<float>(file, "support_vectors", {vectors, parts.features});
    parts.labels = detail::stored_counts(file, "labels");
    parts.support_counts = detail::stored_counts(file, "support_counts");
    if (parts.labels.size() < 2)
        detail::throw_tensor_error(file.file(), "labels", {"two classes or more"}, {parts.labels.size()});
    parts.coefficients =
        detail::svm_values<double>(file, "coefficients", {vectors, parts.coefficients_each()});
    parts.offsets = detail::svm_values<double>(file, "offsets", {detail::first_extent(file, "offsets")});
    if (file.contains("sigmoids")) {
        const std::vector<double> sigmoids =
            detail::svm_values<double>(file, "sigmoids", {detail::first_extent(file, "sigmoids"), 2});
        for (std::size_t i = 0; i < sigmoids.size(); i += 2)
            parts.sigmoids.push_back({sigmoids[i], sigmoids[i + 1]});
    }
    parts.standardise = detail::stored_standardisation(file, parts.features);
    return detail::machine_of<kernel_machine<Kernel, Features>>(file, std::move(parts), Features);
}
/// Reads a kernel machine from a file.
template <svm_kernel Kernel, std::size_t Features = dynamic_features>
[[nodiscard]] kernel_machine<Kernel, Features> load_kernel_machine(const std::filesystem::path& path) {
    return load_kernel_machine<Kernel, Features>(safetensors::read(path));
}

/// Reads a linear machine. Throws file_error, as load_kernel_machine.
template <std::size_t Features = dynamic_features>
[[nodiscard]] linear_machine<Features> load_linear_machine(const safetensors& file) {
    detail::require_machine(file, "linear");
    linear_machine_parameters parts;
    parts.labels = detail::stored_counts(file, "labels");
    const auto& extents = file.at("weights").extents;
    parts.features = extents.size() == 2 ? extents[1] : 0;
    parts.weights = detail::svm_values<float>(file, "weights", {parts.labels.size(), parts.features});
    parts.offsets = detail::svm_values<double>(file, "offsets", {parts.labels.size()});
    parts.standardise = detail::stored_standardisation(file, parts.features);
    return detail::machine_of<linear_machine<Features>>(file, std::move(parts), Features);
}
/// Reads a linear machine from a file.
template <std::size_t Features = dynamic_features>
[[nodiscard]] linear_machine<Features> load_linear_machine(const std::filesystem::path& path) {
    return load_linear_machine<Features>(safetensors::read(path));
}

}} // namespace tactnet

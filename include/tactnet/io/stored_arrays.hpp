#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors/header.hpp>
#include <tactnet/io/safetensors/index.hpp>
#include <tactnet/tensor/named_array.hpp>
#include <tactnet/text/quoting.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// What a network's arrays are called in weight files and how large they are, and whether a file has them.
// Names and extents do for that: only what reads them off a network is a template.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The arrays of a network as weight files see them, without its type.
struct stored_arrays {
    std::vector<named_array> list;
    std::size_t outputs = 0;

    /// How the arrays of the layer that gives the logits begin, since these have a row for each class: "fc."
    /// of a dense layer at the end, "classifier.1." of a convolution with a filter for each class and no more
    /// than pools behind it. Empty for a network that ends otherwise.
    [[nodiscard]] std::string output_layer() const {
        if (list.size() < 2 || list.back().extents.front() != outputs)
            return "";
        const std::string prefix = list.back().name.substr(0, list.back().name.rfind('.') + 1);
        const named_array& weights = list[list.size() - 2];
        return list.back().name == prefix + "bias" && weights.name == prefix + "weight" &&
                       weights.extents.size() > 1
                   ? prefix
                   : "";
    }
    /// The extents of an array in the file of a network of `classes` classes.
    [[nodiscard]] std::vector<std::size_t> extents(const named_array& a, std::size_t classes) const {
        std::vector<std::size_t> result = a.extents;
        if (const std::string prefix = output_layer(); !prefix.empty() && a.name.starts_with(prefix))
            result.front() = classes;
        return result;
    }
};

namespace detail {

/// What a weight file may hold beside a network's arrays.
inline bool is_companion(std::string_view name) {
    return name == "input_mean" || name.starts_with("selftest.") || name.ends_with(".num_batches_tracked");
}

/// Throws unless all values are finite, and none is negative where that makes no sense.
inline void check_values(const safetensors_index& file, const std::string& name,
                         std::span<const float> values) {
    const bool variance = name.ends_with(".running_var");
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!std::isfinite(values[i]) || (variance && values[i] < 0))
            throw file_error(file.file(), tensor_place(name) + ", element " + std::to_string(i),
                             variance ? "a variance (finite, at least 0)" : "a finite number",
                             std::to_string(values[i]));
}

inline void check_classes(const char* where, std::size_t classes, std::size_t outputs) {
    if (classes == 0 || classes > outputs)
        throw std::invalid_argument(std::string(where) + ": classes must be 1 to " + std::to_string(outputs));
}

} // namespace detail

/// The arrays that a network describes, in its order.
template <class Parameter>
[[nodiscard]] stored_arrays stored_arrays_of(const std::vector<Parameter>& parameters, std::size_t outputs) {
    return {{parameters.begin(), parameters.end()}, outputs};
}
template <class Network>
[[nodiscard]] stored_arrays stored_arrays_of() {
    return stored_arrays_of(Network::describe(), Network::outputs);
}

namespace detail {

/// The arrays of a file that are not as the network's, in sentences.
struct array_differences {
    std::vector<std::string> missing, misshapen, surplus;

    [[nodiscard]] std::size_t count() const { return missing.size() + misshapen.size() + surplus.size(); }
    /// "2 missing: 'a' of 8x1, 'b' of 8; 1 of another network: 'c'".
    [[nodiscard]] std::string text() const {
        std::string all;
        const auto add = [&](const std::vector<std::string>& list, const char* what) {
            if (list.empty())
                return;
            all += (all.empty() ? "" : "; ") + std::to_string(list.size()) + what;
            for (const std::string& one : list)
                all += (&one == list.data() ? ": " : ", ") + one;
        };
        add(missing, " missing");
        add(misshapen, " of another shape");
        add(surplus, " of another network");
        return all;
    }
};

} // namespace detail

/// Throws file_error, one that names all of them, when arrays of the network are missing in the file or of
/// other extents, or when it holds arrays of another network. Those whose names begin with one of `unread`
/// are passed over. Of the last dense layer the file must hold a row for each of `classes`.
inline void require_arrays(const safetensors_index& file, const stored_arrays& arrays, std::size_t classes,
                           std::span<const std::string> unread = {}) {
    detail::array_differences differences;
    // The only one is told where it is.
    std::optional<file_error> only;
    std::set<std::string, std::less<>> known;
    for (const auto& a : arrays.list) {
        known.insert(a.name);
        const std::vector<std::size_t> extents = arrays.extents(a, classes);
        if (!file.contains(a.name)) {
            only.emplace(file.file(), "", "a " + detail::tensor_place(a.name) + " of " + shape_text(extents),
                         "none of that name");
            differences.missing.push_back(in_quotes(a.name) + " of " + shape_text(extents));
            continue;
        }
        std::vector<std::size_t> apart = a.flattened;
        if (!apart.empty())
            apart.insert(apart.begin(), extents.front());
        const auto& found = file.at(a.name).extents;
        if (found == extents || (!apart.empty() && found == apart))
            continue;
        std::string expected = shape_text(extents);
        if (!apart.empty())
            expected += " or " + shape_text(apart);
        only.emplace(file.file(), detail::tensor_place(a.name), expected, shape_text(found));
        differences.misshapen.push_back(in_quotes(a.name) + " of " + shape_text(found) + " instead of " +
                                        expected);
    }
    const std::string all = std::to_string(known.size()) + " arrays of this network";
    for (const auto& [name, tensor] : file.tensors()) {
        const auto begins = [&name = name](const std::string& start) { return name.starts_with(start); };
        if (known.contains(name) || detail::is_companion(name) ||
            std::any_of(unread.begin(), unread.end(), begins))
            continue;
        only.emplace(file.file(), "", "only the " + all, detail::tensor_place(name) + " of another network");
        differences.surplus.push_back(in_quotes(name));
    }
    if (differences.count() > 1)
        throw file_error(file.file(), "", "the " + all, differences.text());
    if (only)
        throw *only;
}

/// How many classes the stored network tells apart: the rows of its last dense layer, from 1 to the outputs.
/// Throws file_error when that layer is missing or has more rows than the network has outputs.
[[nodiscard]] inline std::size_t stored_classes(const safetensors_index& file, const stored_arrays& arrays) {
    const std::string prefix = arrays.output_layer();
    if (prefix.empty())
        return arrays.outputs;
    const auto& extents = file.at(prefix + "bias").extents;
    if (extents.size() != 1 || extents[0] == 0 || extents[0] > arrays.outputs)
        throw file_error(file.file(), detail::tensor_place(prefix + "bias"),
                         "one number for each of 1 to " + std::to_string(arrays.outputs) + " classes",
                         shape_text(extents));
    return extents[0];
}
template <class Network>
[[nodiscard]] std::size_t stored_classes(const safetensors_index& file) {
    return stored_classes(file, stored_arrays_of<Network>());
}

} // namespace TACTNET_ARCH
} // namespace tactnet

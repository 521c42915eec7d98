#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/header.hpp>
#include <tactnet/tensor/named_array.hpp>
#include <tactnet/text/message.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

// The names and extents of a network's arrays in weight files, and whether a file has these arrays. Only
// `stored_arrays_of` is a template on the network; all else compiles once per unit.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The arrays of a network in weight files, without its type.
struct stored_arrays {
    std::vector<named_array> list;
    std::size_t outputs = 0;

    /// The beginning of the names of the output layer's arrays, which have a row per class: "fc." for a dense
    /// layer at the end, "classifier.1." for a convolution with a filter per class that only pools follow.
    /// Empty for a network that ends otherwise.
    [[nodiscard]] [[gnu::cold, gnu::noinline]] std::string_view output_layer() const {
        if (list.size() < 2 || list.back().extents.front() != outputs)
            return {};
        const named_array& weights = list[list.size() - 2];
        const std::string_view bias = list.back().name, weight = weights.name;
        const std::string_view prefix = bias.substr(0, bias.rfind('.') + 1);
        return bias.substr(prefix.size()) == "bias" && weight.starts_with(prefix) &&
                       weight.substr(prefix.size()) == "weight" && weights.extents.size() > 1 &&
                       weights.extents.front() == outputs
                   ? prefix
                   : std::string_view();
    }
    /// The extents of an array in the file of a network of `classes` classes.
    [[nodiscard]] [[gnu::cold]] std::vector<std::size_t> extents(const named_array& a,
                                                                 std::size_t classes) const {
        std::vector<std::size_t> result = a.extents;
        if (const std::string_view prefix = output_layer();
            !prefix.empty() && std::string_view(a.name).starts_with(prefix))
            result.front() = classes;
        return result;
    }
};

/// The arrays that a network describes, in its order.
template <class Parameter>
[[nodiscard]] stored_arrays stored_arrays_of(const std::vector<Parameter>& parameters, std::size_t outputs) {
    return {{parameters.begin(), parameters.end()}, outputs};
}
/// The arrays of a type of network.
template <class Network>
[[nodiscard]] stored_arrays stored_arrays_of() {
    return stored_arrays_of(Network::describe(), Network::outputs);
}

namespace detail {

/// Whether a tensor is none of a network's arrays, but may be stored with them.
inline bool is_companion(std::string_view name) {
    return name == "input_mean" || name.starts_with("selftest.") || name.ends_with(".num_batches_tracked");
}

inline constexpr const char* untrained = "one whose weights are all zero, as before training: its outputs "
                                         "would be the same for every frame";

/// Whether a weight, an element of an array of more than one extent, is not zero; `values` has those of each
/// array. True without such arrays.
template <class Values>
[[nodiscard]] bool any_weight(const stored_arrays& arrays, const std::vector<Values>& values) {
    bool any = false, found = false;
    for (std::size_t i = 0; i < values.size() && !found; ++i)
        if (arrays.list[i].extents.size() > 1) {
            any = true;
            for (const float value : values[i])
                found = found || value != 0;
        }
    return found || !any;
}

/// Throws file_error for floats whose bytes lie in the other order: reversed nearly all are as large as
/// weights are, but not as they stand.
[[gnu::cold, gnu::noinline]] inline void
check_byte_order(const safetensors_index& file, std::string_view name, std::span<const float> values) {
    std::size_t nonzero = 0, huge = 0, usual = 0;
    for (const float value : values) {
        const float reversed = std::abs(bits_as<float>(byte_swapped(bits_as<std::uint32_t>(value))));
        nonzero += value != 0;
        huge += !(std::abs(value) < 1e9f);
        usual += reversed > 1e-9f && reversed < 1e9f;
    }
    if (huge > 4 && 8 * huge > nonzero && 10 * usual >= 9 * nonzero)
        throw_tensor_error(file.file(), name, {"little-endian numbers, as safetensors stores them"},
                           {"numbers whose bytes lie in the other order"});
}

/// Throws file_error unless all values are finite, and a variance is not negative.
template <class T>
void check_values(const safetensors_index& file, std::string_view name, std::span<const T> values,
                  bool variance) {
    const auto good = [&](T value) { return std::isfinite(value) && !(variance && value < 0); };
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!good(values[i]))
            throw_element_error(file.file(), name, i,
                                variance ? "a variance (finite, at least 0)" : "a finite number",
                                std::to_string(static_cast<double>(values[i])));
}
inline void check_values(const safetensors_index& file, std::string_view name,
                         std::span<const float> values) {
    check_byte_order(file, name, values);
    check_values(file, name, values, name.ends_with(".running_var"));
}

[[gnu::cold]] inline void check_classes(const char* where, std::size_t classes, std::size_t outputs) {
    if (classes == 0 || classes > outputs)
        throw std::invalid_argument(
            joined({where, ": expected the names of 1 to ", outputs, " classes, found ", classes}));
}

/// Collects the arrays of a file that differ from the network's, and throws one error for all. It lists the
/// first ones of each kind and counts the others: a file can hold any number.
class array_differences {
public:
    enum kind { missing, misshapen, surplus };

    /// `listed` describes the array among several; the other texts are the error if it is the only one.
    [[gnu::cold, gnu::noinline]] void add(kind what, text_parts listed, text_parts place, text_parts expected,
                                          text_parts found) {
        constexpr std::size_t most = 240; // bytes of a list
        std::string& list = lists_[what];
        if (++counts_[what] == 1) {
            list = joined({": ", joined(listed)});
            place_ = joined(place);
            expected_ = joined(expected);
            found_ = joined(found);
        } else if (!list.ends_with("…")) {
            const std::string next = joined(listed);
            list += list.size() + next.size() <= most ? joined({", ", next}) : ", …";
        }
    }
    [[gnu::cold, gnu::noinline]] void throw_if_any(const safetensors_index& file,
                                                   std::string_view all) const {
        const std::size_t count = counts_[missing] + counts_[misshapen] + counts_[surplus];
        if (count == 1)
            throw_file_error(file.file(), {place_}, {expected_}, {found_});
        constexpr const char* titles[] = {" missing", " of another shape", " of another network"};
        std::string text;
        for (const kind k : {missing, misshapen, surplus})
            if (counts_[k] > 0)
                text = joined({text, text.empty() ? "" : "; ", counts_[k], titles[k], lists_[k]});
        if (count > 1)
            throw_file_error(file.file(), {}, {"the ", all}, {text});
    }

private:
    std::string lists_[3], place_, expected_, found_;
    std::size_t counts_[3] = {};
};

} // namespace detail

/// Throws file_error, one that counts all of them and names the first, when arrays of the network are missing
/// in the file or have other extents, or when the file holds arrays of another network. Arrays whose names
/// begin with one of `unread` are ignored. The output layer must have a row per class.
[[gnu::cold]] inline void require_arrays(const safetensors_index& file, const stored_arrays& arrays,
                                         std::size_t classes, std::span<const std::string> unread = {}) {
    using detail::array_differences;
    array_differences differences;
    for (const named_array& a : arrays.list) {
        const std::vector<std::size_t> extents = arrays.extents(a, classes);
        const detail::quoted name{a.name};
        if (!file.contains(a.name)) {
            const std::string shape = shape_text(extents);
            differences.add(array_differences::missing, {name, " of ", shape}, {},
                            {"a tensor ", name, " of ", shape}, {"none of that name"});
            continue;
        }
        std::vector<std::size_t> apart; // empty unless there are other extents
        for (const std::size_t extent : a.flattened) {
            if (apart.empty())
                apart.push_back(extents.front());
            apart.push_back(extent);
        }
        const std::vector<std::size_t>& found = file.at(a.name).extents;
        if (found == extents || (!apart.empty() && found == apart))
            continue;
        std::string expected = shape_text(extents);
        if (!apart.empty())
            expected = detail::joined({expected, " or ", shape_text(apart)});
        const std::string other = shape_text(found);
        differences.add(array_differences::misshapen, {name, " of ", other, " instead of ", expected},
                        {"tensor ", name}, {expected}, {other});
    }
    const std::string all = detail::joined({arrays.list.size(), " arrays of this network"});
    for (const auto& [name, tensor] : file.tensors()) {
        bool known = detail::is_companion(name);
        for (const named_array& a : arrays.list)
            known = known || a.name == name;
        for (const std::string& start : unread)
            known = known || name.starts_with(start);
        if (!known)
            differences.add(array_differences::surplus, {detail::quoted{name}}, {}, {"only the ", all},
                            {"tensor ", detail::quoted{name}, " of another network"});
    }
    differences.throw_if_any(file, all);
}

/// Returns the number of classes of the stored network: the rows of its output layer, from 1 to the outputs.
/// Throws file_error when that layer is missing or has more rows than the network has outputs.
[[nodiscard]] [[gnu::cold]] inline std::size_t stored_classes(const safetensors_index& file,
                                                              const stored_arrays& arrays) {
    if (arrays.output_layer().empty())
        return arrays.outputs;
    const std::string& bias = arrays.list.back().name;
    const auto& extents = file.at(bias).extents;
    if (extents.size() != 1 || extents[0] == 0 || extents[0] > arrays.outputs)
        detail::throw_tensor_error(file.file(), bias,
                                   {"one number for each of 1 to ", arrays.outputs, " classes"},
                                   {shape_text(extents)});
    return extents[0];
}

}} // namespace tactnet

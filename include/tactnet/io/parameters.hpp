#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/io/text.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// A network's arrays in and out of weight files, under the names that PyTorch gives them. Names, extents and
// spans do for that: only what reads them off a network is a template, and anything that describes its arrays
// as tactnet::basic_network does may be one.

// A network's arrays in and out of weight files, under the names that PyTorch gives them. The network is a
// template argument: anything that describes its arrays as tactnet::basic_network does.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The arrays of a network as weight files see them, without its type.
struct stored_arrays {
    struct array {
        std::string name; ///< PyTorch's
        std::vector<std::size_t> extents;
        /// For the weights of a dense layer [channels, rows, columns] of what it sees, which a flatten joins
        /// to one extent; else empty.
        std::vector<std::size_t> flattened = {};
    };
    std::vector<array> list;
    std::size_t outputs = 0;

    /// How the arrays of the dense layer that gives the logits begin ("fc."), since these have a row for each
    /// class. Empty for a network that ends otherwise.
    [[nodiscard]] std::string output_layer() const {
        if (list.empty())
            return "";
        const std::string& last = list.back().name;
        return last.starts_with("fc") && list.back().extents.front() == outputs
                   ? last.substr(0, last.rfind('.') + 1)
                   : "";
    }
    /// The extents of an array in the file of a network of `classes` classes.
    [[nodiscard]] std::vector<std::size_t> extents(const array& a, std::size_t classes) const {
        std::vector<std::size_t> result = a.extents;
        if (const std::string prefix = output_layer(); !prefix.empty() && a.name.starts_with(prefix))
            result.front() = classes;
        return result;
    }
};

namespace detail {

/// What the dense layers of a list of layers see, in order.
template <class T, shape Input>
void append_dense_inputs(std::vector<shape>&) {}
template <class T, shape Input, class Spec, class... Rest>
void append_dense_inputs(std::vector<shape>& list) {
    if (Spec::name == "fc")
        list.push_back(Input);
    append_dense_inputs<T, Spec::template layer<T, Input>::output, Rest...>(list);
}

/// What the dense layers of a network see. Nothing for networks that are no list of layers, and for layers
/// within blocks.
template <class Network>
struct dense_inputs {
    static std::vector<shape> of() { return {}; }
};
template <template <class, shape, class...> class Network, class T, shape Input, class... Specs>
struct dense_inputs<Network<T, Input, Specs...>> {
    static std::vector<shape> of() {
        std::vector<shape> inputs;
        append_dense_inputs<T, Input, Specs...>(inputs);
        return inputs;
    }
};

/// `Parameter` is what networks describe their arrays by: one type for all of them.
template <class Parameter>
stored_arrays make_stored_arrays(const std::vector<Parameter>& parameters, std::size_t outputs,
                                 const std::vector<shape>& dense_inputs) {
    stored_arrays arrays{{}, outputs};
    for (const Parameter& p : parameters) {
        stored_arrays::array a{p.name, p.extents};
        for (std::size_t i = 0; i < dense_inputs.size(); ++i)
            if (a.name == "fc" + (dense_inputs.size() > 1 ? std::to_string(i + 1) : "") + ".weight")
                a.flattened = {dense_inputs[i].channels, dense_inputs[i].rows, dense_inputs[i].columns};
        arrays.list.push_back(std::move(a));
    }
    return arrays;
}

/// What a weight file may hold beside a network's arrays.
inline bool is_companion(std::string_view name) {
    return name == "input_mean" || name.starts_with("selftest.") || name.ends_with(".num_batches_tracked");
}

/// Throws unless all values are finite, and none is negative where that makes no sense.
inline void check_values(const safetensors& file, const std::string& name, const std::vector<float>& values) {
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

/// The arrays of a network, in its order.
template <class Network>
[[nodiscard]] stored_arrays stored_arrays_of() {
    return detail::make_stored_arrays(Network::describe(), Network::outputs,
                                      detail::dense_inputs<Network>::of());
}

/// How many classes the stored network tells apart: the rows of its last dense layer, from 1 to the outputs.
/// Throws file_error when that layer is missing or has more rows than the network has outputs.
[[nodiscard]] inline std::size_t stored_classes(const safetensors& file, const stored_arrays& arrays) {
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
[[nodiscard]] std::size_t stored_classes(const safetensors& file) {
    return stored_classes(file, stored_arrays_of<Network>());
}

/// Reads arrays from a file, in order. Of the last dense layer the file holds a row for each of `classes`,
/// and so does the result. Throws as `load_parameters`.
[[nodiscard]] inline std::vector<std::vector<float>>
read_arrays(const safetensors& file, const stored_arrays& arrays, std::size_t classes) {
    detail::check_classes("load_parameters", classes, arrays.outputs);
    std::set<std::string, std::less<>> known;
    for (const auto& a : arrays.list)
        known.insert(a.name);
    for (const auto& [name, tensor] : file.tensors())
        if (!known.contains(name) && !detail::is_companion(name))
            throw file_error(file.file(), "",
                             "only the " + std::to_string(known.size()) + " arrays of this network",
                             detail::tensor_place(name) + " of another network");

    std::vector<std::vector<float>> values;
    for (const auto& a : arrays.list) {
        const std::vector<std::size_t> extents = arrays.extents(a, classes);
        if (!file.contains(a.name))
            throw file_error(file.file(), "",
                             "a " + detail::tensor_place(a.name) + " of " + shape_text(extents),
                             "none of that name");
        std::vector<std::size_t> apart = a.flattened;
        if (!apart.empty())
            apart.insert(apart.begin(), extents.front());
        if (const auto& found = file.at(a.name).extents;
            found != extents && (apart.empty() || found != apart))
            throw file_error(file.file(), detail::tensor_place(a.name),
                             shape_text(extents) + (apart.empty() ? "" : " or " + shape_text(apart)),
                             shape_text(found));
        values.push_back(file.values<float>(a.name));
        detail::check_values(file, a.name, values.back());
    }
    return values;
}

/// Fills a network with what `read_arrays` gave: rows that were not stored become zero.
template <class Network>
void set_parameters(Network& network, const std::vector<std::vector<float>>& values) {
    std::size_t index = 0;
    network.for_each_parameter([&](const auto&, auto to) {
        const std::vector<float>& from = values.at(index++);
        using number = typename decltype(to)::value_type;
        std::fill(to.begin(), to.end(), number{});
        std::transform(from.begin(), from.end(), to.begin(), [](float v) { return static_cast<number>(v); });
    });
}

/// Fills a network from a file. With fewer `classes` than outputs the file holds only as many rows of the
/// last dense layer; the others become zero. The weights of a dense layer may be stored as [outputs, inputs]
/// or as [outputs, channels, rows, columns] of what it sees. `input_mean`, `selftest.*` and PyTorch's
/// `num_batches_tracked` are passed over. Throws file_error when an array is missing, of other extents or not
/// finite, when a variance is negative, or when there is a tensor that the network does not know; the network
/// is then as it was. Throws std::invalid_argument unless there are 1 to Network::outputs classes.
template <class Network>
void load_parameters(Network& network, const safetensors& file, std::size_t classes = Network::outputs) {
    set_parameters(network, read_arrays(file, stored_arrays_of<Network>(), classes));
}

/// Adds one of the arrays; of the last dense layer the rows of the first `classes` outputs. `values` are
/// those of the whole array.
inline void add_array(safetensors_writer& writer, const stored_arrays& arrays, std::size_t index,
                      std::span<const float> values, std::size_t classes) {
    const stored_arrays::array& a = arrays.list[index];
    std::vector<std::size_t> extents = arrays.extents(a, classes);
    const std::size_t size = values.size() / a.extents.front() * extents.front();
    writer.add(a.name, std::move(extents), values.first(size));
}

/// Adds all arrays of a network in single precision; of its last dense layer the rows of the first `classes`
/// outputs. Throws std::invalid_argument unless there are 1 to Network::outputs of them.
template <class Network>
void add_parameters(safetensors_writer& writer, const Network& network,
                    std::size_t classes = Network::outputs) {
    detail::check_classes("add_parameters", classes, Network::outputs);
    const stored_arrays arrays = stored_arrays_of<Network>();
    std::size_t index = 0;
    network.for_each_parameter([&](const auto&, auto from) {
        std::vector<float> values(from.size());
        std::transform(from.begin(), from.end(), values.begin(),
                       [](auto v) { return static_cast<float>(v); });
        add_array(writer, arrays, index++, values, classes);
    });
}

} // namespace TACTNET_ARCH
} // namespace tactnet

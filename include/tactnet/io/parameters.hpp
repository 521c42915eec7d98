#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors_writer.hpp>
#include <tactnet/io/text.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// A network's arrays in and out of weight files, under the names that PyTorch gives them. The network is a
// template argument: anything that describes its arrays as tactnet::basic_network does.

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

/// How the arrays of the dense layer that gives the logits begin ("fc."), since these have a row for each
/// class. Empty for a network that ends otherwise.
template <class Network>
std::string output_layer_prefix() {
    const auto list = Network::describe();
    if (list.empty())
        return "";
    const std::string& last = list.back().name;
    return last.starts_with("fc") && list.back().extents.front() == Network::outputs
               ? last.substr(0, last.rfind('.') + 1)
               : "";
}

/// The extents of an array in the file of a network of `classes` classes.
template <class Parameter>
std::vector<std::size_t> stored_extents(const Parameter& p, const std::string& output_layer,
                                        std::size_t classes) {
    std::vector<std::size_t> extents = p.extents;
    if (!output_layer.empty() && p.name.starts_with(output_layer))
        extents.front() = classes;
    return extents;
}

/// What the dense layers of a list of layers see, in order.
template <class T, shape Input>
void append_dense_inputs(std::vector<shape>&) {}
template <class T, shape Input, class Spec, class... Rest>
void append_dense_inputs(std::vector<shape>& list) {
    if (Spec::name == "fc")
        list.push_back(Input);
    append_dense_inputs<T, Spec::template layer<T, Input>::output, Rest...>(list);
}

/// For the weights of dense layers, by name: [channels, rows, columns] of what they see, which a flatten
/// joins to one extent. Nothing for networks that are no list of layers, and for layers within blocks.
template <class Network>
struct flattened_extents {
    static std::map<std::string, std::vector<std::size_t>, std::less<>> of() { return {}; }
};
template <template <class, shape, class...> class Network, class T, shape Input, class... Specs>
struct flattened_extents<Network<T, Input, Specs...>> {
    static std::map<std::string, std::vector<std::size_t>, std::less<>> of() {
        std::vector<shape> inputs;
        append_dense_inputs<T, Input, Specs...>(inputs);
        std::map<std::string, std::vector<std::size_t>, std::less<>> result;
        for (std::size_t i = 0; i < inputs.size(); ++i)
            result["fc" + (inputs.size() > 1 ? std::to_string(i + 1) : "") + ".weight"] = {
                inputs[i].channels, inputs[i].rows, inputs[i].columns};
        return result;
    }
};

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

} // namespace detail

/// How many classes the stored network tells apart: the rows of its last dense layer, from 1 to
/// Network::outputs. Throws file_error when that layer is missing or has more rows than the network has
/// outputs.
template <class Network>
[[nodiscard]] std::size_t stored_classes(const safetensors& file) {
    const std::string prefix = detail::output_layer_prefix<Network>();
    if (prefix.empty())
        return Network::outputs;
    const auto& extents = file.at(prefix + "bias").extents;
    if (extents.size() != 1 || extents[0] == 0 || extents[0] > Network::outputs)
        throw file_error(file.file(), detail::tensor_place(prefix + "bias"),
                         "one number for each of 1 to " + std::to_string(Network::outputs) + " classes",
                         shape_text(extents));
    return extents[0];
}

/// Fills a network from a file. With fewer `classes` than outputs the file holds only as many rows of the
/// last dense layer; the others become zero. The weights of a dense layer may be stored as [outputs, inputs]
/// or as [outputs, channels, rows, columns] of what it sees. `input_mean`, `selftest.*` and PyTorch's
/// `num_batches_tracked` are passed over. Throws file_error when an array is missing, of other extents or not
/// finite, when a variance is negative, or when there is a tensor that the network does not know; the network
/// is then as it was.
template <class Network>
void load_parameters(Network& network, const safetensors& file, std::size_t classes = Network::outputs) {
    const std::string output_layer = detail::output_layer_prefix<Network>();
    if (classes == 0 || classes > Network::outputs)
        throw std::invalid_argument("load_parameters: classes must be 1 to " +
                                    std::to_string(Network::outputs));

    const auto arrays = Network::describe();
    std::set<std::string, std::less<>> known;
    for (const auto& p : arrays)
        known.insert(p.name);
    for (const auto& [name, tensor] : file.tensors())
        if (!known.contains(name) && !detail::is_companion(name))
            throw file_error(file.file(), "",
                             "only the " + std::to_string(known.size()) + " arrays of this network",
                             detail::tensor_place(name) + " of another network");

    const auto flattened = detail::flattened_extents<Network>::of();
    std::vector<std::vector<float>> values;
    for (const auto& p : arrays) {
        const std::vector<std::size_t> extents = detail::stored_extents(p, output_layer, classes);
        if (!file.contains(p.name))
            throw file_error(file.file(), "",
                             "a " + detail::tensor_place(p.name) + " of " + shape_text(extents),
                             "none of that name");
        std::vector<std::size_t> apart;
        if (const auto inputs = flattened.find(p.name); inputs != flattened.end()) {
            apart = inputs->second;
            apart.insert(apart.begin(), extents.front());
        }
        if (const auto& found = file.at(p.name).extents;
            found != extents && (apart.empty() || found != apart))
            throw file_error(file.file(), detail::tensor_place(p.name),
                             shape_text(extents) + (apart.empty() ? "" : " or " + shape_text(apart)),
                             shape_text(found));
        values.push_back(file.template values<float>(p.name));
        detail::check_values(file, p.name, values.back());
    }

    std::size_t index = 0;
    network.for_each_parameter([&](const auto&, auto to) {
        const std::vector<float>& from = values[index++];
        using number = typename decltype(to)::value_type;
        std::fill(to.begin(), to.end(), number{});
        std::transform(from.begin(), from.end(), to.begin(), [](float v) { return static_cast<number>(v); });
    });
}

/// Adds all arrays of a network in single precision; of its last dense layer the rows of the first `classes`
/// outputs.
template <class Network>
void add_parameters(safetensors_writer& writer, const Network& network,
                    std::size_t classes = Network::outputs) {
    const std::string output_layer = detail::output_layer_prefix<Network>();
    if (classes == 0 || classes > Network::outputs)
        throw std::invalid_argument("add_parameters: classes must be 1 to " +
                                    std::to_string(Network::outputs));
    network.for_each_parameter([&](const auto& p, auto from) {
        std::vector<std::size_t> extents = detail::stored_extents(p, output_layer, classes);
        const std::size_t size = from.size() / p.extents.front() * extents.front();
        std::vector<float> values(size);
        std::transform(from.begin(), from.begin() + static_cast<std::ptrdiff_t>(size), values.begin(),
                       [](auto v) { return static_cast<float>(v); });
        writer.add(p.name, std::move(extents), std::span<const float>(values));
    });
}

} // namespace TACTNET_ARCH
} // namespace tactnet

#pragma once

#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/stored_arrays.hpp>

#include <algorithm>
#include <cstddef>
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

}} // namespace tactnet

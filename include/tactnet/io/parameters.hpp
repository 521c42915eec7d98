#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/io/stored_arrays.hpp>

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

// A network's arrays in and out of weight files, under the names that PyTorch gives them. Names, extents and
// spans do for that: only what reads them off a network is a template, and anything that describes its arrays
// as tactnet::basic_network does may be one.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Reads arrays from a file, in order. Of the last dense layer the file holds a row for each of `classes`,
/// and so does the result. Throws as `load_parameters`.
[[nodiscard]] inline std::vector<std::vector<float>>
read_arrays(const safetensors& file, const stored_arrays& arrays, std::size_t classes) {
    detail::check_classes("load_parameters", classes, arrays.outputs);
    require_arrays(file, arrays, classes);
    std::vector<std::vector<float>> values;
    for (const auto& a : arrays.list) {
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
    const named_array& a = arrays.list[index];
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

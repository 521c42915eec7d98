#pragma once

#include <tactnet/io/safetensors/source.hpp>
#include <tactnet/io/stored_arrays.hpp>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

// Pretrained weights, for networks of up to hundreds of megabytes.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The arrays by their names in a file that puts a prefix before them.
[[nodiscard]] [[gnu::cold]] inline stored_arrays with_prefix(stored_arrays arrays, std::string_view prefix) {
    for (named_array& a : arrays.list)
        a.name.insert(0, prefix);
    return arrays;
}

/// Throws as load_pretrained for arrays that are missing, surplus or of other extents, without reading any.
/// `arrays` have the names of the file.
[[gnu::cold]] inline void require_pretrained(const safetensors_index& file, const stored_arrays& arrays,
                                             std::span<const std::string> unread = {},
                                             std::string_view prefix = "") {
    std::vector<std::string> others(unread.begin(), unread.end());
    for (std::string& begin : others)
        begin.insert(0, prefix);
    for (const auto& [name, tensor] : file.tensors())
        if (!name.starts_with(prefix) || detail::is_companion(std::string_view(name).substr(prefix.size())))
            others.push_back(name);
    require_arrays(file, arrays, arrays.outputs, others);
}

/// Fills a network with the arrays of a file, under torchvision's names, in float32, float16, bfloat16 or any
/// other type that converts to float. Arrays are read one by one into the network, which needs one megabyte
/// in addition to the network. Arrays whose names begin with one of `unread` (such as "classifier.") are
/// ignored, for a trunk that is read from the file of a whole network.
///
/// If the file holds the network among other things, `prefix` stands before its names there; all names
/// without the prefix are ignored.
///
/// Throws file_error, one that counts all of them and names the first, when arrays are missing, surplus or of
/// other extents; the network is then unchanged. Throws file_error for values that are not finite and for
/// negative variances; the network then holds some of the arrays.
template <class Network>
void load_pretrained(Network& network, safetensors_source& file, std::span<const std::string> unread = {},
                     std::string_view prefix = "") {
    const stored_arrays arrays = with_prefix(stored_arrays_of<Network>(), prefix);
    require_pretrained(file, arrays, unread, prefix);
    std::size_t index = 0;
    network.for_each_parameter([&](const auto&, auto to) {
        using number = typename decltype(to)::value_type;
        const std::string& name = arrays.list[index++].name;
        if constexpr (std::is_same_v<number, float>) {
            file.read<float>(name, to);
            detail::check_values(file, name, to);
        } else {
            const std::vector<float> values = file.values<float>(name);
            detail::check_values(file, name, values);
            std::copy(values.begin(), values.end(), to.begin());
        }
    });
}
/// Reads the weights from a file.
template <class Network>
void load_pretrained(Network& network, const std::filesystem::path& path,
                     std::span<const std::string> unread = {}) {
    safetensors_source file = safetensors_source::open(path);
    load_pretrained(network, file, unread);
}

}} // namespace tactnet

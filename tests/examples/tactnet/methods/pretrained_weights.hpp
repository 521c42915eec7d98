#pragma once

// Files of weights as torchvision would give them, of numbers by chance.

#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/runtime/random.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace support {

/// The 16-bit number in front of one that is none of the smallest.
inline std::uint16_t as_float16(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    if (std::abs(value) < 0x1p-14F)
        return 0;
    return static_cast<std::uint16_t>((bits >> 16U & 0x8000U) | (((bits >> 23U & 0xFFU) - 112U) << 10U) |
                                      (bits >> 13U & 0x3FFU));
}

/// All arrays of a network, weights of the usual size; in float16 on demand. `change`(name, extents) may
/// change what an array is called or how large it is; an empty name leaves it out.
template <class Network, class Change>
void write_pretrained(const std::filesystem::path& file, tactnet::element_type type, const Change& change) {
    tactnet::safetensors_writer writer;
    writer.metadata["format"] = "pt";
    tactnet::random_stream random(6, tactnet::random_purposes::order);
    for (const tactnet::parameter& p : Network::describe()) {
        std::string name = p.name;
        std::vector<std::size_t> extents = p.extents;
        change(name, extents);
        if (name.empty())
            continue;
        // Few numbers again and again: hundreds of megabytes of them would take seconds.
        std::vector<float> some(4099);
        const bool one =
            p.role == tactnet::parameter_role::scale || p.role == tactnet::parameter_role::running_variance;
        const double most =
            p.role == tactnet::parameter_role::weight ? std::sqrt(6.0 / static_cast<double>(p.fan_in)) : 0;
        for (float& value : some)
            value = static_cast<float>(random.uniform(-most, most) + (one ? 1 : 0));
        std::vector<std::uint16_t> halves(some.size());
        std::transform(some.begin(), some.end(), halves.begin(), as_float16);
        const auto stored = type == tactnet::element_type::float16 ? std::as_bytes(std::span(halves))
                                                                   : std::as_bytes(std::span(some));
        std::size_t size = stored.size() / some.size();
        for (const std::size_t extent : extents)
            size *= extent;
        writer.add(name, type, extents,
                   [size, bytes = std::vector<std::byte>(stored.begin(), stored.end())](const auto& take) {
                       for (std::size_t given = 0; given < size; given += bytes.size())
                           take(std::span(bytes).first(std::min(bytes.size(), size - given)));
                   });
    }
    // What stands behind a part of a network; behind whole ones there is nothing.
    const std::string last = Network::describe().back().name;
    const std::vector<float> one{1};
    if (last != "fc.bias" && last != "classifier.1.bias")
        writer.add("classifier.6.bias", {1}, std::span<const float>(one));
    writer.write(file);
}
template <class Network>
void write_pretrained(const std::filesystem::path& file,
                      tactnet::element_type type = tactnet::element_type::float32) {
    write_pretrained<Network>(file, type, [](std::string&, std::vector<std::size_t>&) {});
}

} // namespace support

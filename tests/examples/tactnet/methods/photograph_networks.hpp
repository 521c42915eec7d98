#pragma once

// Methods that begin with a network trained on photographs, and files of random weights as torchvision would
// give them.

#include "../workshop.hpp"

#include <tactnet/io/safetensors/source.hpp>
#include <tactnet/networks/network.hpp>

#include <bit>
#include <cmath>

namespace support {

/// A number of normal size, rounded towards zero to 16 bits.
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
    // What follows a part of a network; nothing follows a whole one.
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

inline std::vector<std::string> training(const workshop& shop, const std::string& method,
                                         const std::string& output, words more = {}) {
    more.insert(more.begin(), {"--method", method, "--output", output, "--pretrained", "pretrained"});
    return shop.train_arguments(more);
}
inline bool knows(const workshop& shop, const std::string& method) {
    const bool found = shop.run("list").out.find(method + " ") != std::string::npos;
    if (!found)
        MESSAGE("skipped: the program was built without " << method);
    return found;
}

} // namespace support

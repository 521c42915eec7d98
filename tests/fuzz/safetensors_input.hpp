#pragma once

// Safetensors files as inputs of fuzz targets, in two forms: as they are, and without the length of the
// header in front, which few mutations get right. In the second form the header ends at the first byte 0xFF,
// which is never part of text.

#include "fuzz_target.hpp"

#include <tactnet/io/safetensors/writer.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

/// check(bytes) with the input in these forms.
template <class Check>
void check_both_forms(const std::uint8_t* data, std::size_t size, const Check& check) {
    const auto input = std::as_bytes(std::span(data, size));
    fuzz_forms(size, 2, [&](std::size_t form) {
        if (form == 0)
            return check(std::vector<std::byte>(input.begin(), input.end()));
        const std::size_t header =
            static_cast<std::size_t>(std::find(data, data + size, std::uint8_t{0xFF}) - data);
        const std::uint64_t length = header;
        std::vector<std::byte> framed(sizeof(length));
        std::memcpy(framed.data(), &length, sizeof(length));
        framed.insert(framed.end(), input.begin(), input.begin() + static_cast<std::ptrdiff_t>(header));
        if (header < size)
            framed.insert(framed.end(), input.begin() + static_cast<std::ptrdiff_t>(header) + 1, input.end());
        check(std::move(framed));
    });
}

/// A file in both forms, to the seeds.
inline void add_seeds(std::vector<std::vector<std::uint8_t>>& seeds,
                      const tactnet::safetensors_writer& writer) {
    const std::vector<std::byte> bytes = writer.to_bytes();
    std::vector<std::uint8_t> whole(bytes.size());
    std::memcpy(whole.data(), bytes.data(), bytes.size());
    std::uint64_t length = 0;
    std::memcpy(&length, bytes.data(), sizeof(length));
    std::vector<std::uint8_t> framed(whole.begin() + sizeof(length), whole.end());
    framed.insert(framed.begin() + static_cast<std::ptrdiff_t>(length), 0xFF);
    seeds.push_back(std::move(whole));
    seeds.push_back(std::move(framed));
}

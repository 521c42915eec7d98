#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors/checksum.hpp>
#include <tactnet/io/safetensors/element_type.hpp>
#include <tactnet/io/safetensors/json_scanner.hpp>
#include <tactnet/text/quoting.hpp>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// The header of a safetensors file: eight bytes with its length (little endian), then JSON that maps each
// tensor's name to element type, extents and place. The file may come from anywhere, so everything that the
// header claims is checked against everything else before a byte of data is touched. Source: the format
// description at https://github.com/huggingface/safetensors.

namespace tactnet {
inline namespace TACTNET_ARCH {

static_assert(
    std::endian::native == std::endian::little,
    "safetensors stores little-endian numbers; reading them on a big-endian machine is not provided for");

/// One tensor of a file. `begin` and `end` count bytes from the start of the data, behind the header.
struct safetensors_entry {
    element_type type{};
    std::vector<std::size_t> extents;
    std::size_t begin = 0;
    std::size_t end = 0;
};

/// Text that goes with the tensors of a file, by key.
using file_metadata = std::map<std::string, std::string, std::less<>>;

/// The key of the metadata that a checksum of the whole file stands under.
inline constexpr std::string_view safetensors_checksum_key = "tactnet.checksum";

struct safetensors_header {
    /// Without the checksum, which says nothing of the content.
    file_metadata metadata;
    std::map<std::string, safetensors_entry, std::less<>> tensors;
    /// Where the data begins in the file.
    std::size_t data_begin = 0;
    std::optional<std::uint64_t> checksum;
    /// Where its digits begin in the file, if there is one.
    std::size_t checksum_place = 0;
};

/// The longest header that the format allows, in bytes.
inline constexpr std::size_t safetensors_header_limit = 100'000'000;

/// Extents for a message: "8x1x5x5", or "a single number" for none.
inline std::string shape_text(std::span<const std::size_t> extents) {
    std::string text;
    for (const std::size_t extent : extents) {
        if (!text.empty())
            text += 'x';
        text += std::to_string(extent);
    }
    return text.empty() ? "a single number" : text;
}

namespace detail {

/// False when the number of bytes does not fit a std::size_t.
inline bool tensor_bytes(element_type type, std::span<const std::size_t> extents, std::size_t& bytes) {
    bytes = element_size(type);
    for (const std::size_t extent : extents) {
        if (extent != 0 && bytes > std::numeric_limits<std::size_t>::max() / extent)
            return false;
        bytes *= extent;
    }
    return true;
}

inline std::string tensor_place(std::string_view name) {
    return "tensor " + in_quotes(name);
}

/// Reads the object behind one tensor's name. Members that the format does not know are passed over.
inline safetensors_entry scan_entry(json_scanner& scanner, const std::string& file, const std::string& name) {
    safetensors_entry entry;
    bool has_type = false, has_extents = false, has_place = false;
    std::vector<std::size_t> place;
    const auto numbers = [&](std::vector<std::size_t>& list) {
        scanner.array([&] {
            const std::uint64_t number = scanner.unsigned_integer();
            if (number > std::numeric_limits<std::size_t>::max())
                throw file_error(file, tensor_place(name), "sizes within the address space",
                                 std::to_string(number));
            list.push_back(static_cast<std::size_t>(number));
        });
    };
    scanner.object([&](const std::string& key) {
        if (key == "dtype") {
            const std::string type = scanner.string();
            const auto known = find_element_type(type);
            if (!known)
                throw file_error(file, tensor_place(name), "a known element type (F32, U8, …)",
                                 in_quotes(type));
            entry.type = *known;
            has_type = true;
        } else if (key == "shape") {
            numbers(entry.extents);
            has_extents = true;
        } else if (key == "data_offsets") {
            numbers(place);
            has_place = true;
        } else {
            scanner.skip_value();
        }
    });
    const auto require = [&](bool has, const char* key) {
        if (!has)
            throw file_error(file, tensor_place(name), std::string("the member '") + key + "'", "none");
    };
    require(has_type, "dtype");
    require(has_extents, "shape");
    require(has_place, "data_offsets");
    if (place.size() != 2 || place[0] > place[1])
        throw file_error(file, tensor_place(name), "data_offsets [begin, end] with begin at most end",
                         place.size() == 2
                             ? "[" + std::to_string(place[0]) + ", " + std::to_string(place[1]) + "]"
                             : std::to_string(place.size()) + " numbers");
    entry.begin = place[0];
    entry.end = place[1];

    std::size_t bytes = 0;
    const std::string kind = std::string(element_type_name(entry.type)) + " " + shape_text(entry.extents);
    if (!tensor_bytes(entry.type, entry.extents, bytes))
        throw file_error(file, tensor_place(name), "a size within the address space", kind);
    if (bytes != entry.end - entry.begin)
        throw file_error(file, tensor_place(name), std::to_string(bytes) + " bytes for " + kind,
                         std::to_string(entry.end - entry.begin) + " in data_offsets");
    return entry;
}

/// Reads a value of the metadata: to keep, or as the checksum. What looks like one under another key is one
/// whose key is damaged; taken as none it would hide just that.
inline void scan_metadata(json_scanner& scanner, std::string_view text, std::size_t origin,
                          const std::string& file, const std::string& key, safetensors_header& header) {
    std::string value = scanner.string();
    const std::string place = "metadata " + in_quotes(key);
    if (key != safetensors_checksum_key) {
        if (value.starts_with(checksum_mark))
            throw file_error(file, place, "checksums under " + in_quotes(safetensors_checksum_key) + " alone",
                             in_quotes(value) + ": the file is damaged");
        header.metadata.emplace(key, std::move(value));
        return;
    }
    header.checksum = parse_checksum(value);
    header.checksum_place = scanner.position() - 1 - checksum_digits;
    // Its digits have a place only if it is spelt without escapes.
    const std::string spelt = '"' + value + '"';
    if (!header.checksum || !text.substr(0, scanner.position() - origin).ends_with(spelt))
        throw file_error(file, place,
                         in_quotes(checksum_mark) + " and " + std::to_string(checksum_digits) +
                             " hexadecimal digits",
                         in_quotes(value) + ": the file is damaged");
}

/// The tensors must tile the data: one that overlaps another, or bytes that belong to none, could hide
/// something. Returns the number of bytes that they cover.
inline std::size_t check_tiling(const safetensors_header& header, const std::string& file) {
    using item = std::pair<const std::string, safetensors_entry>;
    std::vector<const item*> order;
    order.reserve(header.tensors.size());
    for (const item& tensor : header.tensors)
        order.push_back(&tensor);
    std::sort(order.begin(), order.end(), [](const item* a, const item* b) {
        return std::pair(a->second.begin, a->second.end) < std::pair(b->second.begin, b->second.end);
    });
    std::size_t covered = 0;
    for (const item* tensor : order) {
        if (tensor->second.begin != covered)
            throw file_error(file, tensor_place(tensor->first),
                             "data that begin where the tensor before ends, at " + std::to_string(covered),
                             std::to_string(tensor->second.begin) +
                                 (tensor->second.begin < covered ? " (an overlap)" : " (a gap)"));
        covered = tensor->second.end;
    }
    return covered;
}

} // namespace detail

/// How many bytes a file begins with that hold its header's length.
inline constexpr std::size_t safetensors_prefix = sizeof(std::uint64_t);

/// Where the data of a file begins, from its first bytes (all, or safetensors_prefix of them at least) and
/// its size. Throws file_error when the header would be longer than the format allows, or than the file.
inline std::size_t safetensors_data_begin(std::span<const std::byte> beginning, std::uintmax_t size,
                                          const std::string& file) {
    if (beginning.size() < safetensors_prefix)
        throw file_error(file, "",
                         "a safetensors file of at least " + std::to_string(safetensors_prefix) + " bytes",
                         std::to_string(beginning.size()));
    std::uint64_t length = 0;
    std::memcpy(&length, beginning.data(), safetensors_prefix);
    if (length > safetensors_header_limit)
        throw file_error(file, "header length",
                         "at most " + std::to_string(safetensors_header_limit) +
                             " bytes in a safetensors file",
                         std::to_string(length));
    if (length > size - safetensors_prefix)
        throw file_error(file, "header", std::to_string(length) + " bytes",
                         std::to_string(size - safetensors_prefix) + " up to the end of the file");
    return safetensors_prefix + static_cast<std::size_t>(length);
}

/// Reads and checks the header of a file of `size` bytes. `beginning` holds all of them, or those in front of
/// the data at least; `file` names it in errors. Throws file_error for whatever does not agree with the
/// format or with itself, and for a file cut short.
inline safetensors_header parse_safetensors_header(std::span<const std::byte> beginning, std::uintmax_t size,
                                                   const std::string& file) {
    constexpr std::size_t prefix = safetensors_prefix;
    safetensors_header header;
    header.data_begin = safetensors_data_begin(beginning, size, file);
    const std::string_view text(reinterpret_cast<const char*>(beginning.data()) + prefix,
                                header.data_begin - prefix);
    if (text.substr(0, 1) != "{")
        throw file_error(file, "header, byte " + std::to_string(prefix), "'{'",
                         text.empty() ? "an empty header" : in_quotes(text.substr(0, 1)));
    json_scanner scanner(text, file, prefix);
    scanner.object([&](const std::string& name) {
        if (name == "__metadata__")
            scanner.object([&](const std::string& key) {
                detail::scan_metadata(scanner, text, prefix, file, key, header);
            });
        else
            header.tensors.emplace(name, detail::scan_entry(scanner, file, name));
    });
    scanner.end();

    const std::size_t covered = detail::check_tiling(header, file);
    const std::uintmax_t present = size - header.data_begin;
    if (covered != present)
        throw file_error(file, covered > present ? "file cut short" : "end of the file",
                         std::to_string(covered) + " bytes of data for all tensors", std::to_string(present));
    return header;
}

} // namespace TACTNET_ARCH
} // namespace tactnet

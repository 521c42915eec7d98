#pragma once

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors/format.hpp>
#include <tactnet/io/safetensors/json_scanner.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// The header of a safetensors file: eight bytes with its length (little endian), then JSON that maps the name
// of each tensor to element type, extents and place. The file is untrusted, so every statement of the header
// is checked against all others before any data is read. Source: the format description at
// https://github.com/huggingface/safetensors.

namespace tactnet { inline namespace TACTNET_ARCH {

static_assert(
    std::endian::native == std::endian::little,
    "safetensors stores little-endian numbers; reading them on a big-endian machine is not implemented");

/// One tensor of a file. `begin` and `end` count bytes from the start of the data, after the header.
struct safetensors_entry {
    element_type type{};
    std::vector<std::size_t> extents;
    std::size_t begin = 0;
    std::size_t end = 0;
};

/// Text that goes with the tensors of a file, by key.
using file_metadata = std::map<std::string, std::string, std::less<>>;

/// The key in the metadata of the checksum of the whole file.
inline constexpr std::string_view safetensors_checksum_key = "tactnet.checksum";

/// The header of a file, checked.
struct safetensors_header {
    file_metadata metadata; ///< without the checksum
    std::map<std::string, safetensors_entry, std::less<>> tensors;
    std::size_t data_begin = 0; ///< where the data begins in the file
    std::optional<std::uint64_t> checksum;
    std::size_t checksum_place = 0; ///< where the digits of the checksum begin in the file
};

/// The longest header that the format allows, in bytes.
inline constexpr std::size_t safetensors_header_limit = 100'000'000;

/// Extents for a message: "8x1x5x5", or "a single number" for none. Of many, the first and how many there
/// are.
[[gnu::cold, gnu::noinline]] inline std::string shape_text(std::span<const std::size_t> extents) {
    constexpr std::size_t most = 6; // of an untrusted file, whose list can have any length
    std::string text;
    for (const std::size_t extent : extents.first(std::min(extents.size(), most)))
        text += detail::joined({text.empty() ? "" : "x", extent});
    if (extents.size() > most)
        text += detail::joined({"x… (", extents.size(), " extents)"});
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

[[gnu::cold, gnu::noinline]] inline std::string tensor_place(std::string_view name) {
    return joined({"tensor ", quoted{name}});
}

/// Throws file_error for a tensor.
[[noreturn]] [[gnu::cold, gnu::noinline]] inline void
throw_tensor_error(std::string_view file, std::string_view tensor, text_parts expected, text_parts found) {
    throw_file_error(file, {"tensor ", quoted{tensor}}, expected, found);
}
/// Throws file_error for an element of a tensor.
[[noreturn]] [[gnu::cold, gnu::noinline]] inline void
throw_element_error(std::string_view file, std::string_view tensor, std::size_t element,
                    std::string_view expected, std::string_view found) {
    throw_file_error(file, {"tensor ", quoted{tensor}, ", element ", element}, {expected}, {found});
}

/// Reads the description of one tensor. Members that the format does not define are skipped.
[[gnu::cold]] inline safetensors_entry scan_entry(json_scanner& scanner, const std::string& file,
                                                  const std::string& name) {
    safetensors_entry entry;
    std::vector<std::size_t> place;
    const char* missing[] = {"dtype", "shape", "data_offsets"};
    scanner.object([&](const std::string& key) {
        std::vector<std::size_t>* numbers = nullptr;
        if (key == "dtype") {
            const std::string type = scanner.string();
            const auto known = find_element_type(type);
            if (!known)
                throw_tensor_error(file, name, {"a known element type (F32, U8, …)"}, {quoted{type}});
            entry.type = *known;
            missing[0] = nullptr;
        } else if (key == "shape") {
            numbers = &entry.extents;
            missing[1] = nullptr;
        } else if (key == "data_offsets") {
            numbers = &place;
            missing[2] = nullptr;
        } else {
            scanner.skip_value();
        }
        if (numbers != nullptr)
            scanner.array([&] {
                const std::uint64_t number = scanner.unsigned_integer();
                if (number > std::numeric_limits<std::size_t>::max())
                    throw_tensor_error(file, name, {"sizes within the address space"}, {number});
                numbers->push_back(static_cast<std::size_t>(number));
            });
    });
    for (const char* const key : missing)
        if (key != nullptr)
            throw_tensor_error(file, name, {"the member '", key, "'"}, {"none"});
    constexpr const char* order = "data_offsets [begin, end] with begin at most end";
    if (place.size() != 2)
        throw_tensor_error(file, name, {order}, {place.size(), " numbers"});
    entry.begin = place[0];
    entry.end = place[1];
    if (entry.begin > entry.end)
        throw_tensor_error(file, name, {order}, {"[", entry.begin, ", ", entry.end, "]"});

    std::size_t bytes = 0;
    const bool fits = tensor_bytes(entry.type, entry.extents, bytes);
    if (!fits || bytes != entry.end - entry.begin) {
        const std::string kind = joined({element_type_name(entry.type), " ", shape_text(entry.extents)});
        if (!fits)
            throw_tensor_error(file, name, {"a size within the address space"}, {kind});
        throw_tensor_error(file, name, {bytes, " bytes for ", kind},
                           {entry.end - entry.begin, " in data_offsets"});
    }
    return entry;
}

/// Reads a value of the metadata, or the checksum. A value that looks like a checksum under another key is
/// one whose key is damaged; without this error it would hide the damage.
[[gnu::cold]] inline void scan_metadata(json_scanner& scanner, std::string_view text, std::size_t origin,
                                        const std::string& file, const std::string& key,
                                        safetensors_header& header) {
    std::string value = scanner.string();
    const auto fail = [&](text_parts expected) {
        throw_file_error(file, {"metadata ", quoted{key}}, expected,
                         {quoted{value}, ": the file is damaged"});
    };
    if (key != safetensors_checksum_key) {
        if (value.starts_with(checksum_mark))
            fail({"checksums under ", quoted{safetensors_checksum_key}, " alone"});
        header.metadata.insert({key, std::move(value)});
        return;
    }
    header.checksum = parse_checksum(value);
    header.checksum_place = scanner.position() - 1 - checksum_digits;
    // Only digits that are spelt without escapes have a place.
    if (!header.checksum ||
        !text.substr(0, scanner.position() - origin).ends_with(joined({"\"", value, "\""})))
        fail({quoted{checksum_mark}, " and ", checksum_digits, " hexadecimal digits"});
}

/// Tensors by the order of their data: begin, end, and the entry's number in `tensors`. The writer sorts by
/// other keys; one type of keys is one sort to compile.
using tensor_order = std::vector<std::array<std::size_t, 3>>;
[[gnu::cold, gnu::noinline]] inline void sort_tensors(tensor_order& order) {
    using keys = tensor_order::value_type;
    if (order.empty())
        return; // qsort takes no null pointer
    // Much less to compile than std::sort.
    std::qsort(order.data(), order.size(), sizeof(keys), [](const void* a, const void* b) {
        const keys &first = *static_cast<const keys*>(a), &second = *static_cast<const keys*>(b);
        for (std::size_t i = 0; i < first.size(); ++i)
            if (first[i] != second[i])
                return first[i] < second[i] ? -1 : 1;
        return 0;
    });
}

/// Returns the number of bytes that the tensors cover. They must tile the data: a tensor that overlaps
/// another, or bytes that belong to none, could hide something.
[[gnu::cold]] inline std::size_t check_tiling(const safetensors_header& header, const std::string& file) {
    tensor_order order;
    for (const auto& [name, tensor] : header.tensors)
        order.push_back({tensor.begin, tensor.end, order.size()});
    sort_tensors(order);
    std::size_t covered = 0;
    for (const auto& [begin, end, number] : order) {
        if (begin != covered)
            throw_tensor_error(file,
                               std::next(header.tensors.begin(), static_cast<std::ptrdiff_t>(number))->first,
                               {"data that begin where the tensor before ends, at ", covered},
                               {begin, begin < covered ? " (an overlap)" : " (a gap)"});
        covered = end;
    }
    return covered;
}

/// What a file is that is not safetensors, by its first bytes; empty if they say nothing.
[[gnu::cold, gnu::noinline]] inline std::string other_file(std::string_view begin) {
    if (begin.starts_with("PK\x03\x04"))
        return "a zip archive, as torch.save writes: save it with safetensors.torch.save_file";
    if (begin.starts_with("\x80\x02") || begin.starts_with("\x80\x04"))
        return "a pickle of Python: save it with safetensors.torch.save_file";
    if (begin.starts_with("\x89HDF"))
        return "an HDF5 file";
    if (begin.starts_with("MATLAB"))
        return "a file of MATLAB: save it as safetensors";
    const bool text = std::all_of(begin.begin(), begin.end(), [](char c) {
        return (c >= ' ' && c <= '~') || c == '\t' || c == '\n' || c == '\r';
    });
    return text ? joined({"text that begins with ", quoted{begin}}) : std::string();
}

} // namespace detail

/// A file begins with that many bytes, which hold the length of its header.
inline constexpr std::size_t safetensors_prefix = sizeof(std::uint64_t);

/// Returns where the data of a file begins, from its first bytes (at least safetensors_prefix of them) and
/// its size. Throws file_error when the header would be longer than the format allows, or than the file.
[[gnu::cold]] inline std::size_t safetensors_data_begin(std::span<const std::byte> beginning,
                                                        std::uintmax_t size, const std::string& file) {
    if (beginning.size() < safetensors_prefix)
        detail::throw_file_error(file, {}, {"a safetensors file of at least ", safetensors_prefix, " bytes"},
                                 {beginning.size()});
    std::uint64_t length = 0;
    std::memcpy(&length, beginning.data(), safetensors_prefix);
    if (length > safetensors_header_limit) {
        const std::string other =
            detail::other_file({reinterpret_cast<const char*>(beginning.data()), safetensors_prefix});
        if (!other.empty())
            detail::throw_file_error(file, {}, {"a safetensors file"}, {other});
        detail::throw_file_error(file, {"header length"},
                                 {"at most ", safetensors_header_limit, " bytes in a safetensors file"},
                                 {length});
    }
    if (length > size - safetensors_prefix)
        detail::throw_file_error(file, {"header"}, {length, " bytes"},
                                 {size - safetensors_prefix, " up to the end of the file"});
    return safetensors_prefix + static_cast<std::size_t>(length);
}

/// Reads and checks the header of a file of `size` bytes. `beginning` holds at least the bytes before the
/// data; `file` names the file in errors. Throws file_error for a header that contradicts the format or
/// itself, and for a file cut short.
[[gnu::cold]] inline safetensors_header
parse_safetensors_header(std::span<const std::byte> beginning, std::uintmax_t size, const std::string& file) {
    constexpr std::size_t prefix = safetensors_prefix;
    safetensors_header header;
    header.data_begin = safetensors_data_begin(beginning, size, file);
    const std::string_view text(reinterpret_cast<const char*>(beginning.data()) + prefix,
                                header.data_begin - prefix);
    if (!text.starts_with('{'))
        detail::throw_file_error(
            file, {"header, byte ", prefix}, {"'{'"},
            {text.empty() ? detail::text_part("an empty header") : detail::quoted{text.substr(0, 1)}});
    json_scanner scanner(text, file, prefix);
    scanner.object([&](const std::string& name) {
        if (name == "__metadata__")
            scanner.object([&](const std::string& key) {
                detail::scan_metadata(scanner, text, prefix, file, key, header);
            });
        else
            header.tensors.insert({name, detail::scan_entry(scanner, file, name)});
    });
    scanner.end();

    const std::size_t covered = detail::check_tiling(header, file);
    const std::uintmax_t present = size - header.data_begin;
    if (covered != present)
        detail::throw_file_error(file, {covered > present ? "file cut short" : "end of the file"},
                                 {covered, " bytes of data for all tensors"}, {present});
    return header;
}

}} // namespace tactnet

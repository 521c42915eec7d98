#pragma once

#include <tactnet/io/safetensors/format.hpp>
#include <tactnet/io/safetensors/header.hpp>
#include <tactnet/io/write_file.hpp>
#include <tactnet/text/message.hpp>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

// Writes safetensors files. The same content gives the same bytes, in whatever order it was added: tensors
// are sorted by falling element size and then by name, so that each is aligned to its elements. Every file
// carries a checksum over all of it in its metadata, where other programs ignore it.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Collects tensors and text, then writes them as one file, all or nothing.
class safetensors_writer {
public:
    /// Text that goes with the tensors. Keys and values must be UTF-8. An entry under the key of the checksum
    /// is ignored.
    file_metadata metadata;

    /// Adds a copy of `values`, row-major. Throws std::invalid_argument when the name is taken, reserved
    /// (`__metadata__`) or not UTF-8, or when the number of values is not the product of the extents.
    void add(std::string name, std::vector<std::size_t> extents, std::span<const float> values) {
        add(std::move(name), element_type::float32, std::move(extents), std::as_bytes(values));
    }
    void add(std::string name, std::vector<std::size_t> extents, std::span<const double> values) {
        add(std::move(name), element_type::float64, std::move(extents), std::as_bytes(values));
    }
    void add(std::string name, std::vector<std::size_t> extents, std::span<const std::uint8_t> values) {
        add(std::move(name), element_type::uint8, std::move(extents), std::as_bytes(values));
    }
    void add(std::string name, std::vector<std::size_t> extents, std::span<const std::int64_t> values) {
        add(std::move(name), element_type::int64, std::move(extents), std::as_bytes(values));
    }

    /// Adds a tensor of any element type, as little-endian bytes.
    [[gnu::cold]] void add(std::string name, element_type type, std::vector<std::size_t> extents,
                           std::span<const std::byte> bytes) {
        std::size_t needed = 0;
        if (!detail::tensor_bytes(type, extents, needed) || needed != bytes.size())
            throw std::invalid_argument(
                detail::joined({"tactnet: ", detail::tensor_place(name), " of ", element_type_name(type), " ",
                                shape_text(extents), " cannot hold ", bytes.size(), " bytes"}));
        insert(std::move(name), {type, std::move(extents), 0, needed}, {{bytes.begin(), bytes.end()}, {}});
    }

    /// Adds a tensor that stays where it is until it is written. `read` is called twice then, once for the
    /// checksum, and must give the same bytes. What it throws reaches the caller of `write`, and nothing is
    /// written.
    [[gnu::cold]] void add(std::string name, element_type type, std::vector<std::size_t> extents,
                           chunk_source read) {
        std::size_t needed = 0;
        if (!detail::tensor_bytes(type, extents, needed))
            throw std::invalid_argument(
                detail::joined({"tactnet: ", detail::tensor_place(name), " of ", element_type_name(type), " ",
                                shape_text(extents), " is larger than any memory"}));
        insert(std::move(name), {type, std::move(extents), 0, needed}, {{}, std::move(read)});
    }

    /// Writes the file; the old file stays until the new one is complete.
    /// Throws file_error, also when a tensor gives other bytes in its second reading than in its first; and
    /// std::invalid_argument for metadata that are not UTF-8 or look like a checksum.
    [[gnu::cold]] void write(const std::filesystem::path& path) const {
        const head begin = make_head();
        detail::write_pieces(path, [&](chunk_sink take) { give(begin, path.string(), take); });
    }

    /// The content of the file that `write` makes. Throws as `write`.
    [[gnu::cold]] std::vector<std::byte> to_bytes() const {
        std::vector<std::byte> bytes;
        give(make_head(), "a file", [&](std::span<const std::byte> piece) {
            bytes.insert(bytes.end(), piece.begin(), piece.end());
        });
        return bytes;
    }

private:
    /// The elements of a tensor.
    struct content {
        std::vector<std::byte> bytes;
        chunk_source read; ///< or empty, if the bytes are here
    };
    using item = std::pair<const std::string, safetensors_entry>;

    /// Until the file is written, `entry.begin` is the place in `contents_`, and `entry.end` the size in
    /// bytes.
    [[gnu::cold]] void insert(std::string name, safetensors_entry entry, content of) {
        if (name == "__metadata__" || !is_utf8(name))
            throw std::invalid_argument("tactnet: a tensor cannot be named " + in_quotes(name));
        entry.begin = contents_.size();
        const auto [place, is_new] = tensors_.emplace(std::move(name), std::move(entry));
        if (!is_new)
            throw std::invalid_argument("tactnet: there are two tensors named " + in_quotes(place->first));
        contents_.push_back(std::move(of));
    }

    /// The tensors in the order of the file.
    [[gnu::cold]] std::vector<const item*> ordered() const {
        std::vector<const item*> by_name;
        detail::tensor_order order;
        for (const item& tensor : tensors_) {
            order.push_back({std::size_t{8} - element_size(tensor.second.type), by_name.size(), 0});
            by_name.push_back(&tensor);
        }
        detail::sort_tensors(order);
        std::vector<const item*> result;
        for (const auto& each : order)
            result.push_back(by_name[each[1]]);
        return result;
    }

    /// Passes the bytes of a tensor to `take`.
    [[gnu::cold]] void each_piece(const item& tensor, chunk_sink take) const {
        const auto& [name, entry] = tensor;
        const content& from = contents_[entry.begin];
        if (!from.read)
            return take(from.bytes);
        const std::size_t size = entry.end;
        std::size_t given = 0;
        from.read([&](std::span<const std::byte> piece) {
            given += piece.size();
            if (given <= size)
                take(piece);
        });
        if (given != size)
            throw std::logic_error(detail::joined(
                {"tactnet: ", detail::tensor_place(name), " gave ", given, " of ", size, " bytes"}));
    }

    /// The bytes before those of the tensors.
    struct head {
        std::vector<std::byte> bytes; ///< with zeros for the digits of the checksum
        std::size_t digits;           ///< their place
    };

    [[gnu::cold]] std::uint64_t sum_of(const head& begin, chunk_sink take) const {
        xxh64 sum;
        sum.update(begin.bytes);
        for (const item* tensor : ordered())
            each_piece(*tensor, [&](std::span<const std::byte> piece) {
                sum.update(piece);
                take(piece);
            });
        return sum.digest();
    }
    [[gnu::cold]] void give(const head& begin, const std::string& file, chunk_sink take) const {
        const std::uint64_t sum = sum_of(begin, [](std::span<const std::byte>) {});
        const std::string text = checksum_text(sum);
        std::vector<std::byte> bytes = begin.bytes;
        std::memcpy(bytes.data() + begin.digits, text.data() + checksum_mark.size(), checksum_digits);
        take(bytes);
        if (sum_of(begin, take) != sum)
            detail::throw_file_error(file, {},
                                     {"the same bytes in both readings of a tensor that stays elsewhere"},
                                     {"others in the second"});
    }

    [[gnu::cold]] head make_head() const {
        std::string json = detail::joined({"{\"__metadata__\":{", json_string(safetensors_checksum_key), ":",
                                           json_string(checksum_text(0))});
        const std::size_t digits = sizeof(std::uint64_t) + json.size() - 1 - checksum_digits;
        for (const auto& [key, value] : metadata) {
            if (key == safetensors_checksum_key)
                continue;
            if (value.starts_with(checksum_mark))
                throw std::invalid_argument(
                    detail::joined({"tactnet: the metadata ", in_quotes(key),
                                    " cannot begin as a checksum does, ", in_quotes(value)}));
            json += detail::joined({",", json_string(key), ":", json_string(value)});
        }
        json += '}';
        std::size_t begin = 0;
        for (const item* tensor : ordered()) {
            const auto& [name, entry] = *tensor;
            json += detail::joined(
                {",", json_string(name), ":{\"dtype\":\"", element_type_name(entry.type), "\",\"shape\":["});
            for (std::size_t i = 0; i < entry.extents.size(); ++i)
                json += detail::joined({i == 0 ? "" : ",", entry.extents[i]});
            const std::size_t end = begin + entry.end;
            json += detail::joined({"],\"data_offsets\":[", begin, ",", end, "]}"});
            begin = end;
        }
        json += '}';
        // Spaces up to a multiple of eight align the data for programs that map the file into memory.
        json.resize((json.size() + 7) / 8 * 8, ' ');
        if (json.size() > safetensors_header_limit)
            throw std::invalid_argument("tactnet: the header would be longer than the format allows");

        const auto length = static_cast<std::uint64_t>(json.size());
        std::vector<std::byte> bytes(sizeof(length) + json.size());
        std::memcpy(bytes.data(), &length, sizeof(length));
        std::memcpy(bytes.data() + sizeof(length), json.data(), json.size());
        return {std::move(bytes), digits};
    }

    std::map<std::string, safetensors_entry, std::less<>> tensors_;
    std::vector<content> contents_;
};

}} // namespace tactnet

#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/io/file.hpp>
#include <tactnet/io/safetensors/checksum.hpp>
#include <tactnet/io/safetensors/element_type.hpp>
#include <tactnet/io/safetensors/header.hpp>
#include <tactnet/text/quoting.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Writes safetensors files. The same content gives the same bytes, whatever the order it was added in:
// tensors stand by falling element size and then by name, so that each is aligned to its elements. Every file
// carries a checksum over all of it in its metadata, where other programs pass over it.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Collects tensors and text, then writes them as one file, all or nothing.
class safetensors_writer {
public:
    /// Text that goes with the tensors. Keys and values must be UTF-8. The checksum is not for the caller to
    /// give: what stands under its key is passed over.
    file_metadata metadata;

    /// Adds a copy of `values`, row-major. Throws std::invalid_argument when the name is taken, reserved
    /// (`__metadata__`) or not UTF-8, or when the number of values is not the product of the extents.
    void add(std::string name, std::vector<std::size_t> extents, std::span<const float> values) {
        add_values(std::move(name), std::move(extents), values);
    }
    void add(std::string name, std::vector<std::size_t> extents, std::span<const double> values) {
        add_values(std::move(name), std::move(extents), values);
    }
    void add(std::string name, std::vector<std::size_t> extents, std::span<const std::uint8_t> values) {
        add_values(std::move(name), std::move(extents), values);
    }
    void add(std::string name, std::vector<std::size_t> extents, std::span<const std::int64_t> values) {
        add_values(std::move(name), std::move(extents), values);
    }

    /// The same for any element type, as little-endian bytes.
    void add(std::string name, element_type type, std::vector<std::size_t> extents,
             std::span<const std::byte> bytes) {
        std::size_t needed = 0;
        if (!detail::tensor_bytes(type, extents, needed) || needed != bytes.size())
            throw std::invalid_argument("tactnet: " + detail::tensor_place(name) + " of " +
                                        std::string(element_type_name(type)) + " " + shape_text(extents) +
                                        " cannot hold " + std::to_string(bytes.size()) + " bytes");
        add_stored(
            std::move(name),
            {type, std::move(extents), needed, std::vector<std::byte>(bytes.begin(), bytes.end()), {}});
    }

    /// The same for a tensor that stays where it is until it is written: `read` is called twice then, once
    /// for the checksum, and must give the same bytes. What it throws reaches the caller of `write`, and
    /// nothing is written.
    void add(std::string name, element_type type, std::vector<std::size_t> extents, piece_giver read) {
        std::size_t needed = 0;
        if (!detail::tensor_bytes(type, extents, needed))
            throw std::invalid_argument("tactnet: " + detail::tensor_place(name) + " of " +
                                        std::string(element_type_name(type)) + " " + shape_text(extents) +
                                        " is larger than any memory");
        add_stored(std::move(name), {type, std::move(extents), needed, {}, std::move(read)});
    }

    /// Writes the file; what was there before stays until the new one is complete.
    /// Throws file_error, also when a tensor gives other bytes in its second reading than in its first; and
    /// std::invalid_argument for metadata that are not UTF-8 or look like a checksum.
    void write(const std::filesystem::path& path) const {
        const head begin = make_head();
        write_file(path, [&](const std::function<void(std::span<const std::byte>)>& take) {
            give(begin, path.string(), take);
        });
    }

    /// The content of the file that `write` makes. Throws as `write`.
    std::vector<std::byte> to_bytes() const {
        std::vector<std::byte> bytes;
        give(make_head(), "a file", [&](std::span<const std::byte> piece) {
            bytes.insert(bytes.end(), piece.begin(), piece.end());
        });
        return bytes;
    }

private:
    struct stored {
        element_type type;
        std::vector<std::size_t> extents;
        std::size_t size; ///< in bytes
        std::vector<std::byte> bytes;
        piece_giver read; ///< or nothing, if the bytes are here

        template <class Take>
        void each_piece(const std::string& name, const Take& take) const {
            if (!read)
                return take(std::span<const std::byte>(bytes));
            std::size_t given = 0;
            read([&](std::span<const std::byte> piece) {
                given += piece.size();
                if (given <= size)
                    take(piece);
            });
            if (given != size)
                throw std::logic_error("tactnet: " + detail::tensor_place(name) + " gave " +
                                       std::to_string(given) + " of " + std::to_string(size) + " bytes");
        }
    };
    using item = std::pair<const std::string, stored>;

    void add_stored(std::string name, stored tensor) {
        if (name == "__metadata__" || !is_utf8(name))
            throw std::invalid_argument("tactnet: a tensor cannot be named " + in_quotes(name));
        const auto [place, is_new] = tensors_.emplace(std::move(name), std::move(tensor));
        if (!is_new)
            throw std::invalid_argument("tactnet: there are two tensors named " + in_quotes(place->first));
    }
    template <storable T>
    void add_values(std::string name, std::vector<std::size_t> extents, std::span<const T> values) {
        add(std::move(name), element_type_of<T>(), std::move(extents), std::as_bytes(values));
    }

    std::vector<const item*> ordered() const {
        std::vector<const item*> order;
        order.reserve(tensors_.size());
        for (const item& tensor : tensors_)
            order.push_back(&tensor);
        std::stable_sort(order.begin(), order.end(), [](const item* a, const item* b) {
            return element_size(a->second.type) > element_size(b->second.type);
        });
        return order;
    }

    /// What stands in front of the tensors.
    struct head {
        std::vector<std::byte> bytes; ///< with zeros for the checksum, as it is summed
        std::size_t digits;           ///< where those stand
    };

    template <class Take>
    std::uint64_t sum_of(const head& begin, const Take& take) const {
        xxh64 sum;
        sum.update(begin.bytes);
        for (const item* tensor : ordered())
            tensor->second.each_piece(tensor->first, [&](std::span<const std::byte> piece) {
                sum.update(piece);
                take(piece);
            });
        return sum.digest();
    }
    template <class Take>
    void give(const head& begin, const std::string& file, const Take& take) const {
        const std::uint64_t sum = sum_of(begin, [](std::span<const std::byte>) {});
        const std::string text = checksum_text(sum);
        std::vector<std::byte> bytes = begin.bytes;
        std::memcpy(bytes.data() + begin.digits, text.data() + checksum_mark.size(), checksum_digits);
        take(std::span<const std::byte>(bytes));
        if (sum_of(begin, take) != sum)
            throw file_error(file, "", "the same bytes in both readings of a tensor that stays elsewhere",
                             "others in the second");
    }

    head make_head() const {
        std::string json = "{";
        const auto separate = [&] { json += json.back() == '{' ? "" : ","; };
        json += "\"__metadata__\":{" + json_string(safetensors_checksum_key) + ":" +
                json_string(checksum_text(0));
        const std::size_t digits = sizeof(std::uint64_t) + json.size() - 1 - checksum_digits;
        for (const auto& [key, value] : metadata) {
            if (key == safetensors_checksum_key)
                continue;
            if (value.starts_with(checksum_mark))
                throw std::invalid_argument("tactnet: the metadata " + in_quotes(key) +
                                            " cannot begin as a checksum does, " + in_quotes(value));
            separate();
            json += json_string(key) + ":" + json_string(value);
        }
        json += '}';
        std::size_t begin = 0;
        for (const item* tensor : ordered()) {
            const auto& [name, value] = *tensor;
            separate();
            json += json_string(name) + ":{\"dtype\":\"" + std::string(element_type_name(value.type)) +
                    "\",\"shape\":[";
            for (std::size_t i = 0; i < value.extents.size(); ++i) {
                json += i == 0 ? "" : ","; // by itself: of `"," + string` GCC 12 warns (its bug 105329)
                json += std::to_string(value.extents[i]);
            }
            const std::size_t end = begin + value.size;
            json += "],\"data_offsets\":[" + std::to_string(begin) + "," + std::to_string(end) + "]}";
            begin = end;
        }
        json += '}';
        // Spaces up to a multiple of eight align the data for those who map the file into memory.
        json.resize((json.size() + 7) / 8 * 8, ' ');
        if (json.size() > safetensors_header_limit)
            throw std::invalid_argument("tactnet: the header would be longer than the format allows");

        const auto length = static_cast<std::uint64_t>(json.size());
        std::vector<std::byte> bytes(sizeof(length) + json.size());
        std::memcpy(bytes.data(), &length, sizeof(length));
        std::memcpy(bytes.data() + sizeof(length), json.data(), json.size());
        return {std::move(bytes), digits};
    }

    std::map<std::string, stored, std::less<>> tensors_;
};

} // namespace TACTNET_ARCH
} // namespace tactnet

#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors/checksum.hpp>
#include <tactnet/io/safetensors/element_type.hpp>
#include <tactnet/io/safetensors/elements.hpp>
#include <tactnet/io/safetensors/header.hpp>
#include <tactnet/io/safetensors/index.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <ios>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

// A safetensors file that stays on the disk. Networks of hundreds of megabytes are read from it array by
// array, so that no more memory is taken than they need themselves.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Reads tensors of a file one at a time. Only the header is kept. One thread at a time may read.
class safetensors_source : public safetensors_index {
public:
    /// Opens the file at `path`, checks its header, and verifies its checksum if it has one, for which all of
    /// it is read once. Throws file_error, also for what is no regular file, since its parts are read in any
    /// order.
    static safetensors_source open(const std::filesystem::path& path,
                                   checksum_rule rule = checksum_rule::verify) {
        const std::string name = path.string();
        std::error_code code;
        const auto status = std::filesystem::status(path, code);
        if (status.type() == std::filesystem::file_type::none)
            throw file_error(name, "", "a readable file", "'" + code.message() + "'");
        if (status.type() != std::filesystem::file_type::regular)
            throw file_error(name, "", "a file",
                             status.type() == std::filesystem::file_type::not_found   ? "nothing of that name"
                             : status.type() == std::filesystem::file_type::directory ? "a folder"
                                                                                      : "a pipe or a device");
        const std::uintmax_t size = std::filesystem::file_size(path, code);
        std::ifstream stream(path, std::ios::binary);
        if (code || !stream)
            throw file_error(name, "", "a readable file", "none");

        const auto first = static_cast<std::size_t>(std::min<std::uintmax_t>(size, safetensors_prefix));
        std::vector<std::byte> beginning(first);
        read_at(stream, 0, beginning, name);
        beginning.resize(safetensors_data_begin(beginning, size, name));
        read_at(stream, first, std::span(beginning).subspan(first), name);
        safetensors_header header = parse_safetensors_header(beginning, size, name);
        if (header.checksum && rule == checksum_rule::verify) {
            const std::size_t digits = header.checksum_place;
            xxh64 sum;
            sum.update(std::span(beginning).first(digits)).update(std::string(checksum_digits, '0'));
            sum.update(std::span(beginning).subspan(digits + checksum_digits));
            each_piece(stream, beginning.size(), size - beginning.size(), name,
                       [&](std::span<const std::byte> piece, std::uintmax_t) { sum.update(piece); });
            require_checksum(header, sum.digest(), name);
        }
        return safetensors_source(std::move(header), name, rule, std::move(stream));
    }

    /// The elements of a tensor in row-major order; see convert_elements for what becomes of other types.
    /// Throws file_error, also when the file has become shorter since it was opened, and
    /// std::invalid_argument unless there is just as much room.
    template <storable T>
    void read(std::string_view name, std::span<T> to) {
        const entry& tensor = at(name);
        const std::size_t element = element_size(tensor.type);
        if (to.size() != (tensor.end - tensor.begin) / element)
            throw std::invalid_argument("safetensors_source::read: expected room for " +
                                        std::to_string((tensor.end - tensor.begin) / element) +
                                        " elements, found " + std::to_string(to.size()));
        each_piece(stream_, header().data_begin + tensor.begin, tensor.end - tensor.begin, file(),
                   [&](std::span<const std::byte> piece, std::uintmax_t offset) {
                       const auto begin = static_cast<std::size_t>(offset) / element;
                       convert_elements<T>(tensor.type, piece, to.subspan(begin, piece.size() / element),
                                           file(), name);
                   });
    }
    /// The stored bytes of a tensor, whatever its type, in pieces of at most a megabyte: use(piece) for one
    /// after the other. Throws file_error.
    template <class Use>
    void read_bytes(std::string_view name, Use use) {
        const entry& tensor = at(name);
        each_piece(stream_, header().data_begin + tensor.begin, tensor.end - tensor.begin, file(),
                   [&](std::span<const std::byte> piece, std::uintmax_t) { use(piece); });
    }
    template <storable T>
    [[nodiscard]] std::vector<T> values(std::string_view name) {
        const entry& tensor = at(name);
        std::vector<T> result((tensor.end - tensor.begin) / element_size(tensor.type));
        read<T>(name, result);
        return result;
    }

private:
    safetensors_source(safetensors_header header, std::string file, checksum_rule rule, std::ifstream stream)
        : safetensors_index(std::move(header), std::move(file), rule), stream_(std::move(stream)) {}

    static void read_at(std::ifstream& stream, std::uintmax_t place, std::span<std::byte> to,
                        const std::string& file) {
        stream.clear();
        stream.seekg(static_cast<std::streamoff>(place));
        stream.read(reinterpret_cast<char*>(to.data()), static_cast<std::streamsize>(to.size()));
        if (!stream)
            throw file_error(file, "byte " + std::to_string(place),
                             std::to_string(to.size()) + " bytes to read on",
                             std::to_string(stream.gcount()));
    }
    /// Calls use(piece, offset) for pieces of a part of the file, which hold whole elements of any type.
    template <class Use>
    static void each_piece(std::ifstream& stream, std::uintmax_t place, std::uintmax_t size,
                           const std::string& file, Use use) {
        std::vector<std::byte> piece(
            static_cast<std::size_t>(std::min<std::uintmax_t>(size, std::uintmax_t{1} << 20)));
        for (std::uintmax_t done = 0; done < size;) {
            const auto part = std::span(piece).first(
                static_cast<std::size_t>(std::min<std::uintmax_t>(piece.size(), size - done)));
            read_at(stream, place + done, part, file);
            use(std::span<const std::byte>(part), done);
            done += part.size();
        }
    }

    std::ifstream stream_;
};

} // namespace TACTNET_ARCH
} // namespace tactnet

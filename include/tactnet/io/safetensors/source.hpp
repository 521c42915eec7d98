#pragma once

#include <tactnet/detail/function_ref.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/format.hpp>
#include <tactnet/io/safetensors/header.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

// A safetensors file that stays on the disk. Networks of hundreds of megabytes are read array by array, and
// need no memory besides their own.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Reads tensors of a file one at a time. Only the header is kept. One thread at a time may read.
class safetensors_source : public safetensors_index {
public:
    /// Opens the file at `path`, checks its header, and verifies its checksum if it has one, which reads all
    /// of the file once. Throws file_error, also unless it is a regular file, since its parts are read in any
    /// order.
    [[gnu::cold]] static safetensors_source open(const std::filesystem::path& path,
                                                 checksum_rule rule = checksum_rule::verify) {
        const std::string name = path.string();
        std::error_code code;
        const auto status = std::filesystem::status(path, code);
        if (status.type() == std::filesystem::file_type::none)
            detail::throw_file_error(name, {}, {"a readable file"}, {"'", code.message(), "'"});
        if (status.type() != std::filesystem::file_type::regular)
            detail::throw_file_error(
                name, {}, {"a file"},
                {status.type() == std::filesystem::file_type::not_found   ? "nothing of that name"
                 : status.type() == std::filesystem::file_type::directory ? "a folder"
                                                                          : "a pipe or a device"});
        const std::uintmax_t size = std::filesystem::file_size(path, code);
        detail::file_handle stream = detail::open_file(path, "rb");
        if (code || !stream)
            detail::throw_file_error(name, {}, {"a readable file"}, {"none"});

        const auto first = static_cast<std::size_t>(std::min<std::uintmax_t>(size, safetensors_prefix));
        std::vector<std::byte> beginning(first);
        read_at(stream.get(), 0, beginning, name);
        beginning.resize(safetensors_data_begin(beginning, size, name));
        read_at(stream.get(), first, std::span(beginning).subspan(first), name);
        safetensors_header header = parse_safetensors_header(beginning, size, name);
        if (header.checksum && rule == checksum_rule::verify) {
            const std::size_t digits = header.checksum_place;
            xxh64 sum;
            sum.update(std::span(beginning).first(digits)).update(std::string(checksum_digits, '0'));
            sum.update(std::span(beginning).subspan(digits + checksum_digits));
            each_piece(stream.get(), beginning.size(), size - beginning.size(), name,
                       [&](std::span<const std::byte> piece, std::uintmax_t) { sum.update(piece); });
            require_checksum(header, sum.digest(), name);
        }
        return safetensors_source(std::move(header), name, rule, std::move(stream));
    }

    /// Reads the elements of a tensor in row-major order; convert_elements describes conversions. Throws
    /// file_error, also when the file has become shorter since it was opened, and std::invalid_argument
    /// unless `to` has the size of the tensor.
    template <storable T>
    void read(std::string_view name, std::span<T> to) {
        const entry& tensor = at(name);
        const std::size_t element = element_size(tensor.type);
        require_room(tensor, to.size());
        each_piece(stream_.get(), header().data_begin + tensor.begin, tensor.end - tensor.begin, file(),
                   [&](std::span<const std::byte> piece, std::uintmax_t offset) {
                       const auto begin = static_cast<std::size_t>(offset) / element;
                       convert_elements<T>(tensor.type, piece, to.subspan(begin, piece.size() / element),
                                           file(), name);
                   });
    }
    /// Passes the stored bytes of a tensor of any type to `use(piece)`, in pieces of at most a megabyte.
    /// Throws file_error.
    void read_bytes(std::string_view name, detail::function_ref<void(std::span<const std::byte>)> use) {
        const entry& tensor = at(name);
        each_piece(stream_.get(), header().data_begin + tensor.begin, tensor.end - tensor.begin, file(),
                   [&](std::span<const std::byte> piece, std::uintmax_t) { use(piece); });
    }
    /// Returns the elements that `read` reads.
    template <storable T>
    [[nodiscard]] std::vector<T> values(std::string_view name) {
        const entry& tensor = at(name);
        std::vector<T> result((tensor.end - tensor.begin) / element_size(tensor.type));
        read<T>(name, result);
        return result;
    }

private:
    safetensors_source(safetensors_header header, std::string file, checksum_rule rule,
                       detail::file_handle stream)
        : safetensors_index(std::move(header), std::move(file), rule), stream_(std::move(stream)) {}

    [[gnu::cold]] static void require_room(const entry& tensor, std::size_t found) {
        const std::size_t elements = (tensor.end - tensor.begin) / element_size(tensor.type);
        if (found != elements)
            throw std::invalid_argument(detail::joined(
                {"safetensors_source::read: expected room for ", elements, " elements, found ", found}));
    }
    static bool seek(std::FILE* stream, std::uintmax_t place) {
#if defined(_WIN32)
        return ::_fseeki64(stream, static_cast<long long>(place), SEEK_SET) == 0;
#elif defined(__unix__) || defined(__APPLE__)
        return ::fseeko(stream, static_cast<off_t>(place), SEEK_SET) == 0;
#else
        return std::fseek(stream, static_cast<long>(place), SEEK_SET) == 0;
#endif
    }
    [[gnu::cold]] static void read_at(std::FILE* stream, std::uintmax_t place, std::span<std::byte> to,
                                      const std::string& file) {
        const std::size_t got = seek(stream, place) ? std::fread(to.data(), 1, to.size(), stream) : 0;
        if (got != to.size())
            detail::throw_file_error(file, {"byte ", place}, {to.size(), " bytes to read on"}, {got});
    }
    /// Calls use(piece, offset) for pieces of a part of the file, which hold whole elements of any type.
    [[gnu::cold]] static void
    each_piece(std::FILE* stream, std::uintmax_t place, std::uintmax_t size, const std::string& file,
               detail::function_ref<void(std::span<const std::byte>, std::uintmax_t)> use) {
        std::vector<std::byte> piece(
            static_cast<std::size_t>(std::min<std::uintmax_t>(size, std::uintmax_t{1} << 20)));
        for (std::uintmax_t done = 0; done < size;) {
            const auto part = std::span(piece).first(
                static_cast<std::size_t>(std::min<std::uintmax_t>(piece.size(), size - done)));
            read_at(stream, place + done, part, file);
            use(part, done);
            done += part.size();
        }
    }

    detail::file_handle stream_;
};

}} // namespace tactnet

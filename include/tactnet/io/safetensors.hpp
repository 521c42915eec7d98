#pragma once

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/file_name.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/io/safetensors/checksum.hpp>
#include <tactnet/io/safetensors/element_type.hpp>
#include <tactnet/io/safetensors/elements.hpp>
#include <tactnet/io/safetensors/header.hpp>
#include <tactnet/io/safetensors/index.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Tensors by name, in the file format in which machine-learning programs exchange weights. This header reads
// whole files; safetensors/writer.hpp writes them, and safetensors/source.hpp reads large ones in parts.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The content of a safetensors file, checked as a whole when it is made. Owns the bytes.
class safetensors : public safetensors_index {
public:
    /// Reads the file at `path`, of at most `limit` bytes, and verifies its checksum if it has one. Throws
    /// file_error.
    [[gnu::cold]] static safetensors read(const file_name& path, std::size_t limit = default_file_limit) {
        return parse(read_file(path, limit), path.string());
    }

    /// Takes the content of a file; `name` names it in errors. Throws file_error.
    [[gnu::cold]] static safetensors parse(std::vector<std::byte> bytes, std::string name,
                                           checksum_rule rule = checksum_rule::verify) {
        safetensors_header header = parse_safetensors_header(bytes, bytes.size(), name);
        if (header.checksum && rule == checksum_rule::verify)
            require_checksum(header, checksum_around(bytes, header.checksum_place), name);
        return safetensors(std::move(header), std::move(bytes), std::move(name), rule);
    }

    /// The stored bytes of a tensor, of any alignment. Valid for the lifetime of this object.
    [[gnu::cold]] std::span<const std::byte> bytes(std::string_view name) const {
        const entry& tensor = at(name);
        return std::span<const std::byte>(bytes_).subspan(header().data_begin + tensor.begin,
                                                          tensor.end - tensor.begin);
    }

    /// The elements in row-major order; convert_elements describes conversions. Throws file_error.
    template <storable T>
    [[gnu::noinline]] std::vector<T> values(std::string_view name) const {
        const std::span<const std::byte> stored = bytes(name);
        std::vector<T> result(stored.size() / element_size(at(name).type));
        convert_elements<T>(at(name).type, stored, result, file(), name);
        return result;
    }

private:
    safetensors(safetensors_header header, std::vector<std::byte> bytes, std::string file, checksum_rule rule)
        : safetensors_index(std::move(header), std::move(file), rule), bytes_(std::move(bytes)) {}

    std::vector<std::byte> bytes_;
};

}} // namespace tactnet

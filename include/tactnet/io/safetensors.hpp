#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/io/file.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors/checksum.hpp>
#include <tactnet/io/safetensors/element_type.hpp>
#include <tactnet/io/safetensors/header.hpp>
#include <tactnet/io/safetensors/writer.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Tensors by name, in the file format that the machine-learning world exchanges weights in. This is the
// reader; the writer comes with it.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Whether a checksum that does not fit is an error.
enum class checksum_rule {
    verify,
    ignore ///< for tests that damage files, to reach what stands behind the checksum
};

/// The content of a safetensors file, checked as a whole when it is made. Owns the bytes.
class safetensors {
public:
    using entry = safetensors_entry;

    /// Reads the file at `path`, of at most `limit` bytes, and verifies its checksum if it has one. Throws
    /// file_error.
    static safetensors read(const std::filesystem::path& path, std::size_t limit = default_file_limit) {
        return parse(read_file(path, limit), path.string());
    }

    /// Takes the content of a file; `name` stands for it in errors. Throws file_error.
    static safetensors parse(std::vector<std::byte> bytes, std::string name,
                             checksum_rule rule = checksum_rule::verify) {
        safetensors_header header = parse_safetensors_header(bytes, name);
        if (header.checksum && rule == checksum_rule::verify) {
            const std::uint64_t found = checksum_around(bytes, header.checksum_place);
            if (found != *header.checksum)
                throw file_error(name, "checksum of the whole file",
                                 checksum_text(*header.checksum) + ", as when it was written",
                                 checksum_text(found) +
                                     ": it is damaged, or was changed by a program that kept the metadata " +
                                     in_quotes(safetensors_checksum_key));
        }
        return safetensors(std::move(header), std::move(bytes), std::move(name), rule);
    }

    /// The name that errors use: the path it was read from.
    const std::string& file() const noexcept { return file_; }
    /// Without the checksum.
    const file_metadata& metadata() const noexcept { return header_.metadata; }
    /// Files made elsewhere, or before there were checksums, have none.
    checksum_state checksum() const noexcept { return checksum_; }
    /// All tensors by name.
    const std::map<std::string, entry, std::less<>>& tensors() const noexcept { return header_.tensors; }
    bool contains(std::string_view name) const { return header_.tensors.contains(name); }

    /// Throws file_error when there is no tensor of that name.
    const entry& at(std::string_view name) const {
        const auto found = header_.tensors.find(name);
        if (found == header_.tensors.end())
            throw file_error(file_, "", "a " + detail::tensor_place(name),
                             header_.tensors.empty()
                                 ? "no tensors"
                                 : "others, such as " + in_quotes(header_.tensors.begin()->first));
        return found->second;
    }

    /// Throws file_error unless the tensor has just these extents.
    void require_extents(std::string_view name, std::span<const std::size_t> extents) const {
        const entry& tensor = at(name);
        if (!std::ranges::equal(tensor.extents, extents))
            throw file_error(file_, detail::tensor_place(name), shape_text(extents),
                             shape_text(tensor.extents));
    }

    /// The stored bytes of a tensor, of any alignment. Valid as long as this object.
    std::span<const std::byte> bytes(std::string_view name) const {
        const entry& tensor = at(name);
        return std::span(bytes_).subspan(header_.data_begin + tensor.begin, tensor.end - tensor.begin);
    }

    /// The elements in row-major order. For float and double any element type is converted: exactly where
    /// that is possible, else to the nearest value; float64 values beyond the range of float are an error.
    /// For an integer type the tensor must hold that very type. Not-a-number and infinity pass: what they
    /// mean is the caller's. Throws file_error.
    template <storable T>
    std::vector<T> values(std::string_view name) const {
        const element_type type = at(name).type;
        if (type == element_type_of<T>())
            return convert<T, T>(name, [](T value) { return value; });
        if constexpr (std::floating_point<T>) {
            const auto cast = [](auto value) { return static_cast<T>(value); };
            switch (type) {
            case element_type::boolean:
                return convert<T, std::uint8_t>(name,
                                                [](std::uint8_t value) { return T(value != 0 ? 1 : 0); });
            case element_type::uint8:
                return convert<T, std::uint8_t>(name, cast);
            case element_type::int8:
                return convert<T, std::int8_t>(name, cast);
            case element_type::int16:
                return convert<T, std::int16_t>(name, cast);
            case element_type::uint16:
                return convert<T, std::uint16_t>(name, cast);
            case element_type::float16:
                return convert<T, std::uint16_t>(
                    name, [](std::uint16_t bits) { return T(float16_to_float(bits)); });
            case element_type::bfloat16:
                return convert<T, std::uint16_t>(
                    name, [](std::uint16_t bits) { return T(bfloat16_to_float(bits)); });
            case element_type::int32:
                return convert<T, std::int32_t>(name, cast);
            case element_type::uint32:
                return convert<T, std::uint32_t>(name, cast);
            case element_type::float32:
                return convert<T, float>(name, cast);
            case element_type::float64:
                return convert<T, double>(name, [&](double value) { return narrowed<T>(name, value); });
            case element_type::int64:
                return convert<T, std::int64_t>(name, cast);
            case element_type::uint64:
                return convert<T, std::uint64_t>(name, cast);
            }
            throw std::logic_error("tactnet: an element type that does not exist");
        } else {
            throw file_error(file_, detail::tensor_place(name),
                             "element type " + std::string(element_type_name(element_type_of<T>())),
                             std::string(element_type_name(type)));
        }
    }

private:
    safetensors(safetensors_header header, std::vector<std::byte> bytes, std::string file, checksum_rule rule)
        : header_(std::move(header)),
          bytes_(std::move(bytes)),
          file_(std::move(file)),
          checksum_(!header_.checksum               ? checksum_state::absent
                    : rule == checksum_rule::verify ? checksum_state::verified
                                                    : checksum_state::ignored) {}

    template <class T>
    T narrowed(std::string_view name, double value) const {
        // Written so that infinity and not-a-number, which every T has, pass.
        if (std::isfinite(value) && std::abs(value) > static_cast<double>(std::numeric_limits<T>::max()))
            throw file_error(file_, detail::tensor_place(name), "values within the range of 32-bit numbers",
                             std::to_string(value));
        return static_cast<T>(value);
    }

    template <class T, class Stored, class Conversion>
    std::vector<T> convert(std::string_view name, Conversion conversion) const {
        const std::span<const std::byte> stored = bytes(name);
        std::vector<T> result(stored.size() / sizeof(Stored));
        for (std::size_t i = 0; i < result.size(); ++i) {
            Stored value;
            std::memcpy(&value, stored.data() + i * sizeof(Stored), sizeof(Stored));
            result[i] = conversion(value);
        }
        return result;
    }

    safetensors_header header_;
    std::vector<std::byte> bytes_;
    std::string file_;
    checksum_state checksum_;
};

} // namespace TACTNET_ARCH
} // namespace tactnet

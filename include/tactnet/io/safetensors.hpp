#pragma once

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/io/safetensors/format.hpp>
#include <tactnet/io/safetensors/header.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Converts the bytes of a file to numbers.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

template <class Stored, class T, class Conversion>
[[gnu::cold, gnu::noinline]] void convert_each(std::span<const std::byte> stored, std::span<T> to,
                                               Conversion conversion) {
    for (std::size_t i = 0; i < to.size(); ++i) {
        Stored value;
        std::memcpy(&value, stored.data() + i * sizeof(Stored), sizeof(Stored));
        to[i] = conversion(value);
    }
}

/// Throws for a finite value beyond the range of T. Infinity and NaN, which every T has, pass.
template <class T>
T narrowed(double value, const std::string& file, std::string_view tensor) {
    if (std::isfinite(value) && std::abs(value) > static_cast<double>(std::numeric_limits<T>::max()))
        throw_tensor_error(file, tensor, {"values within the range of 32-bit numbers"},
                           {std::to_string(value)});
    return static_cast<T>(value);
}

} // namespace detail

/// Converts elements of type `from`, stored with any alignment, to numbers. Any element type converts to
/// float and double: exactly where that is possible, else to the nearest value; float64 values beyond the
/// range of float are an error. An integer type must be the stored type. NaN and infinity pass, for the
/// caller to judge. `file` and `tensor` name the place in errors. Throws file_error.
template <storable T>
void convert_elements(element_type from, std::span<const std::byte> stored, std::span<T> to,
                      const std::string& file, std::string_view tensor) {
    if (from == element_type_of<T>()) {
        // The pointer of an empty span may be null.
        if (!to.empty())
            std::memcpy(to.data(), stored.data(), to.size_bytes());
        return;
    }
    if constexpr (std::floating_point<T>) {
        const auto cast = [](auto value) { return static_cast<T>(value); };
        switch (from) {
        case element_type::boolean:
            return detail::convert_each<std::uint8_t>(stored, to,
                                                      [](std::uint8_t value) { return T(value != 0); });
        case element_type::uint8:
            return detail::convert_each<std::uint8_t>(stored, to, cast);
        case element_type::int8:
            return detail::convert_each<std::int8_t>(stored, to, cast);
        case element_type::int16:
            return detail::convert_each<std::int16_t>(stored, to, cast);
        case element_type::uint16:
            return detail::convert_each<std::uint16_t>(stored, to, cast);
        case element_type::float16:
            return detail::convert_each<std::uint16_t>(
                stored, to, [](std::uint16_t bits) { return T(float16_to_float(bits)); });
        case element_type::bfloat16:
            return detail::convert_each<std::uint16_t>(
                stored, to, [](std::uint16_t bits) { return T(bfloat16_to_float(bits)); });
        case element_type::int32:
            return detail::convert_each<std::int32_t>(stored, to, cast);
        case element_type::uint32:
            return detail::convert_each<std::uint32_t>(stored, to, cast);
        case element_type::float32:
            return detail::convert_each<float>(stored, to, cast);
        case element_type::float64:
            return detail::convert_each<double>(
                stored, to, [&](double value) { return detail::narrowed<T>(value, file, tensor); });
        case element_type::int64:
            return detail::convert_each<std::int64_t>(stored, to, cast);
        case element_type::uint64:
            return detail::convert_each<std::uint64_t>(stored, to, cast);
        }
        throw std::logic_error("tactnet: an element type that does not exist");
    } else {
        detail::throw_tensor_error(file, tensor, {"element type ", element_type_name(element_type_of<T>())},
                                   {element_type_name(from)});
    }
}

/// Whether a wrong checksum is an error.
enum class checksum_rule {
    verify,
    ignore ///< for tests that damage files, to reach the checks after the checksum
};

/// The tensors of a safetensors file by name, and its metadata; the elements may be in memory or on disk.
class safetensors_index {
public:
    using entry = safetensors_entry;

    /// The path of the file, or another name for errors.
    const std::string& file() const noexcept { return file_; }
    /// The metadata without the checksum.
    const file_metadata& metadata() const noexcept { return header_.metadata; }
    /// The text under a key of the metadata, or null.
    [[gnu::cold, gnu::noinline]] const std::string* find_metadata(std::string_view key) const {
        const auto found = header_.metadata.find(key);
        return found == header_.metadata.end() ? nullptr : &found->second;
    }
    /// Absent in files of other programs.
    checksum_state checksum() const noexcept { return checksum_; }
    /// All tensors by name.
    const std::map<std::string, entry, std::less<>>& tensors() const noexcept { return header_.tensors; }
    bool contains(std::string_view name) const { return header_.tensors.contains(name); }

    /// Throws file_error when there is no tensor of that name.
    [[gnu::cold]] const entry& at(std::string_view name) const {
        const auto found = header_.tensors.find(name);
        if (found == header_.tensors.end())
            throw_missing(name);
        return found->second;
    }

    /// Throws file_error unless the tensor has exactly these extents.
    [[gnu::cold]] void require_extents(std::string_view name, std::span<const std::size_t> extents) const {
        const entry& tensor = at(name);
        if (!std::equal(tensor.extents.begin(), tensor.extents.end(), extents.begin(), extents.end()))
            detail::throw_tensor_error(file_, name, {shape_text(extents)}, {shape_text(tensor.extents)});
    }

protected:
    safetensors_index(safetensors_header header, std::string file, checksum_rule rule)
        : header_(std::move(header)),
          file_(std::move(file)),
          checksum_(!header_.checksum               ? checksum_state::absent
                    : rule == checksum_rule::verify ? checksum_state::verified
                                                    : checksum_state::ignored) {}
    safetensors_index(const safetensors_index&) = default;
    safetensors_index(safetensors_index&&) = default;
    safetensors_index& operator=(const safetensors_index&) = default;
    safetensors_index& operator=(safetensors_index&&) = default;
    ~safetensors_index() = default;

    const safetensors_header& header() const noexcept { return header_; }

    /// Throws file_error unless the header has the checksum that was computed.
    [[gnu::cold]] static void require_checksum(const safetensors_header& header, std::uint64_t computed,
                                               const std::string& file) {
        if (computed != *header.checksum)
            detail::throw_file_error(file, {"checksum of the whole file"},
                                     {checksum_text(*header.checksum), ", as when it was written"},
                                     {checksum_text(computed),
                                      ": it is damaged, or was changed by a program that kept the metadata ",
                                      detail::quoted{safetensors_checksum_key}});
    }

private:
    [[noreturn]] [[gnu::cold, gnu::noinline]] void throw_missing(std::string_view name) const {
        if (header_.tensors.empty())
            detail::throw_file_error(file_, {}, {"a tensor ", detail::quoted{name}}, {"no tensors"});
        detail::throw_file_error(file_, {}, {"a tensor ", detail::quoted{name}},
                                 {"others, such as ", detail::quoted{header_.tensors.begin()->first}});
    }

    safetensors_header header_;
    std::string file_;
    checksum_state checksum_;
};

// Tensors by name, in the file format in which machine-learning programs exchange weights. This header reads
// whole files; safetensors/writer.hpp writes them, and safetensors/source.hpp reads large ones in parts.

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

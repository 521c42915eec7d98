#pragma once

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors/checksum.hpp>
#include <tactnet/io/safetensors/header.hpp>
#include <tactnet/text/quoting.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace tactnet { inline namespace TACTNET_ARCH {

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

}} // namespace tactnet

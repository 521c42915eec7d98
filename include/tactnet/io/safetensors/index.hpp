#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors/checksum.hpp>
#include <tactnet/io/safetensors/header.hpp>
#include <tactnet/text/quoting.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>

// What a safetensors file says of its tensors, wherever their elements are.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Whether a checksum that does not fit is an error.
enum class checksum_rule {
    verify,
    ignore ///< for tests that damage files, to reach what stands behind the checksum
};

/// The tensors of a file by name, and its metadata.
class safetensors_index {
public:
    using entry = safetensors_entry;

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
        if (!std::equal(tensor.extents.begin(), tensor.extents.end(), extents.begin(), extents.end()))
            throw file_error(file_, detail::tensor_place(name), shape_text(extents),
                             shape_text(tensor.extents));
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

    /// Throws file_error unless the checksum in the header is the one found.
    static void require_checksum(const safetensors_header& header, std::uint64_t found,
                                 const std::string& file) {
        if (found != *header.checksum)
            throw file_error(file, "checksum of the whole file",
                             checksum_text(*header.checksum) + ", as when it was written",
                             checksum_text(found) +
                                 ": it is damaged, or was changed by a program that kept the metadata " +
                                 in_quotes(safetensors_checksum_key));
    }

private:
    safetensors_header header_;
    std::string file_;
    checksum_state checksum_;
};

} // namespace TACTNET_ARCH
} // namespace tactnet

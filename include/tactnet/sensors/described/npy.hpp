#pragma once

#include <tactnet/sensors/described/frame_file.hpp>
#include <tactnet/sensors/text/measures.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

// Arrays as NumPy's save writes them (.npy): "\x93NUMPY", a version, the length of the head, and the head, a
// dictionary of Python: {'descr': '<f4', 'fortran_order': False, 'shape': (3, 16, 16), }.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Decodes such a file, or several arrays of one size in it: rows × columns, or frames × rows × columns, of
/// integers, booleans, or floats of 32 or 64 bits.
class npy_array : public frame_file<npy_array> {
public:
    explicit npy_array(const sensor_description& sensor = {}) : frame_file("NPY", sensor) {}

    /// The first bytes of a file.
    static constexpr std::string_view magic = "\x93NUMPY";

private:
    friend class frame_file<npy_array>;

    std::optional<head> read_head(std::span<const std::byte> bytes, sensor_description& d) {
        const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        if (text.size() < 12)
            return std::nullopt;
        if (!text.starts_with(magic))
            return refuse("'\\x93NUMPY'", text.substr(0, 6));
        const bool is_short = text[6] == 1;
        const std::size_t length = is_short ? little_endian<std::uint16_t>(bytes.subspan(8))
                                            : little_endian<std::uint32_t>(bytes.subspan(8)),
                          begin = is_short ? 10 : 12;
        if (text[6] < 1 || text[6] > 3 || length >= largest_header_bytes)
            return refuse("version 1 to 3 and a head of less than 262144 bytes", text.substr(6, 6));
        if (text.size() < begin + length)
            return std::nullopt;
        const std::string_view said = text.substr(begin, length);
        std::vector<std::size_t> extents;
        std::string_view shape = value_of(said, "'shape':");
        shape = shape.substr(0, shape.find(')'));
        while (!shape.empty()) {
            shape.remove_prefix(1);
            const std::size_t end = std::min(shape.find(','), shape.size());
            if (const std::string_view extent = trimmed(shape.substr(0, end)); !extent.empty())
                extents.push_back(static_cast<std::size_t>(
                    std::min<std::uint64_t>(whole_number(extent).value_or(no_extent), no_extent)));
            shape.remove_prefix(end);
        }
        const std::string_view fortran = value_of(said, "'fortran_order':");
        const bool by_columns = fortran.starts_with("True");
        const bool one = extents.size() == 2 || (extents.size() == 3 && extents[0] == 1);
        if (extents.size() < 2 || extents.size() > 3 || extents[0] == no_extent || (by_columns && !one) ||
            !(by_columns || fortran.starts_with("False")))
            return refuse("rows x columns, or frames x rows x columns, in the order of C", said);
        if (!read_type(value_of(said, "'descr':"), d))
            return refuse("integers, booleans, or floats of 32 or 64 bits", value_of(said, "'descr':"));
        d.rows = extents[extents.size() - 2], d.columns = extents.back();
        d.order = by_columns ? cell_order::columns : d.order;
        return head{begin + length, one ? 1 : extents[0]};
    }

    static constexpr std::size_t no_extent = static_cast<std::size_t>(-1);

    static std::string_view value_of(std::string_view said, std::string_view key) noexcept {
        const std::size_t at = said.find(key);
        return at == std::string_view::npos ? std::string_view() : trimmed(said.substr(at + key.size()));
    }
    /// "'<f4', …".
    static bool read_type(std::string_view type, sensor_description& d) noexcept {
        if (type.size() < 5 || type[4] != type[0] || (type[0] != '\'' && type[0] != '"'))
            return false;
        d.cell_bytes = type[1] == '>' ? byte_order::big : byte_order::little;
        using enum cell_type;
        for (const auto& [name, cell] :
             {std::pair("u1", uint8), std::pair("b1", uint8), std::pair("i1", int8), std::pair("u2", uint16),
              std::pair("i2", int16), std::pair("u4", uint32), std::pair("i4", int32),
              std::pair("u8", uint64), std::pair("i8", int64), std::pair("f4", float32),
              std::pair("f8", float64)})
            if (type.substr(2, 2) == name) {
                d.cell = cell;
                return true;
            }
        return false;
    }
    std::nullopt_t refuse(const char* expected, std::string_view found) {
        damage({expected}, {detail::quoted{found.substr(0, 100)}});
        return std::nullopt;
    }
};

}} // namespace tactnet

#include "recording_file.hpp"

#include "decode_image.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/sensors/decoder.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <zlib.h>

namespace {

using tactnet::file_error;

/// A ZIP archive (PKWARE's APPNOTE, 4.3): a directory at its end says where entries are.
class zip_archive {
public:
    /// Refuses an entry that would make more than `largest` bytes of those read.
    zip_archive(std::string file, std::span<const std::byte> bytes, std::size_t largest)
        : file_(std::move(file)), bytes_(bytes), left_(largest) {
        const std::size_t end = text(0, bytes.size(), "").rfind("PK\5\6");
        require(end != std::string_view::npos, "", "a directory at the end of the archive", "none");
        entries_ = number<std::uint16_t>(end + 10);
        at_ = number<std::uint32_t>(end + 16), end_ = end;
    }

    /// The contents of the next entry, and whether there was one.
    bool next(std::vector<std::byte>& contents) {
        if (entries_ == 0) {
            require(at_ == end_, "", "as many entries as the directory has", "another number");
            return false;
        }
        --entries_;
        require(text(at_, 46, "").starts_with("PK\1\2"), "", "an entry of the directory", "other bytes");
        const auto method = number<std::uint16_t>(at_ + 10);
        const auto sum = number<std::uint32_t>(at_ + 16), packed = number<std::uint32_t>(at_ + 20),
                   size = number<std::uint32_t>(at_ + 24), head = number<std::uint32_t>(at_ + 42);
        const std::size_t name_size = number<std::uint16_t>(at_ + 28);
        const std::string& name = name_ = "entry " + tactnet::in_quotes(text(at_ + 46, name_size, ""), 100);
        at_ += 46 + name_size + number<std::uint16_t>(at_ + 30) + number<std::uint16_t>(at_ + 32);
        require(text(head, 30, name).starts_with("PK\3\4"), name, "its head", "other bytes");
        const std::size_t data =
            std::size_t{head} + 30 + number<std::uint16_t>(head + 26) + number<std::uint16_t>(head + 28);
        require(size <= left_, name, "at most " + std::to_string(left_) + " bytes", std::to_string(size));
        left_ -= size;
        const std::string_view from = text(data, packed, name);
        require(size / most_inflated <= packed, name, "at most 1032 bytes for each that is packed",
                std::to_string(size) + " for " + std::to_string(packed));
        contents.resize(size);
        if (method == 0 && packed == size)
            std::copy_n(reinterpret_cast<const std::byte*>(from.data()), size, contents.begin());
        else
            require(method == Z_DEFLATED && inflates(from, contents), name, "deflated or plain bytes",
                    method == Z_DEFLATED ? "damage" : "method " + std::to_string(method));
        const auto found = crc32(0, reinterpret_cast<const Bytef*>(contents.data()), size);
        require(found == sum, name, "the checksum " + std::to_string(sum), std::to_string(found));
        return true;
    }
    /// The name of the latest entry, for messages.
    const std::string& place() const { return name_; }

private:
    static constexpr std::size_t most_inflated = 1032; ///< bytes of one of deflate

    void require(bool holds, const std::string& place, const std::string& expected,
                 const std::string& found) const {
        if (!holds)
            throw file_error(file_, place, expected, found);
    }
    std::string_view text(std::size_t at, std::size_t size, const std::string& place) const {
        require(at <= bytes_.size() && size <= bytes_.size() - at, place,
                std::to_string(size) + " bytes from byte " + std::to_string(at), "the end of the file");
        return {reinterpret_cast<const char*>(bytes_.data()) + at, size};
    }
    template <class T>
    T number(std::size_t at) const {
        text(at, sizeof(T), "");
        return tactnet::little_endian<T>(bytes_.subspan(at));
    }
    static bool inflates(std::string_view from, std::vector<std::byte>& to) {
        z_stream stream{};
        if (inflateInit2(&stream, -MAX_WBITS) != Z_OK)
            return false;
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(from.data()));
        stream.avail_in = static_cast<uInt>(from.size());
        stream.next_out = reinterpret_cast<Bytef*>(to.data());
        stream.avail_out = static_cast<uInt>(to.size());
        const int ended = inflate(&stream, Z_FINISH);
        const bool whole = ended == Z_STREAM_END && stream.avail_out == 0;
        inflateEnd(&stream);
        return whole;
    }

    std::string file_, name_;
    std::span<const std::byte> bytes_;
    std::size_t entries_ = 0, at_ = 0, end_ = 0, left_;
};

/// The dimensions that the head of an NPY array states; 0 of anything else.
std::ptrdiff_t dimensions_of(std::span<const std::byte> npy) {
    const std::string_view text(reinterpret_cast<const char*>(npy.data()),
                                std::min<std::size_t>(npy.size(), 4096));
    const std::size_t from = std::min(text.find("'shape': ("), text.size());
    const std::string_view shape = text.substr(from, text.find(')', from) - from);
    return shape.empty() ? 0 : std::count(shape.begin(), shape.end(), ',') + (shape.ends_with(',') ? 0 : 1);
}

} // namespace

std::vector<std::byte> read_recording_file(const std::filesystem::path& path, std::size_t largest) {
    std::vector<std::byte> bytes = tactnet::read_file(path), result;
    const std::string_view begin(reinterpret_cast<const char*>(bytes.data()),
                                 std::min<std::size_t>(bytes.size(), 4));
    if (begin == "PK\3\4") {
        zip_archive archive(path.string(), bytes, largest);
        for (std::vector<std::byte> entry; archive.next(entry);) {
            const auto dimensions = dimensions_of(entry);
            if (dimensions > 3)
                throw file_error(path.string(), archive.place(),
                                 "an array of rows x columns, or frames x rows x columns",
                                 std::to_string(dimensions) + " dimensions");
            if (dimensions > 1) // labels have one
                result.insert(result.end(), entry.begin(), entry.end());
        }
        if (result.empty())
            throw file_error(path.string(), "", "an array of rows x columns, or frames x rows x columns",
                             "none in the archive");
        return result;
    }
    if (begin != "\x89PNG" && !begin.starts_with("\xFF\xD8\xFF"))
        return bytes;
    const grey_counts image = decode_counts(path);
    const std::string head = "P5 " + std::to_string(image.columns) + ' ' + std::to_string(image.rows) + ' ' +
                             (image.largest > 255 ? "65535" : "255") + '\n';
    for (const char c : head)
        result.push_back(static_cast<std::byte>(c));
    for (const float count : image.pixels) {
        const auto pixel = static_cast<unsigned>(count);
        if (image.largest > 255)
            result.push_back(static_cast<std::byte>(pixel >> 8U));
        result.push_back(static_cast<std::byte>(pixel & 0xFFU));
    }
    return result;
}

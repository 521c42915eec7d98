#pragma once

#include <tactnet/sensors/decoder.hpp>
#include <tactnet/sensors/described/matrix_stream.hpp>
#include <tactnet/sensors/described/npy.hpp>
#include <tactnet/sensors/described/pgm.hpp>
#include <tactnet/sensors/described/text_stream.hpp>
#include <tactnet/sensors/novel.hpp>
#include <tactnet/sensors/tekscan/ascii.hpp>
#include <tactnet/sensors/tekscan/binary.hpp>
#include <tactnet/sensors/tekscan/line.hpp>
#include <tactnet/sensors/tekscan/map.hpp>
#include <tactnet/sensors/text/lines.hpp>
#include <tactnet/sensors/xsensor.hpp>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

// Recognises the format of a recording or map by its bytes, never by the name of its file.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// Rejects bytes of an unknown format.
class unknown_recording : public decoder_base {
public:
    explicit unknown_recording(bool is_equilibration = false) : is_equilibration_(is_equilibration) {}

    template <class Sink>
    decode_status push(std::span<const std::byte> bytes, Sink&&) {
        if (status() == decode_status::damaged)
            return status();
        const std::string_view foreign =
            foreign_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
        return fail(
            {.expected = "a Tekscan recording or map (a line 'ASCII_DATA @@' or 'SENSOR_MAP @@', or bytes "
                         "0A BB BA)",
             .found = bytes.empty()       ? "not a single byte, as from a file that is empty or not there"
                      : is_equilibration_ ? "an equilibration: see read_equilibration"
                      : foreign.empty() ? "none of it in the first " + std::to_string(bytes.size()) + " bytes"
                                        : std::string(foreign)});
    }
    template <class Sink>
    decode_status finish(Sink&&) {
        return status();
    }

private:
    bool is_equilibration_;
};

} // namespace detail

/// Decodes any of Tekscan's formats, which is known by the end of the header, novel's ASCII, XSENSOR's CSV,
/// NPY or PGM; with a description, NPY, PGM, or the packets or lines that it describes.
///
/// Memory: that of the format, and one more header.
class any_recording {
public:
    /// The mask is used for binary recordings: see tekscan_binary.
    explicit any_recording(std::vector<std::uint8_t> mask = {}) : mask_(std::move(mask)) {}
    /// Throws std::invalid_argument for a description that cannot be.
    template <std::same_as<sensor_description> Sensor>
    explicit any_recording(Sensor sensor) : sensor_(std::move(sensor)) {
        require_valid(*sensor_);
    }

    template <class Sink>
    decode_status push(std::span<const std::byte> bytes, Sink&& sink) {
        if (known_)
            return decode(bytes, sink);
        const std::size_t room = largest_header_bytes - std::min(begun_.size(), largest_header_bytes);
        const std::size_t consumed = std::min(room, bytes.size());
        begun_.insert(begun_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(consumed));
        if (!recognise() && begun_.size() < largest_header_bytes)
            return decode_status::reading;
        const decode_status status = start(sink);
        return status == decode_status::damaged ? status : decode(bytes.subspan(consumed), sink);
    }

    template <class Sink>
    decode_status finish(Sink&& sink) {
        if (!known_) {
            if (sensor_)
                recognise_described();
            else if (line_ > 0 && begun_text().substr(line_).starts_with("\xBB\xBA"))
                found<tekscan_binary>(std::move(mask_));
            else
                recognise_line(begun_text().substr(line_));
            if (start(sink) == decode_status::damaged)
                return decode_status::damaged;
        }
        return std::visit([&](auto& decoder) { return decoder.finish(sink); }, decoder_);
    }

    [[nodiscard]] const recording_description& description() const { return decoder().description(); }
    [[nodiscard]] const decoding_error& error() const { return decoder().error(); }
    [[nodiscard]] std::uint64_t frames() const { return decoder().frames(); }
    [[nodiscard]] std::uint64_t certain_frames() const { return decoder().certain_frames(); }
    [[nodiscard]] const decoding_warnings& warnings() const { return decoder().warnings(); }

private:
    [[nodiscard]] const decoder_base& decoder() const {
        return std::visit([](const auto& known) -> const decoder_base& { return known; }, decoder_);
    }
    [[nodiscard]] std::string_view begun_text() const noexcept {
        return {reinterpret_cast<const char*>(begun_.data()), begun_.size()};
    }

    /// Returns whether a line that ends a header has come.
    bool recognise() {
        const std::string_view text = begun_text();
        if (sensor_)
            return text.size() >= npy_array::magic.size() && recognise_described();
        while (true) {
            if (line_ > 0 && text.substr(line_).starts_with("\xBB\xBA")) {
                if (text.size() < line_ + 6)
                    return false;
                // A run without cells is in no recording.
                return text.substr(line_ + 2, 4) == std::string_view("\xB8\x01\0\0", 4)
                           ? found<detail::unknown_recording>(true)
                           : found<tekscan_binary>(std::move(mask_));
            }
            const std::size_t end = text.find('\n', searched_);
            if (end == std::string_view::npos)
                break;
            if (recognise_line(text.substr(line_, end - line_)))
                return true;
            line_ = searched_ = end + 1;
        }
        searched_ = text.size();
        return false;
    }

    bool recognise_described() {
        const std::string_view text = begun_text();
        return text.starts_with(npy_array::magic)   ? found<npy_array>(*sensor_)
               : is_pgm(text)                       ? found<pgm_images>(*sensor_)
               : sensor_->cell == cell_type::digits ? found<text_stream>(*sensor_)
                                                    : found<matrix_stream>(*sensor_);
    }
    static bool is_pgm(std::string_view text) {
        return text.starts_with("P5") && std::string_view(" \t\r\n#").find(text.substr(2, 1)) < 5;
    }

    bool recognise_line(std::string_view line) {
        if (line_ == 0 && line.starts_with(npy_array::magic))
            return found<npy_array>();
        if (line_ == 0 && is_pgm(line))
            return found<pgm_images>();
        while (line.ends_with('\r'))
            line.remove_suffix(1);
        constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
        if (line_ == 0 && line.starts_with(byte_order_mark))
            line.remove_prefix(byte_order_mark.size());
        if (line_ == 0 && line.starts_with("File:,"))
            return found<xsensor_csv>();
        if (line_ == 0 && line.starts_with("file name:"))
            return found<novel_ascii>();
        std::string unquoted;
        const tekscan_part next = detail::read_header_line(line, unquoted).followed_by;
        return next == tekscan_part::cells ? found<tekscan_ascii>()
               : next == tekscan_part::map ? found<tekscan_map>()
                                           : false;
    }

    template <class Decoder, class... Arguments>
    bool found(Arguments&&... arguments) {
        decoder_.emplace<Decoder>(std::forward<Arguments>(arguments)...);
        return true;
    }

    /// Gives the bytes kept so far to the decoder.
    template <class Sink>
    decode_status start(Sink& sink) {
        known_ = true;
        const decode_status status = decode(begun_, sink);
        begun_ = {};
        return status;
    }

    template <class Sink>
    decode_status decode(std::span<const std::byte> bytes, Sink& sink) {
        return std::visit([&](auto& decoder) { return decoder.push(bytes, sink); }, decoder_);
    }

    std::variant<detail::unknown_recording, tekscan_ascii, tekscan_binary, tekscan_map, novel_ascii,
                 xsensor_csv, npy_array, pgm_images, text_stream, matrix_stream>
        decoder_;
    std::vector<std::uint8_t> mask_;
    std::optional<sensor_description> sensor_;
    std::vector<std::byte> begun_;
    std::size_t line_ = 0;     ///< the start of the first line without an end
    std::size_t searched_ = 0; ///< the end of the bytes searched for it
    bool known_ = false;
};

}} // namespace tactnet

#pragma once

#include <tactnet/io/file_error.hpp>
#include <tactnet/sensors/frame.hpp>
#include <tactnet/sensors/warning.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

// Decoders take bytes as they arrive, split anywhere, and call a sink for each frame. A decoder keeps at most
// one frame and one piece of its input, whose largest sizes are stated with each decoder; while a piece
// grows, it may take three times that. Decoders throw nothing but std::bad_alloc: they return a status, and
// report errors and warnings on request.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The largest rows × columns that a source may announce, so that damaged bytes cannot exhaust the memory.
inline constexpr std::size_t largest_frame_cells = std::size_t{1} << 20;
/// The largest size of a text header and of a single line, in bytes.
inline constexpr std::size_t largest_header_bytes = std::size_t{1} << 18;
/// The largest number of lines of a text header, all of which are kept.
inline constexpr std::size_t largest_header_lines = std::size_t{1} << 13;

/// The status of a decoder after some bytes.
enum class decode_status : std::uint8_t {
    reading,  ///< all bytes are taken, more may follow
    finished, ///< the source is complete
    damaged   ///< see `error()`; frames so far are whole. Recordings end here, live streams continue
};

/// An error in a source, and its place.
struct decoding_error {
    std::size_t byte = 0;    ///< offset from the first byte pushed
    std::size_t line = 0;    ///< from 1; 0 in binary data
    std::uint64_t frame = 0; ///< position of the frame, from 1; 0 in a header
    std::string expected, found;
    std::optional<std::uint64_t> missing_frames{}; ///< announced, but not found

    /// For example "byte 812, line 31, frame 1".
    [[nodiscard]] std::string place() const { return detail::place_text(byte, line, frame); }
    /// What was found, with the number of missing frames if it is known.
    [[nodiscard]] std::string outcome() const {
        return found + (missing_frames.value_or(0) > 0
                            ? " (" + std::to_string(*missing_frames) + " announced frames are missing)"
                            : "");
    }
    /// The error as a sentence: "file: byte 812, line 31, frame 1: expected …, found …".
    [[nodiscard]] std::string message(const std::string& file = {}) const {
        return error_sentence(file, place(), expected, outcome());
    }
};

/// A sink that ignores frames.
struct ignore_frames {
    void operator()(const frame_view&) const noexcept {}
};

/// A source of frames. `push` and `finish` call the sink once per complete frame; `finish` ends the source.
template <class Decoder>
concept frame_decoder =
    std::movable<Decoder> &&
    requires(Decoder decoder, const Decoder& constant, std::span<const std::byte> bytes, ignore_frames sink) {
        { decoder.push(bytes, sink) } -> std::same_as<decode_status>;
        { decoder.finish(sink) } -> std::same_as<decode_status>;
        { constant.description() } -> std::same_as<const recording_description&>;
        { constant.error() } -> std::same_as<const decoding_error&>;
    };

/// Base class of decoders, also of your own.
class decoder_base {
public:
    /// What the source says about itself; complete when the sink gets the first frame.
    [[nodiscard]] const recording_description& description() const noexcept { return description_; }
    /// The error of the last call that returned `damaged`.
    [[nodiscard]] const decoding_error& error() const noexcept { return error_; }
    /// Number of frames so far.
    [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }
    /// How many of the first frames are beyond doubt: all of them, unless the format, as that of
    /// tekscan_binary, shows damage only in later frames.
    [[nodiscard]] std::uint64_t certain_frames() const noexcept { return certain_.value_or(frames_); }
    /// Bytes so far that the format allows, but no known program writes.
    [[nodiscard]] const decoding_warnings& warnings() const noexcept { return warnings_; }

protected:
    decoder_base() = default;
    explicit decoder_base(recording_description description) : description_(std::move(description)) {
        resize_cells();
    }

    [[nodiscard]] recording_description& mutable_description() noexcept { return description_; }
    [[nodiscard]] std::span<float> cells() noexcept { return cells_; }
    [[nodiscard]] decode_status status() const noexcept { return status_; }
    void set_status(decode_status status) noexcept { status_ = status; }
    [[nodiscard]] decoding_warnings& mutable_warnings() noexcept { return warnings_; }
    /// For formats in which later frames confirm earlier ones.
    void set_certain_frames(std::uint64_t frames) noexcept { certain_ = frames; }

    /// Allocates the cells of a frame once rows and columns are known.
    void resize_cells() { resize_cells(description_.cells()); }
    /// Allocates the first cells only, so that memory follows the data instead of the announced size.
    void resize_cells(std::size_t cells) { cells_.resize(cells); }

    /// Gives the frame to the sink.
    template <class Sink>
    void emit(Sink&& sink, std::uint64_t number, std::optional<double> seconds, bool certain = true) {
        if (!certain && !certain_)
            certain_ = frames_;
        ++frames_;
        sink(frame_view{number, seconds, description_.rows, description_.columns, cells_, certain});
    }

    /// Number of announced frames that have not come; nothing if no number was announced.
    [[nodiscard]] std::optional<std::uint64_t> missing_frames() const noexcept {
        if (!description_.frames)
            return std::nullopt;
        return *description_.frames > frames_ ? *description_.frames - frames_ : 0;
    }

    decode_status fail(decoding_error error) {
        error_ = std::move(error);
        return status_ = decode_status::damaged;
    }

private:
    recording_description description_;
    decoding_error error_;
    std::vector<float> cells_;
    std::uint64_t frames_ = 0;
    std::optional<std::uint64_t> certain_;
    decoding_warnings warnings_;
    decode_status status_ = decode_status::reading;
};

/// Reads the unsigned number at the start of `bytes`, lowest byte first, on any machine.
template <std::unsigned_integral T>
[[nodiscard]] constexpr T little_endian(std::span<const std::byte> bytes) noexcept {
    T value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i)
        value = static_cast<T>(value | static_cast<T>(static_cast<T>(bytes[i]) << (8 * i)));
    return value;
}

/// Reads the unsigned number at the start of `bytes`, highest byte first, on any machine.
template <std::unsigned_integral T>
[[nodiscard]] constexpr T big_endian(std::span<const std::byte> bytes) noexcept {
    T value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i)
        value = static_cast<T>(value | static_cast<T>(static_cast<T>(bytes[sizeof(T) - 1 - i]) << (8 * i)));
    return value;
}

}} // namespace tactnet

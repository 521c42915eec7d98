#pragma once

#include <tactnet/detail/config.hpp>
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

// What a decoder is: bytes are pushed as they arrive, split anywhere, and frames come out. A decoder keeps at
// most one frame and one piece of its input; what both may need at most is a constant of the format, stated
// with each decoder. Where the memory of a piece grows as its bytes come, it may be three times what is
// stated while it does. A decoder throws nothing but std::bad_alloc: a push returns a status, and what was
// wrong can be asked for, and what was unlike a real writer as well.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The most rows × columns that a source may announce, so that a few damaged bytes cannot ask for all memory.
inline constexpr std::size_t largest_frame_cells = std::size_t{1} << 20;
/// The most bytes of a text header, and of a single line.
inline constexpr std::size_t largest_header_bytes = std::size_t{1} << 18;
/// The most lines of a text header, each of which is kept.
inline constexpr std::size_t largest_header_lines = std::size_t{1} << 13;

enum class decode_status : std::uint8_t {
    reading,  ///< all bytes are taken, more are welcome
    finished, ///< the source is complete
    damaged ///< `error()` tells; frames that came out before are whole, and `certain_frames()` of them beyond
            ///< doubt. Recordings end here, live streams go on
};

/// What is wrong with a source, and where.
struct decoding_error {
    std::size_t byte = 0;    ///< offset from the first byte pushed
    std::size_t line = 0;    ///< from 1; 0 in binary data
    std::uint64_t frame = 0; ///< position of the frame, from 1; 0 in a header
    std::string expected, found;
    std::optional<std::uint64_t> missing_frames; ///< of those announced

    /// For example "byte 812, line 31, frame 1".
    [[nodiscard]] std::string place() const { return detail::place_text(byte, line, frame); }
    /// What was found, with the number of frames that are missing where it is known.
    [[nodiscard]] std::string outcome() const {
        return found + (missing_frames.value_or(0) > 0
                            ? " (" + std::to_string(*missing_frames) + " announced frames are missing)"
                            : "");
    }
    /// All of it in one sentence: "byte 812, line 31, frame 1: expected …, found …". A file's name is put in
    /// front, where one is given.
    [[nodiscard]] std::string message(const std::string& file = {}) const {
        return detail::sentence_text(file, place(), expected, outcome());
    }
};

/// Takes frames and does nothing with them.
struct ignore_frames {
    void operator()(const frame_view&) const noexcept {}
};

/// A source of frames. `push` and `finish` call the sink once for every frame that has become whole; `finish`
/// tells that no more bytes will come.
template <class Decoder>
concept frame_decoder = std::movable<Decoder> &&
    requires(Decoder decoder, const Decoder& constant, std::span<const std::byte> bytes, ignore_frames sink) {
    { decoder.push(bytes, sink) } -> std::same_as<decode_status>;
    { decoder.finish(sink) } -> std::same_as<decode_status>;
    { constant.description() } -> std::same_as<const recording_description&>;
    { constant.error() } -> std::same_as<const decoding_error&>;
};

/// What decoders have in common; they derive from it, as a user's own may.
class decoder_base {
public:
    /// Complete when the first frame comes out.
    [[nodiscard]] const recording_description& description() const noexcept { return description_; }
    /// Of the last call that returned `damaged`.
    [[nodiscard]] const decoding_error& error() const noexcept { return error_; }
    /// Frames that came out so far.
    [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }
    /// How many of the first frames are beyond doubt. All that came out, where each is checked by itself; a
    /// format in which damage may go unnoticed until later says fewer, as tekscan_binary does.
    [[nodiscard]] std::uint64_t certain_frames() const noexcept { return certain_.value_or(frames_); }
    /// What was unlike a real writer so far, though the format allows it.
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
    /// For formats where a frame needs those behind it to be certain.
    void set_certain_frames(std::uint64_t frames) noexcept { certain_ = frames; }

    /// Once rows and columns are known.
    void resize_cells() { resize_cells(description_.cells()); }
    /// The same for the first cells only: memory then follows what has come, not what was announced.
    void resize_cells(std::size_t cells) { cells_.resize(cells); }

    /// Hands the cells to the sink.
    template <class Sink>
    void emit(Sink&& sink, std::uint64_t number, std::optional<double> seconds) {
        ++frames_;
        sink(frame_view{number, seconds, description_.rows, description_.columns, cells_});
    }

    /// Frames that were announced and have not come out; nothing where none were announced.
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

} // namespace TACTNET_ARCH
} // namespace tactnet

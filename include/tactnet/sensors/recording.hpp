#pragma once

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/sensors/any_recording.hpp>
#include <tactnet/sensors/decoder.hpp>
#include <tactnet/sensors/frame.hpp>
#include <tactnet/sensors/warning.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

// Whole recordings in memory, from bytes or files. In a control loop, push bytes into a decoder instead.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The frames of a source in memory.
class recording {
public:
    recording_description description;
    /// Set if damage has ended the recording early. The frames before it are whole.
    std::optional<decoding_error> damage;
    /// How many of the first frames are beyond doubt: see decoder_base::certain_frames.
    std::uint64_t certain_frames = 0;
    /// Bytes that the format allows, but no known program writes.
    decoding_warnings warnings;

    [[nodiscard]] std::size_t size() const noexcept { return stamps_.size(); }
    /// Frame `index`, counted from 0, as a view into the recording. Throws std::out_of_range.
    [[nodiscard]] frame_view operator[](std::size_t index) const& {
        if (index >= size())
            throw std::out_of_range(
                detail::joined({"recording: expected a frame below ", size(), ", found ", index}));
        const auto& [number, seconds] = stamps_[index];
        const std::size_t cells = description.cells();
        return {number, seconds, description.rows, description.columns,
                std::span(cells_).subspan(index * cells, cells)};
    }
    frame_view operator[](std::size_t) const&& = delete; // the frame would dangle

    /// Frame `index` as a view of a shape known at compile time. Throws std::invalid_argument if the frames
    /// have another size.
    template <shape Shape>
    [[nodiscard]] tensor_view<const float, Shape> as(std::size_t index) const& {
        const auto view = (*this)[index].template as<Shape>();
        if (!view)
            detail::throw_invalid_argument({"recording: expected frames of ", Shape.rows, " x ",
                                            Shape.columns, ", found ", description.rows, " x ",
                                            description.columns});
        return *view;
    }
    template <shape Shape>
    void as(std::size_t) const&& = delete; // the frame would dangle

    void add(const frame_view& frame) {
        cells_.insert(cells_.end(), frame.cells.begin(), frame.cells.end());
        stamps_.emplace_back(frame.number, frame.seconds);
    }

private:
    std::vector<float> cells_;
    std::vector<std::pair<std::uint64_t, std::optional<double>>> stamps_;
};

/// The default limit of cells of all frames together, since a few bytes of a binary recording may encode
/// thousands of cells.
inline constexpr std::size_t default_recording_cells = std::size_t{1} << 28;

/// Decodes all of `bytes`. Damage, or more than `limit` cells, ends the recording, which reports it.
template <frame_decoder Decoder>
[[nodiscard]] recording decode_all(Decoder decoder, std::span<const std::byte> bytes,
                                   std::size_t limit = default_recording_cells) {
    recording result;
    std::size_t kept = 0;
    bool full = false;
    const auto keep = [&](const frame_view& frame) {
        full = full || frame.cells.size() > limit - kept;
        if (full)
            return;
        kept += frame.cells.size();
        result.add(frame);
    };
    // In pieces, so that decoding stops soon after the limit.
    constexpr std::size_t piece = std::size_t{1} << 16;
    decode_status status = decode_status::reading;
    while (!bytes.empty() && status != decode_status::damaged && !full) {
        status = decoder.push(bytes.first(std::min(piece, bytes.size())), keep);
        bytes = bytes.subspan(std::min(piece, bytes.size()));
    }
    if (status != decode_status::damaged && !full)
        status = decoder.finish(keep);
    result.description = decoder.description();
    result.certain_frames = result.size();
    // A decoder that is not derived from decoder_base may lack these.
    if constexpr (requires { decoder.certain_frames(), decoder.warnings(); }) {
        result.certain_frames = std::min<std::uint64_t>(result.size(), decoder.certain_frames());
        result.warnings = decoder.warnings();
    }
    if (full)
        result.damage = decoding_error{.frame = result.size() + 1,
                                       .expected = "at most " + std::to_string(limit) + " cells",
                                       .found = "more"};
    else if (status == decode_status::damaged)
        result.damage = decoder.error();
    return result;
}

/// What `read_recording` does with a damaged or truncated file.
enum class damaged_file : std::uint8_t {
    refuse,           ///< throw
    keep_whole_frames ///< return the frames before the damage, and set `recording::damage`
};

/// Reads a recording or map of any of Tekscan's formats, recognised by its content. Throws file_error if the
/// file cannot be read or has another format, and, by default, if it is damaged or has more than
/// default_recording_cells.
[[nodiscard]] inline recording read_recording(const std::filesystem::path& path,
                                              damaged_file damaged = damaged_file::refuse) {
    recording result = decode_all(any_recording(), read_file(path));
    if (result.damage && (damaged == damaged_file::refuse || result.description.format.empty()))
        throw file_error(path.string(), result.damage->place(), result.damage->expected,
                         result.damage->outcome());
    return result;
}

}} // namespace tactnet

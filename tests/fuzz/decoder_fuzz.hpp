#pragma once

// What holds for every decoder and any bytes: frames and status do not depend on how the bytes are split,
// frames are of the size that the description says and hold counts or pressures, and damage is reported with
// its place.

#include "fuzz_target.hpp"

#include <tactnet/sensors/decoder.hpp>
#include <tactnet/sensors/described/description_file.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fuzz {

/// What came out, in a form that can be compared.
struct outcome {
    tactnet::decode_status status = tactnet::decode_status::reading;
    std::uint64_t frames = 0, numbers = 0, hash = 14695981039346656037U;
    double seconds = 0;
    std::string error;
    std::uint64_t certain = 0, uncertain = 0, warnings = 0;
    std::vector<tactnet::decoding_warning> kept;

    friend bool operator==(const outcome&, const outcome&) = default;
};

/// Whether cells may be NaN: broken.
enum class cells_of { recordings, described };

/// Pushes pieces of `piece` bytes; with 0 all at once.
template <tactnet::frame_decoder Decoder>
outcome decode(Decoder decoder, std::span<const std::byte> bytes, std::size_t piece, cells_of cells) {
    outcome result;
    const std::size_t total = bytes.size();
    const auto sink = [&](const tactnet::frame_view& frame) {
        const tactnet::recording_description& description = decoder.description();
        require(frame.rows == description.rows && frame.columns == description.columns);
        require(frame.rows > 0 && frame.columns > 0 && frame.cells.size() == description.cells());
        require(description.mask.empty() || description.mask.size() == description.cells());
        require(!frame.seconds || !std::isnan(*frame.seconds));
        for (std::size_t i = 0; i < frame.cells.size(); ++i) {
            require((std::isfinite(frame.cells[i]) && frame.cells[i] >= 0) ||
                    (cells == cells_of::described && std::isnan(frame.cells[i])));
            require(description.exists(i) || frame.cells[i] == 0);
            result.hash = (result.hash ^ std::bit_cast<std::uint32_t>(frame.cells[i])) * 1099511628211U;
        }
        ++result.frames;
        result.uncertain += frame.certain ? 0 : 1;
        result.numbers += frame.number;
        result.seconds += frame.seconds.value_or(0);
    };
    const auto note = [&](tactnet::decode_status status) {
        result.status = status;
        if (status != tactnet::decode_status::damaged)
            return;
        const tactnet::decoding_error& error = decoder.error();
        require(!error.expected.empty() && !error.found.empty() && error.byte <= total);
    };
    while (!bytes.empty()) {
        const std::size_t size = piece == 0 ? bytes.size() : std::min(piece, bytes.size());
        note(decoder.push(bytes.first(size), sink));
        bytes = bytes.subspan(size);
    }
    note(decoder.finish(sink));
    require(result.status != tactnet::decode_status::reading);
    if (result.status == tactnet::decode_status::damaged)
        result.error = decoder.error().place() + decoder.error().expected + decoder.error().outcome();
    result.certain = decoder.certain_frames();
    result.warnings = decoder.warnings().count();
    result.kept.assign(decoder.warnings().kept().begin(), decoder.warnings().kept().end());
    require(result.certain <= result.frames && result.kept.size() <= result.warnings);
    require(result.status == tactnet::decode_status::damaged || result.warnings > 0 || result.uncertain > 0 ||
            result.certain == result.frames);
    return result;
}

/// The same bytes, whole and in pieces, into copies of `decoder`. The size chooses the pieces, since time is
/// better spent on more inputs.
template <tactnet::frame_decoder Decoder>
void check(const Decoder& decoder, std::span<const std::byte> bytes, cells_of cells = cells_of::recordings) {
    const std::size_t piece = bytes.size() % 3 == 0 ? 7 : 1;
    require(decode(decoder, bytes, piece, cells) == decode(decoder, bytes, 0, cells));
}

inline std::vector<tactnet::sensor_description> parsed(std::span<const std::string_view> descriptions) {
    std::vector<tactnet::sensor_description> all;
    for (const std::string_view description : descriptions)
        all.push_back(tactnet::parse_sensor(description));
    return all;
}

inline std::span<const std::byte> bytes_of(const std::uint8_t* data, std::size_t size) {
    return std::as_bytes(std::span(data, size));
}

inline std::vector<std::uint8_t> input(std::string_view text) {
    return {text.begin(), text.end()};
}

} // namespace fuzz

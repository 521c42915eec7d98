#pragma once

// Runs a decoder over bytes that a test makes.

#include <tactnet/sensors/decoder.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sensors_test {

struct kept_frame {
    std::uint64_t number;
    std::optional<double> seconds;
    std::vector<float> cells;

    friend bool operator==(const kept_frame&, const kept_frame&) = default;
};

/// All that came out of a decoder.
struct decoded {
    std::vector<kept_frame> frames;
    tactnet::decode_status status = tactnet::decode_status::reading;
    std::string error; ///< "place: expected …, found …"; empty without damage
    tactnet::recording_description description;
    std::uint64_t certain_frames = 0;
    std::vector<std::string> warnings; ///< "place: expected …, found …", the first ones
    std::uint64_t warning_count = 0;
};

inline std::span<const std::byte> bytes_of(std::string_view text) {
    return std::as_bytes(std::span(text.data(), text.size()));
}

/// Pushes pieces that end at each of `cuts` and at the end.
template <tactnet::frame_decoder Decoder>
decoded decode(Decoder decoder, std::span<const std::byte> bytes, const std::vector<std::size_t>& cuts = {}) {
    decoded result;
    const auto keep = [&](const tactnet::frame_view& frame) {
        result.frames.push_back({frame.number, frame.seconds, {frame.cells.begin(), frame.cells.end()}});
    };
    const auto note = [&](tactnet::decode_status status) {
        result.status = status;
        if (status == tactnet::decode_status::damaged)
            result.error = decoder.error().message();
    };
    std::size_t from = 0;
    for (const std::size_t cut : cuts) {
        note(decoder.push(bytes.subspan(from, cut - from), keep));
        from = cut;
    }
    note(decoder.push(bytes.subspan(from), keep));
    note(decoder.finish(keep));
    result.description = decoder.description();
    result.certain_frames = decoder.certain_frames();
    for (const tactnet::decoding_warning& warning : decoder.warnings().kept())
        result.warnings.push_back(warning.message());
    result.warning_count = decoder.warnings().count();
    return result;
}

/// Whether the same comes out with a cut at any one byte, and with a cut at every byte.
template <tactnet::frame_decoder Decoder>
bool same_however_split(const Decoder& decoder, std::span<const std::byte> bytes) {
    const decoded whole = decode(decoder, bytes);
    const auto same = [&](const std::vector<std::size_t>& cuts) {
        const decoded split = decode(decoder, bytes, cuts);
        return split.frames == whole.frames && split.status == whole.status && split.error == whole.error &&
               split.certain_frames == whole.certain_frames && split.warnings == whole.warnings &&
               split.warning_count == whole.warning_count;
    };
    std::vector<std::size_t> every;
    for (std::size_t cut = 1; cut < bytes.size(); ++cut) {
        every.push_back(cut);
        if (!same({cut}))
            return false;
    }
    return same(every);
}

/// Whether every shorter piece gives only frames that all of the bytes give, and damage where some are
/// missing.
template <tactnet::frame_decoder Decoder>
bool only_whole_frames_when_cut(const Decoder& decoder, std::span<const std::byte> bytes,
                                std::size_t step = 1) {
    const decoded whole = decode(decoder, bytes);
    for (std::size_t size = 0; size < bytes.size(); size += step) {
        const decoded cut = decode(decoder, bytes.first(size));
        if (cut.frames.size() > whole.frames.size() ||
            !std::equal(cut.frames.begin(), cut.frames.end(), whole.frames.begin()) ||
            (cut.frames.size() < whole.frames.size() && cut.status != tactnet::decode_status::damaged))
            return false;
    }
    return true;
}

} // namespace sensors_test

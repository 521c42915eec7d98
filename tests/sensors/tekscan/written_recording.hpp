#pragma once

// A binary recording as I-Scan writes one, made by a test: see tekscan/binary_checks.hpp for what it does and
// what it never does.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sensors_test {

/// The lowest byte first.
inline std::string little(std::uint64_t value, std::size_t bytes) {
    std::string result;
    for (std::size_t i = 0; i < bytes; ++i)
        result += static_cast<char>(static_cast<unsigned char>(value >> (8 * i)));
    return result;
}

inline std::string record(unsigned tag, std::uint64_t value, std::size_t bytes) {
    return little(tag, 2) + little(bytes, 2) + little(value, bytes);
}

/// Counts below 3, the noise threshold, are left out.
inline std::string runs(const std::vector<std::uint8_t>& counts) {
    std::string result;
    for (std::size_t at = 0; at < counts.size(); ++at) {
        std::string run;
        const std::size_t from = at;
        for (; at < counts.size() && counts[at] >= 3; ++at)
            run += static_cast<char>(counts[at]);
        if (!run.empty())
            result += little(from, 2) + little(run.size(), 1) + run;
    }
    return result + "\xFF\xFF";
}

struct written_records {
    std::uint64_t number, microseconds, time_of_day;

    [[nodiscard]] std::string bytes() const {
        return record(1, number, 4) + record(2, microseconds, 8) + record(16, time_of_day, 8) + "\xFF\xFF";
    }
};

inline constexpr std::uint64_t first_time_of_day = 0x1d5f932df573a1a;

/// The records of the frame at position `index`, from 0; every fourth is 10 microseconds late.
inline written_records usual_records(std::uint64_t index) {
    const std::uint64_t time = 10'000 * index + 10 * (index / 4);
    return {index + 1, time, first_time_of_day + 10 * time};
}

inline constexpr std::size_t written_rows = 20, written_columns = 24;

/// Where a fingertip wanders.
inline std::vector<std::uint8_t> usual_counts(std::size_t index) {
    std::vector<std::uint8_t> counts;
    for (std::size_t row = 0; row < written_rows; ++row)
        for (std::size_t column = 0; column < written_columns; ++column) {
            const auto down = static_cast<double>(row) - 6 - 0.1 * static_cast<double>(index),
                       across = static_cast<double>(column) - 9 - 0.05 * static_cast<double>(index);
            const double away = down * down + 1.5 * across * across;
            // With rings, so that runs have gaps, as in real recordings.
            const bool gap = away > 5 && away < 9;
            counts.push_back(static_cast<std::uint8_t>(away > 20 || gap ? 0 : 90 - 4 * away));
        }
    return counts;
}

inline std::string written_header(std::size_t frames) {
    return "VERSION Tek API\nHW_TYPE 7\nSENSOR_TYPE NULL\nROWS 20\nCOLS 24\nROW_SPACING 1\nCOL_SPACING 1\n"
           "SENSEL_AREA 1\nNOISE_THRESHOLD 3\nSECONDS_PER_FRAME 0.01\nMICRO_SECOND 1\nUNITS PSI\n"
           "GraphBoxAligned 1\nEditFiltMax 255\nFRAMES " +
           std::to_string(frames) + "\nFRAME_INFO 1\nTIME_2 1d5f932df573a1a\n\xBB\xBA";
}

inline std::string written_recording(std::size_t frames) {
    std::string result = written_header(frames);
    for (std::size_t i = 0; i < frames; ++i)
        result += runs(usual_counts(i)) + usual_records(i).bytes();
    return result + "\xFF\xFE";
}

} // namespace sensors_test

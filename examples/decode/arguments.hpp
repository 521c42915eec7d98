#pragma once

#include <tactnet/sensors/text/measures.hpp>
#include <tactnet/text/message.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <program_arguments.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

/// What the user asks for.
struct arguments {
    std::filesystem::path file;
    std::filesystem::path map, sensor; ///< empty: none
    bool help = false;
    bool csv = false;
    std::optional<std::uint64_t> picture; ///< the number of the frame to draw
    std::filesystem::path picture_file;
};

inline constexpr const char* usage =
    "usage: tactnet_decode [--csv | --picture N OUT.png] [--map FILE.mp | --sensor FILE.json] FILE\n"
    "\n"
    "Prints what is in a recording of Tekscan (.csv, .asf, .fsx), XSENSOR (.csv) or novel (.asc), a map "
    "(.mp), or\n"
    "frames as NPY, NPZ, PGM or PNG; its content tells which.\n"
    "  --csv               every frame: a line frame,NUMBER,SECONDS and its rows, with B where no tactel is\n"
    "  --picture N OUT.png draws the frame with the number N\n"
    "  --map FILE.mp       the map of the sensor, which says which cells have a tactel: .fsx does not tell\n"
    "  --sensor FILE.json  the array is as a description says: its packets or lines, its counts in any file\n"
    "Standard error has warnings of what no real writer makes, and of a damaged recording how many of the "
    "first\n"
    "frames are certain.\n";

/// Something in the command line that cannot be.
struct usage_error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Throws usage_error.
inline arguments read_arguments(std::span<const char* const> words) {
    arguments result;
    const auto next = [&](std::size_t& at, const char* what) {
        if (++at >= words.size())
            throw usage_error(std::string("expected ") + what + ", found the end of the command line");
        return words[at];
    };
    bool only_files = false;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const std::string_view word = words[i];
        if (only_files || word.size() < 2 || word.front() != '-') {
            if (!result.file.empty())
                throw usage_error("expected one file, found " + tactnet::in_quotes(word) + " as well");
            result.file = path_of(word);
        } else if (word == "--") {
            only_files = true;
        } else if (word == "--help" || word == "-h") {
            result.help = true;
        } else if (word == "--csv") {
            result.csv = true;
        } else if (word == "--map") {
            result.map = path_of(next(i, "a map behind --map"));
        } else if (word == "--sensor") {
            result.sensor = path_of(next(i, "a description behind --sensor"));
        } else if (word == "--picture") {
            const std::string_view number = next(i, "the number of a frame behind --picture");
            result.picture = tactnet::whole_number(number);
            if (!result.picture)
                throw usage_error("expected the number of a frame behind --picture, found " +
                                  tactnet::in_quotes(number));
            result.picture_file = path_of(next(i, "a file to draw to behind --picture N"));
        } else {
            throw usage_error("unknown option " + tactnet::in_quotes(word));
        }
    }
    if (result.csv && result.picture)
        throw usage_error("expected --csv or --picture, found both");
    if (!result.map.empty() && !result.sensor.empty())
        throw usage_error("expected --map or --sensor, found both");
    if (result.file.empty() && !result.help)
        throw usage_error("expected a file");
    return result;
}

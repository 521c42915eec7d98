#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

/// What the user asks for.
struct arguments {
    std::filesystem::path file;
    std::filesystem::path map; ///< empty: none
    bool help = false;
    bool csv = false;
    std::optional<std::uint64_t> picture; ///< the number of the frame to draw
    std::filesystem::path picture_file;
};

inline constexpr const char* usage =
    "usage: tactnet_decode [--csv | --picture N OUT.png] [--map FILE.mp] FILE\n"
    "\n"
    "Prints what is in a Tekscan recording (.csv, .asf, .fsx) or map (.mp); its content tells which.\n"
    "  --csv               every frame: a line frame,NUMBER,SECONDS and its rows, with B where no tactel is\n"
    "  --picture N OUT.png draws the frame with the number N\n"
    "  --map FILE.mp       the map of the sensor, which says which cells have a tactel: .fsx does not tell\n"
    "Standard error has warnings of what no real writer makes, and of a damaged recording how many of the "
    "first\n"
    "frames are certain.\n";

/// Something in the command line that cannot be.
struct usage_error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Throws usage_error.
arguments read_arguments(std::span<const char* const> words);

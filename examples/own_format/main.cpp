// tactnet_own_format FILE: what is in a recording of the format in grid_text.hpp. Exit status: 0, or 2 for a
// file that cannot be read or is damaged.

#include "grid_text.hpp"

#include <tactnet/sensors.hpp>

#include <cstdio>
#include <exception>

int main(int count, char** arguments) {
    if (count != 2) {
        std::fputs("usage: tactnet_own_format FILE\n", stderr);
        return 2;
    }
    try {
        const tactnet::recording recording =
            tactnet::decode_all(grid_text(), tactnet::read_file(arguments[1]));
        std::printf("%zu frames of %zu x %zu cells\n", recording.size(), recording.description.rows,
                    recording.description.columns);
        if (!recording.damage)
            return 0;
        std::fprintf(stderr, "%s\n", recording.damage->message(arguments[1]).c_str());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "tactnet_own_format: %s\n", error.what());
    }
    return 2;
}

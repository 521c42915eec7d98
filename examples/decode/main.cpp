// tactnet_decode: what is in a sensor's recording, as a summary, as text or as a picture.
//
// Exit status: 0, or 2 (bad input or arguments, or output that cannot be written). Of a damaged recording the
// whole frames are printed before the error, and standard error reports how many of them are certain. What is
// unlike a real writer is a warning there, and no reason for another exit status.

#include "arguments.hpp"
#if defined(TACTNET_DECODE_DRAWS)
#include <decode_image.hpp>
#include <recording_file.hpp>
#endif

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/sensors/any_recording.hpp>
#include <tactnet/sensors/described/description_file.hpp>
#include <tactnet/sensors/recording.hpp>
#include <tactnet/sensors/text/measures.hpp>
#include <tactnet/sensors/warning.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <program_arguments.hpp>
#include <span>
#include <stack.hpp>
#include <standard_output.hpp>
#include <string>
#include <utility>
#include <vector>

namespace {

constexpr int success = 0, bad_input = 2;

/// To the nanosecond: no sensor is more precise, and sums of tenths do not show.
std::string seconds_text(std::optional<double> seconds) {
    return seconds ? tactnet::shortest_text(std::round(*seconds * 1e9) / 1e9) : "";
}

/// The first and last frame's time, and how many there are.
struct span_of_time {
    std::optional<double> first, last;
    std::uint64_t frames = 0;

    void add(const tactnet::frame_view& frame) {
        if (frames++ == 0)
            first = frame.seconds;
        last = frame.seconds;
    }
};

void print_summary(const tactnet::recording_description& description, const span_of_time& time) {
    std::optional<double> seconds;
    if (time.first && time.last)
        seconds = *time.last - *time.first;
    const auto line = [](const std::string& name, const std::string& value) {
        print(name + ": " + (value.empty() ? "unknown" : value) + "\n");
    };
    line("format", description.format);
    // It comes out of a file that may hold anything.
    const std::string version = tactnet::in_quotes(description.version, 200);
    line("version", version.substr(1, version.size() - 2));
    line("rows", std::to_string(description.rows));
    line("columns", std::to_string(description.columns));
    line("frames", std::to_string(time.frames));
    line("missing cells", std::to_string(description.missing_cells()));
    line("unit", description.unit == tactnet::pressure_unit::raw ? "raw" : "pascal");
    line("seconds", time.frames > 0 ? seconds_text(seconds) : "");
}

void print_frame(const tactnet::frame_view& frame, const tactnet::recording_description& description) {
    std::string text = "frame," + std::to_string(frame.number) + "," + seconds_text(frame.seconds) + "\n";
    for (std::size_t i = 0; i < frame.cells.size(); ++i) {
        text += std::isnan(frame.cells[i]) ? "nan"
                : description.exists(i)    ? tactnet::shortest_text(frame.cells[i])
                                           : "B";
        text += (i + 1) % frame.columns == 0 ? '\n' : ',';
    }
    print(text);
}

#if defined(TACTNET_DECODE_DRAWS)
/// Draws a frame as a PNG file, eight pixels per tactel: counts up to 255 unchanged, anything else so that
/// the largest cell is white; broken cells are black. Throws tactnet::file_error.
void draw(const std::filesystem::path& path, const tactnet::frame_view& frame, tactnet::pressure_unit unit) {
    constexpr std::size_t side = 8;
    float largest = 0;
    for (const float cell : frame.cells)
        largest = std::max(largest, cell); // never NaN
    const bool counts = unit == tactnet::pressure_unit::raw && largest <= 255;
    const float scale = counts || largest == 0 ? 1 : 255 / largest;
    std::vector<std::uint8_t> pixels;
    pixels.reserve(frame.cells.size() * side * side);
    for (std::size_t y = 0; y < frame.rows * side; ++y)
        for (std::size_t x = 0; x < frame.columns * side; ++x)
            if (const float cell = frame(y / side, x / side); std::isnan(cell))
                pixels.push_back(0);
            else
                pixels.push_back(static_cast<std::uint8_t>(std::lround(cell * scale)));
    write_png(path, frame.rows * side, frame.columns * side, pixels);
}
std::vector<std::byte> read_bytes(const std::filesystem::path& path) {
    return read_recording_file(path);
}
#else
std::vector<std::byte> read_bytes(const std::filesystem::path& path) {
    return tactnet::read_file(path);
}
void draw(const std::filesystem::path&, const tactnet::frame_view&, tactnet::pressure_unit) {
    throw usage_error("this program was built without PNG, which --picture needs");
}
#endif

/// Which cells the user's map gives a tactel; empty without a map.
std::vector<std::uint8_t> read_mask(const std::filesystem::path& map) {
    if (map.empty())
        return {};
    tactnet::recording_description description = tactnet::read_recording(map).description;
    if (description.mask.empty())
        throw tactnet::file_error(map.string(), "", "a map of a sensor",
                                  "a recording without one (" + description.format + ")");
    return std::move(description.mask);
}

/// On standard error, which may be closed: what is printed elsewhere goes on.
void print_warnings(const arguments& asked, const tactnet::decoding_warnings& warnings) {
    const std::string file = asked.file.string();
    for (const tactnet::decoding_warning& warning : warnings.kept())
        std::fprintf(stderr, "tactnet_decode: %s: %s: warning: expected %s, found %s\n", file.c_str(),
                     warning.place().c_str(), std::string(warning.expected.view()).c_str(),
                     std::string(warning.found.view()).c_str());
    if (warnings.count() > warnings.kept().size())
        std::fprintf(stderr, "tactnet_decode: %s: %s more warnings\n", file.c_str(),
                     std::to_string(warnings.count() - warnings.kept().size()).c_str());
}

/// Which of the frames that came out can be relied on.
void print_certain(const arguments& asked, std::uint64_t certain, std::uint64_t frames) {
    std::fprintf(stderr, "tactnet_decode: %s: the first %s of %s frames are certain\n",
                 asked.file.string().c_str(), std::to_string(certain).c_str(),
                 std::to_string(frames).c_str());
}

void decode(const arguments& asked) {
    const std::vector<std::uint8_t> mask = read_mask(asked.map);
    const std::vector<std::byte> bytes = read_bytes(asked.file);
    tactnet::any_recording decoder = asked.sensor.empty()
                                         ? tactnet::any_recording(mask)
                                         : tactnet::any_recording(tactnet::read_sensor(asked.sensor));
    span_of_time time;
    bool drawn = false;
    const auto take = [&](const tactnet::frame_view& frame) {
        time.add(frame);
        if (asked.csv)
            print_frame(frame, decoder.description());
        if (asked.picture == frame.number) {
            draw(asked.picture_file, frame, decoder.description().unit);
            drawn = true;
        }
    };
    tactnet::decode_status status = decoder.push(bytes, take);
    if (status != tactnet::decode_status::damaged)
        status = decoder.finish(take);
    const bool damaged = status == tactnet::decode_status::damaged;
    print_warnings(asked, decoder.warnings());
    if (damaged && decoder.frames() > 0)
        print_certain(asked, decoder.certain_frames(), decoder.frames());
    if (!asked.csv && !asked.picture && (!damaged || time.frames > 0))
        print_summary(decoder.description(), time);
    finish_output();
    if (damaged)
        throw tactnet::file_error(asked.file.string(), decoder.error().place(), decoder.error().expected,
                                  decoder.error().outcome());
    if (!mask.empty() && decoder.description().mask != mask)
        throw tactnet::file_error(asked.file.string(), "", "tactels in the cells of the map", "others");
    if (asked.picture && !drawn)
        throw tactnet::file_error(asked.file.string(), "",
                                  "a frame with number " + std::to_string(*asked.picture),
                                  std::to_string(time.frames) + " frames with others");
}

} // namespace

int main(int count, char** words) {
    require_stack("tactnet_decode");
    ignore_output_signals();
    try {
        const program_arguments given(count, words);
        const arguments asked = read_arguments(given.words());
        if (asked.help) {
            print(usage);
            finish_output();
        } else {
            decode(asked);
        }
        return success;
    } catch (const usage_error& error) {
        std::fprintf(stderr, "tactnet_decode: %s\n%s", printable(error.what()).c_str(), usage);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "tactnet_decode: %s\n", printable(error.what()).c_str());
    }
    return bad_input;
}

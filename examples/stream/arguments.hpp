#pragma once

#include "input.hpp"

#include <tactnet/sensors/text/measures.hpp>
#include <tactnet/text/message.hpp>
#include <tactnet/text/numbers.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <program_arguments.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

/// What the user asks for.
struct arguments {
    std::filesystem::path weights, sensor; ///< a description of the array, if any
    std::filesystem::path save;            ///< a folder for images of touches
    std::string port;                      ///< a serial port or pipe; empty: standard input
    unsigned speed = 115200;               ///< of a serial port, in bits per second
    enum class source { frames, own, recording } from = source::frames;
    enum class output { lines, json, picture } as = output::lines;
    std::size_t frames_of_air = 0;
    double rate = 0; ///< frames per second; 0: as they come
    bool paced = false;
    bool awake = false; ///< while it waits
    bool help = false;
};

inline constexpr const char* usage =
    "usage: tactnet_stream [options] WEIGHTS [own | recording] <STREAM\n"
    "\n"
    "Recognises the frames of a sensor one by one, as they arrive at standard input: frames of a byte per\n"
    "tactel, packets of the device in own_device.hpp (own), or a recording (recording). WEIGHTS is of a "
    "network\n"
    "and size that was compiled in, such as tactnet train writes; without weights, --help lists them.\n"
    "  --sensor FILE  the array is as a description in JSON says: its bytes or lines, its counts of any "
    "depth\n"
    "  --port PATH    reads a serial port, such as /dev/ttyACM0, or a pipe, and opens it again if it is "
    "lost\n"
    "  --speed BITS   of the port, per second (115200)\n"
    "  --air N     nothing touches the array in the first N frames (50 will do): learns the baseline from\n"
    "              them, finds faulty tactels and contacts, and recognises touches by all their frames\n"
    "  --save FOLDER  writes the strongest frame of each touch as an image, to train on, with --air and "
    "--sensor;\n"
    "                 WEIGHTS can be left out\n"
    "  --json      a JSON object per frame\n"
    "  --picture   each frame as a picture in a terminal of 24-bit colours, with 50 columns or more\n"
    "  --rate HZ   plays so many frames per second\n"
    "  --paced     plays a recording at its own pace\n"
    "  --awake     does not sleep while frames arrive: answers some microseconds sooner, for a whole "
    "core\n";

/// Something in the command line that cannot be.
struct usage_error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Throws usage_error.
inline arguments read_arguments(std::span<const char* const> words) {
    arguments result;
    bool sourced = false;
    const auto number_behind = [&](std::size_t& at, const char* what) {
        const std::string option = words[at];
        if (++at >= words.size())
            throw usage_error("expected " + std::string(what) + " behind " + option +
                              ", found the end of the command line");
        return std::string_view(words[at]);
    };
    for (std::size_t i = 0; i < words.size(); ++i) {
        const std::string_view word = words[i];
        if (word == "--help" || word == "-h") {
            result.help = true;
        } else if (word == "--air") {
            const std::string_view text = number_behind(i, "a number of frames");
            const auto frames = tactnet::whole_number(text);
            if (!frames || *frames == 0 || *frames > 1'000'000)
                throw usage_error("--air: expected a number of frames from 1 to 1000000, found " +
                                  tactnet::in_quotes(text));
            result.frames_of_air = static_cast<std::size_t>(*frames);
        } else if (word == "--rate") {
            const std::string_view text = number_behind(i, "frames per second");
            const auto read = tactnet::read_floating_point<double>(text.data(), text.data() + text.size());
            if (read.end != text.data() + text.size() || !(read.value >= 0.001 && read.value <= 1e6))
                throw usage_error("--rate: expected frames per second from 0.001 to 1000000, found " +
                                  tactnet::in_quotes(text));
            result.rate = read.value;
        } else if (word == "--sensor") {
            result.sensor = path_of(number_behind(i, "a description of the array"));
        } else if (word == "--save") {
            result.save = path_of(number_behind(i, "a folder"));
        } else if (word == "--port") {
            result.port = number_behind(i, "a port");
        } else if (word == "--speed") {
            const std::string_view text = number_behind(i, "bits per second");
            const auto bits = tactnet::whole_number(text);
            if (!bits || std::ranges::find(port_speeds, *bits, &std::pair<unsigned, speed_t>::first) ==
                             port_speeds.end())
                throw usage_error("--speed: expected 9600, 115200, 921600 or another usual speed up to "
                                  "4000000, found " +
                                  tactnet::in_quotes(text));
            result.speed = static_cast<unsigned>(*bits);
        } else if (word == "--json") {
            result.as = arguments::output::json;
        } else if (word == "--picture") {
            result.as = arguments::output::picture;
        } else if (word == "--paced") {
            result.paced = true;
        } else if (word == "--awake") {
            result.awake = true;
        } else if (word.size() > 1 && word.front() == '-') {
            throw usage_error("unknown option " + tactnet::in_quotes(word));
        } else if (result.weights.empty()) {
            result.weights = path_of(word);
        } else if (!sourced && (word == "own" || word == "recording")) {
            result.from = word == "own" ? arguments::source::own : arguments::source::recording;
            sourced = true;
        } else {
            throw usage_error("expected 'own' or 'recording' behind the weights, found " +
                              tactnet::in_quotes(word));
        }
    }
    if (!result.save.empty() && (result.frames_of_air == 0 || result.sensor.empty()))
        throw usage_error("--save: expected --air, to know touches by, and --sensor");
    if (result.weights.empty() && !result.help && result.save.empty())
        throw usage_error("expected a weight file");
    if (!result.sensor.empty() && result.from != arguments::source::frames)
        throw usage_error("--sensor: expected the stream that it describes, found 'own' or 'recording'");
    if (result.paced && result.from != arguments::source::recording)
        throw usage_error("--paced: expected a recording, which has times; see --rate");
    return result;
}

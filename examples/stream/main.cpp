// tactnet_stream: recognises the frames of a sensor one by one, as they arrive. arguments.hpp says how it is
// called, answer_text.hpp what it writes.
//
// A damaged frame is reported, and what follows is recognised all the same; so is a sensor that stops for a
// while. Exit status: 0, or 2 (bad input, damage in the stream, no frame in it, or output that cannot be
// written).

#include "answer_text.hpp"
#include "arguments.hpp"
#include "own_device.hpp"

#include <tactnet/image/resize.hpp>
#include <tactnet/io.hpp>
#include <tactnet/sensors.hpp>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#ifdef TACTNET_STREAM_SAVES
#include <decode_image.hpp>
#endif
#include <exception>
#include <optional>
#include <program_arguments.hpp>
#include <span>
#include <stack.hpp>
#include <standard_output.hpp>
#include <stdexcept>
#include <stopwatch.hpp>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace {

void complain(const std::string& sentence) {
    std::fprintf(stderr, "tactnet_stream: %s\n", printable(sentence).c_str());
}

/// What comes of frames, one after the other.
class stage {
public:
    stage(const arguments& given, frame_reader& reader, const std::vector<std::string>& classes)
        : given_(given), reader_(reader), classes_(classes) {}

    void take(const tactnet::frame_view& frame) {
        wait_for(frame);
        const answer found = reader_.read(frame);
        if (found.says == answer::state::unreadable) {
            complain("frame " + std::to_string(frame.number) + " cannot be recognised");
            all_well_ = false;
        } else if (found.says != answer::state::learning) {
            write(found);
            save(found);
        }
        ++frames_;
    }
    bool all_well() const { return all_well_; }
    std::size_t frames() const { return frames_; }

private:
    /// Until it is the frame's turn to be played.
    void wait_for(const tactnet::frame_view& frame) {
        std::optional<double> seconds;
        if (given_.paced)
            seconds = frame.seconds;
        else if (given_.rate > 0)
            seconds = static_cast<double>(frames_) / given_.rate;
        if (!seconds)
            return;
        if (!first_)
            first_ = *seconds;
        const double left = *seconds - *first_ - since_first_.seconds();
        if (left > 0) {
            finish_output();
            std::this_thread::sleep_for(std::chrono::duration<double>(std::min(left, longest_pause)));
        }
    }
    void write(const answer& found) {
        if (given_.as != arguments::output::picture)
            print(given_.as == arguments::output::json ? json_line_of(found, classes_)
                                                       : line_of(found, classes_));
        else if (drawn_ == 0 || since_drawn_.seconds() >= 1.0 / 30) { // more pictures cannot be seen
            print((drawn_++ == 0 ? "\x1b[2J" : "") + picture_of(found, classes_));
            since_drawn_ = {};
        }
    }

    /// The strongest frame of a touch, once it is over.
    void save(const answer& found) {
        if (given_.save.empty())
            return;
        if (found.contact->firm && found.contact->force > strongest_) {
            strongest_ = found.contact->force;
            image_.resize(found.counts.size());
            std::ranges::transform(found.counts, image_.begin(), tactnet::saturate_to_count);
        }
        if (!found.contact->ended || std::exchange(strongest_, 0) == 0)
            return;
        std::array<char, 32> name{};
        std::snprintf(name.data(), name.size(), "%06llu.png", static_cast<unsigned long long>(found.number));
#ifdef TACTNET_STREAM_SAVES
        write_png(given_.save / name.data(), image_.size() / found.columns, found.columns, image_);
#else
        throw std::runtime_error("--save: this program was built without PNG");
#endif
    }

    static constexpr double longest_pause = 3600; ///< of a recording whose times leap

    const arguments& given_;
    frame_reader& reader_;
    const std::vector<std::string>& classes_;
    std::optional<double> first_;
    stopwatch since_first_, since_drawn_;
    std::size_t frames_ = 0, drawn_ = 0;
    std::uint32_t strongest_ = 0; ///< force of a touch so far, and its frame
    std::vector<std::uint8_t> image_;
    bool all_well_ = true;
};

/// True if the stream was whole, its frames were recognised and their answers written.
template <class Decoder>
bool run(Decoder decoder, byte_input& input, stage& to) {
    bool whole = true;
    const auto take = [&](const tactnet::frame_view& frame) { to.take(frame); };
    const auto note = [&](tactnet::decode_status status) {
        if (status == tactnet::decode_status::damaged) {
            complain(decoder.error().message());
            whole = false;
        }
    };
    std::size_t total = 0;
    while (const auto bytes = input.read(complain)) {
        total += bytes->size();
        note(decoder.push(*bytes, take));
        finish_output();
    }
    if (whole ||
        !std::is_same_v<Decoder, tactnet::any_recording>) // which has reported its damage, and ends there
        note(decoder.finish(take));
    finish_output();
    // Bytes before the first packet are skipped, so that all of another device's stream would be.
    if (whole && to.frames() == 0) {
        complain("expected frames, found none in " + std::to_string(total) + " bytes");
        return false;
    }
    return whole && to.all_well();
}

std::string size_text(const tactnet::shape& input) {
    return std::to_string(input.rows) + " x " + std::to_string(input.columns);
}
std::string list_of_readers() {
    std::string text;
    for (const compiled_reader& each : compiled_readers())
        text += (text.empty() ? "" : ", ") + std::string(each.network) + " at " + size_text(each.input);
    return text;
}

/// The network and size that a file says it is for; of what it does not say, the first that was compiled in.
compiled_reader reader_for(const tactnet::model_description& says, const std::string& file) {
    for (const compiled_reader& each : compiled_readers())
        if ((says.network.empty() || says.network == each.network) &&
            says.rows.value_or(each.input.rows) == each.input.rows &&
            says.columns.value_or(each.input.columns) == each.input.columns)
            return each;
    const std::string network = says.network.empty() ? "tactnet6" : says.network;
    const std::string size =
        std::to_string(says.rows.value_or(0)) + 'x' + std::to_string(says.columns.value_or(0));
    throw tactnet::file_error(file, "", "a network that was compiled in (" + list_of_readers() + ")",
                              network + " at " + size + ": build with -DTACTNET_STREAM_NETWORKS=" + network +
                                  '=' + size);
}

bool run(const arguments& given) {
    std::optional<tactnet::safetensors> weights;
    tactnet::model_description says;
    tactnet::sensor_description sensor;
    std::optional<tactnet::count_scale> scale;
    if (!given.weights.empty()) {
        weights = tactnet::safetensors::read(given.weights);
        says = tactnet::describe_model(*weights);
    }
    if (!given.sensor.empty()) {
        sensor = tactnet::read_sensor(given.sensor);
        scale = tactnet::count_scale{.full = static_cast<float>(sensor.full_scale.value_or(255))};
        if (!weights)
            says.rows = sensor.frame_rows(), says.columns = sensor.frame_columns();
    }
    const compiled_reader network =
        reader_for(says, tactnet::file_name(weights ? given.weights : given.sensor).string());
    if (!scale)
        sensor = {.rows = network.input.rows, .columns = network.input.columns};
    if (const tactnet::shape array{sensor.frame_rows(), sensor.frame_columns()}; array != network.input)
        throw tactnet::file_error(tactnet::file_name(given.sensor).string(), "",
                                  "an array of " + size_text(network.input) + ", as the network",
                                  size_text(array));
    const auto reader = network.make(weights ? &*weights : nullptr, given.frames_of_air, scale);
    const std::vector<std::string> classes = reader->classes();
    stage to(given, *reader, classes);
    byte_input input(given.port, given.speed, given.awake);
    switch (given.from) {
    case arguments::source::own:
        return run(own_device(), input, to);
    case arguments::source::recording:
        return run(tactnet::any_recording(), input, to);
    case arguments::source::frames:
        break;
    }
    if (sensor.cell == tactnet::cell_type::digits)
        return run(tactnet::text_stream(sensor), input, to);
    return run(tactnet::matrix_stream(sensor), input, to);
}

} // namespace

int main(int count, char** words) {
    require_stack("tactnet_stream");
    ignore_output_signals();
    try {
        const program_arguments asked(count, words);
        const arguments given = read_arguments(asked.words());
        if (given.help) {
            print(usage + ("Compiled in: " + list_of_readers() + ".\n"));
            finish_output();
            return 0;
        }
        return run(given) ? 0 : 2;
    } catch (const usage_error& error) {
        complain(error.what());
        std::fputs(usage, stderr);
    } catch (const std::exception& error) {
        complain(error.what());
    }
    return 2;
}

// tactnet_stream: recognises the frames of a sensor one by one, as they arrive. arguments.hpp says how it is
// called, answer_text.hpp what it writes.
//
// A damaged frame is reported, and what follows is recognised all the same; so is a sensor that stops for a
// while. Exit status: 0, or 2 (bad input, damage in the stream, no frame in it, or output that cannot be
// written).

#include "answer_text.hpp"
#include "arguments.hpp"
#include "own_device.hpp"
#include "touch_reader.hpp"

#include <tactnet/io.hpp>
#include <tactnet/sensors.hpp>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <exception>
#include <optional>
#include <poll.h>
#include <span>
#include <stack.hpp>
#include <standard_output.hpp>
#include <stopwatch.hpp>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

namespace {

void complain(const std::string& sentence) {
    std::fprintf(stderr, "tactnet_stream: %s\n", printable(sentence).c_str());
}

/// What comes of frames, one after the other.
class stage {
public:
    stage(const arguments& given, touch_reader& reader, const std::vector<std::string>& classes)
        : given_(given), reader_(reader), classes_(classes) {}

    void take(const tactnet::frame_view& frame) {
        wait_for(frame);
        const answer found = reader_.read(frame);
        if (found.says == answer::state::unreadable) {
            complain("frame " + std::to_string(frame.number) + " cannot be recognised");
            all_well_ = false;
        } else if (found.says != answer::state::learning) {
            write(found);
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

    static constexpr double longest_pause = 3600; ///< of a recording whose times leap

    const arguments& given_;
    touch_reader& reader_;
    const std::vector<std::string>& classes_;
    std::optional<double> first_;
    stopwatch since_first_, since_drawn_;
    std::size_t frames_ = 0, drawn_ = 0;
    bool all_well_ = true;
};

/// Waits for bytes, and says when none come for a second or more. A file always has some, or ends.
void wait_for_input(bool& silent, const stopwatch& since_last) {
    constexpr int patience = 1000; // milliseconds
    pollfd input{STDIN_FILENO, POLLIN, 0};
    while (::poll(&input, 1, silent ? -1 : patience) == 0) {
        complain("no frame for a second");
        silent = true;
    }
    if (silent) {
        complain("the stream goes on after " + formatted("%.1f", since_last.seconds()) + " s");
        silent = false;
    }
}

/// True if the stream was whole, its frames were recognised and their answers written.
template <class Decoder>
bool run(Decoder decoder, stage& to) {
    bool whole = true;
    const auto take = [&](const tactnet::frame_view& frame) { to.take(frame); };
    const auto note = [&](tactnet::decode_status status) {
        if (status == tactnet::decode_status::damaged) {
            complain(decoder.error().message());
            whole = false;
        }
        return status;
    };
    std::size_t total = 0;
    std::array<std::byte, 4096> bytes;
    ssize_t got = 0;
    bool silent = false;
    for (stopwatch since_last;; since_last = {}) {
        wait_for_input(silent, since_last);
        // Returns with what there is, so that a frame is not kept waiting for the next.
        got = ::read(STDIN_FILENO, bytes.data(), bytes.size());
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            break;
        total += static_cast<std::size_t>(got);
        note(decoder.push(std::span(bytes).first(static_cast<std::size_t>(got)), take));
        finish_output();
    }
    if (got < 0) {
        complain(std::string("cannot read the stream: ") + std::strerror(errno));
        return false;
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

bool run(const arguments& given) {
    const auto network = tactnet::load_deployed<touch_network>(given.weights);
    touch_reader reader(network, given.frames_of_air);
    const std::vector<std::string> classes(network.classes().begin(), network.classes().end());
    stage to(given, reader, classes);
    switch (given.from) {
    case arguments::source::own:
        return run(own_device(), to);
    case arguments::source::recording:
        return run(tactnet::any_recording(), to);
    case arguments::source::frames:
        break;
    }
    return run(tactnet::matrix_stream({.rows = frame_shape.rows, .columns = frame_shape.columns}), to);
}

} // namespace

int main(int count, char** words) {
    require_stack("tactnet_stream");
    ignore_output_signals();
    try {
        const arguments given =
            read_arguments(std::span<const char* const>(words, static_cast<std::size_t>(count)).subspan(1));
        if (given.help) {
            print(usage);
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

#include "reports/gnuplot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace {

/// An open file of the system, closed with its owner. Never 0, 1 or 2: the child puts its own there, one
/// after the other.
class descriptor {
public:
    descriptor() = default;
    explicit descriptor(int given) : number_(::fcntl(given, F_DUPFD_CLOEXEC, 3)) { ::close(given); }
    descriptor(descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    descriptor& operator=(descriptor&& other) noexcept {
        std::swap(number_, other.number_);
        return *this;
    }
    ~descriptor() { close(); }
    void close() {
        if (number_ >= 0)
            ::close(std::exchange(number_, -1));
    }
    int number() const { return number_; }
    bool open() const { return number_ >= 0; }

private:
    int number_ = -1;
};

/// The two ends of a stream; of a socket, since writing to one whose reader is gone need not end the program.
struct stream {
    descriptor ours, theirs;

    stream() {
        std::array<int, 2> ends{};
        if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
            return;
        ours = descriptor(ends[0]);
        theirs = descriptor(ends[1]);
    }
    bool open() const { return ours.open() && theirs.open(); }
};

/// Writes what is left of the text as far as it goes; closes the stream when nothing is, or nobody reads.
void write_some(descriptor& to, std::string_view& rest) {
    const ssize_t count = ::send(to.number(), rest.data(), rest.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count > 0)
        rest.remove_prefix(static_cast<std::size_t>(count));
    else if (errno != EAGAIN && errno != EINTR)
        rest = {};
    if (rest.empty())
        to.close();
}

/// Reads what is there; closes the stream at its end, or when there is more than any picture has.
void read_some(descriptor& from, std::string& text) {
    constexpr std::size_t most = std::size_t{256} << 20;
    std::array<char, 65536> some{};
    const ssize_t count = ::read(from.number(), some.data(), some.size());
    if (count > 0 && text.size() < most)
        text.append(some.data(), static_cast<std::size_t>(count));
    else if (count >= 0 || errno != EINTR)
        from.close();
}

/// All three streams at once: neither side waits for the other for ever.
void converse(stream& in, stream& out, stream& error, std::string_view script, std::string& picture,
              std::string& words) {
    while (out.ours.open() || error.ours.open()) {
        std::array<pollfd, 3> ready{pollfd{in.ours.number(), POLLOUT, 0},
                                    pollfd{out.ours.number(), POLLIN, 0},
                                    pollfd{error.ours.number(), POLLIN, 0}}; // those closed are passed over
        if (::poll(ready.data(), ready.size(), -1) < 0) {
            if (errno == EINTR)
                continue;
            return;
        }
        if (ready[0].revents != 0)
            write_some(in.ours, script);
        if (ready[1].revents != 0)
            read_some(out.ours, picture);
        if (ready[2].revents != 0)
            read_some(error.ours, words);
    }
}

bool is_whole(std::string_view bytes, picture_format format) {
    using namespace std::string_view_literals;
    if (format == picture_format::svg)
        return bytes.starts_with("<?xml"sv) && bytes.ends_with("</svg>\n\n"sv);
    return bytes.starts_with("\x89PNG\r\n\x1A\n"sv) && bytes.ends_with("\0\0\0\0IEND\xAE\x42\x60\x82"sv);
}

/// The first of gnuplot's words that say what was wrong.
std::string first_line(std::string_view words) {
    while (!words.empty()) {
        std::string_view line = words.substr(0, words.find('\n'));
        words.remove_prefix(std::min(line.size() + 1, words.size()));
        line.remove_prefix(std::min(line.find_first_not_of(" \t^"), line.size()));
        if (!line.empty())
            return std::string(line);
    }
    return "";
}

drawn_picture no_drawing(std::string problem) {
    return {{}, std::move(problem)};
}
drawn_picture not_run(int error) {
    return no_drawing(error == ENOENT ? "gnuplot was not found"
                                      : fmt::format("gnuplot could not be run ('{}')",
                                                    std::generic_category().message(error)));
}

} // namespace

drawn_picture draw_picture(std::string_view script, picture_format format) {
    stream in, out, error;
    if (!in.open() || !out.open() || !error.open())
        return not_run(errno);
    std::string program = "gnuplot";
    std::array<char*, 2> arguments{program.data(), nullptr};
    posix_spawn_file_actions_t actions;
    if (const int code = posix_spawn_file_actions_init(&actions); code != 0)
        return not_run(code);
    posix_spawn_file_actions_adddup2(&actions, in.theirs.number(), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, out.theirs.number(), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, error.theirs.number(), STDERR_FILENO);
    pid_t child = 0;
    const int code = posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (code != 0)
        return not_run(code);
    in.theirs.close(), out.theirs.close(), error.theirs.close();
    drawn_picture result;
    std::string words;
    converse(in, out, error, script, result.picture, words);
    in.ours.close(), out.ours.close(), error.ours.close();
    int status = 0;
    while (::waitpid(child, &status, 0) != child)
        if (errno != EINTR)
            return not_run(errno);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && is_whole(result.picture, format))
        return result;
    const std::string line = first_line(words);
    return no_drawing("gnuplot did not draw it" + (line.empty() ? "" : " ('" + line + "')"));
}

#pragma once

// Where bytes come from: standard input, or a port that is opened again whenever it was lost.

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <optional>
#include <span>
#include <stdexcept>
#include <stopwatch.hpp>
#include <string>
#include <thread>
#include <utility>

#if defined(_WIN32)

#include <io.h>

using speed_t = unsigned;
inline constexpr std::array<std::pair<unsigned, speed_t>, 1> port_speeds{{{115200, 115200}}};

/// Standard input alone, which says nothing of silence. Ports have an interface of their own on Windows.
class byte_input {
public:
    byte_input(const std::string& port, unsigned, bool) {
        if (!port.empty())
            throw std::runtime_error("cannot open " + port + ": on Windows, frames come from standard input");
    }
    template <class Say>
    std::optional<std::span<const std::byte>> read(const Say&) {
        const int got = ::_read(0, bytes_.data(), static_cast<unsigned>(bytes_.size()));
        if (got < 0)
            throw std::runtime_error(std::string("cannot read the stream: ") + std::strerror(errno));
        if (got == 0)
            return std::nullopt;
        return std::span(bytes_).first(static_cast<std::size_t>(got));
    }

private:
    std::array<std::byte, 4096> bytes_{};
};

#else

#include <poll.h>
#include <termios.h>
#include <unistd.h>

/// The speeds that every Linux knows, in bits per second.
inline constexpr std::array<std::pair<unsigned, speed_t>, 16> port_speeds{{{9600, B9600},
                                                                           {19200, B19200},
                                                                           {38400, B38400},
                                                                           {57600, B57600},
                                                                           {115200, B115200},
                                                                           {230400, B230400},
                                                                           {460800, B460800},
                                                                           {500000, B500000},
                                                                           {576000, B576000},
                                                                           {921600, B921600},
                                                                           {1000000, B1000000},
                                                                           {1500000, B1500000},
                                                                           {2000000, B2000000},
                                                                           {2500000, B2500000},
                                                                           {3000000, B3000000},
                                                                           {4000000, B4000000}}};

class byte_input {
public:
    /// Standard input if `port` is empty. If `awake`, the thread does not sleep while it waits.
    byte_input(std::string port, unsigned speed, bool awake)
        : port_(std::move(port)), speed_(speed), awake_(awake) {
        if (port_.empty())
            file_ = STDIN_FILENO;
        else if (!open())
            throw std::runtime_error("cannot open " + port_ + ": " + std::strerror(errno));
    }
    byte_input(const byte_input&) = delete;
    byte_input& operator=(const byte_input&) = delete;
    ~byte_input() { close(); }

    /// Waits for bytes and reads what there is, so that a frame is not kept waiting for the next. Nothing at
    /// the end of standard input; a port has no end. `say(sentence)` hears of silence, and of a port that is
    /// lost and found. Throws std::runtime_error if standard input cannot be read.
    template <class Say>
    std::optional<std::span<const std::byte>> read(const Say& say) {
        while (true) {
            if (!wait(say))
                continue;
            const ssize_t got = ::read(file_, bytes_.data(), bytes_.size());
            since_last_ = {};
            if (got > 0)
                return std::span(bytes_).first(static_cast<std::size_t>(got));
            if (got < 0 && (errno == EINTR || errno == EAGAIN))
                continue;
            if (port_.empty() && got == 0)
                return std::nullopt;
            if (port_.empty() || (got < 0 && errno == EISDIR)) // a folder is no port that comes back
                throw std::runtime_error(std::string("cannot read the stream: ") + std::strerror(errno));
            say(port_ + " is lost, and opened again when it is there");
            find_again();
            say(port_ + " is there again");
        }
    }

private:
    /// Whether there may be something to read.
    template <class Say>
    bool wait(const Say& say) {
        constexpr int patience = 1000; // milliseconds
        pollfd input{file_, POLLIN, 0};
        int ready = ::poll(&input, 1, silent_ ? -1 : awake_ ? 0 : patience);
        // Others may have the core in between, such as what brings the bytes.
        for (const stopwatch waited; awake_ && ready == 0 && 1000 * waited.seconds() < patience;
             ready = ::poll(&input, 1, 0))
            std::this_thread::yield();
        if (ready == 0) {
            say("no frame for a second");
            silent_ = true;
            return false;
        }
        if (ready > 0 && silent_) {
            std::array<char, 64> text{};
            std::snprintf(text.data(), text.size(), "the stream goes on after %.1f s", since_last_.seconds());
            say(text.data());
            silent_ = false;
        }
        return ready > 0;
    }

    bool open() {
        file_ = ::open(port_.c_str(), O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
        if (file_ < 0)
            return false;
        termios line{};
        if (::tcgetattr(file_, &line) != 0) // a pipe or a file
            return true;
        ::cfmakeraw(&line);
        line.c_cflag |= CLOCAL | CREAD;
        for (const auto& [bits, code] : port_speeds)
            if (bits == speed_)
                ::cfsetspeed(&line, code);
        if (::tcsetattr(file_, TCSANOW, &line) == 0)
            return true;
        const int why = errno;
        close();
        errno = why;
        return false;
    }
    void find_again() {
        do {
            close();
            ::poll(nullptr, 0, 100); // milliseconds
        } while (!open());
    }
    void close() {
        if (file_ > STDERR_FILENO)
            ::close(file_);
        file_ = -1;
    }

    std::string port_;
    unsigned speed_;
    bool awake_;
    int file_ = -1;
    bool silent_ = false;
    stopwatch since_last_;
    std::array<std::byte, 4096> bytes_{};
};

#endif

#include "run.hpp"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <grp.h>
#include <iterator>
#include <poll.h>
#include <stdexcept>
#include <sys/resource.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>

namespace faults {
namespace {

using clock = std::chrono::steady_clock;

// Before anything may make this process root of a space of its own, where it is no other user.
const bool is_root = ::geteuid() == 0;

int check(int result) {
    if (result < 0)
        throw std::system_error(errno, std::generic_category(), "the attack itself");
    return result;
}

struct channel {
    int ends[2] = {-1, -1};
    channel() { check(::pipe2(ends, O_CLOEXEC)); }
    channel(const channel&) = delete;
    channel& operator=(const channel&) = delete;
    ~channel() { close(0), close(1); }
    void close(int end) {
        if (ends[end] >= 0)
            ::close(ends[end]);
        ends[end] = -1;
    }
};

/// In the child, which may only make system calls: puts `what` in the place of a standard stream.
void place(stream what, int number, int usual) {
    int file = usual;
    int unread[2] = {-1, -1};
    switch (what) {
    case stream::usual:
        break;
    case stream::closed:
        ::close(number);
        return;
    case stream::full:
        file = ::open("/dev/full", O_RDWR);
        break;
    case stream::null:
        file = ::open("/dev/null", O_RDWR);
        break;
    case stream::broken:
        if (::pipe(unread) != 0)
            ::_exit(126);
        ::close(unread[0]);
        file = unread[1];
        break;
    }
    if (::dup2(file, number) < 0)
        ::_exit(126);
    if (file != usual)
        ::close(file);
}

[[noreturn]] void become(char** arguments, char** environment, const char* folder, const conditions& under,
                         const int (&usual)[3]) {
    ::setpgid(0, 0);
    for (const int number : {SIGPIPE, SIGXFSZ, SIGINT, SIGTERM, SIGHUP})
        ::signal(number, SIG_DFL);
    if (::chdir(folder) != 0)
        ::_exit(126);
    const stream streams[3] = {under.in, under.out, under.error};
    for (int number = 0; number < 3; ++number)
        place(streams[number], number, usual[number]);
    if (under.limited_user && is_root &&
        (::setgroups(0, nullptr) != 0 || ::setgid(64'999) != 0 || ::setuid(64'999) != 0))
        ::_exit(126);
    for (const auto& [resource, most] : under.limits) {
        const struct rlimit limit {
            most, most
        };
        if (::setrlimit(static_cast<decltype(RLIMIT_AS)>(resource), &limit) != 0)
            ::_exit(126);
    }
    ::execve(arguments[0], arguments, environment);
    ::_exit(127);
}

void take(int from, std::string& to) {
    char bytes[4096];
    ssize_t got = 0;
    while ((got = ::read(from, bytes, sizeof(bytes))) > 0)
        if (to.size() < std::size_t{1} << 22)
            to.append(bytes, static_cast<std::size_t>(got));
}

/// Waits, takes what is printed, and sends what is to be sent.
void watch(pid_t child, const conditions& under, int out, int error, ending& result) {
    const auto start = clock::now();
    bool sent = under.signal == 0;
    int status = 0;
    for (bool over = false; !over;) {
        const auto now = clock::now() - start;
        if (!sent && now >= under.after)
            sent = true, ::kill(child, under.signal);
        if (now > under.patience && !result.hung)
            result.hung = true, ::kill(-child, SIGKILL);
        over = ::waitpid(child, &status, WNOHANG) == child;
        take(out, result.out);
        take(error, result.error);
        if (!over) {
            struct pollfd waits[2] = {{out, POLLIN, 0}, {error, POLLIN, 0}};
            ::poll(waits, 2, 1);
            if ((waits[0].revents | waits[1].revents) & POLLHUP)
                ::usleep(300);
        }
    }
    ::kill(-child, SIGKILL); // what it has started
    result.took = std::chrono::duration_cast<std::chrono::microseconds>(clock::now() - start);
    if (WIFSIGNALED(status))
        result.signal = WTERMSIG(status);
    else
        result.status = WEXITSTATUS(status);
}

} // namespace

std::string ending::text() const {
    std::string first = error.substr(0, 300);
    while (!first.empty() && first.back() == '\n')
        first.pop_back();
    if (hung)
        return "hung; " + first;
    return (signal != 0 ? "signal " + std::to_string(signal) : "exit status " + std::to_string(status)) +
           (first.empty() ? ", no message" : "; " + first);
}

ending run(const words& command, const fs::path& folder, const conditions& under) {
    words texts = command;
    std::vector<char*> arguments;
    for (std::string& text : texts)
        arguments.push_back(text.data());
    arguments.push_back(nullptr);
    std::string path = under.pictures ? "PATH=/usr/local/bin:/usr/bin:/bin" : "PATH=/nowhere",
                language = "LC_ALL=C";
    // Built with the address sanitizer, a program looks for leaks in a thread that limits do not let it have.
    std::string leaks = under.limits.empty() ? "ASAN_OPTIONS=" : "ASAN_OPTIONS=detect_leaks=0";
    std::string library = std::string("LD_PRELOAD=") + TACTNET_CLOCK_LIBRARY,
                clock = "TACTNET_CLOCK=" + under.clock;
    char* environment[] = {path.data(),  language.data(),
                           leaks.data(), under.clock.empty() ? nullptr : library.data(),
                           clock.data(), nullptr};

    channel in, out, error;
    // More than a pipe holds would have to be written while it is read.
    if (under.input.size() > 60'000)
        throw std::logic_error("the attack itself: too much input");
    const pid_t child = check(::fork());
    if (child == 0)
        become(arguments.data(), environment, folder.c_str(), under,
               {in.ends[0], out.ends[1], error.ends[1]});
    in.close(0), out.close(1), error.close(1);
    for (const int file : {out.ends[0], error.ends[0]})
        check(::fcntl(file, F_SETFL, O_NONBLOCK));
    static_cast<void>(!::write(in.ends[1], under.input.data(), under.input.size()));
    in.close(1);
    ending result;
    watch(child, under, out.ends[0], error.ends[0], result);
    return result;
}

std::string shell_line(const words& command, const fs::path& folder, const conditions& under) {
    const auto quoted = [](const std::string& word) {
        if (!word.empty() && word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                                    "0123456789_-./,=") == std::string::npos)
            return word;
        std::string text = "'";
        for (const char c : word)
            text += c == '\'' ? std::string("'\\''") : std::string(1, c);
        return text + "'";
    };
    std::string line = "cd " + quoted(folder.string()) + " &&";
    for (const auto& [resource, most] : under.limits)
        line += " [limit " + std::to_string(resource) + ": " + std::to_string(most) + "]";
    if (!under.clock.empty())
        line += " LD_PRELOAD=" + quoted(TACTNET_CLOCK_LIBRARY) + " TACTNET_CLOCK=" + under.clock;
    for (const std::string& word : command)
        line += " " + quoted(word);
    const char* const ends[] = {"", "&-", "/dev/full", " [broken pipe]", "/dev/null"};
    const std::pair<stream, const char*> streams[] = {
        {under.in, " <"}, {under.out, " >"}, {under.error, " 2>"}};
    for (const auto& [what, sign] : streams)
        if (what != stream::usual)
            line += sign + std::string(ends[static_cast<int>(what)]);
    if (under.signal != 0)
        line += " [signal " + std::to_string(under.signal) + " after " + std::to_string(under.after.count()) +
                " us]";
    return line;
}

std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void write_bytes(const fs::path& file, const std::string& bytes) {
    std::ofstream stream(file, std::ios::binary | std::ios::trunc);
    stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!stream.flush())
        throw std::runtime_error("the attack itself cannot write " + file.string());
}

} // namespace faults

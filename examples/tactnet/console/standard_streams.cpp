#include "console/standard_streams.hpp"

#include <tactnet/io/file_error.hpp>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <fcntl.h>
#include <system_error>
#include <unistd.h>

namespace {

[[noreturn]] void output_is_lost() {
    const int error = errno != 0 ? errno : EIO;
    throw tactnet::file_error("standard output", "", "to write all results",
                              fmt::format("'{}'", std::generic_category().message(error)));
}

} // namespace

void prepare_standard_streams() noexcept {
    // A new file gets the lowest free number. Open for reading only, so that what is printed fails as it does
    // on a closed stream.
    int file = 0;
    do
        file = ::open("/dev/null", O_RDONLY);
    while (file >= 0 && file <= STDERR_FILENO);
    if (file >= 0)
        ::close(file);
    struct sigaction ignore {};
    ignore.sa_handler = SIG_IGN;
    sigaction(SIGPIPE, &ignore, nullptr);
    sigaction(SIGXFSZ, &ignore, nullptr);
}

void show(std::string_view text) noexcept {
    static_cast<void>(std::fwrite(text.data(), 1, text.size(), stderr));
    static_cast<void>(std::fflush(stderr));
}

void print(std::string_view text) {
    errno = 0;
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size())
        output_is_lost();
}

void finish_output() {
    errno = 0;
    if (std::ferror(stdout) != 0 || std::fflush(stdout) != 0)
        output_is_lost();
}

#include "standard_output.hpp"

#include <tactnet/io/file_error.hpp>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <string>
#include <system_error>

namespace {

[[noreturn]] void output_is_lost() {
    const int error = errno != 0 ? errno : EIO;
    throw tactnet::file_error("standard output", "", "to write all results",
                              "'" + std::generic_category().message(error) + "'");
}

} // namespace

void ignore_output_signals() noexcept {
#if defined(SIGPIPE)
    std::signal(SIGPIPE, SIG_IGN);
#endif
#if defined(SIGXFSZ)
    std::signal(SIGXFSZ, SIG_IGN);
#endif
}

void print(std::string_view text) {
    errno = 0;
    if (!text.empty() && std::fwrite(text.data(), 1, text.size(), stdout) != text.size())
        output_is_lost();
}

void finish_output() {
    errno = 0;
    if (std::ferror(stdout) != 0 || std::fflush(stdout) != 0)
        output_is_lost();
}

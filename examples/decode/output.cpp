#include "output.hpp"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <system_error>

namespace {

[[noreturn]] void fail() {
    throw std::system_error(errno != 0 ? errno : EIO, std::generic_category(), "cannot write the output");
}

} // namespace

void survive_closed_output() {
#if defined(SIGPIPE)
    std::signal(SIGPIPE, SIG_IGN);
#endif
}

void print(std::string_view text) {
    errno = 0;
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size())
        fail();
}

void flush_output() {
    errno = 0;
    if (std::fflush(stdout) != 0)
        fail();
}

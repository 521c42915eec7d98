#include "console/standard_streams.hpp"

#include <csignal>
#include <cstdio>
#include <fcntl.h>
#include <unistd.h>

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
    if (!text.empty())
        static_cast<void>(std::fwrite(text.data(), 1, text.size(), stderr));
    static_cast<void>(std::fflush(stderr));
}

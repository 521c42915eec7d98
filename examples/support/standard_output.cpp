#include "standard_output.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/text/message.hpp>

#include <cerrno>
#include <csignal>
#include <cstddef>
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

std::string printable(std::string_view text) {
    std::string shown;
    while (!text.empty()) {
        const std::size_t length = tactnet::utf8_sequence_length(text);
        const std::string_view character = text.substr(0, length == 0 ? 1 : length);
        if (length > 0 && tactnet::is_visible(character))
            shown += character;
        else
            for (const char c : character) {
                constexpr std::string_view digits = "0123456789abcdef";
                const auto byte = static_cast<unsigned char>(c);
                shown += "\\x";
                shown += digits[byte / 16];
                shown += digits[byte % 16];
            }
        text.remove_prefix(character.size());
    }
    return shown;
}

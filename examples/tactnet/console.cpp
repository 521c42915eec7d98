#include "console.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fcntl.h>
#include <functional>
#include <interrupt.hpp>
#include <thread>
#include <unistd.h>

void prepare_standard_streams() noexcept {
#if !defined(_WIN32)
    // A new file gets the lowest free number. For reading only: printing fails as on a closed stream.
    int file = 0;
    do
        file = ::open("/dev/null", O_RDONLY);
    while (file >= 0 && file <= STDERR_FILENO);
    if (file >= 0)
        ::close(file);
#endif
    ignore_output_signals();
}

std::string shortened(std::string text) {
    constexpr std::size_t most = 1000;
    if (text.size() <= most)
        return text;
    const auto is_inside_character = [&](std::size_t at) {
        return (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
    };
    std::size_t first = most / 2 - 5, last = text.size() - first;
    while (is_inside_character(first))
        --first;
    while (is_inside_character(last))
        ++last;
    return text.replace(first, last - first, " … ");
}

void show(std::string_view text) noexcept {
    if (!text.empty())
        static_cast<void>(std::fwrite(text.data(), 1, text.size(), stderr));
    static_cast<void>(std::fflush(stderr));
}

progress::progress() : terminal_(::isatty(STDERR_FILENO) == 1) {}

void progress::show(const std::string& text, bool final) {
    const double now = watch_.seconds();
    if (now < next_ && !final)
        return;
    next_ = now + (terminal_ ? 0.1 : 5.0);
    if (!terminal_) {
        tell("{}\n", text);
        return;
    }
    tell("\r{:<{}}", text, width_);
    width_ = std::max(width_, text.size());
    open_ = true;
    if (final)
        end_line();
}

void progress::end_line() {
    if (open_)
        ::show("\n");
    open_ = false;
}

std::string duration_text(double seconds) {
    const auto whole = static_cast<long long>(std::llround(std::max(seconds, 0.0)));
    if (whole < 60)
        return fmt::format("{} s", whole);
    if (whole < 3600)
        return fmt::format("{} min {} s", whole / 60, whole % 60);
    return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

std::string time_left(double seconds, std::size_t done, std::size_t left) {
    return duration_text(seconds / static_cast<double>(done) * static_cast<double>(left)) + " left";
}

bool wait_until(const std::function<bool()>& ready, const std::string& sentence) {
    for (bool told = false; !ready(); std::this_thread::sleep_for(std::chrono::milliseconds(200))) {
        if (interrupted())
            return false;
        if (!std::exchange(told, true))
            tell("{}\n", sentence);
    }
    return true;
}

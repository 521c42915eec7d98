// The clocks of a program that this library is loaded into before all others (LD_PRELOAD). TACTNET_CLOCK says
// how they go.

#include <cerrno>
#include <cstdlib>
#include <ctime>
#include <string_view>
#include <sys/syscall.h>
#include <unistd.h>

extern "C" __attribute__((visibility("default"))) int clock_gettime(clockid_t which,
                                                                    timespec* time) noexcept {
    const char* const value = std::getenv("TACTNET_CLOCK");
    const std::string_view mode = value != nullptr ? value : "";
    if (::syscall(SYS_clock_gettime, which, time) != 0)
        return -1;
    const long nanoseconds = time->tv_nsec;
    if (mode == "still") {
        *time = {1'700'000'000, 0};
    } else if (mode == "backwards") {
        *time = {4'000'000'000 - time->tv_sec, 999'999'999 - nanoseconds};
    } else if (mode == "leaps") { // to and fro by up to 35 minutes
        time->tv_sec += nanoseconds / 1000 * 7919 % 4201 - 2100;
    } else if (mode == "slow") { // a second takes a quarter of an hour
        static const long long began = time->tv_sec * 1'000'000'000LL + nanoseconds;
        const long long now = began + (time->tv_sec * 1'000'000'000LL + nanoseconds - began) / 1000;
        *time = {static_cast<time_t>(now / 1'000'000'000), static_cast<long>(now % 1'000'000'000)};
    } else if (mode == "early") { // before 1970
        time->tv_sec -= 5'000'000'000;
    } else if (mode == "late") { // beyond what 64 bits of nanoseconds hold
        time->tv_sec += 9'300'000'000;
    } else if (mode == "refused") {
        errno = EINVAL;
        return -1;
    }
    return 0;
}

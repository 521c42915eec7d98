#include "interrupt.hpp"

#include <atomic>
#include <csignal>

namespace {

std::atomic<bool> caught = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may not wait for a lock");

extern "C" void on_interrupt(int) {
    caught = true;
}

} // namespace

void catch_interrupts() {
#if defined(_WIN32) // where a handler serves once by itself
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
#else
    struct sigaction action {};
    action.sa_handler = on_interrupt;
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    // A terminal that closes sends this twice, by the shell and by the system; nohup has it ignored.
    action.sa_flags = static_cast<int>(SA_RESTART);
    struct sigaction before {};
    if (sigaction(SIGHUP, nullptr, &before) == 0 && before.sa_handler != SIG_IGN)
        sigaction(SIGHUP, &action, nullptr);
#endif
}

bool interrupted() {
    return caught;
}

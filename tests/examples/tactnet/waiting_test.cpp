// Waiting for what other programs do, and for a clock.

#include <doctest/doctest.h>

#include <console.hpp>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <functional>
#include <interrupt.hpp>
#include <stopwatch.hpp>
#include <string>
#include <support/files/temporary_folder.hpp>
#include <support/run_program.hpp>
#include <sys/wait.h>
#include <unistd.h>

namespace {

struct outcome {
    int status;
    std::string said;
};

/// Of work in a process of its own, for an interruption stays with a process: the exit status is its result.
outcome of_process(const std::function<int()>& work) {
    const support::temporary_folder folder;
    const std::string error = (folder / "error").string();
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        const int file = ::open(error.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        ::dup2(file, STDERR_FILENO);
        ::_exit(work());
    }
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status), support::text_of(error)};
}

} // namespace

TEST_SUITE("program") {
    TEST_CASE("wait_until: asks until it is ready or interrupted, and says once why it waits") {
        struct {
            int ready_at, interrupted_at; ///< by the number of the question
            bool ready;
            int asked;
            const char* said;
        } const cases[]{
            {1, 9, true, 1, ""}, // what is ready is not waited for
            {4, 9, true, 4, "waiting for {another} program\n"},
            {6, 2, false, 2, "waiting for {another} program\n"},
            {1, 0, true, 1, ""}, // what is ready is taken, also after an interruption
        };
        for (const auto& c : cases) {
            CAPTURE(c.ready_at);
            CAPTURE(c.interrupted_at);
            const outcome found = of_process([&] {
                int asked = 0;
                catch_interrupts();
                const auto interrupt = [&] {
                    if (asked == c.interrupted_at)
                        static_cast<void>(std::raise(SIGTERM));
                };
                interrupt();
                const bool ready = wait_until(
                    [&] {
                        ++asked;
                        interrupt();
                        return asked >= c.ready_at;
                    },
                    "waiting for {another} program");
                return ready ? asked : 100 + asked;
            });
            CHECK(found.status == (c.ready ? c.asked : 100 + c.asked));
            CHECK(found.said == c.said);
        }
    }
}

TEST_CASE("progress: a line of a terminal ends, so that what follows begins a new one") {
    const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
    REQUIRE(terminal >= 0);
    REQUIRE(grantpt(terminal) == 0);
    REQUIRE(unlockpt(terminal) == 0);
    const int standard_error = ::dup(STDERR_FILENO), user_side = ::open(ptsname(terminal), O_RDWR | O_NOCTTY);
    REQUIRE(user_side >= 0);
    ::dup2(user_side, STDERR_FILENO);
    {
        progress line;
        line.show("1 of 2");
        line.show("2 of 2", true);
        line.end_line(); // of no line
    }
    ::dup2(standard_error, STDERR_FILENO);
    std::string shown; // which may come in pieces
    for (char byte = 0; byte != '\n' && ::read(terminal, &byte, 1) == 1;)
        shown += byte;
    CHECK(shown == "\r1 of 2\r2 of 2\r\n");
    for (const int file : {standard_error, user_side, terminal})
        ::close(file);
}

TEST_CASE("median_microseconds: work that takes no time has a time all the same") {
    const double found = median_microseconds([] {});
    CHECK(found >= 0);
    CHECK(found < 1);
}

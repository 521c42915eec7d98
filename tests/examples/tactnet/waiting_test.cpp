// Waiting for what other programs do, and for a clock.

#include <doctest/doctest.h>

#include <console/progress.hpp>
#include <csignal>
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
    TEST_CASE("wait_until: what is ready is not waited for, nor told") {
        const outcome found = of_process([] {
            int asked = 0;
            const bool there = wait_until([&] { return ++asked == 1; }, "waiting");
            return there ? asked : 100;
        });
        CHECK(found.status == 1);
        CHECK(found.said.empty());
    }

    TEST_CASE("wait_until: asks until it is ready, and says once why it waits") {
        const outcome found = of_process([] {
            int asked = 0;
            const bool there = wait_until([&] { return ++asked == 4; }, "waiting for {another} program");
            return there ? asked : 100;
        });
        CHECK(found.status == 4);
        CHECK(found.said == "waiting for {another} program\n");
    }

    TEST_CASE("wait_until: an interruption ends it") {
        const outcome found = of_process([] {
            int asked = 0;
            catch_interrupts();
            const bool there = wait_until(
                [&] {
                    if (++asked == 2)
                        static_cast<void>(std::raise(SIGTERM));
                    return asked > 5;
                },
                "waiting");
            return there ? 100 : asked;
        });
        CHECK(found.status == 2);
        CHECK(found.said == "waiting\n");
    }

    TEST_CASE("wait_until: what is ready is taken, also after an interruption") {
        const outcome found = of_process([] {
            catch_interrupts();
            static_cast<void>(std::raise(SIGTERM));
            return wait_until([] { return true; }, "waiting") ? 1 : 0;
        });
        CHECK(found.status == 1);
    }
}

TEST_CASE("median_microseconds: work that takes no time has a time all the same") {
    const double found = median_microseconds([] {});
    CHECK(found >= 0);
    CHECK(found < 1);
}

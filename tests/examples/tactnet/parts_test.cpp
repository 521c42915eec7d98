// Numbers on the command line and in the metadata of weight files; waiting for other programs and for a
// clock.

#include "workshop.hpp"

#include <tactnet/text/message.hpp>

#include <console.hpp>
#include <cstdlib>
#include <functional>
#include <interrupt.hpp>
#include <number_options.hpp>
#include <stopwatch.hpp>

using namespace support;

namespace {

/// Runs `work` in a process of its own, since an interruption stays with a process. Its result is the exit
/// status.
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
    return {status_of(status), "", text_of(error)};
}

} // namespace

TEST_SUITE("program") {
    TEST_CASE("shortened: a sentence of at most 1000 bytes, whose characters stay whole") {
        CHECK(shortened(std::string(1000, 'x')) == std::string(1000, 'x'));
        for (std::size_t before = 0; before < 4; ++before) {
            std::string text(before, 'x');
            for (std::size_t i = 0; i < 1000; ++i)
                text += "€";
            const std::string found = shortened(text + "end\n");
            CHECK(found.size() <= 1000);
            CHECK(found.size() > 980);
            CHECK(found.ends_with("€end\n"));
            CHECK(tactnet::is_utf8(found));
        }
    }

    TEST_CASE("number_options: what counts as a number") {
        constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
        CHECK(whole_number_of("0") == 0);
        CHECK(whole_number_of("+7") == 7);
        CHECK(whole_number_of("18446744073709551615") == most);
        for (const char* text : {"", "+", "-1", "-0", "010", "0x1F", "1.5", "1e3", " 1", "1 ", "one", "true",
                                 "nan", "18446744073709551616", "99999999999999999999999"})
            CHECK_MESSAGE(!whole_number_of(text), text);
        CHECK(number_of("0.25") == 0.25);
        CHECK(number_of("-1e-3") == -1e-3);
        CHECK(number_of("+.5") == 0.5);
        CHECK(number_of("0") == 0.0);
        for (const char* text : {"", "+", "+-1", "nan", "NaN", "-nan", "nan(1)", "inf", "-inf", "Infinity",
                                 "1e999", "0x1p3", "1,5", " 1", "1 ", "1e", "half"})
            CHECK_MESSAGE(!number_of(text), text);
        CHECK(is_share(0));
        CHECK(!is_share(1));
        CHECK(!is_share(-0.1));
        CHECK(!is_share(std::numeric_limits<double>::quiet_NaN()));
    }

    TEST_CASE("number_options: numbers that mean nothing are refused, for every option of every command") {
        const workshop shop;
        const words train = shop.train_arguments("--output net"), evaluate("evaluate --data DATA"),
                    simulate("simulate --out made"), weights("classify --weights net image.png"),
                    listing("list");
        const auto refuses = [&](const words& command, const std::string& option,
                                 std::initializer_list<const char*> values) {
            for (const char* value : values) {
                words all = command;
                all.insert(all.begin() + 1, option + "=" + value);
                shop.refuses(all, option + ": expected a ");
            }
        };
        const std::pair<const words&, const char*> shares_and_rates[]{
            {train, "--validation"},    {train, "--test"},       {train, "--rate"},
            {evaluate, "--test"},       {evaluate, "--rate"},    {train, "--checkpoint-every"},
            {evaluate, "--validation"}, {evaluate, "--epsilon"}, {weights, "--epsilon"}};
        for (const auto& [command, option] : shares_and_rates)
            refuses(command, option, {"nan", "-1", ""});
        const std::pair<const words&, const char*> whole_numbers[]{
            {evaluate, "--seed"},   {simulate, "--seed"},      {evaluate, "--jobs"},
            {evaluate, "--splits"}, {evaluate, "--rows"},      {evaluate, "--epochs"},
            {evaluate, "--batch"},  {weights, "--columns"},    {train, "--self-test"},
            {listing, "--classes"}, {simulate, "--per-class"}, {simulate, "--threads"}};
        for (const auto& [command, option] : whole_numbers)
            refuses(command, option, {"18446744073709551616", "-1", "010"});
        for (const std::string size :
             {"7x", "x13", "-7x13", " 7x13", "7x13x1", "18446744073709551623x13", "7 x 13"})
            says(shop.refuses(evaluate + words{"--sizes", size},
                              ": expected a size that it was compiled for ("),
                 "), found '" + size + "'; sizes are chosen when building");
    }

    TEST_CASE("evaluate: seeds that run over, and tests without images, are refused; the last seed is not") {
        const workshop shop;
        const auto arguments = [](const char* more) {
            return words("evaluate --data DATA --rows 7 --columns 13 --method svm-linear --results r "
                         "--split random") +
                   more;
        };
        shop.refuses(arguments("--seed 18446744073709551615 --splits 3"),
                     "--seed, --splits: expected seeds below 2^64 for all splits, found 3 of them from "
                     "18446744073709551615 on");
        says_not(shop.succeeds(arguments("--seed 18446744073709551615 --splits 1")).out, "nan");
        says(shop.text("r/evaluation.jsonl"), "\"seed\":\"18446744073709551615\"");

        // Two images a class, of which a small share is none.
        shop.keep_images(2);
        shop.refuses(
            arguments("--test 0.1"),
            "data: expected enough images for a test, of which --test takes a share of 0.1, found 6 of 3 "
            "classes");
    }

    TEST_CASE("evaluate: a split in the metadata of --weights that means nothing is refused") {
        const workshop shop;
        shop.trains("--method svm-linear --output net");
        const char* const statements[][3] = {
            {"test_share", "nan", "metadata 'test_share': expected a share from 0 to below 1, found 'nan'"},
            {"validation_share", "0.9", "expected shares that leave some images for training, found 0.9 to "},
            {"seed", "-1", "metadata 'seed': expected a whole number below 2^64, found '-1'"}};
        for (const auto& [key, value, sentence] : statements) {
            rewrite_metadata(shop / "net", shop / "says", key, value);
            shop.refuses("evaluate --weights says --data DATA", sentence);
        }
    }

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
            CHECK(found.error == c.said);
        }
    }

    TEST_CASE("progress: a line of a terminal ends, so that what follows begins a new one") {
        const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
        REQUIRE(terminal >= 0);
        REQUIRE(grantpt(terminal) == 0);
        REQUIRE(unlockpt(terminal) == 0);
        const int standard_error = ::dup(STDERR_FILENO),
                  user_side = ::open(ptsname(terminal), O_RDWR | O_NOCTTY);
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
        std::size_t calls = 0; // with a clock of any speed
        median_microseconds([&] { ++calls; }, 100);
        CHECK(calls <= 1100);
    }
}

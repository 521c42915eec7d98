// Names of files and classes that do more than name: to a terminal, a shell, gnuplot, or the program that
// opens them.

#include "study/rows.hpp"
#include "workshop.hpp"

#include <tactnet/io/file_error.hpp>

#include <cstdlib>
#include <reports/pictures.hpp>
#include <standard_output.hpp>
#include <study/page.hpp>
#include <sys/stat.h>

using namespace support;

namespace {

/// The program's environment with another gnuplot.
class own_gnuplot {
public:
    /// `script`: of a shell; none: there is no gnuplot.
    own_gnuplot(const fs::path& folder, const std::string& script) : before_(std::getenv("PATH")) {
        fs::create_directories(folder);
        if (!script.empty()) {
            tactnet::write_file(folder / "gnuplot", "#!/bin/sh\nPATH='" + before_ + "'\n" + script);
            fs::permissions(folder / "gnuplot", fs::perms::owner_all);
        }
        setenv("PATH", folder.c_str(), 1);
    }
    own_gnuplot(const own_gnuplot&) = delete;
    own_gnuplot& operator=(const own_gnuplot&) = delete;
    ~own_gnuplot() { setenv("PATH", before_.c_str(), 1); }

private:
    std::string before_;
};

std::vector<tactnet::epoch_report> history(bool validated) {
    std::vector<tactnet::epoch_report> epochs;
    for (std::size_t e = 1; e <= 3; ++e) {
        tactnet::epoch_report& report = epochs.emplace_back();
        report.epoch = e, report.rate = 0.1, report.loss = 1.0 / static_cast<double>(e);
        if (validated)
            report.validation_loss = 1.5 * report.loss, report.validation_accuracy = 1 - 0.5 * report.loss;
    }
    return epochs;
}

/// What is wrong with a picture: nothing for a whole one, in colour as gnuplot's are.
std::string decode_error(const fs::path& picture) {
    try {
        decode_image(picture);
    } catch (const tactnet::file_error& error) {
        return error.expected() == "a grey image" ? "" : error.what();
    }
    return "";
}

const char* const shell_names[] = {"|touch broken",
                                   "<touch broken",
                                   "-e system(\"touch broken\")",
                                   "a\nb",
                                   "it's `touch broken`",
                                   "$(touch broken)",
                                   "\"; touch broken",
                                   "%s{}@#\\",
                                   "; touch broken"};

} // namespace

TEST_SUITE("program") {
    TEST_CASE("printable: one line, without what a terminal obeys") {
        CHECK(printable("plain name, caf\xC3\xA9 \xE2\x80\xA6 ±.png") ==
              "plain name, caf\xC3\xA9 \xE2\x80\xA6 ±.png");
        CHECK(printable("a\nb\tc\r\x7F") == "a\\x0ab\\x09c\\x0d\\x7f");
        CHECK(printable("\x1B[31mred") == "\\x1b[31mred");
        CHECK(printable("\xC2\x9B"
                        "31m\xC2\xA0") == "\\xc2\\x9b31m\xC2\xA0"); // CSI in one character
        CHECK(printable("\xE2\x80\xAEgnp.\xE2\x81\xA9") ==
              "\\xe2\\x80\\xaegnp.\\xe2\\x81\\xa9");           // right to left
        CHECK(printable("\xE2\x80\xA8") == "\\xe2\\x80\\xa8"); // a line's end
        CHECK(printable("\xFF\xC3") == "\\xff\\xc3");
        CHECK(printable(std::string_view("\0", 1)) == "\\x00");
    }

    TEST_CASE("names: no commands of gnuplot or a shell, and they keep their pictures") {
        if (std::system("gnuplot --version >/dev/null 2>&1") != 0) {
            MESSAGE("skipped: there is no gnuplot");
            return;
        }
        const workshop shop;
        const fs::path before = fs::current_path();
        fs::current_path(shop.work()); // where commands would leave their traces
        for (const std::string name : shell_names) {
            CAPTURE(name);
            tactnet::confusion_matrix confusion(2);
            confusion.add(0, 0);
            confusion.add(1, 0);
            plot_learning_curves(name, name, history(true));
            CHECK(decode_error(name + ".png").empty());
            fs::remove(name + ".png");
            plot_confusion(name, name, confusion, {name, "other"});
            CHECK(decode_error(name + ".png").empty());
            study_row row = studied(name, 0.9, 10), larger = row;
            larger.values["rows"] = 28;
            draw_study_pictures({row, larger}, fs::path("in") / name);
            for (const char* picture : {"accuracy_and_time.png", "accuracy_and_tactels.png"})
                CHECK(decode_error(fs::path("in") / name / picture).empty());
        }
        for (const auto& entry : fs::recursive_directory_iterator("."))
            CHECK_MESSAGE(entry.path().filename().string().find("broken") != 0, entry.path().string());
        // Without validation there is nothing to measure the accuracy by.
        plot_learning_curves("short", "without validation", history(false));
        CHECK(decode_error("short.png").empty());
        fs::current_path(before);
    }

    TEST_CASE("names: pictures are whole or not there, and it is said why") {
        const workshop shop;
        write_png(shop / "whole.png", 3, 3, std::vector<std::uint8_t>(9));
        const fs::path picture = shop / "out/it's.confusion.png";
        const std::string file = (shop / "whole.png").string(), found = "gnuplot did not draw it",
                          draws = "cat >/dev/null\ncat " + file + "\n";
        const std::pair<std::string, std::string> cases[]{
            {draws, ""},
            {"head -c 50 " + file + "\n", found}, // as on a full disk, without a word
            {"cat >/dev/null\nprintf '\\n  ^\\nundefined\\n' >&2\nexit 1\n", found + " ('undefined')"},
            {"exit 0\n", found},         // reads nothing either
            {draws + "exit 1\n", found}, // whole, but gnuplot has failed
            {"", "gnuplot was not found"},
        };
        for (const auto& [script, problem] : cases) {
            CAPTURE(script);
            fs::remove_all(shop / "bin");
            const own_gnuplot fake(shop.work() / "bin", script);
            const outcome result = shop.trains("--method svm-linear --output out/it's");
            CHECK(fs::exists(picture) == problem.empty());
            if (problem.empty())
                CHECK(text_of(picture) == shop.text("whole.png"));
            else
                says(result.error, "out/it's.confusion.png is not drawn: " + problem +
                                       "; its numbers are in out/it's.confusion.csv\n");
        }
    }

    TEST_CASE("names: hostile ones are printed so that a terminal shows them") {
        const workshop shop;
        const std::string hostile = "\x1B[2J\nok", shown = "\\x1b[2J\\x0aok";
        shop.refuses({"train", "--data", hostile, "--output", "net", "--method", "svm-linear", "--rows", "7",
                      "--columns", "13"},
                     "tactnet: " + shown + ": expected a folder");
        for (const std::vector<std::string>& arguments :
             {std::vector<std::string>{"list", hostile},
              {"list", "--classes", hostile},
              {"classify", "--weights", hostile, hostile},
              {"train", "--data", shop.data().string(), "--output", "net", "--method", hostile}}) {
            const outcome result = shop.run(arguments);
            CHECK(result.status == 2);
            says_not(result.error, "\x1B");
            says(result.error, "\\x1b[2J");
        }
        const outcome trained = shop.train({"--method", "svm-linear", "--output", hostile + "/net"});
        CHECK(trained.status == 0);
        CHECK(trained.out.starts_with(shown + "/net: trained in "));
        says_not(trained.error, "\x1B");

        // What a file says of itself.
        rewrite_metadata(shop.work() / hostile / "net", shop / "says", "network", hostile);
        shop.refuses("classify --weights says x.png", shown);
    }

    TEST_CASE("names: pipes are not waited for") {
        const workshop shop;
        shop.trains("--method svm-linear --output net");
        for (const char* name : {"pipe", "pipe.png"})
            REQUIRE(mkfifo((shop / name).c_str(), 0600) == 0);
        const std::string found = "expected a regular file, found a named pipe";
        fs::create_directory(shop / "made");
        fs::create_directory(shop / "r");
        for (const char* name : {"made/simulation.json", "r/evaluation.jsonl"})
            REQUIRE(mkfifo((shop / name).c_str(), 0600) == 0);
        shop.refuses_each({
            {"classify --weights net pipe.png", "pipe.png: " + found},
            {"classify --weights pipe IMAGE", "pipe: " + found},
            {"classify --weights net --classes pipe IMAGE", "pipe: " + found},
            {shop.train_arguments("--start pipe --output x"), "pipe: " + found},
            {"simulate --out made", "simulation.json: " + found},
            {"evaluate --data DATA --method svm-linear --rows 7 --columns 13 --results r",
             "evaluation.jsonl: " + found},
        });
        // One that a shell made ends with its writer, and is read.
        const auto piped =
            run_program("cat '" + shop.image().string() + "' | " TACTNET_PROGRAM " classify --weights '" +
                        (shop / "net").string() + "' /dev/stdin");
        CHECK_MESSAGE(piped.status == 0, piped.error);

        REQUIRE(mkfifo((shop.data() / "right" / "image99.png").c_str(), 0600) == 0);
        shop.refuses(shop.train_arguments("--output x"), "image99.png: " + found);
        fs::remove(shop.data() / "right" / "image99.png");
        fs::create_directory_symlink("gone", shop.data() / "fourth");
        shop.refuses(shop.train_arguments("--output x"),
                     "fourth: expected a link to something that is there, found one to 'gone'");
    }
}

// What may go wrong around the program: streams that take nothing, names that are the same file, disks that
// are full, other programs at work, a program that was killed.

#include "workshop.hpp"

#include <atomic>
#include <files/claims.hpp>

using namespace support;

namespace {

/// A command of the shell in the workshop's folder.
program_result in_shell(const workshop& shop, const std::string& command) {
    return run_program("cd '" + shop.work().string() + "' && " + command);
}
std::string program() {
    return "'" TACTNET_PROGRAM "'";
}
std::string training(const workshop& shop, const std::string& more) {
    return program() + " train --data '" + shop.data().string() +
           "' --method tactnet4 --rows 7 --columns 13 --seed 5 " + more;
}

} // namespace

TEST_SUITE("program") {
    TEST_CASE("standard_output: results that cannot be printed are no success") {
        const workshop shop; // faults.attack has every command, and messages that cannot be shown
        for (const char* end : {" >/dev/full", " >&-"})
            says(in_shell(shop, program() + " list" + end).error,
                 "standard output: expected to write all results");
        const program_result trained = in_shell(shop, training(shop, "--epochs 1 --output net >/dev/full"));
        CHECK(trained.status == 2);
        CHECK(fs::exists(shop / "net")); // what does not go to the standard output
        CHECK_FALSE(fs::exists(shop / "net.checkpoint"));
        // Nobody reads the pipe: an error too, and no end by a signal.
        CHECK(in_shell(shop, "exec bash -c \"set -o pipefail; { sleep 1; " + program() + " list; } | true\"")
                  .status == 2);
    }

    TEST_CASE("output_files: one file under two names is refused") {
        const workshop shop;
        shop.trains("--epochs 2 --output net");
        const std::string kept = shop.text("net");
        fs::create_symlink("net", shop / "link");
        fs::create_hard_link(shop / "net", shop / "hard");
        fs::create_symlink("later", shop / "dangling");
        fs::create_directory_symlink(".", shop / "here");
        tactnet::write_file(shop / "names", "one\ntwo\nthree\n");
        fs::create_directory(shop / "results");
        for (const char* file : {"table.csv", "confusion_net.csv"})
            fs::create_symlink("../net", shop / "results" / file);
        const auto training = [&](const words& more) { return shop.train_arguments(more); };
        const std::string same = "which are the same", different = ": expected different files";
        shop.refuses_each({
            {training("--output w --checkpoint w"),
             "--output and --checkpoint: expected different files, found 'w' for both"},
            {training("--output w --checkpoint ./here/w"), same},
            {training("--output later --checkpoint dangling"), same},
            {training("--output net --checkpoint link --afresh"), same},
            {training("--output net --checkpoint hard --afresh"), same},
            {training("--output net --start link"), "--start and --output" + different},
            {training("--output w --start net --checkpoint net --afresh"),
             "--start and --checkpoint" + different},
            {training("--output w --checkpoint w.learning.csv"), "--checkpoint and --output" + different},
            {training("--output w --checkpoint net --afresh"),
             "net: expected a checkpoint, which --afresh gives up, found another file"},
            {"export --weights net --output net", "--weights and --output" + different},
            {"export --weights net --output link", "--weights and --output" + different},
            {"export --weights net --output hard", "--weights and --output" + different},
            {"export --weights net --output here/net", "--weights and --output" + different},
            {"export --weights net --onnx --output net", "--weights and --output" + different},
            {"export --weights net --onnx --packing at-start --output net.onnx",
             "--onnx: expected an ONNX file"},
            {"export --weights net --classes names --output names", "--classes and --output" + different},
            {"evaluate --data DATA --method tactnet4 --rows 7 --columns 13 --start net",
             "--start and --results" + different},
            {"evaluate --data DATA --weights net", "--weights and --results" + different},
        });
        CHECK(shop.text("net") == kept);
    }

    TEST_CASE("output_files: nothing is written among the images") {
        const workshop shop;
        for (const char* output : {"left/net", "new/net", "left/image0.png"})
            shop.refuses(shop.train_arguments({"--output", (shop.data() / output).string()}),
                         "--output: expected a place outside the folders of classes");
        shop.refuses({"evaluate", "--data", shop.data().string(), "--method", "tactnet4", "--rows", "7",
                      "--columns", "13", "--results", (shop.data() / "results").string()},
                     "--results: expected a place outside the folders of classes");
        shop.trains({"--epochs", "1", "--output", (shop.data() / "net").string()});
    }

    TEST_CASE("output_files: names are tried before the work") {
        const workshop shop;
        const std::string too_long = "'File name too long'";
        for (const auto& [output, sentence] : std::initializer_list<std::pair<std::string, std::string>>{
                 {std::string(300, 'a'),
                  "expected the name of a file that can be written, found " + too_long},
                 {"new/" + std::string(300, 'a') + "/net", too_long},
                 {std::string(250, 'a'), too_long}, // its reports' names are longer
                 {"/dev/null", "--output: expected the name of a file to write, found a device or a pipe at "
                               "/dev/null"}}) {
            // A training that has begun would report its first progress.
            const std::string error = shop.refuses(shop.train_arguments({"--output", output}), sentence);
            says_not(error, "to train");
        }
        shop.refuses(shop.train_arguments("--output net --checkpoint /dev/null"),
                     "--checkpoint: expected the name of a file to write, found a device or a pipe");
        CHECK(fs::exists("/dev/null"));
    }

    TEST_CASE("checkpoint: one that cannot be written does not end a training") {
        const workshop shop;
        // In blocks of 512 bytes: enough for the weights, not for a checkpoint with three times as much.
        const program_result trained =
            in_shell(shop, "ulimit -f 100 && " + training(shop, "--epochs 40 --output net "
                                                                "--checkpoint-every 0.00001"));
        CHECK_MESSAGE(trained.status == 0, trained.error);
        says(trained.error, "warning: no checkpoint of epoch ");
        says(trained.error, "'File too large'); the training goes on");
        CHECK(fs::exists(shop / "net"));

        // Room for the weights and not for the history of so many epochs: what is safe is said.
        const program_result half =
            in_shell(shop, "ulimit -f 100 && " + training(shop, "--epochs 1500 --output half"));
        CHECK(half.status == 2);
        says(half.error, "the weights are whole in half; what failed is about them");
        says(half.error, "half.learning.csv: expected to write all bytes, found 'File too large'");
        says_not(half.error, "no checkpoint of the finished");
        shop.succeeds("classify --weights half IMAGE");

        // No room even for the weights: an error, and no end by SIGXFSZ.
        const program_result full =
            in_shell(shop, "ulimit -f 10 && " + training(shop, "--epochs 2 --output full"));
        CHECK(full.status == 2);
        says(full.error, "full: expected to write all bytes, found 'File too large'");
        CHECK_FALSE(fs::exists(shop / "full"));
    }

    TEST_CASE("checkpoint: a training whose results cannot be written is kept") {
        const workshop shop;
        // What the weights need is taken away while the training runs.
        const auto arguments = [&](words more) {
            more += "--epochs 1500 --output out/net --checkpoint kept";
            return shop.train_arguments(more);
        };
        const pid_t child = shop.start(arguments({}));
        shop.wait_for_first_epoch(child);
        fs::create_directories(shop / "out" / "net" / "in the way");
        const outcome failed = shop.wait(child);
        CHECK(failed.status == 2);
        says(failed.error, "the finished training is kept");
        fs::remove_all(shop / "out");
        shop.succeeds(arguments("--resume"));
        CHECK_FALSE(fs::exists(shop / "kept"));
        shop.trains("--epochs 1500 --output whole");
        CHECK(shop.text("out/net") == shop.text("whole"));
    }

    TEST_CASE("checkpoint: a closed terminal leaves one") {
        const workshop shop;
        const auto before = std::signal(SIGHUP, SIG_DFL); // nohup has it ignored, by children too
        const pid_t child = shop.start(shop.train_arguments("--epochs 100000 --output net"));
        std::signal(SIGHUP, before);
        shop.wait_for_first_epoch(child);
        // By the shell and by the system; what comes before the previous one is caught counts as the
        // same.
        for (int i = 0; i < 10; ++i) {
            kill(child, SIGHUP);
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        CHECK(shop.wait(child).status == 130);
        CHECK(fs::exists(shop / "net.checkpoint"));
    }

    TEST_CASE("output_files: what a killed program left half-written goes with the next run") {
        const workshop shop;
        const std::string name = ".tactnet-17-0.partial";
        fs::create_directories(shop / "results");
        for (const char* folder : {".", "results"})
            tactnet::write_file(shop / folder / name, "half");
        shop.trains("--epochs 1 --output net");
        CHECK_FALSE(fs::exists(shop / name.c_str()));
        CHECK(fs::exists(shop / "results" / name));
        tactnet::write_file(shop / name.c_str(), "half");
        shop.succeeds("export --weights net --output net.hpp");
        shop.succeeds("export --weights net --onnx --output net.onnx");
        CHECK(shop.text("net.onnx").find("counts") != std::string::npos);
        CHECK_FALSE(fs::exists(shop / name.c_str()));
        shop.succeeds("evaluate --data DATA --weights net");
        CHECK_FALSE(fs::exists(shop / "results" / name));
        fs::create_directory(shop / "results" / "predictions");
        tactnet::write_file(shop / "results" / "predictions" / name, "half");
        shop.succeeds("evaluate --data DATA --method tactnet4 --rows 7 --columns 13 --splits 1 --epochs 1 "
                      "--split random");
        CHECK_FALSE(fs::exists(shop / "results" / "predictions" / name));

        // A simulation goes on, also with nothing else in its folder.
        fs::create_directory(shop / "made");
        tactnet::write_file(shop / "made" / name, "half");
        const words simulation("simulate --out made --per-class 1");
        shop.succeeds(simulation);
        CHECK_FALSE(fs::exists(shop / "made" / name));
        tactnet::write_file(shop / "made" / "rock" / name, "half");
        shop.succeeds(simulation);
        CHECK_FALSE(fs::exists(shop / "made" / "rock" / name));
    }

    TEST_CASE("output_files: two trainings of one file are refused, however it is named") {
        const workshop shop;
        fs::create_directory_symlink(".", shop / "here");
        const pid_t first = shop.start(shop.train_arguments("--epochs 1000000 --output new/net"));
        shop.wait_for_first_epoch(first);
        const std::string sentence = "found another training at work on ";
        for (const char* more : {"--method tactnet4 --output new/net", "--method svm-linear --output new/net",
                                 "--method tactnet4 --output here/new/net --afresh",
                                 "--method tactnet4 --output new/net --resume",
                                 "--method tactnet4 --output other --checkpoint new/net.checkpoint"}) {
            const program_result second =
                in_shell(shop, program() + " train --data '" + shop.data().string() +
                                   "' --rows 7 --columns 13 " + std::string(more));
            CHECK(second.status == 2);
            says(second.error, sentence);
        }
        // Beside it there is room, and a killed one has no claim any more.
        CHECK(in_shell(shop, training(shop, "--epochs 2 --output new/beside")).status == 0);
        CHECK(shop.stop(first, SIGKILL).status == 1000 + SIGKILL);
        shop.trains("--epochs 2 --output new/net --afresh");
        for (const std::string& name : shop.everything())
            says_not(name, ".lock");
        // A refused one leaves no folder.
        shop.refuses(shop.train_arguments("--output a/b/net --data nothing"), "nothing");
    }

    TEST_CASE("claims: one holder at a time, while others come and go") {
        // The lock file goes with its holder, perhaps just when another one has opened it.
        const support::temporary_folder folder;
        std::atomic<int> granted = 0, holders = 0, together = 0;
        {
            std::vector<std::jthread> threads;
            for (int t = 0; t < 4; ++t)
                threads.emplace_back([&] {
                    claims mine;
                    while (granted < 500) {
                        if (mine.take(folder / "net")) {
                            together += ++holders > 1;
                            ++granted;
                            std::this_thread::yield();
                            --holders;
                            mine.release(folder / "net");
                        }
                        std::this_thread::yield();
                    }
                });
        }
        CHECK(together == 0);
        CHECK(fs::is_empty(folder.path()));
    }

    TEST_CASE("evaluate: the claim of a program that was killed just before its end is removed") {
        const workshop shop;
        const words arguments(
            "evaluate --data DATA --method tactnet4 --rows 7 --columns 13 --epochs 2 --splits 1 "
            "--results r");
        shop.succeeds(arguments);
        const auto locks = [&] {
            const std::set<std::string> files = shop.everything();
            return std::count_if(files.begin(), files.end(), [](const std::string& name) {
                return name.find(".lock") != std::string::npos;
            });
        };
        const pid_t holder = shop.start(shop.train_arguments("--epochs 1000000 --output r/net"));
        shop.wait_for_first_epoch(holder);
        const auto held = locks();
        CHECK(held > 0);
        // No program holds this lock: no training is left that would take it over.
        tactnet::write_file(shop / "r" / ".tactnet-0123456789abcdef.lock", "");
        tactnet::write_file(shop / "r" / ".tactnet-my.lock", "somebody's");
        shop.succeeds(arguments);
        CHECK(locks() == held + 1);
        CHECK(fs::exists(shop / "r" / ".tactnet-my.lock"));
        CHECK(shop.stop(holder, SIGKILL).status == 1000 + SIGKILL);
        shop.succeeds(arguments);
        CHECK(locks() == 1);
    }

    TEST_CASE("claims: names are apart, one to be given up is waited for, folders that stay empty go") {
        const support::temporary_folder folder;
        {
            claims first, second;
            REQUIRE(first.take(folder / "net"));
            CHECK_FALSE(second.take(folder / "net"));
            const std::jthread ends([&] {
                std::this_thread::sleep_for(std::chrono::milliseconds(50));
                first.release(folder / "net");
            });
            CHECK(second.take_soon(folder / "net"));
        }
        {
            claims mine, others;
            CHECK(mine.take(folder / "a/b/net"));
            CHECK(mine.take(folder / "a/other"));
            CHECK_FALSE(others.take(folder / "a/b/net"));
            CHECK_FALSE(others.take(folder / "a/b/../b/net"));
            CHECK(others.take(folder / "a/b/more"));
            mine.release(folder / "a/b/net");
            CHECK(others.take(folder / "a/b/net"));
            mine.release(folder / "never taken");
        }
        CHECK(fs::is_empty(folder.path()));
    }

    TEST_CASE("checkpoint: one without a checksum is accepted, with a message") {
        const workshop shop;
        const pid_t child = shop.start(shop.train_arguments("--epochs 1500 --output net"));
        shop.wait_for_first_epoch(child);
        REQUIRE(shop.stop(child, SIGINT).status == 130);
        // As an earlier version wrote it.
        tactnet::write_file(shop / "net.checkpoint", without_checksum(shop.text("net.checkpoint")));
        says(shop.trains("--epochs 1500 --output net --resume").error,
             "net.checkpoint: no checksum in it, so that damage may go unnoticed");
    }

    TEST_CASE("study: programs on one folder share the work") {
        const workshop shop;
        const words arguments("study --data DATA --methods tactnet4 --sizes 7x13 --recipes default --bits 32 "
                              "--jobs 1 --splits 6 --results r");
        const pid_t children[] = {shop.start(arguments), shop.start(arguments), shop.start(arguments)};
        for (const pid_t child : children)
            CHECK(shop.wait(child).status == 0);
        CHECK(shop.lines("r/evaluation.jsonl").size() == 12); // not 36
        CHECK(shop.lines("r/timings.jsonl").size() == 1);
        CHECK(shop.lines("r/study.csv").size() == 2);

        // What a killed one had begun is done by another.
        fs::remove_all(shop / "r");
        const pid_t killed = shop.start(arguments), goes_on = shop.start(arguments);
        shop.wait_for_file("r/evaluation.jsonl");
        kill(killed, SIGKILL);
        CHECK(shop.wait(goes_on).status == 0);
        CHECK(shop.wait(killed).status == 1000 + SIGKILL);
        CHECK(shop.lines("r/evaluation.jsonl").size() == 12);
        // The lock of the killed one is taken over by the next to do that training.
        fs::remove(shop / "r" / "evaluation.jsonl");
        shop.succeeds(arguments);
        for (const std::string& name : shop.everything())
            says_not(name, ".lock");
    }
}

// A stopped training goes on.

#include "../workshop.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

using namespace support;

TEST_SUITE("program") {
    TEST_CASE("resume: stopped by Ctrl-C and resumed, the same bits as in one go") {
        const workshop shop;
        constexpr const char* epochs = "1500";
        const pid_t child = shop.start(shop.train_arguments({"--epochs", epochs, "--output", "net"}));
        shop.wait_for_first_epoch(child);
        kill(child, SIGINT);
        const outcome stopped = shop.wait(child);
        REQUIRE_MESSAGE(stopped.status == 130, stopped.error);
        says(stopped.error, "--resume goes on from net.checkpoint");
        CHECK(fs::exists(shop / "net.checkpoint"));
        CHECK_FALSE(fs::exists(shop / "net"));

        const auto kept = text_of(shop / "net.checkpoint");
        shop.refuses(shop.train_arguments({"--epochs", epochs, "--output", "net", "--resume", "--seed", "6"}),
                     "net.checkpoint: setting 'seed' of the stopped training: expected ");

        // It is given up only when asked, by whatever settings it is found.
        for (const char* other_epochs : {epochs, "2"})
            shop.refuses(shop.train_arguments({"--epochs", other_epochs, "--output", "net"}),
                         "net.checkpoint: expected no checkpoint here, found one of an unfinished training; "
                         "--resume goes on from it, --afresh gives it up, --checkpoint takes another name");
        shop.refuses(shop.train_arguments("--output net --resume --afresh"), "--afresh");
        CHECK(text_of(shop / "net.checkpoint") == kept);
        REQUIRE(shop.train("--epochs 2 --output net --checkpoint other").status == 0);
        fs::remove(shop / "net");
        CHECK(text_of(shop / "net.checkpoint") == kept);
        REQUIRE(shop.train("--epochs 2 --output net --afresh").status == 0);
        CHECK_FALSE(fs::exists(shop / "net.checkpoint"));
        fs::remove(shop / "net");

        // More epochs than the recipe has.
        tactnet::write_file(shop / "net.checkpoint", kept);
        rewrite<double>(shop / "net.checkpoint", shop / "long.checkpoint", "progress",
                        [](std::vector<double>& v) { v.resize(6 + 4 * 1501); });
        shop.refuses(shop.train_arguments({"--epochs", epochs, "--output", "net", "--resume", "--checkpoint",
                                           "long.checkpoint"}),
                     "long.checkpoint: tensor 'progress': expected the numbers of this training, found");
        REQUIRE(shop.train({"--epochs", epochs, "--output", "net", "--resume"}).status == 0);
        CHECK_FALSE(fs::exists(shop / "net.checkpoint"));
        REQUIRE(shop.train({"--epochs", epochs, "--output", "whole"}).status == 0);
        CHECK(text_of(shop / "net") == text_of(shop / "whole"));
    }

    TEST_CASE("resume: what started from a weight file goes on from that one only") {
        const workshop shop;
        REQUIRE(shop.train("--epochs 1 --output first").status == 0);
        REQUIRE(shop.train("--epochs 1 --seed 6 --output other").status == 0);
        const auto arguments = [&](const char* output, const char* start) {
            return shop.train_arguments({"--epochs", "1500", "--output", output, "--start", start});
        };
        const pid_t child = shop.start(arguments("net", "first"));
        shop.wait_for_first_epoch(child);
        kill(child, SIGINT);
        REQUIRE(shop.wait(child).status == 130);
        const auto resumed = [](std::vector<std::string> all) {
            all.emplace_back("--resume");
            return all;
        };
        shop.refuses(resumed(arguments("net", "other")), "setting 'start' of the stopped training");
        shop.refuses(resumed(shop.train_arguments("--epochs 1500 --output net")), "of the stopped training");
        REQUIRE(shop.run(resumed(arguments("net", "first"))).status == 0);
        REQUIRE(shop.run(arguments("whole", "first")).status == 0);
        CHECK(text_of(shop / "net") == text_of(shop / "whole"));
    }
}

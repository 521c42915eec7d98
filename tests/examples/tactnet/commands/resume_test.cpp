// A stopped training goes on.

#include "../workshop.hpp"

#include <doctest/doctest.h>

#include <csignal>
#include <string>
#include <vector>

using namespace support;

TEST_SUITE("program") {
    TEST_CASE("resume: stopped by Ctrl-C and resumed, the same bits as in one go") {
        const workshop shop;
        constexpr const char* epochs = "1500";
        const pid_t child = shop.start(shop.train_arguments({"--epochs", epochs, "--output", "net"}));
        shop.wait_for_first_epoch(child);
        const outcome stopped = shop.stop(child, SIGINT);
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
        shop.trains("--epochs 2 --output net --checkpoint other");
        fs::remove(shop / "net");
        CHECK(text_of(shop / "net.checkpoint") == kept);
        shop.trains("--epochs 2 --output net --afresh");
        CHECK_FALSE(fs::exists(shop / "net.checkpoint"));
        fs::remove(shop / "net");

        // More epochs than the recipe has.
        tactnet::write_file(shop / "net.checkpoint", kept);
        rewrite<double>(shop / "net.checkpoint", shop / "long.checkpoint", "progress",
                        [](std::vector<double>& v) { v.resize(6 + 4 * 1501); });
        shop.refuses(shop.train_arguments({"--epochs", epochs, "--output", "net", "--resume", "--checkpoint",
                                           "long.checkpoint"}),
                     "long.checkpoint: tensor 'progress': expected the numbers of this training, found");
        shop.trains({"--epochs", epochs, "--output", "net", "--resume"});
        CHECK_FALSE(fs::exists(shop / "net.checkpoint"));
        shop.trains({"--epochs", epochs, "--output", "whole"});
        CHECK(text_of(shop / "net") == text_of(shop / "whole"));
    }

    TEST_CASE("resume: what started from a weight file goes on from that one only") {
        const workshop shop;
        shop.trains("--epochs 1 --output first");
        shop.trains("--epochs 1 --seed 6 --output other");
        const auto arguments = [&](const char* output, const char* start) {
            return shop.train_arguments({"--epochs", "1500", "--output", output, "--start", start});
        };
        const pid_t child = shop.start(arguments("net", "first"));
        shop.wait_for_first_epoch(child);
        REQUIRE(shop.stop(child, SIGINT).status == 130);
        const auto resumed = [](std::vector<std::string> all) {
            all.emplace_back("--resume");
            return all;
        };
        shop.refuses(resumed(arguments("net", "other")), "setting 'start' of the stopped training");
        shop.refuses(resumed(shop.train_arguments("--epochs 1500 --output net")), "of the stopped training");
        shop.succeeds(resumed(arguments("net", "first")));
        shop.succeeds(arguments("whole", "first"));
        CHECK(text_of(shop / "net") == text_of(shop / "whole"));
    }
}

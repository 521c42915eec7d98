// tactnet simulate.

#include "../workshop.hpp"

using namespace support;

TEST_SUITE("program") {
    TEST_CASE("simulate: a folder that a training takes, from a seed, on any number of threads") {
        const workshop shop;
        const auto simulate = [&](const char* out, words more) {
            more.insert(more.begin(), {"simulate", "--out", out, "--per-class", "2"});
            return shop.succeeds(more).out;
        };
        says(simulate("one", "--threads 1"), "44 images of 22 classes");
        simulate("three", "--threads 3");
        simulate("other", "--seed 2");
        simulate("ideal", "--scene ideal");
        std::size_t files = 0, same = 0;
        for (const auto& entry : fs::recursive_directory_iterator(shop / "one"))
            if (entry.path().extension() == ".png") {
                const fs::path inside = fs::relative(entry.path(), shop / "one");
                const tactnet::grey_image image = decode_image(entry.path());
                CHECK((image.rows == 28 && image.columns == 50));
                CHECK(image.pixels == decode_image(shop / "three" / inside).pixels);
                same += image.pixels == decode_image(shop / "other" / inside).pixels;
                same += image.pixels == decode_image(shop / "ideal" / inside).pixels;
                ++files;
            }
        CHECK(files == 44);
        CHECK(same == 0);

        // A folder begun with these settings is continued, any other left alone.
        fs::remove(shop / "one" / "rock" / "00002.png");
        simulate("one", {});
        CHECK(shop.text("one/rock/00002.png") == shop.text("three/rock/00002.png"));
        shop.refuses_each({
            {"simulate --out one --per-class 3", "expected images of the same simulation"},
            {"simulate --out DATA", "expected a new folder, an empty one"},
            {{"simulate", "--out", ""}, "found no name"},
            {"simulate --out one/simulation.json/in", "expected to make the folder"},
            {"simulate --out new --scene none", "--scene: none not in {"},
        });
        // A note that is cut short, or of levels without end, which would take a stack without end.
        for (const std::string& note : {std::string("{\"scene\": "), std::string(100'000, '['),
                                        std::string(100'000, '[') + std::string(100'000, ']')}) {
            tactnet::write_file(shop / "other" / "simulation.json", note);
            shop.refuses("simulate --out other --per-class 2",
                         "simulation.json: expected images of the same simulation, {\"images per class\":2,");
        }

        // Ended at its very beginning, it can still be continued.
        fs::create_directory(shop / "begun");
        fs::copy(shop / "one" / "simulation.json", shop / "begun");
        simulate("begun", {});
        CHECK(shop.text("begun/rock/00002.png") == shop.text("three/rock/00002.png"));
    }

    TEST_CASE("simulate: Ctrl-C, then the same command goes on; two at once do no harm") {
        const workshop shop;
        const auto command = [](const char* out) {
            return "simulate --per-class 40 --seed 3 --threads 1" + words{"--out", out};
        };
        const pid_t child = shop.start(command("stopped"));
        shop.wait_for_file("stopped/ball/00002.png");
        const outcome stopped = shop.stop(child, SIGINT);
        CHECK(stopped.status == 130);
        says(stopped.error, "the same command goes on");
        const pid_t one = shop.start(command("stopped")), two = shop.start(command("stopped"));
        CHECK(shop.wait(one).status == 0);
        CHECK(shop.wait(two).status == 0);
        shop.succeeds(command("whole"));
        std::size_t files = 0;
        for (const auto& entry : fs::recursive_directory_iterator(shop / "stopped")) {
            if (!entry.is_regular_file())
                continue;
            CHECK(text_of(entry.path()) == shop.text("whole" / fs::relative(entry.path(), shop / "stopped")));
            ++files;
        }
        CHECK(files == 22 * 40 + 1); // with the note, and nothing half-written
    }
}

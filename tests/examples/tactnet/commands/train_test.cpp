// tactnet train, also stopped and resumed.

#include "../workshop.hpp"

#include <tactnet/training/recipe.hpp>

#include <fmt/format.h>

#include <cmath>

using namespace support;

TEST_SUITE("program") {
    TEST_CASE("train: the file is evaluated and classifies") {
        const workshop shop;
        const outcome trained = shop.trains("--epochs 15 --output out/net.safetensors");
        says(trained.out, "test accuracy");
        for (const char* name :
             {"net.safetensors", "net.learning.csv", "net.confusion.csv", "net.predictions.csv"})
            CHECK_MESSAGE(fs::exists(shop / "out" / name), name);
        // A picture, or a message.
        for (const std::string name : {"net.learning.png", "net.confusion.png"})
            CHECK(fs::exists(shop / "out" / name) !=
                  (trained.error.find(name + " is not drawn") != std::string::npos));
        CHECK(shop.lines("out/net.learning.csv").size() == 16);
        CHECK(shop.lines("out/net.predictions.csv")[0] ==
              "path,group,label,prediction,p left,\"p middle, of all\",p right");
        CHECK(shop.lines("out/net.predictions.csv").size() == 7);
        CHECK(shop.lines("out/net.confusion.csv")[0] == "true class,left,\"middle, of all\",right");
        CHECK_FALSE(fs::exists(shop / "out/net.safetensors.checkpoint"));

        // A network of three classes, however many the program was compiled for.
        const auto file = tactnet::safetensors::read(shop / "out/net.safetensors");
        file.require_extents("fc.bias", std::vector<std::size_t>{3});
        CHECK(file.metadata().at("network") == "tactnet4");
        CHECK(file.metadata().at("classes") == "[\"left\",\"middle, of all\",\"right\"]");
        CHECK(file.metadata().at("seed") == "5");
        CHECK(file.contains("selftest.logits"));
        CHECK(file.contains("input_mean"));

        // The split's test images give the same accuracy again.
        const outcome tested = shop.succeeds("evaluate --weights out/net.safetensors --data DATA");
        const auto accuracy = std::stod(file.metadata().at("test_accuracy"));
        says(tested.out, "tactnet4  7x13");
        CHECK(accuracy > 0.5); // three bright bars: nearly all are right
        const outcome all = shop.succeeds("evaluate --weights out/net.safetensors --data DATA --images all");
        says(all.out, "     36  ");

        const std::string image = shop.image(1, 3).string();
        const outcome named = shop.succeeds({"classify", "--weights", "out/net.safetensors", image, image});
        const auto lines = lines_of(named.out);
        REQUIRE(lines.size() == 2);
        CHECK(lines[0] == lines[1]);
        CHECK(lines[0].starts_with("\"" + image + "\",1,\"middle, of all\",0."));

        // Probabilities are of a temperature that the validation images gave; files without one have 1.
        const double temperature = std::stod(file.metadata().at("temperature"));
        CHECK(temperature != 1);
        says(tested.out, fmt::format(" {:.2f} ", temperature));
        CHECK(fs::exists(shop / "results/reliability_net.csv"));
        tactnet::safetensors_writer without = copy_of(file);
        without.metadata.erase("temperature");
        without.write(shop / "out/plain.safetensors");
        const outcome plain = shop.succeeds({"classify", "--weights", "out/plain.safetensors", image});
        const auto probability = [](const std::string& line) {
            return std::stod(line.substr(line.rfind(',') + 1));
        };
        const double softmax = probability(lines_of(plain.out)[0]), scaled = probability(lines[0]);
        CHECK((scaled > softmax) == (temperature < 1));
        shop.succeeds("export --weights out/net.safetensors --output net.hpp");
        const std::string header = text_of(shop / "net.hpp"), before = ", classes.size(), ";
        REQUIRE(header.find(before) != std::string::npos);
        CHECK(std::stod(header.substr(header.find(before) + before.size())) == temperature);

        // Another size only when asked.
        write_png(shop / "large.png", 14, 26, std::vector<std::uint8_t>(14 * 26, 50));
        shop.refuses("classify --weights out/net.safetensors large.png",
                     "large.png: expected 7 x 13 pixels (rows x columns), or --resize, found 14 x 26");
        shop.succeeds("classify --resize --weights out/net.safetensors large.png");
    }

    TEST_CASE("train: images choose the augmentation, unless an option or a published recipe does") {
        const workshop shop;
        const auto printed = [&](const std::string& more) {
            return shop.trains(more + " --afresh --output net").error;
        };
        // The bar on the right is narrower than that on the left, and bars have no upside.
        const std::string off = "reflections of columns: off, since reflected images resemble no class";
        says(printed("--epochs 2"), off);
        says_not(printed("--epochs 2"), "reflections of rows");
        says(printed("--epochs 2 --recipe thorough"), off);
        says(printed("--epochs 2"), "too few images or epochs for short trainings");
        says_not(printed("--epochs 40"), "too few");
        CHECK(tactnet::safetensors::read(shop / "net").metadata().at("augmentation") == "auto");
        for (const char* fixed : {"--augmentation each-epoch", "--augmentation none", "--recipe published"})
            says_not(printed(std::string("--epochs 2 ") + fixed), "augmentation:");
        CHECK(tactnet::safetensors::read(shop / "net").metadata().at("augmentation") == "each-epoch");
        // What options say stays.
        for (const char* fixed : {"--reflect both", "--reflect columns", "--partners left=right"})
            says_not(printed(std::string("--epochs 2 ") + fixed), "reflections of columns");
        shop.refuses(
            shop.train_arguments("--partners left=right --reflect rows --output net"),
            "--partners: expected reflections of columns, which exchange them, found --reflect rows");
        shop.refuses(shop.train_arguments("--recipe published --augmentation auto --output net"),
                     "--augmentation: expected none, each-epoch or sixfold for the published recipe");
    }

    TEST_CASE("train: same seed, same bits; another seed, others; any number of threads") {
        const workshop shop;
        shop.trains("--epochs 4 --output a");
        shop.trains("--epochs 4 --output b --threads 3");
        shop.trains("--epochs 4 --output c --seed 6");
        CHECK(shop.text("a") == shop.text("b"));
        CHECK(shop.text("a") != shop.text("c"));
        for (const char* recipe : {"published", "thorough", "default"})
            for (const char* augmentation : {"none", "each-epoch", "sixfold"})
                shop.trains({"--epochs", "2", "--output", "d", "--recipe", recipe, "--augmentation",
                             augmentation, "--input", "scale", "--split", "blocked"});
    }

    TEST_CASE("train: how far images are turned and moved") {
        const workshop shop;
        shop.trains("--epochs 2 --output recipe");
        says(shop.trains("--epochs 1 --output one/two/three/net").error,
             "one/two/three: neither this folder nor the one above it is there; they will be made\n");
        says_not(shop.trains("--epochs 1 --output four/net").error, "neither this folder");
        const auto turned = tactnet::recipe::default_for(7, 13).ranges;
        shop.trains({"--epochs", "2", "--output", "same", "--rotation", std::to_string(turned.rotation),
                     "--translation", std::to_string(turned.translation)});
        shop.trains("--epochs 2 --output further --rotation 90");
        shop.trains("--epochs 2 --output elsewhere --translation 4");
        CHECK(shop.text("same") == shop.text("recipe"));
        CHECK(shop.text("further") != shop.text("recipe"));
        CHECK(shop.text("elsewhere") != shop.text("recipe"));
    }

    TEST_CASE("train: it starts from a weight file") {
        const workshop shop;
        shop.trains("--output first.safetensors");
        // 440 at this size, for 24 training images in place of 352.
        CHECK(tactnet::safetensors::read(shop / "first.safetensors").metadata().at("epochs") == "6453");
        for (const char* again : {"second.safetensors", "third.safetensors"})
            shop.trains("--start first.safetensors --epochs 1 --seed 6 --output" + words{again});
        shop.trains("--epochs 1 --seed 6 --output fresh.safetensors");
        const auto second = tactnet::safetensors::read(shop / "second.safetensors"),
                   third = tactnet::safetensors::read(shop / "third.safetensors"),
                   fresh = tactnet::safetensors::read(shop / "fresh.safetensors"),
                   first = tactnet::safetensors::read(shop / "first.safetensors");
        const auto weights = [](const tactnet::safetensors& file) {
            return file.values<float>("conv1.weight");
        };
        CHECK(weights(second) == weights(third));
        CHECK(second.metadata().contains("start"));
        CHECK(!fresh.metadata().contains("start"));
        const auto distance = [&](const tactnet::safetensors& file) {
            double sum = 0;
            for (std::size_t i = 0; i < weights(file).size(); ++i)
                sum += std::abs(static_cast<double>(weights(file)[i] - weights(first)[i]));
            return sum;
        };
        CHECK(distance(second) > 0);
        CHECK(distance(second) < 0.2 * distance(fresh)); // one epoch does not lead far
        shop.succeeds("evaluate --data DATA --method tactnet4 --rows 7 --columns 13 --epochs 1 --splits 1 "
                      "--start first.safetensors");

        shop.refuses(shop.train_arguments("--start none.safetensors --output x.safetensors"),
                     "none.safetensors");
        shop.refuses(shop.train_arguments("--start first.safetensors --output x.safetensors --input scale"),
                     "expected a network of inputs by 'scale'");
        shop.refuses(shop.train_arguments("--start first.safetensors --method svm-rbf --output x"),
                     "expected a network, found svm-rbf");
        fs::rename(shop.data() / "left", shop.data() / "leftmost");
        shop.refuses(shop.train_arguments("--start first.safetensors --output x.safetensors"),
                     "the 3 classes of the images");
    }

    TEST_CASE("train: one that diverges says so and writes nothing") {
        const workshop shop;
        const outcome result = shop.train("--epochs 30 --rate 1e30 --recipe published --output net");
        CHECK(result.status == 1);
        says(result.error, "training diverged in epoch ");
        CHECK(shop.everything().empty());
    }

    TEST_CASE("train: bad images") {
        const workshop shop;
        const fs::path image = shop.data() / "left" / "image2.png";
        const words training = shop.train_arguments("--epochs 1 --output net");
        const std::string good = text_of(image);
        tactnet::write_file(image, std::string_view(good).substr(0, good.size() / 2));
        shop.refuses(training, "image2.png: PNG data: expected an intact image, found ");
        write_png(image, 8, 13, std::vector<std::uint8_t>(8 * 13));
        shop.refuses(training, "image2.png: expected 7 x 13 pixels (rows x columns), found 8 x 13 pixels");
        tactnet::write_file(image, good);
        fs::create_directory(shop.data() / "zebra");
        shop.refuses(training,
                     "zebra: expected at least one image (.jpg, .jpeg, .png, .npy) for this class, found "
                     "an empty folder");
        for (const char* folder : {"zebra", "left", "right"})
            fs::remove_all(shop.data() / folder);
        shop.refuses(training,
                     "data: expected at least two classes, a subfolder each, found only 'middle, of all'");
    }

    TEST_CASE("train: images that are resized are varied as they were taken, and the file says so") {
        const workshop shop;
        const fs::path large = shop / "large";
        tactnet::random_stream random(2, tactnet::random_purposes::order);
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t i = 0; i < images_per_class; ++i) {
                std::vector<std::uint8_t> pixels(28 * 50);
                for (std::size_t e = 0; e < pixels.size(); ++e)
                    pixels[e] = static_cast<std::uint8_t>(random.below(40) + (e % 50 / 17 == c ? 150 : 0));
                const fs::path folder = large / std::string(1, static_cast<char>('a' + c));
                fs::create_directories(folder);
                write_png(folder / (std::to_string(i) + ".png"), 28, 50, pixels);
            }
        const auto trained = [&](const char* name, words more) {
            more.insert(more.end(), {"--data", large.string(), "--epochs", "2", "--output", name});
            shop.trains(more);
            const auto metadata = tactnet::safetensors::read(shop / name).metadata();
            const auto found = metadata.find("varied");
            return found == metadata.end() ? std::string() : found->second;
        };
        CHECK(trained("taken", {"--resize"}).starts_with("28x50 "));
        CHECK(trained("published", "--resize --recipe published").empty());
        CHECK(trained("alike", "--resize --augmentation none").empty());
        CHECK(shop.text("taken") != shop.text("alike"));

        // Where not all have one size, nothing is known of how they were taken.
        write_png(large / "a" / "small.png", 7, 13, std::vector<std::uint8_t>(7 * 13, 90));
        CHECK(trained("mixed", {"--resize"}).empty());
    }

    TEST_CASE("train: bad arguments") {
        const workshop shop;
        says(shop.succeeds("--help").out, "(instruction set: s");
        CHECK(shop.run({}).status == 2);
        tactnet::write_file(shop / "file", "");
        const auto training = [&](const words& more) { return shop.train_arguments(more); };
        shop.refuses_each({
            {"trian --output net", "A subcommand is required, found 'trian'"},
            {training("--output net --epocs 2"), "The following arguments were not expected: 2 --epocs"},
            {"train --output net", "--data is required"},
            {training("--output net --method vgg"), "--method: expected one of tactnet4"},
            {training("--output net --split other"), "--split: other not in {"},
            {training("--output net --rotation 181"),
             "--rotation: expected a number from 0 to 180, found '181'"},
            {training("--output net --augmentation none --rotation 5"),
             "--rotation, --translation: expected an augmentation, which they change, found --augmentation "
             "none"},
            {training("--output net --translation -1"),
             "--translation: expected a number from 0 to 4096, found '-1'"},
            {training("--output net --test 0.6 --validation 0.5"),
             "expected shares that leave some images for training, found 0.5 and 0.6"},
            {training("--output net --resume"),
             "net.checkpoint: expected a file, found nothing of that name"},
            {training("--output ."), "expected the name of a file to write, found a folder"},
            {training("--output file/net"), "file/net: expected a folder to write in, found a file at "},
        });
        // The default method is one that was compiled in.
        const bool has_tactnet6 = shop.run("list").out.find("\ntactnet6 ") != std::string::npos;
        says(shop.succeeds("train --help").out, has_tactnet6 ? "=tactnet6 " : "=tactnet4 ");
    }

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

        const auto kept = shop.text("net.checkpoint");
        shop.refuses(shop.train_arguments({"--epochs", epochs, "--output", "net", "--resume", "--seed", "6"}),
                     "net.checkpoint: setting 'seed' of the stopped training: expected ");

        // It is given up only when asked, by whatever settings it is found.
        for (const char* other_epochs : {epochs, "2"})
            shop.refuses(shop.train_arguments({"--epochs", other_epochs, "--output", "net"}),
                         "net.checkpoint: expected no checkpoint here, found one of an unfinished training; "
                         "--resume goes on from it, --afresh gives it up, --checkpoint takes another name");
        shop.refuses(shop.train_arguments("--output net --resume --afresh"), "--afresh");
        CHECK(shop.text("net.checkpoint") == kept);
        shop.trains("--epochs 2 --output net --checkpoint other");
        fs::remove(shop / "net");
        CHECK(shop.text("net.checkpoint") == kept);
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
        CHECK(shop.text("net") == shop.text("whole"));
    }

    TEST_CASE("resume: what short trainings have found is kept and not found again, the same bits") {
        const workshop shop;
        const words arguments = shop.train_arguments("--epochs 1000 --batch 1");
        shop.succeeds(arguments + "--output whole");
        // Stopped while images choose the augmentation, whenever that is, and after it.
        const std::string resumable =
            "stopped before the training; the same command with --resume goes on from net.checkpoint\n";
        std::string stopped;
        for (int ms = 4; ms < 4000 && !stopped.ends_with(resumable); ms += ms / 4) {
            const pid_t child = shop.start(arguments + "--output net --afresh");
            std::this_thread::sleep_for(std::chrono::milliseconds(ms));
            stopped = shop.stop(child, SIGINT).error;
        }
        REQUIRE(stopped.ends_with(resumable));
        CHECK(stopped.starts_with("short trainings: 1 of "));
        const auto trials = [&](const char* name) {
            return tactnet::safetensors::read(shop / name).metadata().at("setting.trials");
        };
        const std::string first = trials("net.checkpoint");
        // Scores say nothing of another search, though the recipe be the same; damaged ones say nothing.
        for (const char* fixed : {"--rotation 15", "--reflect both"})
            shop.refuses(arguments + "--output net --resume" + fixed,
                         "net.checkpoint: setting 'trials_of' of the stopped training: expected 'fixed ");
        std::string damaged = shop.text("net.checkpoint");
        const std::string before = "\"setting.trials\":\"[[";
        REQUIRE(damaged.find(before) != std::string::npos);
        char& digit = damaged[damaged.find(before) + before.size()];
        digit = digit == '1' ? '0' : '1';
        tactnet::write_file(shop / "damaged", damaged);
        shop.refuses(arguments + "--output net --resume --checkpoint damaged",
                     "damaged: checksum of the whole file: expected ");
        const pid_t child = shop.start(arguments + "--output net --resume");
        shop.wait_for_first_epoch(child);
        REQUIRE(shop.stop(child, SIGINT).status == 130);
        CHECK(trials("net.checkpoint").starts_with(first.substr(0, first.size() - 1)));
        // Those that are kept decide, whatever the images say.
        rewrite_metadata(shop / "net.checkpoint", shop / "other", "setting.trials", "[[0.5],[0.9],[0.9]]");
        const outcome other = shop.run(arguments + "--output net --resume --checkpoint other");
        says(other.error, "other: setting 'chosen_augmentation_ranges' of the stopped training: expected ");
        shop.succeeds(arguments + "--output net --resume");
        CHECK(shop.text("net") == shop.text("whole"));
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
        shop.refuses(arguments("net", "other") + "--resume", "setting 'start' of the stopped training");
        shop.refuses(shop.train_arguments("--epochs 1500 --output net --resume"), "of the stopped training");
        shop.succeeds(arguments("net", "first") + "--resume");
        shop.succeeds(arguments("whole", "first"));
        CHECK(shop.text("net") == shop.text("whole"));
    }
}

// tactnet evaluate.

#include "../workshop.hpp"

#include <tactnet/io/safetensors/json_checksum.hpp>

#include <nlohmann/json.hpp>

#include <sys/file.h>

using namespace support;

TEST_SUITE("program") {
    TEST_CASE("evaluate: what is done is kept") {
        const workshop shop;
        const auto arguments = [](const words& more) {
            return "evaluate --data DATA --method tactnet4,tactnet6-economical --rows 7 --columns 13 "
                   "--epochs 3 --results r" +
                   more;
        };
        const auto evaluate = [&](const words& more) { return shop.succeeds(arguments(more)); };
        const outcome first = evaluate("--splits 1 --jobs 2");
        says(first.error, "4 trainings to do, of 4 in all");
        const auto kept = shop.text("r/evaluation.jsonl");
        CHECK(lines_of(kept).size() == 4);
        for (const std::string& line : lines_of(kept)) {
            const auto result = nlohmann::json::parse(line);
            CHECK(result.at("reflected_accuracy").is_number());
            CHECK(result.at("calibration").at("temperature").is_number());
            std::size_t images = 0, tested = 0;
            for (const auto& bin : result.at("calibration").at("after"))
                images += bin.at(0).get<std::size_t>();
            for (const auto& count : result.at("confusion"))
                tested += count.get<std::size_t>();
            CHECK(images == tested);
        }
        CHECK(shop.lines("r/table.csv").size() == 3);
        CHECK(shop.lines("r/table.jsonl").size() == 2);
        CHECK(fs::exists(shop / "r/confusion_tactnet4_7x13.csv"));
        CHECK(shop.lines("r/reliability_tactnet4_7x13.csv").size() == 16);
        says(first.out, "calibration error before, %");
        CHECK(shop.lines("r/accuracy_and_time.csv")[0] == "series,x,accuracy,deviation,label");
        CHECK(shop.lines("r/table.csv")[0].starts_with("method,rows,columns,recipe,bits,"));
        const auto row = nlohmann::json::parse(shop.lines("r/table.jsonl")[0]);
        for (const char* known :
             {"random_accuracy", "random_deviation", "blocked_accuracy", "blocked_deviation", "parameters",
              "multiply_adds", "multiply_adds_on_pixels", "bytes", "activation_bytes", "microseconds",
              "microseconds_in_batch", "training_seconds", "temperature", "softmax_calibration_error",
              "softmax_brier_score", "calibration_error", "brier_score"})
            CHECK_MESSAGE(row.at(known).is_number(), known);
        // TactNet-4 for three classes: 6128 parameters of convolutions and batch norms, 64 x 3 + 3 of the
        // last layer.
        says(first.out, " 6 323 ");
        says(first.out, "`tactnet::tactnet4<tactnet::shape{7, 13}, 3>`");

        says(evaluate("--splits 2 --jobs 1").error, "4 trainings to do, of 8 in all");
        CHECK(shop.text("r/evaluation.jsonl").starts_with(kept));

        // One kind of split alone: the same trainings, and nothing is said of the other kind.
        const outcome random = evaluate("--splits 2 --split random --jobs 1");
        says(random.error, "0 trainings to do, of 4 in all");
        says(random.out, "random splits, %");
        for (const std::string& text : {random.out, shop.text("r/accuracy_and_time.csv")})
            says_not(text, "blocked");
        CHECK(nlohmann::json::parse(shop.lines("r/table.jsonl")[0]).at("blocked_accuracy").is_null());

        // A line that was being written when the power went is passed over, and replaced.
        const auto whole = shop.text("r/evaluation.jsonl");
        tactnet::write_file(shop / "r/evaluation.jsonl",
                            std::string_view(whole).substr(0, whole.size() - 20));
        says(evaluate("--splits 2 --jobs 1").error, "1 trainings to do, of 8 in all");
        CHECK(shop.lines("r/evaluation.jsonl").size() == 8);

        // Another version of the library may train otherwise: its results are not taken for this one's.
        std::string older = shop.text("r/evaluation.jsonl");
        const std::string version = "\"library\":\"";
        REQUIRE(older.find(version) != std::string::npos);
        for (std::size_t at = 0; (at = older.find(version, at)) != std::string::npos; at += version.size())
            older.insert(at + version.size(), "0.");
        tactnet::write_file(shop / "r/evaluation.jsonl", older);
        shop.refuses(arguments("--splits 1"), "evaluation.jsonl: checksum of the line 1: expected");
        // As that version would have written it.
        const auto summed_anew = [](const std::string& text) {
            std::string all;
            for (const std::string& line : lines_of(text))
                all += tactnet::with_checksum(line.substr(0, line.rfind(",\"checksum\"")) + '}') + '\n';
            return all;
        };
        older = summed_anew(older);
        tactnet::write_file(shop / "r/evaluation.jsonl", older);
        says(evaluate("--splits 1").error, "4 trainings to do, of 4 in all");
        CHECK(shop.text("r/evaluation.jsonl").starts_with(older));

        says(evaluate("--splits 1 --afresh").error, "4 trainings to do, of 4 in all");
        CHECK(shop.lines("r/evaluation.jsonl").size() == 4);

        tactnet::write_file(shop / "r/evaluation.jsonl", "{}\n");
        shop.refuses(arguments("--splits 1"),
                     "evaluation.jsonl: line 1: expected a result of tactnet evaluate, found");
    }

    TEST_CASE("evaluate: short trainings of an interrupted one are kept until it is done, the same result") {
        const workshop shop;
        const auto arguments = [](const char* results) {
            return "evaluate --data DATA --method tactnet4 --rows 7 --columns 13 --epochs 1000 --batch 1 "
                   "--split random --splits 1 --jobs 1 --results" +
                   words{results};
        };
        const fs::path trials = shop / "r/trials";
        for (int ms = 50; ms < 10'000 && !fs::exists(trials); ms += ms / 4) {
            const pid_t child = shop.start(arguments("r"));
            std::this_thread::sleep_for(std::chrono::milliseconds(ms));
            shop.stop(child, SIGINT);
        }
        REQUIRE(fs::exists(trials));
        const fs::path kept = fs::directory_iterator(trials)->path();
        const std::string whole = text_of(kept);
        tactnet::write_file(kept, whole.substr(1));
        CHECK(shop.run(arguments("r")).status == 2);
        tactnet::write_file(kept, whole);
        shop.succeeds(arguments("r"));
        CHECK(fs::is_empty(trials));
        shop.succeeds(arguments("whole"));
        for (const char* found : {"predictions_tactnet4_7x13.csv", "confusion_tactnet4_7x13.csv"})
            CHECK(shop.text(fs::path("r") / found) == shop.text(fs::path("whole") / found));
    }

    TEST_CASE("evaluate: results are of the groups and fixed kinds that short trainings chose by") {
        const workshop shop;
        for (const char* more : {"--group (\\d)", "--group (image)", "--rotation 15"}) {
            const words arguments = "evaluate --data DATA --method tactnet4 --rows 7 --columns 13 --epochs 2 "
                                    "--split random --splits 1 --results r" +
                                    words(more);
            says(shop.succeeds(arguments).error, "1 trainings to do, of 1 in all");
            says(shop.succeeds(arguments).error, "0 trainings to do, of 1 in all");
        }
    }

    TEST_CASE("evaluate: what mean images choose for the thorough recipe is described") {
        const workshop shop;
        for (const char* more : {"", "--augmentation each-epoch"})
            says(shop.succeeds("evaluate --data DATA --method tactnet4 --rows 7 --columns 13 --epochs 2 "
                               "--splits 1 --split random --jobs 1 --recipe thorough --results r" +
                               words(more))
                     .error,
                 "1 trainings to do, of 1 in all");
    }

    TEST_CASE("evaluate: a learning curve, intervals, and each class and image") {
        const workshop shop;
        const auto evaluate = [](const words& more) {
            return "evaluate --data DATA --method tactnet4,svm-linear --rows 7 --columns 13 --epochs 3 "
                   "--split random --splits 2 --jobs 1 --results r" +
                   more;
        };
        const outcome first = shop.succeeds(evaluate("--learning-curve 0.1,0.5"));
        says(first.error, "12 trainings to do, of 12 in all");
        says(first.out, "training images");
        // 8 of 12 images of each class train; 0.1 and 0.5 of them are 1 and 4.
        const auto curve = shop.lines("r/learning_curve.csv");
        REQUIRE(curve.size() == 7);
        CHECK(curve[0] == "series,x,accuracy,deviation,share,splits");
        for (const auto& [line, start] : {std::pair{1u, "3.0,"}, {2u, "12.0,"}, {3u, "24.0,"}})
            CHECK_MESSAGE(curve[line].starts_with("tactnet4 7x13 random," + std::string(start)), curve[line]);
        CHECK(shop.lines("r/table.csv").size() == 3); // of the whole alone
        CHECK(shop.lines("r/intervals.csv").size() == 3);
        CHECK(nlohmann::json::parse(shop.lines("r/intervals.jsonl")[1]).at("to_first").is_number());
        CHECK(shop.lines("r/classes_tactnet4_7x13.csv").size() == 4);
        // Two splits of 2 test images a class.
        const auto predictions = shop.lines("r/predictions_tactnet4_7x13.csv");
        REQUIRE(predictions.size() == 1 + 2 * 6);
        CHECK(predictions[0].starts_with("split,seed,path,group,label,prediction,p left,"));
        CHECK(predictions[12].starts_with("random,1,right/"));
        CHECK(shop.lines("r/predictions_svm-linear_7x13.csv").size() == 13);

        fs::remove_all(shop / "r/predictions");
        const outcome again = shop.succeeds(evaluate("--learning-curve 0.1"));
        says(again.error, "0 trainings to do, of 8 in all");
        says(again.error, "tactnet4: the predictions of 2 trainings were not kept; --afresh makes them");
        shop.refuses(evaluate("--learning-curve 1"), "--learning-curve: ");
    }

    TEST_CASE("evaluate: support vector machines, on the same splits") {
        const workshop shop;
        const auto evaluate = [](const words& more) {
            return "evaluate --data DATA --rows 7 --columns 13 --split random --splits 2 --results r "
                   "--method svm-linear,svm-rbf,surf-svm" +
                   more;
        };
        shop.succeeds(evaluate("--jobs 2"));
        const auto table = shop.lines("r/table.csv");
        REQUIRE(table.size() == 4);
        const char* names[] = {"svm-linear", "svm-rbf", "surf-svm"};
        for (std::size_t m = 0; m < 3; ++m) {
            CAPTURE(table[m + 1]);
            // The bars are easy to distinguish, by the window's edges even where only words count; chance
            // is a third.
            const std::string start = std::string(names[m]) + ",7,13,default,32,2,2,";
            REQUIRE(table[m + 1].find(start) == 0);
            CHECK(std::stod(table[m + 1].substr(start.size())) >= (m < 2 ? 1.0 : 0.9));
            CHECK(fs::exists(shop / ("r/confusion_" + std::string(names[m]) + "_7x13.csv")));
        }
        const auto kept = shop.text("r/evaluation.jsonl");
        says(shop.run(evaluate("--jobs 1")).error, "0 trainings to do, of 6 in all");
        CHECK(shop.text("r/evaluation.jsonl") == kept);

        // What is for networks goes to those of the list; without any it is a mistake.
        shop.succeeds("evaluate --data DATA --rows 7 --columns 13 --split random --splits 1 --epochs 2 "
                      "--method tactnet4,svm-linear --results both");
        shop.refuses(evaluate("--epochs 3"), "expected a network, found svm-linear");
        shop.refuses(evaluate("--recipe published"),
                     "expected default, since nothing was published for svm-linear");
        shop.refuses(evaluate("--recipe thorough"),
                     "a thorough training is one of a network that begins by chance, not of svm-linear");

        // They are described by their own settings, and by no recipe of networks.
        const auto described = lines_of(kept);
        REQUIRE(described.size() == 6);
        for (const std::string& line : described) {
            const auto has = [&](const char* text) { return line.find(text) != std::string::npos; };
            for (const char* recipe : {"optimiser", "rate", "batch", "augmentation", "patience"})
                CHECK_MESSAGE(!has(("\"" + std::string(recipe) + "\":").c_str()), line);
            for (const char* common : {"\"seed\":", "\"data\":", "\"library\":", "\"instruction_set\":",
                                       "\"tolerance\":", "\"iteration_limit\":"})
                CHECK_MESSAGE(has(common), line);
            CHECK(has("\"cost\":\"1\"") == has("\"network\":\"svm-linear\""));
            CHECK(has("\"gamma_rule\":\"scale\"") == has("\"network\":\"svm-rbf\""));
            CHECK(has("\"loss\":\"squared hinge\"") != has("\"network\":\"svm-rbf\""));
            for (const char* of_words :
                 {"\"words\":\"500\"", "\"surf_step\":\"3x3\"", "\"surf_scales\":\"1 2\"",
                  "\"word_descriptors\":\"20000\"",
                  "\"word_iterations\":", "\"word_seed\":", "\"histogram\":\"square roots of counts\""})
                CHECK_MESSAGE(has(of_words) == has("\"network\":\"surf-svm\""), line);
        }
    }

#if !defined(__SANITIZE_ADDRESS__) &&                                                                        \
    !defined(__SANITIZE_THREAD__) // which takes more addresses than any limit
    TEST_CASE("evaluate: goes on with fewer threads where the system refuses some") {
        const workshop shop;
        // A stack of 4 GiB for each thread, of 2 GiB in all.
        const auto limited =
            run_program("ulimit -S -s 4194304 && ulimit -v 2097152 || exit 77; cd '" + shop.work().string() +
                        "' && exec " TACTNET_PROGRAM " evaluate --data '" + shop.data().string() +
                        "' --method svm-linear --rows 7 --columns 13 --splits 2 --results r --jobs 3");
        if (limited.status == 77) {
            MESSAGE("skipped: limits cannot be set here");
            return;
        }
        CHECK_MESSAGE(limited.status == 0, limited.error);
        says(limited.error, "the system refuses more threads: 1 trainings at a time in place of 3");
        CHECK(shop.lines("r/evaluation.jsonl").size() == 4);
    }
#endif

    TEST_CASE("evaluate: several share a folder of results") {
        const workshop shop;
        const auto arguments = [](const char* seed, const char* splits, const char* results) {
            return "evaluate --data DATA --method tactnet4 --rows 7 --columns 13 --epochs 2 --jobs 1 --split "
                   "random" +
                   words{"--results", results, "--seed", seed, "--splits", splits};
        };
        shop.succeeds(arguments("0", "1", "other"));
        const std::string line = shop.text("other/evaluation.jsonl");

        // The test writes as another program does, and is slow about it.
        fs::create_directory(shop / "r");
        const fs::path list = shop / "r/evaluation.jsonl";
        const int file = open(list.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
        REQUIRE(file >= 0);
        REQUIRE(flock(file, LOCK_EX) == 0);
        const std::size_t half = line.size() / 2;
        REQUIRE(write(file, line.data(), half) == static_cast<ssize_t>(half));
        const pid_t child = shop.start(arguments("1", "2", "r"));
        std::this_thread::sleep_for(std::chrono::seconds(1));
        REQUIRE(write(file, line.data() + half, line.size() - half) ==
                static_cast<ssize_t>(line.size() - half));
        REQUIRE(close(file) == 0);
        const outcome waited = shop.wait(child);
        REQUIRE_MESSAGE(waited.status == 0, waited.error);
        CHECK(text_of(list).starts_with(line));
        CHECK(lines_of(text_of(list)).size() == 3);
    }
}

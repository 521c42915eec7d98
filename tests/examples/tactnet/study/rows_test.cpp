// The rows of a study: the front, CSV and JSON lines, curves of results; and the paper's figures.

#include "rows.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors/json_checksum.hpp>
#include <tactnet/io/write_file.hpp>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <evaluation/results.hpp>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <study/rows.hpp>
#include <support/files/data_folder.hpp>
#include <support/files/temporary_folder.hpp>
#include <support/run_program.hpp>
#include <utility>
#include <vector>

using namespace support;
using tactnet::epoch_report;
using tactnet::split_rule;

namespace {

std::vector<std::string> front_of(const std::vector<study_row>& rows, split_rule rule = split_rule::random) {
    std::vector<std::string> titles;
    for (const study_row* row : pareto_front(rows, rule))
        titles.push_back(title_of(*row));
    return titles;
}

using titles = std::vector<std::string>;

/// Lines of a CSV file without quotes, the head first.
std::vector<std::vector<std::string>> cells_of(const std::filesystem::path& path) {
    std::vector<std::vector<std::string>> lines;
    std::istringstream text(text_of(path));
    for (std::string line; std::getline(text, line);) {
        std::istringstream cells(line);
        lines.emplace_back();
        for (std::string cell; std::getline(cells, cell, ',');)
            lines.back().push_back(cell);
    }
    return lines;
}

const published_result* find_title(std::string_view title, std::size_t rows, std::size_t columns) {
    const auto found =
        std::find_if(published_results.begin(), published_results.end(), [&](const published_result& p) {
            return p.title == title && p.rows == rows && p.columns == columns;
        });
    return found == published_results.end() ? nullptr : &*found;
}

std::vector<std::size_t> numbers_of(const std::vector<epoch_report>& curve) {
    std::vector<std::size_t> numbers;
    for (const epoch_report& e : curve)
        numbers.push_back(e.epoch);
    return numbers;
}

} // namespace

TEST_SUITE("program") {
    TEST_CASE("pareto_front: no method of it is both slower and less accurate than another") {
        CHECK(front_of({}).empty());
        CHECK(front_of({studied("slow", 0.9, 30), studied("fast", 0.8, 10), studied("worse", 0.7, 20)}) ==
              titles{"fast 7x13", "slow 7x13"});
        CHECK(front_of({studied("slow", 0.9, 30), studied("best", 0.95, 20)}) == titles{"best 7x13"});
        // Not more accurate, but slower: it has no place there.
        CHECK(front_of({studied("first", 0.9, 10), studied("second", 0.9, 20)}) == titles{"first 7x13"});
    }

    TEST_CASE("pareto_front: of equal times the most accurate, and of equal methods the first") {
        CHECK(front_of({studied("worse", 0.8, 10), studied("better", 0.9, 10), studied("last", 0.7, 10)}) ==
              titles{"better 7x13"});
        // Two recipes of a method take equally long.
        CHECK(front_of({studied("net", 0.8, 10, "default"), studied("net", 0.85, 10, "published")}) ==
              titles{"net 7x13, published"});
        CHECK(front_of({studied("net", 0.8, 10, "default"), studied("net", 0.8, 10, "published")}) ==
              titles{"net 7x13"});
    }

    TEST_CASE("pareto_front: only of rows with all their splits and a time") {
        std::vector<study_row> rows{studied("whole", 0.8, 20), studied("few", 0.99, 10),
                                    studied("untimed", 0.99, 10), studied("blocked", 0.99, 10)};
        rows[1].accuracies.front().splits = 19;
        rows[2].latency.reset();
        rows[3].accuracies.front().rule = split_rule::blocked;
        rows.push_back(not_run("lost", "needs a file"));
        CHECK(front_of(rows) == titles{"whole 7x13"});
        CHECK(front_of(rows, split_rule::blocked) == titles{"blocked 7x13"});
    }

    TEST_CASE("title_of: names 8 bits and a recipe other than the default") {
        study_row row = studied("net", 0.8, 10, "thorough");
        CHECK(title_of(row) == "net 7x13, thorough");
        row.bits = 8;
        CHECK(title_of(row) == "net in 8 bits 7x13, thorough");
        CHECK(method_title(row) == "net in 8 bits");
    }

    TEST_CASE("shown_rule: random splits if a row has any") {
        std::vector<study_row> rows{studied("net", 0.8, 10)};
        CHECK(shown_rule(rows) == split_rule::random);
        rows[0].accuracies.front().rule = split_rule::blocked;
        CHECK(shown_rule(rows) == split_rule::blocked);
        rows.push_back(studied("other", 0.8, 10));
        CHECK(shown_rule(rows) == split_rule::random);
    }

    TEST_CASE("study_json_lines: a line a row with its checksum, null for what is not known") {
        std::vector<study_row> rows{studied("net", 0.875, 10), not_run("lost", "needs \"a file\"")};
        rows[0].accuracies.front().validation = std::nan("");
        rows[0].costs.parameters = 1234;
        rows[1].published = find_published("tactnet6", 28, 50);
        std::istringstream lines(study_json_lines(rows));
        std::vector<nlohmann::json> read;
        for (std::string line; std::getline(lines, line);) {
            const tactnet::checked_json checked = tactnet::check_json(line, "lines");
            CHECK(checked.checksum == tactnet::checksum_state::verified);
            read.push_back(nlohmann::json::parse(checked.text));
        }
        REQUIRE(read.size() == 2);
        CHECK(read[0].at("method") == "net");
        CHECK(read[0].at("rows") == 7);
        CHECK(read[0].at("bits") == 32);
        CHECK(read[0].at("random_accuracy") == 0.875);
        CHECK(read[0].at("random_splits") == 20);
        CHECK(read[0].at("random_training_accuracy") == 1);
        CHECK(read[0].at("random_validation_accuracy").is_null());
        CHECK(read[0].at("random_reflected_accuracy").is_null());
        CHECK(read[0].at("blocked_accuracy").is_null());
        CHECK(read[0].at("microseconds") == 10);
        CHECK(read[0].at("parameters") == 1234);
        CHECK(read[0].at("published_accuracy").is_null());
        for (const char* unknown : {"random_accuracy", "microseconds", "training_seconds", "parameters"})
            CHECK_MESSAGE(read[1].at(unknown).is_null(), unknown);
        CHECK(read[1].at("line") == 2);
        CHECK(read[1].at("lines") == 2);
        CHECK(read[1].at("missing") == "needs \"a file\"");
        CHECK(read[1].at("published_accuracy") == doctest::Approx(0.9502).epsilon(1e-15));
        CHECK(read[1].at("published_microseconds") == doctest::Approx(103'000).epsilon(1e-15));
    }

    TEST_CASE("study_csv: the same numbers, empty where nothing is known") {
        std::vector<study_row> rows{studied("net", 0.875, 10),
                                    not_run("lost", "needs a file, which is \"away\"")};
        rows[0].accuracies.front().validation = std::nan("");
        std::istringstream text(study_csv(rows));
        std::string head, first, second, rest;
        std::getline(text, head);
        std::getline(text, first);
        std::getline(text, second);
        CHECK(!std::getline(text, rest));
        CHECK(head.starts_with("method,rows,columns,recipe,bits,random_splits,random_splits_wanted,"
                               "random_accuracy,random_deviation,random_validation_accuracy,"
                               "random_training_accuracy,random_reflected_splits,random_reflected_accuracy,"
                               "random_reflected_deviation,blocked_splits,"));
        CHECK_MESSAGE(first.starts_with("net,7,13,default,32,20,20,0.875,0.01,,1.0,0,,,,"), first);
        CHECK_MESSAGE(second.starts_with("lost,28,50,default,32,,,"), second);
        CHECK_MESSAGE(second.ends_with(",\"needs a file, which is \"\"away\"\"\""), second);
    }

    TEST_CASE(
        "published_results: those of the paper's table and of its figure of resolutions, number by number" *
        doctest::test_suite("data")) {
        using cells = std::vector<std::string>;
        const auto table = find_data("published_results.csv"),
                   figure = find_data("published_resolution_results.csv");
        if (!table || !figure)
            return;
        auto methods = cells_of(*table), sizes = cells_of(*figure);
        REQUIRE(methods.at(0) == cells{"method", "parameters", "test_accuracy_mean_percent",
                                       "test_accuracy_sd_percent", "t_gpu_s", "t_cpu_s"});
        REQUIRE(sizes.at(0) == cells{"method", "rows", "columns", "test_accuracy_mean_percent",
                                     "test_accuracy_sd_percent", "splits"});
        std::set<const published_result*> seen;
        const auto compare = [&](const std::string& title, std::size_t rows, std::size_t columns,
                                 const std::string& accuracy, const std::string& deviation) {
            CAPTURE(title);
            const published_result* const found = find_title(title, rows, columns);
            REQUIRE(found != nullptr);
            CHECK(found->accuracy == std::stod(accuracy));
            CHECK(found->deviation == std::stod(deviation));
            seen.insert(found);
            return found->seconds;
        };
        for (std::size_t i = 1; i < methods.size(); ++i) {
            const cells& c = methods[i];
            CHECK(compare(c.at(0), 28, 50, c.at(2), c.at(3)) == std::stod(c.at(5)));
        }
        for (std::size_t i = 1; i < sizes.size(); ++i) {
            const cells& c = sizes[i];
            const std::size_t rows = std::stoul(c.at(1));
            CHECK((compare(c.at(0), rows, std::stoul(c.at(2)), c.at(3), c.at(4)) == 0) == (rows != 28));
        }
        CHECK(seen.size() == published_results.size());
    }

    TEST_CASE("published_results: a name of ours for each of the paper's") {
        std::set<std::pair<std::string_view, std::string_view>> pairs;
        std::set<std::string_view> names, ours;
        for (const published_result& p : published_results) {
            pairs.insert({p.title, p.method});
            names.insert(p.title);
            ours.insert(p.method);
            CHECK(find_published(p.method, p.rows, p.columns) == &p); // each once
        }
        CHECK(pairs.size() == 12);
        CHECK(names.size() == 12);
        CHECK(ours.size() == 12);
        CHECK(find_published("tactnet6", 9, 16) == nullptr);
    }

    TEST_CASE("curve_of: at most 60 epochs, round numbers apart") {
        CHECK(curve_of({}).empty());
        CHECK(numbers_of(curve_of(epochs(3))) == std::vector<std::size_t>{1, 2, 3});
        const std::pair<std::size_t, std::size_t> steps[] = {
            {60, 1}, {61, 2}, {110, 2}, {121, 5}, {300, 5}, {301, 10}, {1000, 20}, {1201, 50}, {10'000, 200}};
        for (const auto& [epoch_count, step] : steps) {
            const std::size_t count = epoch_count; // Clang 14 captures no structured binding
            CAPTURE(count);
            const std::vector<std::size_t> kept = numbers_of(curve_of(epochs(count)));
            CHECK(kept.size() <= 60);
            CHECK(kept.front() == step);
            CHECK(kept.back() == count / step * step);
            CHECK(kept.size() == count / step);
        }
    }

    TEST_CASE("mean_curve: of trainings that were still at work, at epochs that all of them have") {
        CHECK(mean_curve({}).empty());
        CHECK(mean_curve({{}, {}}).empty());
        std::vector<std::vector<epoch_report>> trainings{epochs(4), epochs(2)};
        trainings[1][1].loss = 1.5;
        const std::vector<epoch_report> mean = mean_curve(trainings);
        CHECK(numbers_of(mean) == std::vector<std::size_t>{1, 2, 3, 4});
        CHECK(mean[0].loss == 1);
        CHECK(mean[1].loss == 1); // of 0.5 and 1.5
        CHECK(mean[2].loss == 1.0 / 3);
        CHECK(mean[1].validation_loss == 1);
        CHECK(mean[1].validation_accuracy == 0.5);
        // One of 120 epochs has every second, one of 60 each: both have every second.
        const auto unlike = mean_curve({curve_of(epochs(120)), curve_of(epochs(60))});
        CHECK(unlike.size() == 60);
        CHECK(unlike.front().epoch == 2);
    }

    TEST_CASE("result_list: a curve comes back to four digits, and support vector machines have none") {
        const temporary_folder folder;
        const auto path = folder / "evaluation.jsonl";
        training_result made;
        made.settings = {{"network", "net"}};
        made.confusion = tactnet::confusion_matrix(2);
        made.confusion.add(0, 0);
        result_list(path).add(made);
        const std::string before = text_of(path);
        CHECK(!has(before, "curve"));
        CHECK(result_list(path).all().begin()->second.curve.empty());

        CHECK(std::isnan(result_list(path).all().begin()->second.reflected_accuracy));

        made.settings["network"] = "other";
        made.reflected_accuracy = 0.75;
        made.curve = {{1, 0.1, 1.0 / 3, std::nan(""), std::nan("")}, {2, 0.1, 1e-7 / 3, 2.0 / 3, 1}};
        result_list(path).add(made);
        CHECK(text_of(path).starts_with(before));
        const result_list read(path);
        CHECK(read.find(made.settings)->reflected_accuracy == 0.75);
        const auto& curve = read.find(made.settings)->curve;
        REQUIRE(curve.size() == 2);
        CHECK(curve[0].epoch == 1);
        CHECK(curve[0].loss == 0.3333);
        CHECK(std::isnan(curve[0].validation_loss));
        CHECK(std::isnan(curve[0].validation_accuracy));
        CHECK(curve[1].loss == 3.333e-08);
        CHECK(curve[1].validation_loss == 0.6667);
        CHECK(curve[1].validation_accuracy == 1);

        const std::string line =
            R"({"settings":{},"validation_accuracy":1,"training_accuracy":1,"reflected_accuracy":null,)"
            R"("epochs":1,"seconds":1,"classes":1,"confusion":[1],"curve":[[1,0.5,0.5]]})";
        tactnet::write_file(path, tactnet::with_checksum(line) + '\n');
        CHECK_THROWS_WITH_AS(result_list{path},
                             (path.string() + ": line 1: expected a result of tactnet evaluate, found "
                                              "'expected 4 numbers of an epoch, found [1,0.5,0.5]'")
                                 .c_str(),
                             tactnet::file_error);
    }

    TEST_CASE("result_list: bins of probabilities come back, and impossible ones are refused") {
        const temporary_folder folder;
        const auto path = folder / "evaluation.jsonl";
        training_result made;
        made.settings = {{"network", "net"}};
        made.confusion = tactnet::confusion_matrix(1);
        made.confusion.add(0, 0);
        result_list(path).add(made);
        CHECK_FALSE(result_list(path).find(made.settings)->calibration);
        made.settings["network"] = "other";
        made.calibration.emplace();
        made.calibration->scaling.temperature = 2.0 / 3;
        made.calibration->before.add(0.7, true);
        made.calibration->before.add(0.72, false);
        made.calibration->after.add(1.0 / 3, true);
        result_list(path).add(made);
        const auto read = result_list(path).find(made.settings)->calibration;
        REQUIRE(read.has_value());
        CHECK(read->scaling.temperature == 2.0 / 3);
        CHECK(read->before.bins()[10].count == 2);
        CHECK(read->before.bins()[10].right == 1);
        CHECK(read->before.calibration_error() == doctest::Approx(0.21));
        CHECK(read->before.brier_score() == doctest::Approx((0.09 + 0.72 * 0.72) / 2));
        CHECK(read->after.calibration_error() == doctest::Approx(2.0 / 3));

        const std::string bins = "[[2,1,1.42,0.6]" + [] {
            std::string others;
            for (int b = 1; b < 15; ++b)
                others += ",[0,0,0.0,0.0]";
            return others;
        }() + "]";
        const auto error_of = [&](const std::string& temperature, const std::string& after) -> std::string {
            const std::string line =
                R"({"settings":{},"validation_accuracy":1,"training_accuracy":1,"reflected_accuracy":null,)"
                R"("epochs":1,"seconds":1,"classes":1,"confusion":[1],"calibration":{"temperature":)" +
                temperature + ",\"before\":" + bins + ",\"after\":" + after + "}}";
            tactnet::write_file(path, tactnet::with_checksum(line) + '\n');
            try {
                result_list{path};
            } catch (const tactnet::file_error& error) {
                return error.what();
            }
            return "";
        };
        const auto with = [&](const std::string& first) {
            return '[' + first + bins.substr(std::string_view("[[2,1,1.42,0.6]").size());
        };
        CHECK(error_of("0.5", bins).empty());
        for (const char* wrong : {"0", "-1", "null", "\"1\""})
            CHECK(has(error_of(wrong, bins), "expected a result of tactnet evaluate, found"));
        for (const char* wrong : {"[2,3,1.4,0.6]", "[2,1,2.4,0.6]", "[2,1,-0.1,0.6]", "[2,1,1.4,2.1]",
                                  "[2,1,1.4]", "[-2,1,1.4,0.6]", "[2,1,null,0.6]"})
            CHECK_MESSAGE(has(error_of("0.5", with(wrong)), "expected a result of tactnet evaluate, found"),
                          wrong);
        CHECK(has(error_of("0.5", "[]"), "expected 15 bins of probabilities"));
    }

    TEST_CASE(
        "result_list: a training by another version or instruction set is found where there is no own") {
        const temporary_folder folder;
        training_result made;
        made.settings = {
            {"network", "net"}, {"seed", "1"}, {"library", "0.1.0"}, {"instruction_set", "scalar"}};
        made.confusion = tactnet::confusion_matrix(2);
        made.confusion.add(0, 0);
        result_list list(folder / "evaluation.jsonl");
        list.add(made);
        tactnet::file_metadata wanted = made.settings;
        wanted["library"] = "0.2.0", wanted["instruction_set"] = "simd_avx2";
        CHECK(list.find(wanted) == nullptr);
        REQUIRE(list.find_elsewhere(wanted) != nullptr);
        CHECK(list.find_elsewhere(wanted)->settings == made.settings);
        wanted["seed"] = "2";
        CHECK(list.find_elsewhere(wanted) == nullptr);
    }

    TEST_CASE("result_list: a line without a checksum is refused") {
        const temporary_folder folder;
        const auto path = folder / "evaluation.jsonl";
        tactnet::write_file(path, std::string("{}\n"));
        CHECK_THROWS_WITH_AS(result_list{path},
                             (path.string() +
                              ": line 1: expected a result of tactnet evaluate, found 'a line "
                              "without a checksum'")
                                 .c_str(),
                             tactnet::file_error);
    }
}

// The rows of a study: the front, results as they are kept, CSV and JSON lines, tables, the page and
// pictures.

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
#include <study/page.hpp>
#include <study/pictures.hpp>
#include <study/rows.hpp>
#include <support/files/data_folder.hpp>
#include <support/files/temporary_folder.hpp>
#include <support/run_program.hpp>
#include <utility>
#include <vector>

using namespace support;
using tactnet::split_rule;

namespace {

using titles = std::vector<std::string>;

titles front_of(const std::vector<study_row>& rows, split_rule rule = split_rule::random) {
    titles found;
    for (const study_row* row : pareto_front(rows, rule))
        found.push_back(title_of(*row));
    return found;
}

std::string markdown(const std::vector<study_row>& rows) {
    return study_markdown(rows, {"images", "program"});
}
std::string page(const std::vector<study_row>& rows) {
    return study_page(rows, {}, {"images", "program"});
}

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

} // namespace

TEST_SUITE("program") {
    TEST_CASE("pareto_front: no method of it is both slower and less accurate than another") {
        CHECK(front_of({}).empty());
        CHECK(front_of({studied("slow", 0.9, 30), studied("fast", 0.8, 10), studied("worse", 0.7, 20)}) ==
              titles{"fast 7x13", "slow 7x13"});
        CHECK(front_of({studied("slow", 0.9, 30), studied("best", 0.95, 20)}) == titles{"best 7x13"});
        // Not more accurate, but slower: it has no place there.
        CHECK(front_of({studied("first", 0.9, 10), studied("second", 0.9, 20)}) == titles{"first 7x13"});
        // Of equal times the most accurate, and of equal methods the first; two recipes take equally long.
        CHECK(front_of({studied("worse", 0.8, 10), studied("better", 0.9, 10), studied("last", 0.7, 10)}) ==
              titles{"better 7x13"});
        CHECK(front_of({studied("net", 0.8, 10), studied("net", 0.85, 10, "published")}) ==
              titles{"net 7x13, published"});
        CHECK(front_of({studied("net", 0.8, 10), studied("net", 0.8, 10, "published")}) ==
              titles{"net 7x13"});
        // Only of rows with all their splits and a time.
        std::vector<study_row> rows{studied("whole", 0.8, 20), studied("few", 0.99, 10),
                                    studied("untimed", 0.99, 10), studied("blocked", 0.99, 10)};
        rows[1].accuracies.front().splits = 19;
        rows[2].latency.reset();
        rows[3].accuracies.front().rule = split_rule::blocked;
        rows.push_back(not_run("lost", "needs a file"));
        CHECK(front_of(rows) == titles{"whole 7x13"});
        CHECK(front_of(rows, split_rule::blocked) == titles{"blocked 7x13"});
        // Pictures and tables show random splits if a row has any.
        CHECK(shown_rule(rows) == split_rule::random);
        CHECK(shown_rule({rows[3]}) == split_rule::blocked);
    }

    TEST_CASE("title_of: names 8 bits and a recipe other than the default") {
        study_row row = studied("net", 0.8, 10, "thorough");
        CHECK(title_of(row) == "net 7x13, thorough");
        row.bits = 8;
        CHECK(title_of(row) == "net in 8 bits 7x13, thorough");
        CHECK(method_title(row) == "net in 8 bits");
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

    TEST_CASE("result_list: a result comes back as it was") {
        const temporary_folder folder;
        const auto path = folder / "evaluation.jsonl";
        training_result made;
        made.settings = {{"network", "machine"}};
        made.confusion = tactnet::confusion_matrix(2);
        made.confusion.add(0, 1);
        result_list(path).add(made);
        const std::string before = text_of(path);
        made.settings["network"] = "net";
        made.reflected_accuracy = 0.75;
        made.calibration.emplace();
        made.calibration->scaling.temperature = 2.0 / 3;
        made.calibration->before.add(0.7, true);
        made.calibration->before.add(0.72, false);
        made.calibration->after.add(1.0 / 3, true);
        made.decisions = {{"set_size", {231, 220}}};
        result_list(path).add(made);
        CHECK(text_of(path).starts_with(before));

        const result_list read(path);
        const training_result &machine = *read.find({{"network", "machine"}}),
                              &net = *read.find(made.settings);
        CHECK(std::isnan(machine.reflected_accuracy));
        CHECK_FALSE(machine.calibration);
        CHECK(machine.decisions.empty());
        CHECK(machine.confusion.count(0, 1) == 1);
        CHECK(machine.confusion.total() == 1);
        CHECK(net.reflected_accuracy == 0.75);
        REQUIRE(net.calibration.has_value());
        CHECK(net.calibration->scaling.temperature == 2.0 / 3);
        CHECK(net.calibration->before.bins()[10].count == 2);
        CHECK(net.calibration->before.bins()[10].right == 1);
        CHECK(net.calibration->before.calibration_error() == doctest::Approx(0.21));
        CHECK(net.calibration->before.brier_score() == doctest::Approx((0.09 + 0.72 * 0.72) / 2));
        CHECK(net.calibration->after.calibration_error() == doctest::Approx(2.0 / 3));
        CHECK(net.decisions.at("set_size").sum == 231);
        CHECK(net.decisions.at("set_size").count == 220);
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

    TEST_CASE("study_markdown: tables between comments, with the reasons of missing rows") {
        std::vector<study_row> rows{studied("net|a", 0.875, 10), not_run("lost", "needs a file")};
        rows[0].accuracies.front().wanted = 25;
        CHECK(!has(markdown(rows), "study front")); // not all of its splits are there
        const std::string text = markdown(rows);
        CHECK(has(text, "<!-- study methods -->\n| method |"));
        CHECK(has(text, "| net\\|a | 7 × 13 | default | 87.50 ± 1.00 (20 of 25) | |"));
        CHECK(has(text, "\n\n- lost 28x50: needs a file\n<!-- study methods ends -->\n"));
    }

    TEST_CASE("study_page: names that would be HTML are text") {
        const std::string markup = "<b>&\"it\"", as_text = "&lt;b&gt;&amp;&quot;it&quot;";
        std::vector<study_row> rows{studied("fast" + markup, 0.8, 10), studied("best" + markup, 0.9, 20),
                                    not_run("lost" + markup, "why" + markup)};
        rows[1].declaration = "own::net<shape{7, 13}, 3>" + markup;
        const std::string text = study_page(
            rows, {{"caption" + markup, "<?xml version=\"1.0\"?>\n<svg>drawn</svg>"}, {"none", ""}},
            {"images" + markup, "program" + markup});
        CHECK(!has(text, markup));
        for (const char* name : {"fast", "best", "lost", "<code>own::net&lt;shape{7, 13}, 3&gt;", "why",
                                 "caption", "images", "program"})
            CHECK_MESSAGE(has(text, name + as_text), name);
        CHECK(has(text, "<figure><svg>drawn</svg><figcaption>caption"));
        CHECK(!has(text, "none</figcaption>"));
        CHECK(text.starts_with("<!DOCTYPE html>"));
        CHECK(text.ends_with("</html>\n"));
    }

    TEST_CASE("study_rows: the mean over reflections follows the mean of images as they are") {
        std::vector<study_row> rows{studied("net", 0.875, 10)};
        CHECK(!has(page(rows), "90.50 ± 0.75"));
        rows[0].accuracies.front().reflected = {0.905, 0.0075};
        rows[0].accuracies.front().reflected_splits = 12;
        CHECK(has(page(rows), "<td>90.50 ± 0.75 (12)</td>"));
        CHECK(has(markdown(rows), "| 87.50 ± 1.00 (20) | 90.50 ± 0.75 (12) |"));
        CHECK(has(study_csv(rows), ",12,0.905,0.0075,"));
    }

    TEST_CASE("study_rows: how sure networks are, before and after a temperature") {
        std::vector<study_row> rows{studied("net", 0.875, 10), studied("machine", 0.5, 1)};
        CHECK(!has(markdown(rows), "study probabilities"));
        rows[0].probabilities.emplace();
        rows[0].probabilities->scaling.temperature = 0.654;
        rows[0].probabilities->before.add(0.5, true);
        rows[0].probabilities->after.add(0.9, true);
        const std::string text = markdown(rows);
        CHECK(has(text, "| net | 7 × 13 | default | 0.65 | 50.00 | 10.00 | 0.2500 | 0.0100 |"));
        CHECK(!has(text, "| machine | 7 × 13 | default | 0"));
        CHECK(has(study_csv(rows), ",temperature,softmax_calibration_error,softmax_brier_score,"
                                   "calibration_error,brier_score,"));
    }

    TEST_CASE("study_rows: sets of classes, faults of the sensor and unknown objects") {
        std::vector<study_row> rows{studied("net", 0.875, 10), studied("machine", 0.5, 1)};
        CHECK(!has(markdown(rows), "study decisions"));
        rows[0].decisions = {{"set_coverage", {19, 20}}, {"set_size", {21, 20}}};
        add_means(rows[0].decisions, {{"set_size", {24, 20}}, {"stuck_row_accuracy", {1, 8}}});
        const std::string text = markdown(rows);
        CHECK(has(text, "| net | 7 × 13 | default | 95.00 | 1.125 | 12.50 |"));
        CHECK(has(page(rows), "<h2>From frames to decisions</h2>"));
        const std::string csv = study_csv(rows);
        CHECK(has(csv, ",set_coverage,set_size,stuck_row_accuracy,stuck_row_corrected_accuracy,"));
        CHECK(has(csv, ",0.95,1.125,0.125,,"));
        CHECK(has(study_json_lines(rows), "\"set_size\":1.125,\"stuck_row_accuracy\":0.125"));
    }

    TEST_CASE("study_markdown: a table of the memory of networks, once for all recipes") {
        study_row known = studied("net", 0.9, 10), thorough = studied("net", 0.95, 10, "thorough");
        known.costs.parameter_bytes = 1234;
        known.costs.activation_bytes = 5678;
        CHECK(!has(markdown({known}), "<!-- study memory -->")); // of what is no single type
        known.declaration = thorough.declaration = "own::net";
        const std::string text = markdown({known, studied("other", 0.8, 5), thorough});
        const std::size_t begin = text.find("<!-- study memory -->");
        const std::string memory = text.substr(begin, text.find("<!-- study memory ends", begin) - begin);
        CHECK(memory.ends_with("| net | 7 × 13 | 1 234 | 5 678 |\n"));
        CHECK(!has(memory, "other"));
        CHECK(!has(memory, "thorough"));
    }

    TEST_CASE("study_page: says over which splits its figures are") {
        std::vector<study_row> rows{studied("fast", 0.8, 10), studied("best", 0.9, 20)};
        CHECK(has(page(rows), "more accurate, over random splits."));
        for (study_row& row : rows)
            row.accuracies.front().rule = split_rule::blocked;
        CHECK(has(page(rows), "more accurate, over blocked splits."));
    }

    TEST_CASE("study_pictures: methods by family, and the Pareto front with names that do not overlap") {
        std::vector<study_row> rows{studied("net", 0.9, 10), studied("svm, own", 0.95, 20),
                                    studied("near", 0.951, 30), studied("untimed", 0.99, 5)};
        rows[1].family = method_family::machines;
        rows[3].latency.reset();
        const std::string csv = study_pictures(rows).front().csv;
        CHECK(csv.starts_with(
            "series,x,accuracy,deviation,words\n"
            "touches,10.0,90.0,1.0,net 7x13\\ndefault recipe\\n90.00 ± 1.00 % over 20 random "
            "splits\\n10.0 µs per frame\n"
            "machines,20.0,95.0,1.0,svm; own 7x13\\n")); // no comma: gnuplot ends a text there
        CHECK(has(csv,
                  "\nfront,30.0,95.1,0.0,near 7x13\nnames,30.0,95.1,0.0,near 7x13\nfront,20.0,95.0,0.0,svm; "
                  "own 7x13\nfront,10.0,90.0,0.0,net 7x13\nnames,10.0,90.0,0.0,net 7x13\n"));
        CHECK(!has(csv, "untimed"));
        CHECK(!has(csv, "paper"));
        rows[0].published = find_published("tactnet6", 28, 50);
        CHECK(has(study_pictures(rows).front().csv, "\npaper,103000.0,95.02,1.33,the paper: TactNet-6\\n"));
    }

    TEST_CASE("study_pictures: tactels where a method was tried at several sizes") {
        std::vector<study_row> rows{studied("net", 0.8, 10), studied("net", 0.9, 10),
                                    studied("once", 0.9, 10)};
        CHECK(study_pictures(rows).size() == 1);
        rows[1].rows = 28, rows[1].columns = 50;
        const auto pictures = study_pictures(rows);
        REQUIRE(pictures.size() == 2);
        CHECK(pictures[1].name == "accuracy_and_tactels");
        CHECK(pictures[1].series == std::vector<std::string>{"net default"});
        CHECK(has(pictures[1].csv, "\nnet default,91.0,80.0,1.0,"));
        CHECK(has(pictures[1].csv, "\nnet default,1400.0,90.0,1.0,"));
        CHECK(!has(pictures[1].csv, "once"));
    }
}

// What a study makes of its rows: the front, the table, CSV and JSON lines, the page; and the paper's figures
// beside them.

#include "rows.hpp"

#include <tactnet/io/read_file.hpp>
#include <tactnet/io/safetensors/json_checksum.hpp>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <study/page/markdown.hpp>
#include <study/page/page.hpp>
#include <study/rows.hpp>
#include <support/files/data_folder.hpp>
#include <support/run_program.hpp>
#include <vector>

using namespace support;
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

bool has(const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
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

    TEST_CASE("study_table: how many of the splits, and why a row has none") {
        std::vector<study_row> rows{studied("net", 0.875, 10), not_run("lost", "needs a file")};
        rows[0].accuracies.front().wanted = 25;
        const std::string text = study_table(rows);
        CHECK(has(text, "87.50 ± 1.00 (20 of 25)"));
        CHECK(text.ends_with("lost 28x50: needs a file\n"));
    }

    TEST_CASE("study_page: names that would be HTML are text") {
        const std::string markup = "<b>&\"it\"", as_text = "&lt;b&gt;&amp;&quot;it&quot;";
        std::vector<study_row> rows{studied("fast" + markup, 0.8, 10), studied("best" + markup, 0.9, 20),
                                    not_run("lost" + markup, "why" + markup)};
        rows[1].declaration = "own::net<shape{7, 13}, 3>" + markup;
        rows[1].classes = {"key" + markup, "ball", "arm"};
        rows[1].confusion = tactnet::confusion_matrix(3);
        for (std::size_t c = 0; c < 3; ++c)
            rows[1].confusion.add(c, (c + 1) % 3);
        const std::string page = study_page(
            rows, {{"caption" + markup, "<?xml version=\"1.0\"?>\n<svg>drawn</svg>"}, {"none", ""}},
            "images" + markup);
        CHECK(!has(page, markup));
        for (const char* name :
             {"fast", "best", "lost", "own::net&lt;shape{7, 13}, 3&gt;", "key", "why", "caption", "images"})
            CHECK_MESSAGE(has(page, name + as_text), name);
        CHECK(has(page, "<figure><svg>drawn</svg><figcaption>caption"));
        CHECK(!has(page, "none</figcaption>"));
        CHECK(page.ends_with("</html>\n"));
    }

    TEST_CASE("study_rows: the mean over reflections stands beside that of images as they are") {
        std::vector<study_row> rows{studied("net", 0.875, 10)};
        CHECK(!has(study_page(rows, {}, ""), "90.50 ± 0.75"));
        rows[0].accuracies.front().reflected = {0.905, 0.0075};
        rows[0].accuracies.front().reflected_splits = 12;
        CHECK(has(study_page(rows, {}, ""), "<td title=\"12 splits\">90.50 ± 0.75</td>"));
        CHECK(has(study_markdown(rows, ""), "| 87.50 ± 1.00 (20) | 90.50 ± 0.75 (12) |"));
        CHECK(has(study_csv(rows), ",12,0.905,0.0075,"));
    }

    TEST_CASE("study_markdown: beside each of the paper's methods the fastest that is at least as accurate") {
        std::vector<study_row> rows{studied("slow", 0.96, 1000), studied("fast", 0.95, 10),
                                    studied("fastest", 0.7, 1)};
        CHECK(!has(study_markdown(rows, ""), "study against")); // of other images than the paper's
        rows[1].published = find_published("tactnet6", 28, 50);
        const std::string text = study_markdown(rows, "");
        CHECK(has(text, "| SURF-SVM | 77.64 | 29 | fast 7x13 | 95.00 ± 1.00 (20) | 10.0 | 2 900 |"));
        CHECK(has(text, "| ResNet-NN | 95.36 | 27 039 | slow 7x13 | 96.00 ± 1.00 (20) | 1000.0 | 27 000 |"));
        rows[0].accuracies.clear();
        CHECK(!has(study_markdown(rows, ""), "| ResNet-NN |")); // nothing here is as accurate
    }

    TEST_CASE("study_page: says over which splits its figures are") {
        std::vector<study_row> rows{studied("fast", 0.8, 10), studied("best", 0.9, 20)};
        CHECK(has(study_page(rows, {}, ""), "more accurate, over random splits."));
        CHECK(has(study_page(rows, {}, ""), "all random splits together"));
        for (study_row& row : rows)
            row.accuracies.front().rule = split_rule::blocked;
        CHECK(has(study_page(rows, {}, ""), "more accurate, over blocked splits."));
        CHECK(has(study_page(rows, {}, ""), "all blocked splits together"));
    }

    TEST_CASE("published_results: those of the paper's table, number by number" *
              doctest::test_suite("data")) {
        const auto path = find_data("published_results.csv");
        if (!path)
            return;
        const auto lines = cells_of(*path);
        REQUIRE(lines.at(0) == std::vector<std::string>{"method", "parameters", "test_accuracy_mean_percent",
                                                        "test_accuracy_sd_percent", "t_gpu_s", "t_cpu_s"});
        for (std::size_t i = 1; i < lines.size(); ++i) {
            const published_result* found = find_title(lines[i].at(0), 28, 50);
            REQUIRE_MESSAGE(found != nullptr, lines[i].at(0));
            CAPTURE(found->title);
            CHECK(found->accuracy == std::stod(lines[i].at(2)));
            CHECK(found->deviation == std::stod(lines[i].at(3)));
            CHECK(found->seconds == std::stod(lines[i].at(5)));
        }
        CHECK(std::count_if(published_results.begin(), published_results.end(), [](const auto& p) {
                  return p.rows == 28;
              }) == static_cast<std::ptrdiff_t>(lines.size() - 1));
    }

    TEST_CASE("published_results: those of the paper's figure of resolutions, number by number" *
              doctest::test_suite("data")) {
        const auto path = find_data("published_resolution_results.csv");
        if (!path)
            return;
        const auto lines = cells_of(*path);
        REQUIRE(lines.at(0) == std::vector<std::string>{"method", "rows", "columns",
                                                        "test_accuracy_mean_percent",
                                                        "test_accuracy_sd_percent", "splits"});
        std::ptrdiff_t lower = 0;
        for (std::size_t i = 1; i < lines.size(); ++i) {
            const std::size_t rows = std::stoul(lines[i].at(1)), columns = std::stoul(lines[i].at(2));
            const published_result* found = find_title(lines[i].at(0), rows, columns);
            REQUIRE_MESSAGE(found != nullptr, lines[i].at(0));
            CAPTURE(found->title);
            CAPTURE(rows);
            CHECK(found->accuracy == std::stod(lines[i].at(3)));
            CHECK(found->deviation == std::stod(lines[i].at(4)));
            if (rows == 28)
                continue;
            ++lower;
            CHECK(found->seconds == 0);
        }
        CHECK(std::count_if(published_results.begin(), published_results.end(),
                            [](const auto& p) { return p.rows != 28; }) == lower);
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
}

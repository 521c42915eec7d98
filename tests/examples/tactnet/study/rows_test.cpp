// The rows of a study: the front, results as they are kept, CSV and JSON lines, the page and pictures.

#include "../workshop.hpp"
#include "rows.hpp"

#include <tactnet/io/safetensors/json_checksum.hpp>

#include <cmath>
#include <evaluation/results.hpp>
#include <study/page.hpp>
#include <study/published.hpp>
#include <tuple>

using namespace support;
using tactnet::split_rule;

namespace {

using titles = std::vector<std::string>;
using rows_list = std::vector<study_row>;

titles front_of(const rows_list& rows, split_rule rule = split_rule::random) {
    titles found;
    for (const study_row& row : pareto_front(rows, rule))
        found.push_back(title_of(row));
    return found;
}

std::string page(const rows_list& rows) {
    return study_page(rows, {{"drawn", "what it shows"}}, "images. program");
}

/// The accuracy of a row is of blocked splits.
void make_blocked(study_row& row) {
    for (const std::string name : {"splits", "splits_wanted", "accuracy", "deviation"})
        row.values["blocked_" + name] = std::exchange(row.values["random_" + name], nullptr);
}

/// Lines of a CSV file without quotes, the head first.
std::vector<std::vector<std::string>> cells_of(const std::filesystem::path& path) {
    std::vector<std::vector<std::string>> lines;
    for (const std::string& line : lines_of(text_of(path))) {
        std::istringstream cells(line);
        lines.emplace_back();
        for (std::string cell; std::getline(cells, cell, ',');)
            lines.back().push_back(cell);
    }
    return lines;
}

} // namespace

TEST_SUITE("program") {
    TEST_CASE("pareto_front: no method of it is both slower and less accurate than another") {
        const study_row slow = studied("slow", 0.9, 30), first = studied("first", 0.8, 10);
        const std::pair<rows_list, titles> cases[]{
            {{}, {}},
            {{slow, first, studied("worse", 0.7, 20)}, {"first 7x13", "slow 7x13"}},
            {{slow, studied("best", 0.95, 20)}, {"best 7x13"}},
            // Not more accurate, but slower: it has no place there.
            {{first, studied("second", 0.8, 20)}, {"first 7x13"}},
            // Of equal times the most accurate, and of equal methods the first; two recipes take equally
            // long.
            {{studied("worse", 0.7, 10), first, studied("last", 0.7, 10)}, {"first 7x13"}},
            {{first, studied("first", 0.85, 10, "published")}, {"first 7x13, published"}},
            {{first, studied("first", 0.8, 10, "published")}, {"first 7x13"}},
        };
        for (const auto& [rows, front] : cases)
            CHECK(front_of(rows) == front);
        // Only of rows with all their splits and a time.
        rows_list rows{studied("whole", 0.8, 20), studied("few", 0.99, 10), studied("untimed", 0.99, 10),
                       studied("blocked", 0.99, 10), make_row("lost", 7, 13, "default", 32)};
        rows[1].values["random_splits"] = 19;
        rows[2].values["microseconds"] = nullptr;
        make_blocked(rows[3]);
        CHECK(front_of(rows) == titles{"whole 7x13"});
        CHECK(front_of(rows, split_rule::blocked) == titles{"blocked 7x13"});
        CHECK(most_accurate(rows, split_rule::random) == &rows[1]);
        CHECK(most_accurate({rows[4]}, split_rule::random) == nullptr);
        // Pictures and tables show random splits if a row has any.
        CHECK(shown_rule(rows) == split_rule::random);
        CHECK(shown_rule({rows[3]}) == split_rule::blocked);
    }

    TEST_CASE("title_of: names 8 bits and a recipe other than the default") {
        CHECK(title_of(make_row("net", 7, 13, "default", 32)) == "net 7x13");
        CHECK(title_of(make_row("net", 7, 13, "thorough", 8)) == "net in 8 bits 7x13, thorough");
    }

    TEST_CASE("write_rows: the same members as JSON lines with checksums and as CSV, in every row") {
        const temporary_folder folder;
        rows_list rows{studied("net, \"own\"", 0.875, 10), make_row("lost", 28, 50, "default", 8)};
        rows[0].values["random_validation_accuracy"] = std::nan("");
        write_rows(rows, folder.path(), "rows");
        std::vector<nlohmann::json> read;
        for (const std::string& line : lines_of(text_of(folder / "rows.jsonl"))) {
            const tactnet::checked_json checked = tactnet::check_json(line, "lines");
            CHECK(checked.checksum == tactnet::checksum_state::verified);
            read.push_back(nlohmann::json::parse(checked.text));
        }
        REQUIRE(read.size() == 2);
        CHECK(read[0].at("random_accuracy") == 0.875);
        CHECK(read[0].at("random_validation_accuracy").is_null());
        CHECK(read[1].at("random_accuracy").is_null());
        CHECK(read[1].at("bits") == 8);
        CHECK(read[1].at("line") == 2);
        CHECK(read[1].at("lines") == 2);
        const std::string csv = text_of(folder / "rows.csv");
        CHECK(csv.starts_with("method,rows,columns,recipe,bits,random_splits,random_splits_wanted,"
                              "random_accuracy,random_deviation,random_validation_accuracy,"
                              "random_training_accuracy,random_reflected_splits,random_reflected_accuracy,"
                              "random_reflected_deviation,blocked_splits,"));
        says(csv, ",brier_score,declaration\n\"net, "
                  "\"\"own\"\"\",7,13,default,32,20.0,20.0,0.875,0.01,,,");
        says(csv, "\nlost,28,50,default,8,,,");
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
        using result = std::tuple<std::string, std::size_t, std::size_t, double, double, double>;
        std::set<result> theirs, ours;
        std::map<std::string, double> seconds; // of the paper's own array
        for (const cells& c : std::span(methods).subspan(1)) {
            seconds[c.at(0)] = std::stod(c.at(5));
            theirs.insert({c[0], 28, 50, std::stod(c[2]), std::stod(c[3]), seconds[c[0]]});
        }
        for (const cells& c : std::span(sizes).subspan(1)) {
            const std::size_t rows = std::stoul(c.at(1));
            theirs.insert({c[0], rows, std::stoul(c.at(2)), std::stod(c.at(3)), std::stod(c.at(4)),
                           rows == 28 ? seconds[c[0]] : 0});
        }
        for (const auto& [title, method, rows, columns, accuracy, deviation, time] : published_results)
            ours.insert({std::string(title), rows, columns, accuracy, deviation, time});
        CHECK((ours == theirs));
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
        result_list(path).add(made);
        CHECK(text_of(path).starts_with(before));

        const result_list read(path);
        const training_result &machine = *read.find({{"network", "machine"}}),
                              &net = *read.find(made.settings);
        CHECK(std::isnan(machine.reflected_accuracy));
        CHECK_FALSE(machine.calibration);
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

    TEST_CASE("study_page: tables between comments, of what is known") {
        study_row net = studied("net|a", 0.875, 10);
        says(page({net}), "more accurate, over random splits.");
        says(page({net}), "\n![what it shows](drawn.png)\n\nwhat it shows\n");
        for (const char* table : {"probabilities", "memory"}) // of methods that have such
            says_not(page({net}), std::string("study ") + table);
        net.values["random_splits_wanted"] = 25;
        says_not(page({net}), "study front"); // not all of its splits are there
        net.values["random_reflected_accuracy"] = 0.905;
        net.values["random_reflected_deviation"] = 0.0075;
        net.values["random_reflected_splits"] = 12;
        net.values["published_accuracy"] = 0.9502;
        net.values["published_deviation"] = 0.0133;
        net.values["published_microseconds"] = 103'000;
        net.values["parameters"] = 1234;
        calibration probabilities{{0.654}};
        probabilities.before.add(0.5, true);
        probabilities.after.add(0.9, true);
        put_calibration(net, probabilities);
        net.values["bytes"] = 4936;
        net.values["declaration"] = "own::net";
        study_row thorough = studied("net|a", 0.95, 10, "thorough");
        thorough.values["declaration"] = "own::net";
        const std::string text = page({net, thorough, make_row("lost", 28, 50, "default", 8)});
        for (const char* part :
             {"<!-- study methods -->\n| method |", "<!-- study methods ends -->\n",
              "| net\\|a | 7 × 13 | default | 87.50 ± 1.00 (20 of 25) | 90.50 ± 0.75 (12) | | 95.02 ± 1.33 | "
              "10.0 | | 103 | 1 234 | | |\n",
              "| lost in 8 bits | 28 × 50 | default | | | | | | | | | | |\n",
              "| net\\|a | 7 × 13 | default | 99.00 | |", "| `own::net` |",
              "| net\\|a | 7 × 13 | default | 0.65 | 50.00 | 10.00 | 0.2500 | 0.0100 |",
              "| weights, bytes | working memory, bytes |\n| --- | --- | --- | --- |\n| net\\|a | 7 × 13 | "
              "4 936 | |\n<!-- study memory ends -->"}) // once for all recipes
            says(text, part);
        make_blocked(net);
        says(page({net}), "All blocked splits together.");
    }

    TEST_CASE("study_pictures: methods by family, and the Pareto front with names that do not overlap") {
        rows_list rows{studied("net", 0.9, 10), studied("svm, own", 0.95, 20), studied("near", 0.951, 30),
                       studied("untimed", 0.99, 5)};
        rows[1].family = "machines";
        rows[3].values["microseconds"] = nullptr;
        const std::string csv = study_pictures(rows).front().csv;
        CHECK(csv.starts_with("series,x,accuracy,deviation,label\ntouches,10.0,90.0,1.0,\n"
                              "machines,20.0,95.0,1.0,\n"));
        says(csv, // no comma in a name: gnuplot ends a text there
             "\nfront,30.0,95.1,0.0,\nnames,30.0,95.1,0.0,near 7x13\nfront,20.0,95.0,0.0,\n"
             "front,10.0,90.0,0.0,\nnames,10.0,90.0,0.0,net 7x13\n");
        says_not(csv, "5.0,99");
        says_not(csv, "paper");
        rows[0].values["published_accuracy"] = 0.9;
        says(study_pictures(rows).front().csv, "\npaper,103000.0,95.02,1.33,\n");
    }

    TEST_CASE("study_pictures: tactels where a method was tried at several sizes") {
        rows_list rows{studied("net", 0.8, 10), studied("net", 0.9, 10), studied("once", 0.9, 10)};
        CHECK(study_pictures(rows).size() == 1);
        rows[1].values["rows"] = 28, rows[1].values["columns"] = 50;
        const auto pictures = study_pictures(rows);
        REQUIRE(pictures.size() == 2);
        CHECK(pictures[1].name == "accuracy_and_tactels");
        CHECK(pictures[1].series == std::vector<std::string>{"net default"});
        says(pictures[1].csv, "\nnet default,91.0,80.0,1.0,");
        says(pictures[1].csv, "\nnet default,1400.0,90.0,1.0,");
        says_not(pictures[1].csv, "once");
    }

    TEST_CASE("csv_of: a head and a line for each object, empty fields for what is not known") {
        const std::pair<std::vector<nlohmann::ordered_json>, const char*> cases[]{
            {{}, ""},
            {{{{"name", "b"}, {"count", 18'446'744'073'709'551'615U}}, {{"name", ""}, {"count", 1e-300}}},
             "name,count\nb,18446744073709551615\n,1e-300\n"},
            {{{{"a", nullptr}, {"b", std::nan("")}},
              {{"a", 1}, {"b", std::numeric_limits<double>::infinity()}}},
             "a,b\n,\n1,\n"},
            {{{{"a", "one, two"}, {"b", "\"so\""}, {"c", "a\nb"}, {"d", "a\rb"}, {"e", "it's"}}},
             "a,b,c,d,e\n\"one, two\",\"\"\"so\"\"\",\"a\nb\",\"a\rb\",it's\n"},
        };
        for (const auto& [rows, text] : cases)
            CHECK(csv_of(rows) == text);
    }
}

// What the page of a study tells of classes, of splits and of how networks learn.

#include "rows.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors/json_checksum.hpp>
#include <tactnet/io/write_file.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <evaluation/results.hpp>
#include <limits>
#include <reports/html.hpp>
#include <string>
#include <string_view>
#include <study/page/class_rates.hpp>
#include <study/page/learning_curves.hpp>
#include <study/split_rules.hpp>
#include <support/files/temporary_folder.hpp>
#include <support/run_program.hpp>
#include <utility>
#include <vector>

using namespace support;
using tactnet::epoch_report;
using tactnet::split_rule;

namespace {

/// Counts by true class, then by recognised one.
study_row confused(std::vector<std::string> classes, const std::vector<std::size_t>& counts) {
    study_row row = studied("net", 0.9, 10);
    row.confusion = tactnet::confusion_matrix(classes.size());
    for (std::size_t i = 0; i < counts.size(); ++i)
        for (std::size_t n = 0; n < counts[i]; ++n)
            row.confusion.add(i / classes.size(), i % classes.size());
    row.classes = std::move(classes);
    return row;
}

bool has(const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
}

std::vector<epoch_report> epochs(std::size_t count) {
    std::vector<epoch_report> all;
    for (std::size_t e = 1; e <= count; ++e)
        all.push_back({e, 0.1, 1.0 / static_cast<double>(e), 2.0 / static_cast<double>(e), 0.5});
    return all;
}
std::vector<std::size_t> numbers_of(const std::vector<epoch_report>& curve) {
    std::vector<std::size_t> numbers;
    for (const epoch_report& e : curve)
        numbers.push_back(e.epoch);
    return numbers;
}

} // namespace

TEST_SUITE("program") {
    TEST_CASE("class_rates: sensitivity along a class's images, precision along what is taken for it") {
        const study_row row = confused({"arm", "ball", "key"}, {8, 2, 0, //
                                                                1, 9, 0, //
                                                                0, 3, 7});
        const std::vector<class_rate> rates = class_rates(row);
        REQUIRE(rates.size() == 3);
        CHECK(rates[0].name == "ball"); // 9 of the 14 that are taken for one
        CHECK(rates[0].precision == 9.0 / 14);
        CHECK(rates[0].sensitivity == 0.9);
        CHECK(rates[0].taken_for == "arm");
        CHECK(rates[0].times == 1);
        CHECK(rates[1].name == "key");
        CHECK(rates[1].sensitivity == 0.7);
        CHECK(rates[1].precision == 1);
        CHECK(rates[1].taken_for == "ball");
        CHECK(rates[1].times == 3);
        CHECK(rates[2].name == "arm");
        CHECK(rates[2].sensitivity == 0.8);
        CHECK(rates[2].precision == 8.0 / 9);
        CHECK(rates[2].images == 10);
        const std::string text = class_rates_table(row, split_rule::blocked);
        CHECK(has(text, "<h2>How well net 7x13 knows each class</h2>"));
        CHECK(has(text, "<tr><td>key</td><td>10</td><td>70.0</td>"));
        CHECK(has(text, "<td>ball, 3 of 10</td>"));
        CHECK(has(text, "60 to 100"));
        CHECK(has(text, "All blocked splits together"));
    }

    TEST_CASE("class_rates: classes without images, or that nothing is taken for") {
        const study_row row = confused({"none", "never", "sure"}, {0, 0, 0, //
                                                                   0, 0, 5, //
                                                                   0, 0, 5});
        const std::vector<class_rate> rates = class_rates(row);
        CHECK(rates[0].name == "never");
        CHECK(rates[0].sensitivity == 0);
        CHECK(std::isnan(rates[0].precision));
        CHECK(rates[1].name == "sure");
        CHECK(rates[1].taken_for.empty());
        CHECK(rates[2].name == "none"); // nothing is known of it
        CHECK(std::isnan(rates[2].worst()));
        const std::string text = class_rates_table(row, split_rule::random);
        CHECK(has(text, "<tr><td>none</td><td>0</td><td></td><td></td><td></td><td></td><td></td></tr>"));
        CHECK(!has(text, "nan"));
    }

    TEST_CASE("split_rules_table: methods with both, the one that loses least first") {
        std::vector<study_row> rows{studied("much", 0.95, 10), studied("little", 0.9, 10),
                                    studied("half", 0.99, 10)};
        CHECK(split_rules_table(rows).empty());
        rows[0].accuracies.push_back({split_rule::blocked, 20, 20, {0.85, 0.01}, 0.9, 1});
        rows[1].accuracies.push_back({split_rule::blocked, 20, 20, {0.88, 0.01}, 0.9, 1});
        const std::string text = split_rules_table(rows);
        const std::size_t first =
                              text.find("<tr><td>little 7x13</td><td>90.00</td><td>88.00</td><td>2.00</td>"),
                          second =
                              text.find("<tr><td>much 7x13</td><td>95.00</td><td>85.00</td><td>10.00</td>");
        REQUIRE(first != std::string::npos);
        REQUIRE(second != std::string::npos);
        CHECK(first < second);
        CHECK(!has(text, "half"));
        CHECK(has(text, "80 to 100"));
        CHECK(has(text, "<i style=\"left:25.0%;width:50.0%\"></i>")); // 85 to 95 of 80 to 100
    }

    TEST_CASE("bar_cell: stays on its axis, which begins at or below what it shows") {
        for (const double lowest : {0.0, 0.5, 42.0, 85.0, 99.9, 100.0}) {
            CAPTURE(lowest);
            CHECK(axis_below(lowest) <= lowest);
            CHECK(axis_below(lowest) >= 0);
            CHECK(axis_below(lowest) <= 95);
        }
        CHECK(has(bar_cell(100, 80, 80), "left:0.0%;width:100.0%"));
        CHECK(has(bar_cell(70, 110, 80), "left:0.0%;width:100.0%"));
        CHECK(has(bar_cell(90, 90, 80), "left:50.0%;width:0.0%"));
    }

    TEST_CASE("curve_of: at most 60 epochs, round numbers apart") {
        CHECK(curve_of({}).empty());
        CHECK(numbers_of(curve_of(epochs(3))) == std::vector<std::size_t>{1, 2, 3});
        for (const auto& [count, step] : std::vector<std::pair<std::size_t, std::size_t>>{{60, 1},
                                                                                          {61, 2},
                                                                                          {110, 2},
                                                                                          {121, 5},
                                                                                          {300, 5},
                                                                                          {301, 10},
                                                                                          {1000, 20},
                                                                                          {1201, 50},
                                                                                          {10'000, 200}}) {
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

    TEST_CASE("result_list: a curve comes back to four digits, and lines made before have none") {
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
            R"({"settings":{},"validation_accuracy":1,"epochs":1,"seconds":1,)"
            R"("images_per_second":1,"classes":1,"confusion":[1],"curve":[[1,0.5,0.5]]})";
        tactnet::write_file(path, tactnet::with_checksum(line) + '\n');
        CHECK_THROWS_WITH_AS(result_list{path},
                             (path.string() + ": line 1: expected a result of tactnet evaluate, found "
                                              "'expected 4 numbers of an epoch, found [1,0.5,0.5]'")
                                 .c_str(),
                             tactnet::file_error);
    }

    TEST_CASE("learning_curves_picture: the best row of each network that has a curve") {
        std::vector<study_row> rows{studied("svm", 0.99, 10), studied("net", 0.8, 10),
                                    studied("net", 0.9, 10, "published"), studied("other", 0.85, 10)};
        CHECK(learning_curves_picture(rows).name.empty());
        rows[1].curve = rows[2].curve = epochs(3);
        rows[3].curve = epochs(30);
        const study_picture picture = learning_curves_picture(rows);
        CHECK(picture.name == "learning_curves");
        CHECK(has(picture.caption, "random splits"));
        CHECK(has(picture.script, "title 'net 7x13, published', $curve1 using 1:4"));
        CHECK(has(picture.script, "title 'other 7x13'\n"));
        CHECK(!has(picture.script, "title 'net 7x13'"));
        CHECK(!has(picture.script, "svm"));
        CHECK(has(picture.script, "set logscale x\n")); // 3 epochs beside 30
        CHECK(has(picture.script, "$curve0 << END\n1 1 2 50\n2 0.5 1 50\n"));
    }
}

// What the page, the Markdown and the pictures of a study show of its rows.

#include "rows.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <reports/pictures.hpp>
#include <string>
#include <string_view>
#include <study/page.hpp>
#include <study/pictures.hpp>
#include <utility>
#include <vector>

using namespace support;
using tactnet::epoch_report;
using tactnet::split_rule;

namespace {

std::string markdown(const std::vector<study_row>& rows) {
    return study_markdown(rows, {"images", "program"});
}
std::string page(const std::vector<study_row>& rows) {
    return study_page(rows, {}, {"images", "program"});
}

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

const study_picture* find_picture(const std::vector<study_picture>& pictures, std::string_view name) {
    for (const study_picture& picture : pictures)
        if (picture.name == name)
            return &picture;
    return nullptr;
}

} // namespace

TEST_SUITE("program") {
    TEST_CASE("methods_table: how many of the splits, and why a row has none") {
        std::vector<study_row> rows{studied("net", 0.875, 10), not_run("lost", "needs a file")};
        rows[0].accuracies.front().wanted = 25;
        const study_table methods = methods_table(rows);
        CHECK(has(table(methods.cells), "87.50 ± 1.00 (20 of 25)"));
        CHECK(methods.notes == "- lost 28x50: needs a file\n");
    }

    TEST_CASE("study_markdown: tables between comments, with the reasons of missing rows") {
        const std::string text = markdown({studied("net|a", 0.875, 10), not_run("lost", "needs a file")});
        CHECK(has(text, "<!-- study front -->\n| method |"));
        CHECK(has(text, "\n<!-- study front ends -->\n"));
        CHECK(has(text, "| net\\|a | 7 × 13 | default | 87.50 ± 1.00 (20) | |"));
        CHECK(has(text, "\n\n- lost 28x50: needs a file\n<!-- study methods ends -->\n"));
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
        const std::string text = study_page(
            rows, {{"caption" + markup, "<?xml version=\"1.0\"?>\n<svg>drawn</svg>"}, {"none", ""}},
            {"images" + markup, "program" + markup});
        CHECK(!has(text, markup));
        for (const char* name : {"fast", "best", "lost", "<code>own::net&lt;shape{7, 13}, 3&gt;", "key",
                                 "why", "caption", "images", "program"})
            CHECK_MESSAGE(has(text, name + as_text), name);
        CHECK(has(text, "<figure><svg>drawn</svg><figcaption>caption"));
        CHECK(!has(text, "none</figcaption>"));
        CHECK(text.starts_with("<!DOCTYPE html>"));
        CHECK(text.ends_with("</html>\n"));
    }

    TEST_CASE("html_table: a matrix of counts shows their share of the row") {
        const std::string text = html_table({{"", "a", "b"}, {"a", "3", "1"}, {"b", "", ""}}, true);
        CHECK(has(text, "<tr><th>a</th><td style=\"background:rgba(var(--mark),0.700)\">3</td>"));
        CHECK(has(text, "<tr><th>b</th><td></td><td></td></tr>"));
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

    TEST_CASE("study_markdown: for each of the paper's methods the fastest that is at least as accurate") {
        std::vector<study_row> rows{studied("slow", 0.96, 1000), studied("fast", 0.95, 10),
                                    studied("fastest", 0.7, 1)};
        CHECK(!has(markdown(rows), "study against")); // of other images than the paper's
        rows[1].published = find_published("tactnet6", 28, 50);
        const std::string text = markdown(rows);
        CHECK(has(text, "| SURF-SVM | 77.64 | fast 7x13 | 95.00 ± 1.00 (20) | 10.0 |"));
        CHECK(has(text, "| ResNet-NN | 95.36 | slow 7x13 | 96.00 ± 1.00 (20) | 1000.0 |"));
        rows[0].accuracies.clear();
        CHECK(!has(markdown(rows), "| ResNet-NN |")); // nothing here is as accurate
    }

    TEST_CASE("study_markdown: a table of memory where bytes of code are known, once for all recipes") {
        study_row known = studied("net", 0.9, 10), thorough = studied("net", 0.95, 10, "thorough");
        known.costs.parameter_bytes = 1234;
        known.costs.activation_bytes = 5678;
        CHECK(!has(markdown({known}), "<!-- study memory -->"));
        known.code_bytes = thorough.code_bytes = 30'303;
        const std::string text = markdown({known, studied("other", 0.8, 5), thorough});
        const std::size_t begin = text.find("<!-- study memory -->");
        const std::string memory = text.substr(begin, text.find("<!-- study memory ends", begin) - begin);
        CHECK(memory.ends_with("| net | 7 × 13 | 1 234 | 5 678 | 30 303 |\n"));
        CHECK(!has(memory, "other"));
        CHECK(!has(memory, "thorough"));
    }

    TEST_CASE("study_page: says over which splits its figures are") {
        std::vector<study_row> rows{studied("fast", 0.8, 10), confused({"a", "b"}, {3, 0, 1, 2})};
        CHECK(has(page(rows), "more accurate, over random splits."));
        CHECK(has(page(rows), "all random splits together"));
        for (study_row& row : rows)
            row.accuracies.front().rule = split_rule::blocked;
        CHECK(has(page(rows), "more accurate, over blocked splits."));
        CHECK(has(page(rows), "all blocked splits together"));
    }

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
        const std::string text = markdown({row});
        CHECK(has(text, "## How well net 7x13 knows each class\n"));
        CHECK(has(text, "| key | 10 | 70.0 | 100.0 | ball, 3 of 10 |\n"));
        CHECK(has(text, "| key | | 3 | 7 |\n")); // the confusion matrix
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
        const std::string text = markdown({row});
        CHECK(has(text, "| none | 0 | | | |\n"));
        CHECK(!has(text, "nan"));
    }

    TEST_CASE("study_tables: methods with both kinds of splits, the one that loses least first") {
        std::vector<study_row> rows{studied("much", 0.95, 10), studied("little", 0.9, 10),
                                    studied("half", 0.99, 10)};
        CHECK(!has(markdown(rows), "split rules"));
        rows[0].accuracies.push_back({split_rule::blocked, 20, 20, {0.85, 0.01}, 0.9, 1});
        rows[1].accuracies.push_back({split_rule::blocked, 20, 20, {0.88, 0.01}, 0.9, 1});
        CHECK(has(markdown(rows), "| little 7x13 | 90.00 | 88.00 | 2.00 |\n"
                                  "| much 7x13 | 95.00 | 85.00 | 10.00 |\n<!-- study split rules ends -->"));
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

    TEST_CASE(
        "study_pictures: a peer stands at its time and the highest accuracy of its network, or nowhere") {
        const std::vector<study_row> rows{studied("net", 0.8, 10), studied("net", 0.9, 10, "thorough"),
                                          studied("other", 0.99, 5)};
        const auto csv = [&](const std::vector<peer_time>& peers) {
            return study_pictures(rows, peers).front().csv;
        };
        const std::string none = csv({});
        CHECK(!has(none, "peers"));
        CHECK(csv({{"onednn", "net", 28, 50, 30}, {"onednn", "lost", 7, 13, 30}}) == none);
        const std::vector<peer_time> one{{"onednn", "net", 7, 13, 30.25}};
        CHECK(has(csv(one), "\npeers,30.25,90.0,0.0,net 7x13 by onednn\\n30.2 µs per frame\n"));
        CHECK(has(study_pictures(rows, one).front().caption, "run by another library"));
        CHECK(csv({{"onednn", "net", 7, 13, 30.25, 8}}) == none); // of which there is no row
    }

    TEST_CASE("study_pictures: tactels where a method was tried at several sizes") {
        std::vector<study_row> rows{studied("net", 0.8, 10), studied("net", 0.9, 10),
                                    studied("once", 0.9, 10)};
        CHECK(find_picture(study_pictures(rows), "accuracy_and_tactels") == nullptr);
        rows[1].rows = 28, rows[1].columns = 50;
        const auto pictures = study_pictures(rows);
        const study_picture* const tactels = find_picture(pictures, "accuracy_and_tactels");
        REQUIRE(tactels != nullptr);
        CHECK(tactels->series == std::vector<std::string>{"net default"});
        CHECK(has(tactels->csv, "\nnet default,91.0,80.0,1.0,"));
        CHECK(has(tactels->csv, "\nnet default,1400.0,90.0,1.0,"));
        CHECK(!has(tactels->csv, "once"));
    }

    TEST_CASE("study_pictures: learning curves of the best row of each network that has one") {
        std::vector<study_row> rows{studied("svm", 0.99, 10), studied("net", 0.8, 10),
                                    studied("net", 0.9, 10, "published"), studied("other", 0.85, 10)};
        CHECK(find_picture(study_pictures(rows), "learning_curves") == nullptr);
        rows[1].curve = rows[2].curve = epochs(3);
        rows[3].curve = epochs(30);
        const auto pictures = study_pictures(rows);
        const study_picture* const curves = find_picture(pictures, "learning_curves");
        REQUIRE(curves != nullptr);
        CHECK(has(curves->caption, "random splits"));
        CHECK(curves->series == std::vector<std::string>{"net 7x13, published", "other 7x13"});
        CHECK(has(curves->csv, "\n2,0.5,1.0,0.5,0.5,1.0,0.5\n"));
    }

    TEST_CASE("learning_curves_csv: an epoch that a training does not have is empty") {
        std::vector<epoch_report> half = epochs(2);
        half.erase(half.begin());
        half[0].validation_loss = std::nan("");
        const std::vector<titled_curve> curves{{"a", epochs(2)}, {"b", half}};
        CHECK(learning_curves_csv(curves) ==
              "epoch,a: loss,a: validation_loss,a: validation_accuracy,b: loss,b: validation_loss,b: "
              "validation_accuracy\n1,1.0,2.0,0.5,,,\n2,0.5,1.0,0.5,0.5,,0.5\n");
        CHECK(learning_curves_csv({}).empty());
    }
}

// tactnet study and tactnet recommend.

#include "../workshop.hpp"

#include <tactnet/io/safetensors/json_checksum.hpp>
#include <tactnet/io/write_file.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

using namespace support;

namespace {

/// A study of two methods on 7 × 13 tactels, in single precision.
words study(const std::string& results_and_more) {
    return words(("study --data DATA --methods tactnet4,svm-linear --sizes 7x13 --recipes default --splits 2 "
                  "--bits 32 --results " +
                  results_and_more)
                     .c_str());
}

/// What of the table does not depend on the machine or the hour: all up to the first time.
std::vector<std::string> accuracies_in(const std::string& csv) {
    std::vector<std::string> lines = lines_of(csv);
    const std::string head = lines.at(0);
    const std::size_t end = head.find(",microseconds");
    const auto columns = static_cast<std::size_t>(
                             std::count(head.begin(), head.begin() + static_cast<std::ptrdiff_t>(end), ',')) +
                         1;
    for (std::string& line : lines) {
        std::size_t place = 0;
        for (std::size_t c = 0; c < columns; ++c)
            place = line.find(',', place) + 1;
        line.resize(place - 1);
    }
    return lines;
}

/// A line as it was before it was given a checksum, its last member.
std::string plain_line(const std::string& line) {
    return line.substr(0, line.rfind(",\"checksum\"")) + '}';
}

/// With another text for a member that has one.
std::string with_member(std::string json, const std::string& name, const std::string& text) {
    const std::size_t begin = json.find('"' + name + "\":\"") + name.size() + 4;
    return json.replace(begin, json.find('"', begin) - begin, text);
}

} // namespace

TEST_SUITE("program") {
    TEST_CASE("study: methods trained and timed once, on one page") {
        const workshop shop;
        const outcome first = shop.succeeds(study("s"));
        says(first.error, "8 trainings to do, of 8 in all");
        CHECK(lines_of(text_of(shop / "s/evaluation.jsonl")).size() == 8);
        CHECK(lines_of(text_of(shop / "s/timings.jsonl")).size() == 2);
        CHECK(lines_of(text_of(shop / "s/study.csv")).size() == 3);
        CHECK(lines_of(text_of(shop / "s/study.jsonl")).size() == 2);
        CHECK(lines_of(text_of(shop / "s/confusion.csv"))[0] == "true class,left,\"middle, of all\",right");
        says(first.out, "svm-linear");

        // The page stands alone, and says all of it.
        const std::string page = text_of(shop / "s/study.html");
        CHECK(page.starts_with("<!DOCTYPE html>"));
        CHECK(page.ends_with("</html>\n"));
        for (const std::string_view part :
             {"tactnet4", "svm-linear", "tactnet::tactnet4&lt;tactnet::shape{7, 13}, 22&gt;",
              "<th>validation, %</th>"})
            says(page, part);
        for (const std::string_view foreign : {"src=", "href=\"http", "url(", "@import"})
            says_not(page, foreign);
        if (fs::exists(shop / "s/accuracy_and_time.png")) // where there is gnuplot
            says(page, "<svg");

        // Tables for a README, each between comments.
        const std::string tables = text_of(shop / "s/study.md");
        for (const std::string_view part : {"<!-- study front -->\n| method |", "<!-- study front ends -->\n",
                                            "| tactnet4 | 7 × 13 | default |", "| svm-linear | 7 × 13 |"})
            says(tables, part);

        const auto before = text_of(shop / "s/study.csv");
        const outcome second = shop.succeeds(study("s"));
        says(second.error, "0 trainings to do, of 8 in all");
        CHECK(text_of(shop / "s/study.csv") == before);
    }

    TEST_CASE("study: networks in 8 bits have rows of their own, of the same trainings") {
        const workshop shop;
        const words both(
            "study --data DATA --methods tactnet4 --sizes 7x13 --recipes default --splits 2 --results s");
        const outcome first = shop.succeeds(both);
        says(first.error, "4 trainings to do, of 4 in all");
        CHECK(lines_of(text_of(shop / "s/evaluation.jsonl")).size() == 8); // each in both
        CHECK(lines_of(text_of(shop / "s/timings.jsonl")).size() == 2);
        const std::vector<std::string> rows = lines_of(text_of(shop / "s/study.jsonl"));
        REQUIRE(rows.size() == 2);
        CHECK(rows[0].find("\"bits\":32") != std::string::npos);
        CHECK(rows[1].find("\"bits\":8") != std::string::npos);
        CHECK(rows[1].find("\"random_splits\":2,") != std::string::npos);
        const std::string tables = text_of(shop / "s/study.md");
        says(tables, "| tactnet4 in 8 bits | 7 × 13 | default |");
        says(text_of(shop / "s/study.html"), ">tactnet4 in 8 bits</td>");

        // It weighs less than a third, so a budget of bytes finds it.
        const outcome small = shop.succeeds("recommend --results s --bytes 12000");
        CHECK(small.out.starts_with("tactnet4 7x13 in 8 bits, default recipe: "));

        // Single precision alone needs no more trainings.
        const outcome second = shop.succeeds(both + "--bits 32");
        says(second.error, "0 trainings to do, of 4 in all");
        CHECK(lines_of(text_of(shop / "s/study.jsonl")).size() == 1);
    }

    TEST_CASE("study: parts of several machines give the table of one, to the last digit") {
        const workshop shop;
        shop.succeeds(study("whole"));
        for (const char* part : {"1", "2"}) {
            const outcome run = shop.succeeds(study("part" + std::string(part) + " --shard " + part + "/2"));
            says(run.error, "4 trainings to do, of 8 in all");
        }
        const outcome merged = shop.succeeds(study("merged --merge part1,part2 --report-only"));
        CHECK(accuracies_in(text_of(shop / "merged/study.csv")) ==
              accuracies_in(text_of(shop / "whole/study.csv")));
        CHECK(lines_of(text_of(shop / "merged/evaluation.jsonl")).size() == 8);
        says(merged.error, "\nwarning: 8 of 8 trainings are there, 0 of 2 methods are timed\n");
        // Again: nothing is doubled.
        shop.succeeds(study("merged --merge part1,part2 --report-only"));
        CHECK(lines_of(text_of(shop / "merged/evaluation.jsonl")).size() == 8);
    }

    TEST_CASE("study: killed, it goes on with what is left, and so do two programs on one folder") {
        const workshop shop;
        shop.succeeds(study("whole"));
        const pid_t child = shop.start(study("killed --jobs 1"));
        for (int i = 0; i < 60'000 && !fs::exists(shop / "killed/evaluation.jsonl"); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        shop.stop(child, SIGKILL);
        const pid_t one = shop.start(study("killed --jobs 1")), other = shop.start(study("killed --jobs 1"));
        CHECK(shop.wait(one).status == 0);
        CHECK(shop.wait(other).status == 0);
        CHECK(lines_of(text_of(shop / "killed/timings.jsonl")).size() == 2); // one of them timed
        CHECK(lines_of(text_of(shop / "killed/evaluation.jsonl")).size() == 8);
        CHECK(accuracies_in(text_of(shop / "killed/study.csv")) ==
              accuracies_in(text_of(shop / "whole/study.csv")));
    }

    TEST_CASE("study: blocked splits alone, and fewer splits than were asked for, are shown as that") {
        const workshop shop;
        const outcome blocked = shop.succeeds(study("s --split blocked"));
        says(text_of(shop / "s/study.html"), "Test accuracy over blocked splits");
        words more = study("s --split blocked --report-only");
        *(std::find(more.begin(), more.end(), "--splits") + 1) = "5";
        const outcome fewer = shop.succeeds(more);
        says(fewer.out, " (2 of 5)");
        CHECK(fewer.error.starts_with("warning: 4 of 10 trainings are there, 2 of 2 methods are timed\n"));
        says(text_of(shop / "s/study.html"), " (2 of 5)</td>");

        // Of another kind of split nothing is there: rows without accuracies, or none.
        says(shop.run(study("s --split random --report-only")).out, "not trained yet");
        const outcome none = shop.succeeds(study("s --split random --report-only --only-trained"));
        CHECK(text_of(shop / "s/study.csv").empty());
    }

    TEST_CASE("study: trainings and times by other programs are reported as that, where there are none of "
              "its own") {
        const workshop shop;
        shop.succeeds(study("s"));
        const std::string table = text_of(shop / "s/study.csv");
        for (const char* file : {"s/evaluation.jsonl", "s/timings.jsonl"}) {
            std::string lines;
            for (const std::string& line : lines_of(text_of(shop / file)))
                lines += tactnet::with_checksum(with_member(with_member(plain_line(line), "library", "0.0.9"),
                                                            "instruction_set", "scalar_sse2")) +
                         '\n';
            tactnet::write_file(shop / file, lines);
        }
        const outcome report = shop.succeeds(study("s --report-only"));
        CHECK(text_of(shop / "s/study.csv") == table);
        const std::string whose = "8 of 8 trainings are by tactnet 0.0.9 for scalar_sse2";
        says(report.error, "warning: " + whose + ", not by this program\n");
        says(report.error, "warning: times are by another program: ");
        says(text_of(shop / "s/study.md"), whose);
        CHECK(text_of(shop / "s/study.html").find("scalar_sse2; tactnet 0.0.9") != std::string::npos);
        // A study that trains takes none of them.
        says(shop.run(study("s --shard 1/2")).error, "4 trainings to do, of 8 in all");
    }

    TEST_CASE("study: what cannot be had has its row, with the reason") {
        const workshop shop;
        const words both(
            "study --data DATA --methods svm-linear,squeezenet-svm --sizes 7x13 --splits 1 --results s");
        const outcome run = shop.succeeds(both);
        const std::string reason =
            "needs SqueezeNet 1.1 trained on photographs, --pretrained squeezenet=FILE";
        says(run.out, "squeezenet-svm 7x13: " + reason);
        says(text_of(shop / "s/study.html"), reason);
        says(text_of(shop / "s/study.csv"), reason);
        shop.succeeds(both + "--report-only --only-trained");
        says_not(text_of(shop / "s/study.csv"), "squeezenet");
    }

    TEST_CASE("study: what it cannot take is said") {
        const workshop shop;
        shop.refuses_each({
            {study("s --shard 3/2"), "--shard: expected a part of all such as 1/4, from 1 on, found '3/2'"},
            {study("s --shard 0/2"), "found '0/2'"},
            {study("s --shard +1/2"), "found '+1/2'"},
            {study("s --pretrained resnet=x"),
             "--pretrained: expected a network and its file, such as squeezenet=FILE, found 'resnet=x'"},
            {"study --data DATA --methods tactnet5", "--methods: tactnet5 not in {"},
            {"study --data DATA --sizes 1x1", "--sizes: 1x1 not in {"},
            {study("s --merge nowhere"),
             "--merge: expected a folder of results, found no nowhere/evaluation.jsonl"},
            {study("s --report-only --shard 1/2"), "--shard excludes --report-only"},
        });
    }

    TEST_CASE("recommend: the best network of a study within a budget, or why there is none") {
        const workshop shop;
        shop.succeeds(study("s"));
        const auto recommend = [](const words& more) { return "recommend --results s" + more; };
        const outcome any = shop.succeeds(recommend("--microseconds 1000000"));
        CHECK(any.out.starts_with("tactnet4 7x13, default recipe: "));
        says(any.out, " over 2 random splits, ");
        CHECK(any.out.ends_with("tactnet::tactnet4<tactnet::shape{7, 13}, 22>\n"));
        shop.succeeds(recommend("--rows 7 --columns 13 --split blocked"));
        shop.refuses(recommend("--bytes 100"),
                     "expected a budget that a network of s/study.jsonl keeps, found "
                     "none; the fastest, tactnet4 7x13, takes ");
        shop.refuses(recommend("--rows 6"), "found none; the fastest");
        shop.refuses("recommend --results nowhere", "nowhere/study.jsonl: expected");

        // Rows that are lost, at the end and before it.
        const std::string whole = text_of(shop / "s/study.jsonl");
        const std::size_t first = whole.find('\n') + 1;
        tactnet::write_file(shop / "s/study.jsonl", whole.substr(0, first));
        shop.refuses(recommend(""), "s/study.jsonl: line 2: expected 2 rows of tactnet study, found the end");
        tactnet::write_file(shop / "s/study.jsonl", whole.substr(0, whole.size() - 1));
        shop.refuses(recommend(""), "s/study.jsonl: line 2: expected 2 rows of tactnet study, found the end");
        tactnet::write_file(shop / "s/study.jsonl", whole.substr(first));
        shop.refuses(recommend(""), "s/study.jsonl: line 1: expected a row of tactnet study, found 'the row "
                                    "that was line 2 of 2'");
        tactnet::write_file(shop / "s/study.jsonl", std::string("{\"method\": 3}\n"));
        shop.refuses(recommend(""), "s/study.jsonl: line 1: expected a row of tactnet study, found '");
    }
}

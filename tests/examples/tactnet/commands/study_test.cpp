// tactnet study, recommend and list.

#include "../workshop.hpp"

#include <tactnet/io/safetensors/json_checksum.hpp>

#include <methods/description.hpp>

using namespace support;

namespace {

/// A study of two methods on 7 × 13 tactels, in single precision.
words study(const std::string& results_and_more) {
    return words("study --data DATA --methods tactnet4,svm-linear --sizes 7x13 --recipes default --splits 2 "
                 "--bits 32 --results " +
                 results_and_more);
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
        CHECK(shop.lines("s/evaluation.jsonl").size() == 8);
        CHECK(shop.lines("s/timings.jsonl").size() == 2);
        CHECK(shop.lines("s/study.csv").size() == 3);
        CHECK(shop.lines("s/study.jsonl").size() == 2);
        CHECK(shop.lines("s/confusion.csv")[0] == "true class,left,\"middle, of all\",right");
        says(first.out, "svm-linear");

        // The page: tables between comments, pictures where there is gnuplot.
        const std::string page = shop.text("s/study.md");
        for (const std::string_view part : {"<!-- study front -->\n| method |", "<!-- study front ends -->\n",
                                            "| tactnet4 | 7 × 13 | default |", "| svm-linear | 7 × 13 |",
                                            "| `tactnet::tactnet4<tactnet::shape{7, 13}, 3>` |"})
            says(page, part);
        if (fs::exists(shop / "s/accuracy_and_time.png"))
            says(page, "](accuracy_and_time.png)");

        const auto before = shop.text("s/study.csv");
        says(shop.succeeds(study("s")).error, "0 trainings to do, of 8 in all");
        CHECK(shop.text("s/study.csv") == before);
    }

    TEST_CASE("study: networks in 8 bits have rows of their own, of the same trainings") {
        const workshop shop;
        const words both(
            "study --data DATA --methods tactnet4 --sizes 7x13 --recipes default --splits 2 --results s");
        says(shop.succeeds(both).error, "4 trainings to do, of 4 in all");
        CHECK(shop.lines("s/evaluation.jsonl").size() == 8); // each in both
        CHECK(shop.lines("s/timings.jsonl").size() == 2);
        const std::vector<std::string> rows = shop.lines("s/study.jsonl");
        REQUIRE(rows.size() == 2);
        CHECK(rows[0].find("\"bits\":32") != std::string::npos);
        CHECK(rows[1].find("\"bits\":8") != std::string::npos);
        CHECK(rows[1].find("\"random_splits\":2,") != std::string::npos);
        const std::string tables = shop.text("s/study.md");
        says(tables, "| tactnet4 in 8 bits | 7 × 13 | default |");

        // It weighs less than a third, so a budget of bytes finds it.
        CHECK(shop.succeeds("recommend --results s --bytes 12000")
                  .out.starts_with("tactnet4 7x13 in 8 bits, default recipe: "));

        // Single precision alone needs no more trainings.
        says(shop.succeeds(both + "--bits 32").error, "0 trainings to do, of 4 in all");
        CHECK(shop.lines("s/study.jsonl").size() == 1);
    }

    TEST_CASE("study: blocked splits alone, and fewer splits than were asked for, are shown as that") {
        const workshop shop;
        const outcome blocked = shop.succeeds(study("s --split blocked"));
        says(shop.text("s/study.md"), "more accurate, over blocked splits.");
        words more = study("s --split blocked --report-only");
        *(std::find(more.begin(), more.end(), "--splits") + 1) = "5";
        const outcome fewer = shop.succeeds(more);
        says(fewer.out, " (2 of 5)");
        CHECK(fewer.error.starts_with("warning: 4 of 10 trainings are there, 2 of 2 methods are timed\n"));
        says(shop.text("s/study.md"), " (2 of 5) |");

        // Of another kind of split nothing is there: rows without accuracies, or none.
        shop.succeeds(study("s --split random --report-only"));
        CHECK(shop.lines("s/study.csv").size() == 3);
        shop.succeeds(study("s --split random --report-only --only-trained"));
        CHECK(shop.text("s/study.csv").empty());
    }

    TEST_CASE("study: trainings and times by other programs are reported as that, where there are none of "
              "its own") {
        const workshop shop;
        shop.succeeds(study("s"));
        const std::string table = shop.text("s/study.csv");
        for (const char* file : {"s/evaluation.jsonl", "s/timings.jsonl"}) {
            std::string lines;
            for (const std::string& line : shop.lines(file))
                lines += tactnet::with_checksum(with_member(with_member(plain_line(line), "library", "0.0.9"),
                                                            "instruction_set", "scalar_sse2")) +
                         '\n';
            tactnet::write_file(shop / file, lines);
        }
        const outcome report = shop.succeeds(study("s --report-only"));
        CHECK(shop.text("s/study.csv") == table);
        const std::string whose = "8 of 8 trainings are by tactnet 0.0.9 for scalar_sse2";
        says(report.error, "warning: " + whose + ", not by this program\n");
        says(report.error, "warning: times are by another program: ");
        says(shop.text("s/study.md"), whose);
        says(shop.text("s/study.md"), "scalar_sse2; tactnet 0.0.9");
        // A study that trains takes them if asked, and names them otherwise.
        const outcome taken = shop.succeeds(study("s --elsewhere"));
        says(taken.error, "warning: " + whose);
        says(taken.error, "0 trainings to do, of 8 in all");
        const outcome again = shop.succeeds(study("s"));
        says(again.error, "8 trainings to do, of 8 in all");
        says(again.error,
             "8 of these lie there, made by another version or for another instruction set than ");
    }

    TEST_CASE("study: instructions of integers leave a training what it is; other settings are named") {
        const workshop shop;
        const words evaluate("evaluate --data DATA --method svm-linear --rows 7 --columns 13 --splits 2 "
                             "--results r");
        shop.succeeds(evaluate);
        std::string lines;
        for (const std::string& line : shop.lines("r/evaluation.jsonl")) {
            const std::string plain = plain_line(line), key = "\"instruction_set\":\"";
            const std::size_t end = plain.find('"', plain.find(key) + key.size());
            lines +=
                tactnet::with_checksum(plain.substr(0, end) + "_vnni_avxvnni" + plain.substr(end)) + '\n';
        }
        tactnet::write_file(shop / "r/evaluation.jsonl", lines);
        says(shop.succeeds(evaluate).error, "0 trainings to do, of 4 in all");
        const outcome other = shop.succeeds(evaluate + "--test 0.4");
        says(other.error, "4 trainings to do, of 4 in all");
        says(other.error, "4 others lie there, of other test_share\n");
    }

    TEST_CASE("float_instruction_set: without the parts that compute integers") {
        CHECK(float_instruction_set("simd_avx512f_fma_bmi2_lzcnt_cd_dq_bw_vl_vbmi_vnni_avxvnni") ==
              "simd_avx512f_fma_dq_bw_vl");
        CHECK(float_instruction_set("simd_avx2_fma_fma4_l1_32") == "simd_avx2_fma_fma4_l1_32");
        CHECK(float_instruction_set("simd_neon64_dotprod_i8mm") == "simd_neon64");
    }

    TEST_CASE("study: what it cannot take is said") {
        const workshop shop;
        says(shop.succeeds("study --data DATA --methods svm-linear,squeezenet-svm --sizes 7x13 --splits 1 "
                           "--results t")
                 .error,
             "squeezenet-svm 7x13 is left out: it needs SqueezeNet 1.1 trained on photographs, "
             "--pretrained squeezenet=FILE");
        CHECK(shop.lines("t/study.csv").size() == 2);
        shop.refuses_each({
            {"study --data DATA --methods squeezenet-svm", "expected something to study, found nothing"},
            {study("s --pretrained resnet=x"),
             "--pretrained: expected a network and its file, such as squeezenet=FILE, found 'resnet=x'"},
            {"study --data DATA --methods tactnet5", "--methods: tactnet5 not in {"},
            {"study --data DATA --sizes 1x1", "--sizes: 1x1 not in {"},
        });
    }

    TEST_CASE("recommend: the best network of a study within a budget, or why there is none") {
        const workshop shop;
        shop.succeeds(study("s"));
        const auto recommend = [](const words& more) { return "recommend --results s" + more; };
        const outcome any = shop.succeeds(recommend("--microseconds 1000000"));
        CHECK(any.out.starts_with("tactnet4 7x13, default recipe: "));
        says(any.out, " over 2 random splits, ");
        CHECK(any.out.ends_with("tactnet::tactnet4<tactnet::shape{7, 13}, 3>\n"));
        shop.succeeds(recommend("--rows 7 --columns 13 --split blocked"));
        shop.refuses(recommend("--bytes 100"),
                     "expected a budget that a network of s/study.jsonl keeps, found "
                     "none; the fastest, tactnet4 7x13, takes ");
        shop.refuses(recommend("--rows 6"), "found none; the fastest");
        shop.refuses("recommend --results nowhere", "nowhere/study.jsonl: expected");

        // Rows that are lost, at the end and before it.
        const std::string whole = shop.text("s/study.jsonl");
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

    TEST_CASE("list: every method that was compiled in, with what it costs") {
        const workshop shop;
        const outcome all = shop.succeeds("list");
        // TactNet-4 for 22 classes: 6128 parameters of convolutions and batch norms, 64 x 22 + 22 of the last
        // layer. A linear machine: 7 x 13 weights and an offset for each class.
        says(all.out, "\ntactnet4 ");
        says(all.out, " 7 558 ");
        says(all.out, "\nsvm-linear ");
        says(all.out, " 2 024 ");
        for (const char* name : {"\nsvm-rbf ", "\nsurf-svm "})
            says(all.out, name);
        says(shop.succeeds("list --classes 3").out, " 6 323 ");
        says(shop.succeeds("list --help").out, "2 to 22");
        shop.refuses("list --classes 23", "--classes: expected a whole number from 2 to 22, found '23'");
    }
}

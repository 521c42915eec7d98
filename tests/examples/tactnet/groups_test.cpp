// Images that belong together, in the program: by file names, folders and tables; and what is reported of
// them.

#include "workshop.hpp"

using namespace support;

namespace {

/// Twelve images of each class become those of four people, three one after the other.
void name_people(const workshop& shop) {
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < images_per_class; ++i)
            fs::rename(shop.image(c, i),
                       shop.data() / class_names[c] /
                           ("person" + std::to_string(i / 3 + 1) + "_" + std::to_string(i % 3) + ".png"));
}

} // namespace

TEST_SUITE("program") {
    TEST_CASE("groups: a split keeps people on one side, and a weight file is tested on the same") {
        const workshop shop;
        name_people(shop);
        const words train("train --data DATA --method svm-linear --rows 7 --columns 13 --output svm --group");
        const outcome trained = shop.succeeds(train + "person(\\d)");
        says(trained.error, "18 images to train, 9 to validate, 9 to test");
        const words test("evaluate --weights svm --data DATA");
        shop.refuses(test, "expected the groups that svm was trained on (fingerprint");
        says(shop.succeeds(test + "--group person(\\d)").out, "svm-linear  7x13       9 ");
        shop.refuses_each({
            {train + "people(\\d)", "--group: expected names that match 'people(\\d)', found '"},
            {train + "(", "--group: expected a regular expression (ECMAScript) such as "},
            {train + "person(\\d) --table t.csv", "--table"},
        });
        const outcome all = shop.succeeds("evaluate --data DATA --method svm-linear --rows 7 --columns 13 "
                                          "--split leave-one-group-out --group person(\\d) --results r");
        says(all.error, "4 trainings to do, of 4 in all");
        says(all.out, "leave-one-group-out splits, %");
        says(shop.lines("r/table.csv")[0], "leave_one_group_out_accuracy");
        shop.refuses(
            "evaluate --data DATA --method svm-linear --rows 7 --columns 13 --split grouped",
            "--split grouped: expected groups of images, by --group, --group-folders or --table, found");
    }

    TEST_CASE("groups: a table names images, and may fix the split") {
        const workshop shop;
        const auto write = [&](const std::string& more) {
            std::string table = "path,group,split\r\n";
            for (std::size_t c = 0; c < 3; ++c)
                for (std::size_t i = 0; i < 8; ++i)
                    table += "\"" + std::string(class_names[c]) + "/image" + std::to_string(i) + ".png\",p" +
                             std::to_string(i / 2) + (i < 6 ? ",training\r\n" : ",test\r\n");
            tactnet::write_file(shop / "t.csv", table + more);
        };
        const words train(
            "train --data DATA --method svm-linear --rows 7 --columns 13 --output svm --table t.csv");
        write("");
        says(shop.succeeds(train).error, "18 images to train, 0 to validate, 6 to test");
        for (const auto& [line, sentence] :
             {std::pair("left/image9.png,p3,training\n",
                        "--split given: expected each group in one part, found 'p3' (left/image"),
              {"left/image1.png,p4,test\n", "t.csv: line 26: expected each image once, found "
                                            "'left/image1.png', which is in line 3 already"},
              {"left/image9.png,p4\n", "t.csv: line 26: expected 3 cells, found 2"},
              {"left/image9.png,,test\n", "t.csv: line 26: expected a group, found an empty cell"},
              {"left/image9.png,p4,exam\n",
               "t.csv: line 26, column 'split': expected training, validation or test, found 'exam'"},
              {"none/image9.png,p4,test\n", "none/image9.png: "}}) {
            write(line);
            says(shop.run(train).error, sentence);
        }
        for (const std::string same : {"./left/image1.png", "left//image1.png", "left/x/../image1.png"}) {
            write(same + ",p0,test\n");
            shop.refuses(train, "which is in line 3 already");
        }
        using namespace std::string_literals;
        for (const auto& [table, sentence] :
             {std::pair("file,label\n"s,
                        "t.csv: line 1: expected columns path, label, group, split, of which path is needed"),
              {"path,label,Label \na,b,c\n"s, "t.csv: line 1: expected one column label, found several"},
              {"path,Labels\na,b\n"s,
               "t.csv: line 1, column 2: expected path, label, group or split, found 'labels'"},
              {"path,label\na\0b,c\n"s, "t.csv: expected a table in UTF-8, found other bytes"},
              {" Path, SPLIT\na/b,exam\nc/d,test\n"s,
               "line 2, column 'split': expected training, validation"}}) {
            tactnet::write_file(shop / "t.csv", table);
            shop.refuses(train, sentence);
        }
        std::string classes = "path,label\n"; // linear in their number
        for (std::size_t i = 0; i < 100'000; ++i)
            classes += std::to_string(i) + "," + std::to_string(i) + "\n";
        tactnet::write_file(shop / "t.csv", classes);
        const auto begin = std::chrono::steady_clock::now();
        shop.refuses(train, "/0: expected a file, found nothing of that name");
        CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(20));
    }

    TEST_CASE("check: few images, unlike classes and hidden folders are warnings") {
        const workshop shop;
        for (std::size_t i = 2; i < images_per_class; ++i)
            fs::remove(shop.image(2, i));
        fs::create_directories(shop.data() / ".box");
        fs::copy_file(shop.image(), shop.data() / ".box/image.png");
        const outcome found = shop.succeeds("check --data DATA");
        says(found.out,
             "warning: right: expected 20 images or more and a third of the largest class, which has 12, "
             "found 2; record more, or train with --balance\n");
        says(found.out, ".box: expected a class, found a name that begins with a dot; it is left out\n");
        CHECK(found.out.ends_with("\nno image is wrong; 2 warnings\n"));
        says(shop.run("train --data DATA --method svm-linear --rows 7 --columns 13 --output s --test 0 "
                      "--validation 0 --balance")
                 .error,
             "36 images to train");
    }

    TEST_CASE("near_duplicates: recordings of a person are near-duplicates") {
        const workshop shop;
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t i = 0; i < images_per_class; ++i) // recordings of three frames
                if (i % 3 > 0)
                    fs::copy_file(shop.image(c, i / 3 * 3), shop.image(c, i),
                                  fs::copy_options::overwrite_existing);
        name_people(shop);
        says(shop.run("check --data DATA").out, "near-duplicates: the nearest image of the same class is the "
                                                "one recorded before or after it for ");
        says(shop.run("check --data DATA --group person(\\d)").out,
             "is of the same group for 36 of 36 images (7 by");
        const words train("train --data DATA --method svm-linear --rows 7 --columns 13 --output s");
        says_not(shop.run(train + "--group person(\\d)").error, "near-duplicates");
    }

    TEST_CASE("evaluate: each class and each image, and a folder that lacks a class") {
        const workshop shop;
        shop.trains("--epochs 2 --output net");
        fs::remove_all(shop.data() / "right");
        const outcome found = shop.succeeds("evaluate --weights net --data DATA --images all --results r");
        says(found.out, "all, means");
        CHECK(shop.lines("r/classes_net.csv").size() == 4);
        CHECK(shop.lines("r/classes_net.jsonl").size() == 3);
        const auto lines = shop.lines("r/predictions_net.csv");
        REQUIRE(lines.size() == 25);
        CHECK(lines[0] == "path,group,label,prediction,p left,\"p middle, of all\",p right");
        CHECK(lines[1].starts_with("left/image0.png,,left,"));
    }

    TEST_CASE("classify: what a spreadsheet would run or split is a text in one cell") {
        const workshop shop;
        shop.trains("--epochs 1 --output net");
        for (const auto& [path, field] : {std::pair("=1.png", "'=1.png,"), {"b;=1.png", "\"b;=1.png\","}}) {
            fs::copy_file(shop.image(), shop / path);
            CHECK(shop.succeeds({"classify", "--weights", "net", "--", path}).out.starts_with(field));
        }
    }
}

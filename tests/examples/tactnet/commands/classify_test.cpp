// tactnet classify and export.

#include "../workshop.hpp"

#include <sys/stat.h>

using namespace support;

TEST_SUITE("program") {
    TEST_CASE("classify: bad weight files are refused, those without a checksum accepted with a message") {
        const workshop shop;
        shop.trains("--epochs 2 --output net");
        const auto whole = shop.text("net");
        tactnet::write_file(shop / "older", without_checksum(whole));
        const std::string sentence = "no checksum in it, so that damage may go unnoticed";
        const outcome with = shop.succeeds("classify --weights net IMAGE"),
                      without = shop.succeeds("classify --weights older IMAGE");
        CHECK(without.out == with.out);
        says_not(with.error, sentence);
        says(without.error, "older: " + sentence);
        for (const std::size_t length :
             {std::size_t{0}, std::size_t{5}, whole.size() / 2, whole.size() - 1}) {
            tactnet::write_file(shop / "cut", std::string_view(whole).substr(0, length));
            shop.refuses("classify IMAGE --weights cut", "cut: ");
        }
        rewrite(shop / "net", shop / "nan", "conv2.weight",
                [](std::vector<float>& v) { v[7] = std::numeric_limits<float>::quiet_NaN(); });
        rewrite(shop / "net", shop / "moved", "fc.bias", [](std::vector<float>& v) { v[0] += 3; });
        tactnet::safetensors_writer writer = copy_of(tactnet::safetensors::read(shop / "net"));
        writer.metadata = {{"rows", "of a table"}}; // another program's word
        writer.write(shop / "bare");
        tactnet::write_file(shop / "names", "one\ntwo\n");
        tactnet::write_file(shop / "three", "\xEF\xBB\xBFone\r\none plus\r\nthree\r\n");
        tactnet::write_file(shop / "twice", "one\ntwo\none\n");
        shop.refuses_each({
            {"classify IMAGE --weights nothing", "nothing: expected a file, found nothing of that name"},
            {"classify IMAGE --weights net --method tactnet6",
             "net: expected weights of tactnet6 as --method says, found those of tactnet4"},
            {"classify IMAGE --weights net --rows 9", "tactnet4: expected a size that it was compiled for ("},
            {"classify IMAGE --weights nan",
             "nan: tensor 'conv2.weight', element 7: expected a finite number, found nan"},
            {"classify IMAGE --weights moved", "moved: self-test, image 0, class 0: expected the logit "},
            {"classify IMAGE --weights bare",
             "bare: expected metadata that say which method it is for, or --method, --rows and --columns, "
             "found neither"},
            {"classify IMAGE --weights bare --method tactnet6-economical --rows 7 --columns 13",
             "bare: expected the 32 arrays of this network, found 12 missing: 'conv4.weight' of 64x32x3x3, "
             "'conv4.bias' of 64, "},
            {"classify IMAGE --weights net --classes names",
             "names: expected 3 class names, as net has, found 2"},
            {"classify IMAGE --weights net --classes twice",
             "twice: expected names without control characters, each once, found 'one' twice"},
        });
        shop.succeeds("export --weights net --output three.hpp --classes three");
        says(shop.text("three.hpp"), "    \"one\",\n    \"one plus\",\n");
        const words bare("classify IMAGE --weights bare --method tactnet4 --rows 7 --columns 13");
        says(shop.run(bare).out, ",class_00,");
        says(shop.run(bare + "--classes DATA").out, ",left,");

        // Other classes, and other images, than those it was trained on.
        fs::rename(shop.data() / "right", shop.data() / "a third");
        shop.refuses("evaluate --weights net --data DATA --images all",
                     "data: expected the classes of net, of which number 0 is 'left', found 'a third'");
        fs::rename(shop.data() / "a third", shop.data() / "right");
        fs::remove(shop.image());
        shop.refuses("evaluate --weights net --data DATA",
                     "data: expected the images that net was trained on");
    }

    TEST_CASE("classify: the published TactNet-4 on real images" * doctest::test_suite("data")) {
        const auto weights = support::find_data("published_tactnet4_14x25.safetensors");
        const auto images = support::find_data("tactile_images");
        if (!weights || !images)
            return;
        const workshop shop;
        if (shop.run("list").out.find("14x25") == std::string::npos) {
            MESSAGE("skipped: the program was built without 14x25");
            return;
        }
        words arguments{"classify", "--weights", fs::absolute(*weights).lexically_normal().string(),
                        "--method", "tactnet4",  "--rows",
                        "14",       "--columns", "25",
                        "--resize", "--classes", fs::absolute(*images).lexically_normal().string()};
        std::vector<std::string> truth;
        for (const auto& folder : fs::directory_iterator(*images))
            for (const auto& image : fs::directory_iterator(folder)) {
                arguments.push_back(fs::absolute(image.path()).lexically_normal().string());
                truth.push_back(folder.path().filename().string());
            }
        const outcome result = shop.succeeds(arguments);
        const auto lines = lines_of(result.out);
        REQUIRE(lines.size() == truth.size());
        std::size_t right = 0;
        for (std::size_t i = 0; i < lines.size(); ++i)
            right += lines[i].find("," + truth[i] + ",") != std::string::npos;
        MESSAGE("recognised ", right, " of ", lines.size());
        // It recognises 93 of the 110 published resized images, 84.5 %; three standard deviations of that
        // below.
        CHECK(static_cast<double>(right) > 0.742 * static_cast<double>(lines.size()));
    }

    TEST_CASE("export: a header, the same every time") {
        const workshop shop;
        shop.trains("--epochs 2 --output net");
        const outcome written = shop.succeeds("export --weights net --output out/net.hpp");
        CHECK(written.out.empty());
        const std::string text = shop.text("out/net.hpp");
        CHECK(text.starts_with("// tactnet4 for frames of 7 × 13 × 1 "));
        says(text, "\nnamespace tactile {\ninline namespace TACTNET_ARCH {\n");
        says(text, "\"middle, of all\"");
        says(text, "inline constexpr recogniser_type::packed_weights packed");
        shop.succeeds("export --weights net --output again.hpp");
        CHECK(shop.text("again.hpp") == text);
        shop.succeeds("export --weights net --output other.hpp --namespace gripper::left --packing at-start");
        says(shop.text("other.hpp"), "\nnamespace gripper::left {\ninline namespace TACTNET_ARCH {\n");
        says(shop.text("other.hpp"), "inline const recogniser_type::packed_weights packed");

        tactnet::write_file(shop / "names", std::string("one\ntw\x1B[31mo\nthree\n"));
        REQUIRE(::mkfifo((shop / "pipe").c_str(), 0600) == 0);
        shop.refuses_each({
            {"export --weights net", "--output is required"},
            {"export --weights net --output x.hpp --packing never", "--packing: never not in {"},
            {"export --weights net --output x.hpp --namespace a-b",
             "--namespace: expected a name such as gripper or gripper::tactile, found 'a-b'"},
            {{"export", "--weights", "net", "--output", "x.hpp", "--classes", ""},
             "--classes: expected a file or a folder of names, found ''"},
            {"export --weights net --output x.hpp --classes names",
             "names: expected names without control characters, each once, found 'tw\\x1b[31mo'"},
            {"export --weights net --output pipe", "expected a regular file, found a named pipe"},
            {"export --weights nothing --output x.hpp",
             "nothing: expected a file, found nothing of that name"},
            {"export --weights net --output out", "found a folder"},
        });
        tactnet::write_file(shop / "cut", std::string_view(text).substr(0, 100));
        shop.refuses("export --weights cut --output out/net.hpp", "cut: ");
        CHECK(shop.text("out/net.hpp") == text);
    }
}

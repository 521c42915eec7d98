// --bits 8 of train, evaluate and export, and what all commands make of the files.

#include "../workshop.hpp"

#include <nlohmann/json.hpp>

using namespace support;

namespace {

words evaluate_arguments(const words& more) {
    return "evaluate --data DATA --rows 7 --columns 13 --epochs 3 --splits 1 --split random --results r "
           "--jobs 1" +
           more;
}

} // namespace

TEST_SUITE("program") {
    TEST_CASE("train: with --bits 8 the file is evaluated, classifies and becomes a header") {
        const workshop shop;
        const outcome trained = shop.trains("--epochs 15 --output out/net.safetensors --bits 8");
        says(trained.out, "in 8 bits, ");
        says(trained.out, "in single precision");
        const auto file = tactnet::safetensors::read(shop / "out/net.safetensors");
        CHECK(file.metadata().at("bits") == "8");
        CHECK(file.metadata().at("network") == "tactnet4");
        CHECK(file.metadata().at("classes") == "[\"left\",\"middle, of all\",\"right\"]");
        CHECK(file.at("step1.weight").type == tactnet::element_type::int8);
        CHECK(file.contains("selftest.logits"));
        CHECK(std::stod(file.metadata().at("test_accuracy")) >
              0.5); // three bright bars: nearly all are right

        says(shop.succeeds("evaluate --weights out/net.safetensors --data DATA").out, "tactnet4  7x13");
        shop.succeeds("evaluate --weights out/net.safetensors --data DATA --images all");
        const std::string image = shop.image(1, 3).string();
        CHECK(shop.succeeds({"classify", "--weights", "out/net.safetensors", image})
                  .out.starts_with("\"" + image + "\",1,\"middle, of all\",0."));
        shop.succeeds("export --weights out/net.safetensors --output net.hpp");
        says(shop.text("net.hpp"), "tactnet::eight_bit_between<std::int16_t, std::uint8_t>");

        // The same seed, the same bits; a file that is left half does not pass.
        shop.trains("--epochs 15 --output again.safetensors --bits 8");
        CHECK((shop.text("again.safetensors") == shop.text("out/net.safetensors")));
        const std::string text = shop.text("again.safetensors");
        tactnet::write_file(shop / "cut", std::string_view(text).substr(0, text.size() - 100));
        shop.refuses({"classify", "--weights", "cut", image}, "cut: ");

        // What needs single precision says so.
        shop.refuses({"classify", "--weights", "out/net.safetensors", "--epsilon", "1e-4", image},
                     "--epsilon: expected weights in single precision, found 8 bits");
        shop.refuses(
            shop.train_arguments("--start out/net.safetensors --output x"),
            "out/net.safetensors: metadata 'bits': expected weights in single precision to begin with, "
            "found '8'");
        shop.refuses("evaluate --weights out/net.safetensors --data DATA --bits 8",
                     "--bits: expected a training, found --weights, whose file says itself");
        shop.refuses("evaluate --weights out/net.safetensors --data DATA --sizes nonsense",
                     "--sizes: expected a training, found --weights, whose file says itself");
    }

    TEST_CASE("train: of 8 bits, what has no such form says so") {
        const workshop shop;
        // A file in 8 bits of a network that was compiled in single precision alone, and of other bits.
        shop.trains("--epochs 1 --bits 8 --output net");
        rewrite_metadata(shop / "net", shop / "other", "network", "tactnet6-economical");
        rewrite_metadata(shop / "net", shop / "four", "bits", "4");
        const auto training = [&](const words& more) { return shop.train_arguments(more); };
        shop.refuses_each({
            {training("--method svm-linear --bits 8 --output x"),
             "--bits: expected a network that is trained from random weights, found the support vector "
             "machine svm-linear, which has no form in 8 bits"},
            {training("--method tactnet6-economical --bits 8 --output x"),
             "--bits: expected a network whose form in 8 bits was compiled in, found "
             "tactnet6-economical 7x13; those are chosen when building, by TACTNET_PROGRAM_EIGHT_BIT"},
            {training("--bits 7 --output x"), "--bits: 7 not in {"},
            {evaluate_arguments("--method tactnet4,svm-linear --bits 8"),
             "found the support vector machine svm-linear, which has no form in 8 bits"},
            {"export --weights other --output x.hpp",
             "other: metadata 'bits': expected weights in single precision, or a network whose form in 8 "
             "bits was compiled in"},
            {"export --weights four --output x.hpp",
             "four: metadata 'bits': expected '8', or none for single precision, found '4'"},
        });
    }

    TEST_CASE("export: with --bits 8 a file in single precision becomes one in 8 bits, or such a header") {
        const workshop shop;
        shop.trains("--epochs 8 --output float.safetensors");
        shop.trains("--epochs 8 --output bytes.safetensors --bits 8");
        const outcome turned = shop.succeeds(
            "export --weights float.safetensors --bits 8 --data DATA --output out/turned.safetensors");
        // As training writes it, with the same images: those of the training, no others.
        const auto ours = tactnet::safetensors::read(shop / "out/turned.safetensors"),
                   theirs = tactnet::safetensors::read(shop / "bytes.safetensors");
        REQUIRE(ours.tensors().size() == theirs.tensors().size());
        for (const auto& tensor : theirs.tensors())
            CHECK_MESSAGE(std::ranges::equal(ours.bytes(tensor.first), theirs.bytes(tensor.first)),
                          tensor.first);
        CHECK(ours.metadata().at("seed") == "5");
        CHECK(!ours.metadata().contains("test_accuracy"));
        shop.succeeds("evaluate --weights out/turned.safetensors --data DATA");

        shop.succeeds("export --weights float.safetensors --bits 8 --data DATA --output a.hpp");
        shop.succeeds("export --weights bytes.safetensors --output b.hpp");
        const auto without_temperature = [&](const char* name) { // that validation images gave each
            std::string text = shop.text(name);
            const std::size_t at = text.find(", classes.size(), ");
            REQUIRE(at != std::string::npos);
            return text.erase(at, text.find(';', at) - at);
        };
        CHECK((without_temperature("a.hpp") == without_temperature("b.hpp"))); // a failure prints no texts
        shop.succeeds("export --weights float.safetensors --bits 8 --data DATA --images all --output c.hpp");

        const std::string of_floats = "export --weights float.safetensors ";
        shop.refuses_each({
            {of_floats + "--bits 8 --output x.hpp",
             "--bits: expected --data with the images of the training"},
            {of_floats + "--data DATA --output x.hpp", "--data: expected --bits 8, for which images"},
            {of_floats + "--output x.safetensors",
             "--output: expected --bits 8, with which a weight file becomes another"},
            {"export --weights bytes.safetensors --bits 8 --data DATA --output x.hpp",
             "bytes.safetensors: metadata 'bits': expected weights in single precision"},
            {of_floats + "--bits 8 --data DATA --classes DATA --output x.safetensors",
             "--classes: expected a header to write, found a weight file"},
        });
        // Images of another training.
        fs::remove(shop.data() / "left" / "image2.png");
        shop.refuses(of_floats + "--bits 8 --data DATA --output x.hpp",
                     "expected the images that float.safetensors was trained on");
    }

    TEST_CASE("evaluate: with --bits 8 each training is reported in both formats, and done once") {
        const workshop shop;
        const auto evaluate = [&](const words& more) { return shop.succeeds(evaluate_arguments(more)); };
        evaluate("--method tactnet4");
        CHECK(shop.lines("r/evaluation.jsonl").size() == 1);
        CHECK(shop.lines("r/table.csv").size() == 2);

        const outcome first = evaluate("--method tactnet4 --bits 8");
        says(first.error, "1 trainings to do, of 1 in all");
        const auto lines = shop.lines("r/evaluation.jsonl");
        REQUIRE(lines.size() == 2); // that in single precision was there
        auto floats = nlohmann::json::parse(lines[0]), bytes = nlohmann::json::parse(lines[1]);
        CHECK(!floats["settings"].contains("bits"));
        CHECK(bytes["settings"]["bits"] == "8");
        bytes["settings"].erase("bits");
        CHECK(bytes["settings"] == floats["settings"]);
        const auto table = shop.lines("r/table.csv");
        REQUIRE(table.size() == 3);
        CHECK(table[0].starts_with("method,rows,columns,recipe,bits,"));
        CHECK(table[1].starts_with("tactnet4,7,13,default,32,1,1,"));
        CHECK(table[2].starts_with("tactnet4,7,13,default,8,1,1,"));
        says(first.out, "tactnet4 in 8 bits");
        CHECK(fs::exists(shop / "r/confusion_tactnet4_7x13.csv"));
        CHECK(fs::exists(shop / "r/confusion_tactnet4_7x13_8bit.csv"));

        for (const char* again : {"--method tactnet4 --bits 8", "--method tactnet4"})
            says(evaluate(again).error, "0 trainings to do, of 1 in all");
        CHECK(shop.lines("r/evaluation.jsonl").size() == 2);

        // A training that was not done yet adds both lines.
        evaluate("--method tactnet4 --bits 8 --seed 3");
        CHECK(shop.lines("r/evaluation.jsonl").size() == 4);
        // Results in 8 bits alone have nothing to compare with: the training is done once more.
        tactnet::write_file(shop / "r/evaluation.jsonl", lines[1] + "\n");
        says(evaluate("--method tactnet4 --bits 8").error, "1 trainings to do, of 1 in all");
        CHECK(shop.lines("r/evaluation.jsonl").size() == 2);
    }
}

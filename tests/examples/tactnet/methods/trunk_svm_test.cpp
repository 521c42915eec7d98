// Support vector machines on features of networks that were trained on photographs.

#include "photograph_networks.hpp"

#include <tactnet/io/safetensors/source.hpp>
#include <tactnet/io/write_file.hpp>
#include <tactnet/networks.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <files/claims.hpp>
#include <iterator>
#include <limits>
#include <string>
#include <support/files/data_folder.hpp>
#include <system_error>
#include <thread>
#include <vector>

using namespace support;
using tactnet::element_type;
using tactnet::shape;

namespace {

using squeezenet = tactnet::squeezenet1_1_trunk<shape{227, 227, 3}>;

std::string only_file_in(const fs::path& folder) {
    REQUIRE(std::distance(fs::directory_iterator(folder), fs::directory_iterator()) == 1);
    return fs::directory_iterator(folder)->path().string();
}

} // namespace

TEST_SUITE("program") {
    TEST_CASE("trunk_svm: SqueezeNet, from pretrained weights to one file") {
        for (const char* method : {"squeezenet-svm", "squeezenet-pooled-svm", "squeezenet-pooled-rbf"})
            check_from_end_to_end<squeezenet>(method, element_type::float32, "selftest.values");
    }
    TEST_CASE("trunk_svm: AlexNet, from pretrained weights to one file") {
        check_from_end_to_end<tactnet::alexnet_fc7<shape{224, 224, 3}>>("alexnet-svm", element_type::float16,
                                                                        "selftest.values");
    }
    TEST_CASE("trunk_svm: ResNet-50, from pretrained weights to one file") {
        check_from_end_to_end<tactnet::resnet50<shape{224, 224, 3}>>("resnet50-svm", element_type::float16,
                                                                     "selftest.values");
    }
    TEST_CASE("trunk_svm: VGG16, from pretrained weights to one file") {
        check_from_end_to_end<tactnet::vgg16_fc6<shape{224, 224, 3}>>("vgg16-svm", element_type::float16,
                                                                      "selftest.values");
    }

    TEST_CASE("trunk_svm: stopped while features are found and run again, the same bits") {
        const workshop shop;
        if (!knows(shop, "squeezenet-pooled-rbf"))
            return;
        write_pretrained<squeezenet>(shop / "pretrained");
        const auto arguments = [&](const char* output, const char* threads) {
            return training(shop, "squeezenet-pooled-rbf", output, {"--threads", threads});
        };
        shop.succeeds(arguments("whole", "3"));
        for (const int signal : {SIGINT, SIGKILL}) {
            CAPTURE(signal);
            const pid_t child = shop.start(arguments("net", "1"));
            std::error_code none;
            // 16 images pass together: some are there, others are not yet.
            for (int i = 0; i < 60'000; ++i) {
                const auto size = fs::file_size(shop / "net.features", none);
                if (!none && size > 1024 * sizeof(float))
                    break;
                std::this_thread::sleep_for(std::chrono::milliseconds(2));
            }
            const outcome stopped = shop.stop(child, signal);
            CHECK(stopped.status == (signal == SIGINT ? 130 : 1000 + SIGKILL));
            if (signal == SIGINT)
                says(stopped.error, "stopped; the same command goes on with what is left, from "
                                    "net.features");
            CHECK_FALSE(fs::exists(shop / "net"));
            CHECK(fs::file_size(shop / "net.features") < 36 * 1024 * sizeof(float));
        }
        const outcome again = shop.succeeds(arguments("net", "2"));
        CHECK(text_of(shop / "net") == text_of(shop / "whole"));
        CHECK_FALSE(fs::exists(shop / "net.features"));

        // Someone else's file of that name is not touched.
        tactnet::write_file(shop / "net.features", std::string_view("mine"));
        shop.refuses(arguments("net", "1"),
                     "net.features: expected a file of features, or none, found another file");
        CHECK(text_of(shop / "net.features") == "mine");
    }

    TEST_CASE("trunk_svm: features are found once for all splits and machines, and anew where damaged") {
        const workshop shop;
        if (!knows(shop, "squeezenet-pooled-svm"))
            return;
        keep_images(shop, 5);
        write_pretrained<squeezenet>(shop / "pretrained");
        const auto arguments = [](const char* methods, const words& more) {
            return words{"evaluate", "--method", methods} +
                   "--data DATA --rows 7 --columns 13 --splits 2 --pretrained pretrained --jobs 2" + more;
        };
        const auto evaluate = [&](const char* methods, const words& more = {}) {
            return shop.succeeds(arguments(methods, more));
        };
        const auto finds = [](const outcome& result) {
            return result.error.find("SqueezeNet 1.1 features of") != std::string::npos;
        };
        const auto results = [&] { // a line each, in the order of their ends, with times in them
            std::vector<std::string> lines;
            for (const std::string& line : lines_of(text_of(shop / "results/evaluation.jsonl")))
                lines.push_back(line.substr(0, line.find(",\"seconds\"")) +
                                line.substr(line.find(",\"classes\""), line.find(']') - line.find(",\"cla")));
            std::sort(lines.begin(), lines.end());
            return lines;
        };
        // Those that need no such file take part.
        CHECK(finds(evaluate("squeezenet-pooled-svm,svm-linear")));
        const std::string file = only_file_in(shop / "results/features"), whole = text_of(file);
        const auto first = results();
        CHECK(first.size() == 8);
        // What a killed program has locked goes.
        const fs::path lock = shop / "results/features/.tactnet-0123456789abcdef.lock";
        tactnet::write_file(lock, "");
        // Nothing is left to do; then another machine on the same features; then all again.
        CHECK_FALSE(finds(evaluate("squeezenet-pooled-svm,svm-linear")));
        CHECK_FALSE(fs::exists(lock));
        CHECK_FALSE(finds(evaluate("squeezenet-pooled-rbf")));
        CHECK_FALSE(finds(evaluate("squeezenet-pooled-svm,svm-linear", {"--afresh"})));
        CHECK(results() == first);
        CHECK(text_of(file) == whole);

        const auto evaluate_damaged = [&](std::size_t place, const std::string& sentence) {
            std::string bytes = whole;
            bytes[place] = static_cast<char>(bytes[place] ^ 1);
            tactnet::write_file(file, bytes);
            const outcome result = evaluate("squeezenet-pooled-svm,svm-linear", {"--afresh"});
            says(result.error, sentence);
            CHECK(finds(result));
            CHECK(text_of(file) == whole);
            CHECK(results() == first);
        };
        evaluate_damaged(whole.size() / 2, "features of 1 of 15 images are damaged, and found anew");
        evaluate_damaged(40, "features of something else, or damaged; all are found anew");

        // One program at a time finds them.
        claims mine;
        REQUIRE(mine.take(file));
        const pid_t waits = shop.start(arguments("squeezenet-pooled-svm", {"--afresh"}));
        shop.wait_for(waits, "waiting for the features that another program finds, results/features/");
        mine.release(file);
        CHECK(shop.wait(waits).status == 0);

        // Other weights give other features, in a file of their own.
        write_pretrained<squeezenet>(shop / "pretrained", element_type::float16);
        CHECK(finds(evaluate("squeezenet-pooled-svm")));
        CHECK(text_of(file) == whole);
        CHECK(results().size() == 4 + 4);
    }

    TEST_CASE("trunk_svm: weights that are missing, wrong, or of no use") {
        const workshop shop;
        if (!knows(shop, "squeezenet-svm"))
            return;
        const auto refuses = [&](const std::string& method, const std::string& sentence) {
            shop.refuses(training(shop, method, "net"), sentence);
        };
        const words without("--method squeezenet-svm --output net");
        shop.refuses(
            shop.train_arguments(without),
            "--pretrained: squeezenet-svm expects a file of SqueezeNet 1.1's weights, found none. It "
            "is a safetensors file with torchvision's names (features.0.weight, ...) in float32, "
            "float16 or bfloat16, at least 2.9 MB in float32, trained on photographs of 227 x 227");
        shop.refuses("evaluate --data DATA --method squeezenet-pooled-rbf --rows 7 --columns 13",
                     "save_file(torchvision.models.squeezenet1_1(weights=\"IMAGENET1K_V1\").state_dict(), "
                     "\"squeezenet1_1.safetensors\")");
        refuses("squeezenet-svm", "pretrained: expected a file, found nothing of that name");
        refuses("tactnet4", "--pretrained: expected a method that begins with a network trained on "
                            "photographs, found tactnet4, which learns all by itself");
        refuses("svm-linear", "found svm-linear, which learns all by itself");
        shop.refuses("evaluate --data DATA --method tactnet4 --rows 7 --columns 13 --pretrained pretrained",
                     "found tactnet4, which learns all by itself");
        shop.refuses(
            "evaluate --data DATA --weights net --pretrained p",
            "--pretrained: expected a training, found --weights, whose file holds all that it needs");
        tactnet::write_file(shop / "pretrained", std::string_view("no such file"));
        refuses("squeezenet-svm",
                "pretrained: expected a safetensors file, found text that begins with 'no such '");

        const auto write = [&](const auto& change) {
            write_pretrained<squeezenet>(shop / "pretrained", element_type::float32, change);
        };
        using extents = std::vector<std::size_t>;
        write([](std::string& name, extents&) {
            if (name == "features.3.squeeze.bias")
                name = "";
        });
        refuses("squeezenet-svm", "pretrained: expected a tensor 'features.3.squeeze.bias' of 16, found none "
                                  "of that name");
        write([](std::string& name, extents&) { name = "module." + name; });
        refuses("squeezenet-svm", "pretrained: expected the 50 arrays of this network, found 50 missing: "
                                  "'features.0.weight' of 64x3x3x3, ");
        write([](std::string& name, extents& e) {
            if (name == "features.0.weight")
                e = {3, 3, 3, 64};
        });
        refuses("squeezenet-svm",
                "pretrained: tensor 'features.0.weight': expected 64x3x3x3, found 3x3x3x64");
        // The file of a training holds all that it needs.
        write_pretrained<squeezenet>(shop / "pretrained");
        keep_images(shop, 3);
        shop.succeeds(training(shop, "squeezenet-pooled-svm", "net", "--test 0.3"));
        const auto refuses_file = [&](const std::string& name, const std::string& sentence) {
            shop.refuses({"classify", "--weights", name, "IMAGE"}, name + ": " + sentence);
        };
        rewrite(shop / "net", shop / "nan", "trunk.features.0.bias",
                [](std::vector<float>& v) { v[3] = std::numeric_limits<float>::infinity(); });
        refuses_file("nan", "tensor 'trunk.features.0.bias', element 3: expected a finite number, found inf");
        rewrite(shop / "net", shop / "moved", "trunk.features.12.squeeze.weight", [](std::vector<float>& v) {
            for (float& value : v)
                value *= 2;
        });
        refuses_file("moved", "self-test, image 0, machine ");
        const auto whole = text_of(shop / "net");
        tactnet::write_file(shop / "cut", std::string_view(whole).substr(0, whole.size() - 100));
        refuses_file("cut", "file cut short");
        std::string flipped = whole;
        flipped[whole.size() / 2] = static_cast<char>(flipped[whole.size() / 2] ^ 1);
        tactnet::write_file(shop / "flipped", flipped);
        refuses_file("flipped", "checksum of the whole file: expected");
        {
            const auto file = tactnet::safetensors::read(shop / "net");
            tactnet::safetensors_writer writer;
            writer.metadata = file.metadata();
            for (const auto& [name, entry] : file.tensors())
                if (!name.starts_with("trunk."))
                    writer.add(name, entry.type, entry.extents, file.bytes(name));
            writer.write(shop / "without");
        }
        refuses_file("without", "expected arrays of SqueezeNet 1.1, whose names begin with 'trunk.', found "
                                "none");
    }

    TEST_CASE("trunk_svm: SqueezeNet's weights recognise real touches as in the paper" *
              doctest::test_suite("data")) {
        const workshop shop;
        const auto images = find_data("tactile_images"),
                   weights = find_data("squeezenet1_1_imagenet_features.safetensors");
        if (!images || !weights)
            return;
        const auto known = lines_of(shop.run("list").out);
        if (std::ranges::none_of(known, [](const std::string& line) {
                return line.starts_with("squeezenet-svm ") && line.find(" 28x50 ") != std::string::npos;
            })) {
            MESSAGE("skipped: the program was built without squeezenet-svm at 28x50");
            return;
        }
        const outcome trained =
            shop.succeeds({"train", "--data", images->string(), "--method", "squeezenet-svm", "--weights",
                           weights->string(), "--output", "net"});
        const auto file = tactnet::safetensors_source::open(shop / "net");
        // The paper has 85.82 ± 2.57 %: within four deviations of one split.
        const double accuracy = std::stod(file.metadata().at("test_accuracy"));
        CHECK(accuracy > 0.755);
        CHECK(accuracy < 0.961);
    }
}

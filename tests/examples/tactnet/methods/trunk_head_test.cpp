// Layers that are trained on frozen networks, which were trained on photographs.

#include "photograph_networks.hpp"

#include <tactnet/io/write_file.hpp>
#include <tactnet/networks.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <csignal>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

using namespace support;
using tactnet::element_type;
using tactnet::shape;

namespace {

using squeezenet = tactnet::squeezenet1_1_trunk<shape{227, 227, 3}>;

} // namespace

TEST_SUITE("program") {
    TEST_CASE("trunk_head: SqueezeNet, from pretrained weights to one file") {
        check_from_end_to_end<squeezenet>("squeezenet-pooled-nn", element_type::float32, "selftest.logits");
    }
    TEST_CASE("trunk_head: AlexNet, from pretrained weights to one file") {
        check_from_end_to_end<tactnet::alexnet_fc7<shape{224, 224, 3}>>(
            "alexnet-fc7-nn", element_type::float16, "selftest.logits");
    }
    TEST_CASE("trunk_head: ResNet-50, from pretrained weights to one file") {
        check_from_end_to_end<tactnet::resnet50<shape{224, 224, 3}>>(
            "resnet50-fc1000-nn", element_type::float16, "selftest.logits");
    }
    TEST_CASE("trunk_head: VGG16, from pretrained weights to one file") {
        check_from_end_to_end<tactnet::vgg16_fc6<shape{224, 224, 3}>>("vgg16-fc6-nn", element_type::float16,
                                                                      "selftest.logits");
    }

    TEST_CASE("trunk_head: stopped between epochs and gone on with, the same bits") {
        const workshop shop;
        if (!knows(shop, "squeezenet-pooled-nn"))
            return;
        keep_images(shop, 4);
        write_pretrained<squeezenet>(shop / "pretrained");
        const auto arguments = [&](const char* output, words more) {
            more = words("--epochs 400 --checkpoint-every 1e-9") + more;
            return training(shop, "squeezenet-pooled-nn", output, more);
        };
        shop.succeeds(arguments("whole", "--threads 2"));
        const pid_t child = shop.start(arguments("net", {}));
        shop.wait_for_file("net.checkpoint");
        shop.stop(child, SIGKILL);
        REQUIRE_FALSE(fs::exists(shop / "net"));
        // What another training cannot go on from it does not touch.
        const std::string kept = text_of(shop / "net.features");
        const fs::path image = shop.image();
        fs::rename(image, shop / "away.png");
        const outcome refused = shop.run(arguments("net", {"--resume"}));
        fs::rename(shop / "away.png", image);
        CHECK(refused.status == 2);
        says(refused.error, "net.checkpoint: setting 'data' of the stopped training: expected '");
        CHECK(text_of(shop / "net.features") == kept);
        const outcome again = shop.succeeds(arguments("net", {"--resume"}));
        says_not(again.error, "features of");
        CHECK(text_of(shop / "net") == text_of(shop / "whole"));
        CHECK_FALSE(fs::exists(shop / "net.features"));
        CHECK_FALSE(fs::exists(shop / "net.checkpoint"));
        CHECK(fs::exists(shop / "net.learning.csv"));
    }

    TEST_CASE("trunk_head: interrupted before and between epochs, it says how to go on") {
        const workshop shop;
        if (!knows(shop, "squeezenet-pooled-nn"))
            return;
        write_pretrained<squeezenet>(shop / "pretrained");
        const auto stopped_at = [&](const char* file, words more) {
            more = words("--epochs 100000 --checkpoint-every 1e-9") + more;
            const pid_t child = shop.start(training(shop, "squeezenet-pooled-nn", "net", more));
            shop.wait_for_file(file);
            const outcome stopped = shop.stop(child, SIGINT);
            CHECK(stopped.status == 130);
            return stopped.error;
        };
        CHECK(stopped_at("net.features", {})
                  .find("the same command goes on with what is left, from "
                        "net.features") != std::string::npos);
        CHECK_FALSE(fs::exists(shop / "net.checkpoint"));
        CHECK(stopped_at("net.checkpoint", {})
                  .find("the same command with --resume goes on from "
                        "net.checkpoint") != std::string::npos);
        CHECK(fs::exists(shop / "net.features"));
        CHECK_FALSE(fs::exists(shop / "net"));
    }

    TEST_CASE("trunk_head: features are those of the support vector machine's trunk, found once") {
        const workshop shop;
        if (!knows(shop, "squeezenet-pooled-nn"))
            return;
        keep_images(shop, 4);
        write_pretrained<squeezenet>(shop / "pretrained");
        const auto evaluate = [&](const char* method, const char* results = "results",
                                  const char* jobs = "1") {
            return shop.run({"evaluate", "--data", shop.data().string(), "--method", method, "--rows", "7",
                             "--columns", "13", "--splits", "2", "--pretrained", "pretrained", "--results",
                             results, "--jobs", jobs});
        };
        const outcome machine = evaluate("squeezenet-pooled-svm"), head = evaluate("squeezenet-pooled-nn");
        REQUIRE_MESSAGE(machine.status == 0, machine.error);
        REQUIRE_MESSAGE(head.status == 0, head.error);
        says(machine.error, "features of 12 of 12 images");
        says_not(head.error, "features of");
        says(head.out, "squeezenet-pooled-nn");
        // Side by side, the same results.
        REQUIRE(evaluate("squeezenet-pooled-nn", "side_by_side", "3").status == 0);
        const auto confusions = [&](const char* results) {
            std::vector<std::string> all;
            for (const std::string& line : lines_of(text_of(shop / results / "evaluation.jsonl")))
                if (line.find("pooled-nn") != std::string::npos) {
                    const std::size_t first = line.find("\"confusion\"");
                    all.push_back(line.substr(first, line.find(']', first) - first));
                }
            std::sort(all.begin(), all.end());
            return all;
        };
        CHECK(confusions("side_by_side").size() == 4);
        CHECK(confusions("side_by_side") == confusions("results"));
    }

    TEST_CASE("trunk_head: what it cannot do is said") {
        const workshop shop;
        if (!knows(shop, "squeezenet-pooled-nn"))
            return;
        keep_images(shop, 3);
        write_pretrained<squeezenet>(shop / "pretrained");
        const auto refuses = [&](words more, const char* sentence) {
            shop.refuses(training(shop, "squeezenet-pooled-nn", "net", std::move(more)), sentence);
        };
        refuses("--augmentation sixfold", "--augmentation: expected none, since features of images are "
                                          "found once, for squeezenet-pooled-nn; found sixfold");
        refuses("--batch 1",
                "--batch: expected 0 or at least 2, since batch norms learn nothing from one row "
                "of features, for squeezenet-pooled-nn; found 1");
        refuses("--recipe published", "nothing was published for squeezenet-pooled-nn");
        refuses("--start other",
                "--start: expected a network that begins with random weights, found squeezenet-pooled-nn");
        const outcome trained =
            shop.succeeds(training(shop, "squeezenet-pooled-nn", "net", "--epochs 1 --test 0.3"));
        shop.refuses(
            "export --weights net --output net.hpp",
            "net: expected a network, found the head of a frozen trunk squeezenet-pooled-nn, which cannot "
            "be written as a header");
        shop.refuses("classify --weights net --method squeezenet-pooled-svm IMAGE",
                     "net: expected weights of squeezenet-pooled-svm as --method says, found those of "
                     "squeezenet-pooled-nn");
        const std::map<std::string, std::string> foreign{{"pooling", "none"},
                                                         {"reflections", "none"},
                                                         {"features", "fc7 of AlexNet"},
                                                         {"photograph", "224x224"}};
        for (const auto& [key, value] : foreign) {
            rewrite_metadata(shop / "net", shop / "other", key, value);
            const outcome refused = shop.run("classify --weights other IMAGE");
            CHECK(refused.status == 2);
            says(refused.error, "other: metadata '" + key + "': expected '");
            says(refused.error, "found '" + value + "'");
        }
        const auto whole = text_of(shop / "net");
        std::string flipped = whole;
        flipped[whole.size() / 2] = static_cast<char>(flipped[whole.size() / 2] ^ 1);
        tactnet::write_file(shop / "flipped", flipped);
        shop.refuses("classify --weights flipped IMAGE", "flipped: checksum of the whole file: expected");
        rewrite(shop / "net", shop / "moved", "trunk.features.12.squeeze.weight", [](std::vector<float>& v) {
            for (float& value : v)
                value *= 2;
        });
        shop.refuses("classify --weights moved IMAGE", "moved: self-test, image 0, class ");
    }
}

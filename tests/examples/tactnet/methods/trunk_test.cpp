// Support vector machines and heads on features of networks that were trained on photographs.

#include "photograph_networks.hpp"

#include <tactnet/networks.hpp>
#include <tactnet/networks/imagenet.hpp>

#include <files/claims.hpp>
#include <iterator>

using namespace support;
using tactnet::element_type;
using tactnet::shape;

namespace {

using squeezenet = tactnet::squeezenet1_1_trunk<shape{227, 227, 3}>;
using extents = std::vector<std::size_t>;

/// Trained, saved, tested and used, from a file by torchvision's names to a file that needs it no more.
template <class Network>
void check_from_end_to_end(const std::string& method, element_type type) {
    const workshop shop;
    if (!knows(shop, method))
        return;
    CAPTURE(method);
    shop.keep_images(2);
    write_pretrained<Network>(shop / "pretrained", type);
    says(shop.succeeds(training(shop, method, "net", "--validation 0 --test 0.3 --self-test 1")).error,
         "features of 6 of 6 images");
    {
        const auto file = tactnet::safetensors_source::open(shop / "net");
        CHECK(file.metadata().at("network") == method);
        CHECK(file.metadata().count("pretrained") == 1);
        for (const tactnet::parameter& p : Network::describe()) {
            const auto& array = file.at("trunk." + p.name);
            CHECK(array.extents == p.extents);
            CHECK(array.type == type);
        }
        CHECK_FALSE(file.contains("trunk.classifier.6.bias"));
        CHECK(file.contains("selftest.values"));
    }
    fs::remove(shop / "pretrained");
    CHECK(lines_of(shop.succeeds("classify --weights net IMAGE IMAGE").out).size() == 2);
    shop.succeeds("evaluate --weights net --data DATA --results r");
    CHECK(shop.text("r/confusion_net.csv") == shop.text("net.confusion.csv"));
}

std::string only_file_in(const fs::path& folder) {
    REQUIRE(std::distance(fs::directory_iterator(folder), fs::directory_iterator()) == 1);
    return fs::directory_iterator(folder)->path().string();
}

void double_all(std::vector<float>& values) {
    for (float& value : values)
        value *= 2;
}

} // namespace

TEST_SUITE("program") {
    TEST_CASE("trunk: every method, from pretrained weights to one file") {
        for (const char* method : {"squeezenet-svm", "squeezenet-pooled-svm", "squeezenet-pooled-rbf"})
            check_from_end_to_end<squeezenet>(method, element_type::float32);
        check_from_end_to_end<tactnet::alexnet_fc7<shape{224, 224, 3}>>("alexnet-svm", element_type::float16);
        check_from_end_to_end<tactnet::resnet50<shape{224, 224, 3}>>("resnet50-svm", element_type::float16);
        check_from_end_to_end<tactnet::vgg16_fc6<shape{224, 224, 3}>>("vgg16-svm", element_type::float16);
    }

    TEST_CASE("trunk: features are found once for all splits and methods, and anew where damaged") {
        const workshop shop;
        if (!knows(shop, "squeezenet-pooled-svm"))
            return;
        shop.keep_images(3);
        write_pretrained<squeezenet>(shop / "pretrained");
        const auto arguments = [](const char* methods, const words& more) {
            return words{"evaluate", "--method", methods} +
                   "--data DATA --rows 7 --columns 13 --splits 2 --pretrained pretrained" + more;
        };
        const auto evaluate = [&](const char* methods, const words& more = "--jobs 2") {
            return shop.succeeds(arguments(methods, more));
        };
        const auto finds = [](const outcome& result) {
            return result.error.find("SqueezeNet 1.1 features of") != std::string::npos;
        };
        // A line each, in the order of their ends, with times in them.
        const auto results = [&](const fs::path& folder = "results") {
            std::vector<std::string> lines;
            for (const std::string& line : shop.lines(folder / "evaluation.jsonl"))
                lines.push_back(line.substr(0, line.find(",\"seconds\"")) +
                                line.substr(line.find(",\"classes\""), line.find(']') - line.find(",\"cla")));
            std::sort(lines.begin(), lines.end());
            return lines;
        };
        // Those that need no such file take part.
        const char* const all = "squeezenet-pooled-svm,squeezenet-pooled-rbf,svm-linear";
        CHECK(finds(evaluate(all)));
        const std::string file = only_file_in(shop / "results/features"), whole = text_of(file);
        const auto first = results();
        CHECK(first.size() == 12);
        // Nothing is left to do; then one machine again, then all, one by one.
        CHECK_FALSE(finds(evaluate(all)));
        CHECK_FALSE(finds(evaluate("squeezenet-pooled-svm", "--jobs 1 --afresh")));
        CHECK_FALSE(finds(evaluate(all, "--jobs 1 --afresh")));
        CHECK(results() == first);
        CHECK(text_of(file) == whole);

        // Damage, with a method whose features take a quarter of the time.
        const words other("--results other");
        const auto evaluate_other = [&](const words& more) {
            return evaluate("squeezenet-svm", other + more);
        };
        CHECK(finds(evaluate_other("--jobs 2")));
        const std::string small = only_file_in(shop / "other/features"), right = text_of(small);
        const auto second = results("other");
        CHECK(second.size() == 4);
        for (const std::size_t place : {right.size() / 2, std::size_t{40}}) {
            std::string bytes = right;
            bytes[place] = static_cast<char>(bytes[place] ^ 1);
            tactnet::write_file(small, bytes);
            const outcome result = evaluate_other("--jobs 3 --afresh");
            says(result.error, "features of something else, or damaged; all are found anew");
            CHECK(finds(result));
            CHECK(text_of(small) == right);
            CHECK(results("other") == second);
        }

        // One program at a time finds them.
        claims mine;
        REQUIRE(mine.take(small));
        const pid_t waits = shop.start(arguments("squeezenet-svm", other + "--afresh"));
        shop.wait_for(waits, "waiting for the features that another program finds, other/features/");
        mine.release(small);
        CHECK(shop.wait(waits).status == 0);

        // Other weights give other features, in a file of their own.
        write_pretrained<squeezenet>(shop / "pretrained", element_type::float16);
        CHECK(finds(evaluate_other("--jobs 2")));
        CHECK(text_of(small) == right);
        CHECK(results("other").size() == 4 + 4);
    }

    TEST_CASE("trunk: options and files that do not go together") {
        const workshop shop;
        if (!knows(shop, "squeezenet-svm"))
            return;
        const auto trains = [&](const std::string& method, const words& more = {}) {
            return training(shop, method, "net", more);
        };
        shop.refuses_each({
            {shop.train_arguments("--method squeezenet-svm --output net"),
             "--pretrained: squeezenet-svm expects a file of SqueezeNet 1.1's weights, found none. It "
             "is a safetensors file with torchvision's names (features.0.weight, ...) in float32, "
             "float16 or bfloat16, at least 2.9 MB in float32, trained on photographs of 227 x 227"},
            {"evaluate --data DATA --method squeezenet-pooled-rbf --rows 7 --columns 13",
             "save_file(torchvision.models.squeezenet1_1(weights=\"IMAGENET1K_V1\").state_dict(), "
             "\"squeezenet1_1.safetensors\")"},
            {trains("squeezenet-svm"), "pretrained: expected a file, found nothing of that name"},
            {trains("tactnet4"), "--pretrained: expected a method that begins with a network trained on "
                                 "photographs, found tactnet4, which learns all by itself"},
            {trains("svm-linear"), "found svm-linear, which learns all by itself"},
            {"evaluate --data DATA --method tactnet4 --rows 7 --columns 13 --pretrained pretrained",
             "found tactnet4, which learns all by itself"},
            {"evaluate --data DATA --weights net --pretrained p",
             "--pretrained: expected a training, found --weights, whose file holds all that it needs"},
            {trains("squeezenet-pooled-svm", "--augmentation sixfold"),
             "--start: expected a network, found squeezenet-pooled-svm, which is not trained by epochs"},
        });
        tactnet::write_file(shop / "pretrained", std::string_view("no such file"));
        shop.refuses(trains("squeezenet-svm"),
                     "pretrained: expected a safetensors file, found text that begins with 'no such '");
        const auto refuses_pretrained = [&](const auto& change, const std::string& sentence) {
            write_pretrained<squeezenet>(shop / "pretrained", element_type::float32, change);
            shop.refuses(trains("squeezenet-svm"), "pretrained: " + sentence);
        };
        refuses_pretrained(
            [](std::string& name, extents&) { name = name == "features.3.squeeze.bias" ? "" : name; },
            "expected a tensor 'features.3.squeeze.bias' of 16, found none of that name");
        refuses_pretrained([](std::string& name, extents&) { name = "module." + name; },
                           "expected the 50 arrays of this network, found 50 missing: 'features.0.weight' of "
                           "64x3x3x3, ");
        refuses_pretrained(
            [](std::string& name, extents& e) {
                if (name == "features.0.weight")
                    e = {3, 3, 3, 64};
            },
            "tensor 'features.0.weight': expected 64x3x3x3, found 3x3x3x64");

        // The file of a training, which holds all that it needs.
        write_pretrained<squeezenet>(shop / "pretrained");
        shop.keep_images(2);
        shop.succeeds(training(shop, "squeezenet-pooled-svm", "svm", "--validation 0 --test 0.3"));
        rewrite(shop / "svm", shop / "nan", "trunk.features.0.bias",
                [](std::vector<float>& v) { v[3] = std::numeric_limits<float>::infinity(); });
        rewrite(shop / "svm", shop / "moved", "trunk.features.12.squeeze.weight", double_all);
        std::string bytes = shop.text("svm");
        tactnet::write_file(shop / "cut", std::string_view(bytes).substr(0, bytes.size() - 100));
        bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
        tactnet::write_file(shop / "flipped", bytes);
        copy_of(tactnet::safetensors::read(shop / "svm"), [](const std::string& name) {
            return name.starts_with("trunk.");
        }).write(shop / "without");
        shop.refuses_each({
            {"classify IMAGE --weights nan",
             "nan: tensor 'trunk.features.0.bias', element 3: expected a finite number, found inf"},
            {"classify IMAGE --weights moved", "moved: self-test, image 0, machine "},
            {"classify IMAGE --weights cut", "cut: file cut short"},
            {"classify IMAGE --weights flipped", "flipped: checksum of the whole file: expected"},
            {"classify IMAGE --weights without",
             "without: expected arrays of SqueezeNet 1.1, whose names begin with 'trunk.', found none"},
            {"classify --weights svm --method squeezenet-pooled-rbf IMAGE",
             "svm: expected weights of squeezenet-pooled-rbf as --method says, found those of "
             "squeezenet-pooled-svm"},
        });
        const std::pair<const char*, const char*> foreign[] = {{"pooling", "none"},
                                                               {"reflections", "none"},
                                                               {"features", "fc7 of AlexNet"},
                                                               {"photograph", "224x224"}};
        for (const auto& [key, value] : foreign) {
            rewrite_metadata(shop / "svm", shop / "other", key, value);
            const std::string error =
                shop.refuses("classify --weights other IMAGE", "found '" + std::string(value) + "'");
            says(error, "other: metadata '" + std::string(key) + "': expected '");
        }
    }

    TEST_CASE("trunk: SqueezeNet's weights recognise real touches as in the paper" *
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
        shop.succeeds({"train", "--data", images->string(), "--method", "squeezenet-svm", "--weights",
                       weights->string(), "--output", "net"});
        const auto file = tactnet::safetensors_source::open(shop / "net");
        // The paper has 85.82 ± 2.57 %: within four deviations of one split.
        const double accuracy = std::stod(file.metadata().at("test_accuracy"));
        CHECK(accuracy > 0.755);
        CHECK(accuracy < 0.961);
    }
}

// Networks that begin with weights learnt from photographs, and are trained on.

#include "photograph_networks.hpp"

#include <tactnet/networks.hpp>
#include <tactnet/networks/imagenet.hpp>

using namespace support;
using tactnet::element_type;

namespace {

using squeezenet = tactnet::squeezenet1_1<tactnet::shape{227, 227, 3}>;

/// Nine images of the workshop in 28 × 50, a network of which few epochs take seconds.
struct fine_tuning {
    workshop shop;
    fine_tuning() { shop.keep_images(3); }
    bool known() const { return knows(shop, "squeezenet-nn"); }
    words arguments(const std::string& output, words more) const {
        more.insert(more.begin(),
                    {"--method", "squeezenet-nn", "--output", output, "--rows", "28", "--columns", "50",
                     "--resize", "--test", "0.3", "--validation", "0", "--threads", "2"});
        return shop.train_arguments(more);
    }
};

std::vector<float> values_of(const fs::path& file, const std::string& name) {
    auto source = tactnet::safetensors_source::open(file);
    return source.values<float>(name);
}

} // namespace

TEST_SUITE("program") {
    TEST_CASE("pretrained_network: SqueezeNet, trained on from a file to one file that all commands take") {
        const fine_tuning tuning;
        const workshop& shop = tuning.shop;
        if (!tuning.known())
            return;
        write_pretrained<squeezenet>(shop / "pretrained");
        shop.succeeds(
            tuning.arguments("net", "--pretrained pretrained --epochs 2 --self-test 1 --rate 1e-4"));
        {
            const auto file = tactnet::safetensors_source::open(shop / "net");
            CHECK(file.metadata().at("network") == "squeezenet-nn");
            CHECK(file.metadata().at("recipe") == "default");
            CHECK(file.metadata().count("pretrained") == 1);
            CHECK(file.at("classifier.1.weight").extents == std::vector<std::size_t>{3, 512, 1, 1});
        }
        // It began there, and went on.
        const auto before = values_of(shop / "pretrained", "features.0.weight"),
                   after = values_of(shop / "net", "features.0.weight");
        double apart = 0, size = 0;
        for (std::size_t i = 0; i < before.size(); ++i) {
            apart += std::abs(static_cast<double>(after[i]) - static_cast<double>(before[i]));
            size += std::abs(static_cast<double>(before[i]));
        }
        CHECK(apart > 0);
        CHECK(apart < 0.01 * size);
        CHECK(values_of(shop / "net", "photograph.running_mean")[0] == doctest::Approx(0.485));

        shop.succeeds(
            "evaluate --data DATA --method squeezenet-nn --pretrained pretrained --rows 28 --columns "
            "50 --resize --epochs 1 --test 0.3 --validation 0 --splits 1");
        CHECK_FALSE(fs::exists(shop / "results/features"));

        fs::remove(shop / "pretrained");
        shop.succeeds("classify --weights net --resize IMAGE");
        shop.succeeds("evaluate --weights net --resize --data DATA --results r");
        CHECK(shop.text("r/confusion_net.csv") == shop.text("net.confusion.csv"));
        shop.succeeds("export --weights net --output net.hpp");
        const std::string header = shop.text("net.hpp");
        says(header, "#include <tactnet/transfer/as_photograph_step.hpp>");
        says(header, "passes_selftest(recogniser_type::workspace& memory)");
    }

    TEST_CASE("pretrained_network: stopped and gone on with, the same bits") {
        const fine_tuning tuning;
        const workshop& shop = tuning.shop;
        if (!tuning.known())
            return;
        write_pretrained<squeezenet>(shop / "pretrained");
        const auto run = [&](const char* output, words more) {
            more += "--pretrained pretrained --epochs 2 --checkpoint-every 1e-9";
            return tuning.arguments(output, more);
        };
        shop.succeeds(run("whole", {}));
        const pid_t child = shop.start(run("net", {}));
        shop.wait_for_file("net.checkpoint");
        shop.stop(child, SIGKILL);
        REQUIRE_FALSE(fs::exists(shop / "net"));
        shop.succeeds(run("net", {"--resume"}));
        CHECK(shop.text("net") == shop.text("whole"));
    }

    TEST_CASE("pretrained_network: what it cannot begin with") {
        const fine_tuning tuning;
        const workshop& shop = tuning.shop;
        if (!tuning.known())
            return;
        shop.refuses(
            tuning.arguments("net", {}),
            "--pretrained: squeezenet-nn expects a file of SqueezeNet 1.1's weights, found none. It is a "
            "safetensors file with torchvision's names (features.0.weight, ...)");
        write_pretrained<squeezenet>(shop / "pretrained", element_type::float32,
                                     [](std::string& name, std::vector<std::size_t>&) {
                                         if (name == "features.12.expand3x3.weight")
                                             name = "";
                                     });
        shop.refuses(
            tuning.arguments("net", "--pretrained pretrained"),
            "pretrained: expected a tensor 'features.12.expand3x3.weight' of 256x64x3x3, found none of "
            "that name");
        write_pretrained<squeezenet>(shop / "pretrained");
        shop.refuses(tuning.arguments("net", "--pretrained pretrained --start other"),
                     "--start: expected a network that begins with random weights, found squeezenet-nn");
        shop.refuses(
            tuning.arguments("net", "--pretrained pretrained --input mean"),
            "--input: expected scale, as weights learnt from photographs want it, for squeezenet-nn; "
            "found mean");
    }
}

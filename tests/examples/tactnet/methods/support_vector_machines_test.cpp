// Support vector machines as methods.

#include "../workshop.hpp"

#include <array>
#include <memory>
#include <methods/support_vector_machines/machine.hpp>

using namespace support;

namespace {

/// A machine of one support vector a class, by its labels alone.
support_vector_machine machine_of(tactnet::multiclass scheme, const std::vector<std::size_t>& labels) {
    tactnet::kernel_machine_parameters<tactnet::rbf_kernel> parts;
    parts.kernel.gamma = 1;
    parts.scheme = scheme;
    parts.features = 1;
    parts.labels = labels;
    for (std::size_t c = 0; c < labels.size(); ++c) {
        parts.support_counts.push_back(1);
        parts.support_vectors.push_back(static_cast<float>(c));
    }
    parts.coefficients.resize(labels.size() * parts.coefficients_each());
    parts.offsets.resize(tactnet::machine_count(labels.size(), scheme));
    return tactnet::kernel_machine<tactnet::rbf_kernel>(parts);
}

} // namespace

TEST_SUITE("program") {
    TEST_CASE("support_vector_machine: the score is the smallest value in favour of the class") {
        using tactnet::multiclass;
        const auto decides = [](const support_vector_machine& machine, const std::vector<double>& values,
                                std::size_t label, double score) {
            const auto last = std::make_unique<double[]>(values.size()); // nothing after it
            std::ranges::copy(values, last.get());
            const scored_class found = machine.decide({last.get(), values.size()});
            CHECK(found.label == label);
            CHECK(found.score == score);
        };
        const auto two = machine_of(multiclass::one_versus_one, {3, 5});
        decides(two, {0.75}, 3, 0.75);
        decides(two, {-0.25}, 5, 0.25);
        decides(two, {0}, 5, 0);
        const auto three = machine_of(multiclass::one_versus_one, {0, 1, 2});
        decides(three, {-1, 0.5, 0.25}, 1, 0.25);
        // A file may say so of a machine with a kernel too: a value for each class.
        const auto rest = machine_of(multiclass::one_versus_rest, {0, 1, 2, 7});
        decides(rest, {0.5, -1, -0.5, 0.625}, 7, 0.625);
        decides(machine_of(multiclass::one_versus_rest, {3, 5}), {-0.5, -0.25}, 5, -0.25);
        CHECK_THROWS(two.decide(std::vector{std::numeric_limits<double>::quiet_NaN()}));
    }

    TEST_CASE("support_vector_machine: trained, the file is evaluated and classifies") {
        const workshop shop;
        write_png(shop / "large.png", 14, 26, std::vector<std::uint8_t>(14 * 26, 50));
        for (const std::string name : {"svm-linear", "svm-rbf", "surf-svm"}) {
            CAPTURE(name);
            const std::string weights = "out/" + name + ".safetensors";
            const outcome trained = shop.trains({"--method", name, "--output", weights});
            says(trained.out, "test accuracy");
            CHECK_FALSE(fs::exists(shop / ("out/" + name + ".learning.csv")));
            const auto file = tactnet::safetensors::read(shop / weights.c_str());
            CHECK(file.metadata().at("network") == name);
            CHECK(file.metadata().at("classes") == "[\"left\",\"middle, of all\",\"right\"]");
            CHECK(file.metadata().at("rows") == "7");
            CHECK(file.metadata().count("cost") == 1);
            CHECK(file.metadata().count("rate") == 0);
            CHECK(file.contains("surf.words") == (name == "surf-svm"));
            CHECK(file.contains("selftest.values"));

            // Any number of threads, and the other name of the option.
            shop.succeeds({"train", "--data", shop.data().string(), "--method", name, "--rows", "7",
                           "--columns", "13", "--seed", "5", "--threads", "3", "--output", "again"});
            CHECK(shop.text("again") == shop.text(weights));

            // The split's test images give the same matrix again.
            const auto evaluate = [&](const char* images) {
                const outcome tested =
                    shop.succeeds({"evaluate", "--weights", weights, "--data", shop.data().string(),
                                   "--images", images, "--results", "r"});
                CHECK(tested.out.find(name + "  7x13") == tested.out.rfind(name));
                return shop.text(("r/confusion_" + name + ".csv"));
            };
            CHECK(evaluate("test") == shop.text(("out/" + name + ".confusion.csv")));

            // All images one by one are what the matrix of all says.
            words arguments{"classify", "--weights", weights};
            for (std::size_t c = 0; c < 3; ++c)
                for (std::size_t i = 0; i < images_per_class; ++i)
                    arguments.push_back(shop.image(c, i).string());
            const auto lines = lines_of(shop.succeeds(arguments).out);
            REQUIRE(lines.size() == 3 * images_per_class);
            std::string matrix = "true class,left,\"middle, of all\",right\n";
            std::size_t right = 0;
            for (std::size_t truth = 0; truth < 3; ++truth) {
                const char* names[] = {",0,left,", ",1,\"middle, of all\",", ",2,right,"};
                matrix += std::array{"left", "\"middle, of all\"", "right"}[truth];
                for (std::size_t found = 0; found < 3; ++found) {
                    const auto of_class = [&](const std::string& line) {
                        return line.find(names[found]) != std::string::npos;
                    };
                    const auto first = lines.begin() + static_cast<std::ptrdiff_t>(truth * images_per_class);
                    const auto count = std::count_if(first, first + images_per_class, of_class);
                    matrix += "," + std::to_string(count);
                    right += truth == found ? static_cast<std::size_t>(count) : 0;
                }
                matrix += "\n";
            }
            CHECK(evaluate("all") == matrix);
            CHECK(right > 2 * images_per_class);
            // Most of the 24 images (of 36) that it was trained on are at the margin or beyond it.
            CHECK(std::count_if(lines.begin(), lines.end(), [](const std::string& line) {
                      return std::stod(line.substr(line.rfind(',') + 1)) > 0.9;
                  }) > 15);

            shop.refuses({"classify", "--weights", weights, "large.png"},
                         "large.png: expected 7 x 13 pixels (rows x columns), or --resize, found 14 x 26");
            shop.succeeds({"classify", "--resize", "--weights", weights, "large.png"});
            shop.refuses({"export", "--weights", weights, "--output", "x.hpp"},
                         weights + ": expected a network, found the support vector machine " + name +
                             ", which cannot be written as a header");
            shop.refuses({"classify", "--weights", weights, "--epsilon", "1", "large.png"},
                         "--epsilon: expected a network, found " + name + ", which has no batch norms");
        }
        shop.refuses(shop.train_arguments("--method svm-rbf --output net --resume"),
                     "--resume: expected a network, found svm-rbf, which is trained in one go");
        shop.refuses(shop.train_arguments("--method svm-rbf --output net --rate 1"),
                     "expected a network, found svm-rbf, which is not trained by epochs");
        for (const auto& image : fs::recursive_directory_iterator(shop.data()))
            if (image.is_regular_file())
                write_png(image.path(), rows, columns, std::vector<std::uint8_t>(rows * columns));
        shop.refuses(shop.train_arguments("--method surf-svm --output net"),
                     "data: dense SURF: found nothing to describe");
    }

    TEST_CASE("support_vector_machine: bad weight files") {
        const workshop shop;
        for (const char* name : {"svm-linear", "svm-rbf", "surf-svm"})
            shop.trains({"--method", name, "--output", name});
        const auto refuses = [&](const char* weights, const std::string& sentence, const words& more = {}) {
            shop.refuses(words{"classify", "--weights", weights, "IMAGE"} + more,
                         std::string(weights) + ": " + sentence);
        };
        for (const char* name : {"svm-linear", "svm-rbf", "surf-svm"}) {
            const auto whole = shop.text(name);
            for (const std::size_t length : {std::size_t{5}, whole.size() / 2, whole.size() - 1}) {
                tactnet::write_file(shop / "cut", std::string_view(whole).substr(0, length));
                refuses("cut", "");
            }
        }
        refuses("svm-linear", "expected weights of svm-rbf as --method says, found those of svm-linear",
                "--method svm-rbf");

        const auto nan = std::numeric_limits<float>::quiet_NaN();
        rewrite(shop / "svm-linear", shop / "nan", "weights", [=](std::vector<float>& v) { v[7] = nan; });
        refuses("nan", "tensor 'weights': expected finite numbers, found nan");
        rewrite(shop / "surf-svm", shop / "nan", "surf.words", [=](std::vector<float>& v) { v[7] = nan; });
        refuses("nan", "tensor 'surf.words': expected a vocabulary, found 'bag_of_words: expected finite");
        rewrite<double>(shop / "svm-rbf", shop / "moved", "gamma", [](std::vector<double>& v) { v[0] *= 2; });
        refuses("moved", "self-test, image 0, machine ");
        rewrite<double>(shop / "surf-svm", shop / "moved", "offsets",
                        [](std::vector<double>& v) { v[1] += 3; });
        refuses("moved", "self-test, image 0, machine 1: expected the value ");

        // What it says of itself.
        struct statement {
            const char *of, *key, *value, *sentence;
        };
        for (const statement& s : std::initializer_list<statement>{
                 {"svm-linear", "network", "svm-rbf",
                  "metadata 'machine': expected 'kernel', found 'linear'"},
                 {"svm-linear", "network", "surf-svm",
                  "metadata 'features': expected 'histograms of surf words', found 'pixels'"},
                 {"surf-svm", "network", "svm-linear",
                  "metadata 'features': expected 'pixels', found 'histograms of surf words'"},
                 {"surf-svm", "surf_scales", "1 3", "metadata 'surf_scales': expected '1 2', found '1 3'"},
                 {"svm-rbf", "input_scale", "2", "metadata 'input_scale': expected '1', found '2'"},
                 {"svm-rbf", "rows", "8", "metadata 'rows': expected '7', found '8'"},
                 {"svm-rbf", "version", "2", "metadata 'version': expected format version 1, found '2'"},
                 {"svm-rbf", "format", "other", "metadata 'format': expected 'tactnet', found 'other'"},
                 {"svm-rbf", "classes", "[\"a\",\"b\"]",
                  "tensor 'labels': expected labels of 2 classes, found 2"},
                 {"svm-rbf", "network", "tactnet4", "expected a tensor "}}) {
            rewrite_metadata(shop / s.of, shop / "says", s.key, s.value);
            refuses("says", s.sentence, std::string_view(s.key) == "rows" ? "--rows 7" : "");
        }
    }
}

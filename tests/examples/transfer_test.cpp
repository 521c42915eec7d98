// The program `tactnet_transfer` from outside, with weights that are drawn at random.

#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/networks/imagenet/squeezenet.hpp>
#include <tactnet/runtime/random.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <decode_image.hpp>
#include <filesystem>
#include <span>
#include <sstream>
#include <string>
#include <support/files/temporary_folder.hpp>
#include <support/run_program.hpp>
#include <vector>

using support::run_program;

namespace {

/// Three classes of bars at angles of their own, anywhere on the array.
void write_images(const std::filesystem::path& folder) {
    constexpr std::size_t rows = 28, columns = 50;
    for (std::uint32_t label = 0; label < 3; ++label) {
        const auto place = folder / ("bar" + std::to_string(label));
        std::filesystem::create_directories(place);
        for (std::uint32_t number = 0; number < 8; ++number) {
            tactnet::random_stream random(5, tactnet::random_purposes::order, label, number);
            const double row = random.uniform(10, 18), column = random.uniform(18, 32),
                         angle = label * 1.0472;
            std::vector<std::uint8_t> pixels;
            for (std::size_t y = 0; y < rows; ++y)
                for (std::size_t x = 0; x < columns; ++x) {
                    const double across = (static_cast<double>(y) - row) * std::cos(angle) -
                                          (static_cast<double>(x) - column) * std::sin(angle);
                    pixels.push_back(std::abs(across) < 2 ? 200 : 0);
                }
            write_png(place / (std::to_string(number) + ".png"), rows, columns, pixels);
        }
    }
}

/// Random weights of the usual size, as torchvision would store them.
void write_weights(const std::filesystem::path& file, bool whole = true) {
    using trunk = tactnet::squeezenet1_1_trunk<tactnet::shape{227, 227, 3}>;
    tactnet::safetensors_writer writer;
    tactnet::random_stream random(6, tactnet::random_purposes::order);
    for (const tactnet::parameter& p : trunk::describe()) {
        const double most =
            p.role == tactnet::parameter_role::weight ? std::sqrt(6.0 / static_cast<double>(p.fan_in)) : 0;
        std::vector<float> values(p.size);
        for (float& value : values)
            value = static_cast<float>(random.uniform(-most, most));
        if (whole || p.name != "features.3.squeeze.bias")
            writer.add(p.name, p.extents, std::span<const float>(values));
    }
    writer.add("classifier.1.bias", {2}, std::span<const float>(std::vector<float>{1, 2}));
    writer.write(file);
}

support::program_result run(const std::string& arguments) {
    return run_program(TACTNET_TRANSFER_PROGRAM " " + arguments);
}

} // namespace

TEST_CASE("transfer: from images and weights to a table of accuracies") {
    const support::temporary_folder folder;
    write_images(folder / "images");
    write_weights(folder / "weights");
    const std::string both = (folder / "images").string() + " " + (folder / "weights").string();
    const auto result = run(both + " 3");
    CHECK(result.status == 0);
    CAPTURE(result.out);
    CAPTURE(result.error);
    std::istringstream lines(result.out);
    std::size_t count = 0;
    for (std::string line; std::getline(lines, line); ++count) {
        const std::size_t percent = line.find(count % 2 == 0 ? "random" : "blocked");
        REQUIRE(percent != std::string::npos);
        // Any features of edges distinguish bars of three angles.
        CHECK(std::stod(line.substr(percent + 7)) >= 75);
    }
    CHECK(count == 6);
    CHECK(result.error.find("24 of 24 images") != std::string::npos);
}

TEST_CASE("transfer: what cannot be used is reported") {
    const support::temporary_folder folder;
    write_images(folder / "images");
    write_weights(folder / "weights", false);
    const std::string images = (folder / "images").string(), weights = (folder / "weights").string();
    CHECK(run(images).status == 2);
    const auto missing = run(images + " " + weights);
    CHECK(missing.status == 2);
    CHECK(missing.error == "tactnet_transfer: " + weights +
                               ": expected a tensor 'features.3.squeeze.bias' of 16, found none of that "
                               "name\n");
    const auto splits = run(images + " " + weights + " none");
    CHECK(splits.status == 2);
    CHECK(splits.error == "tactnet_transfer: SPLITS: expected 1 to 10000, found 'none'\n");
}

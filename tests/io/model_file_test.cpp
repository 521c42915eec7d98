#include <tactnet/deployment.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/io/save_model.hpp>
#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/training/initialise.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <support/error_of.hpp>
#include <support/files/data_folder.hpp>
#include <support/files/temporary_folder.hpp>
#include <utility>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape size{4, 6, 1};
using small_network = network<size, conv2d<2, 3>, batch_norm, relu, max_pool<2>, dense<5>>;

model<small_network> example(std::size_t classes = 3) {
    model<small_network> m;
    initialise(m.network, he_normal{}, 1);
    m.network.epsilon = 1e-4;
    for (std::size_t e = 0; e < size.size(); ++e)
        m.normalise.mean.data()[e] = 0.1F * static_cast<float>(e);
    const std::vector<std::string> names{"cable", "a \"quoted\", one", "Schlüssel"};
    m.classes.assign(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(classes));
    return m;
}

std::vector<std::uint8_t> images(std::size_t count) {
    std::vector<std::uint8_t> pixels(count * size.size());
    for (std::size_t i = 0; i < pixels.size(); ++i)
        pixels[i] = static_cast<std::uint8_t>(i * 97 % 251);
    return pixels;
}

/// The file with other metadata or other bytes in a tensor.
safetensors changed(const safetensors& file, const std::map<std::string, std::string>& metadata,
                    const std::string& tensor = "", std::vector<std::byte> bytes = {}) {
    safetensors_writer writer;
    writer.metadata = file.metadata();
    for (const auto& [key, value] : metadata)
        writer.metadata[key] = value;
    for (const auto& [name, entry] : file.tensors())
        writer.add(name, entry.type, entry.extents,
                   name == tensor ? std::span<const std::byte>(bytes) : file.bytes(name));
    return safetensors::parse(writer.to_bytes(), "m.safetensors");
}

std::string error_of(const safetensors& file) {
    return support::error_of<file_error>([&] { static_cast<void>(load_model<small_network>(file)); });
}

} // namespace

TEST_CASE("model_file: a model comes back as it was") {
    const support::temporary_folder folder;
    const auto path = folder / "m.safetensors";
    const model<small_network> m = example();
    save_model(path, m, {{"network", "small"}, {"seed", "7"}});
    const model_description says = describe_model(safetensors::read(path));
    CHECK(says.network == "small");
    CHECK(says.rows == 4);
    CHECK(says.columns == 6);
    CHECK(says.epsilon == 1e-4);
    CHECK(says.subtracts_mean == true);
    CHECK(safetensors::read(path).metadata().at("seed") == "7");

    const model<small_network> copy = load_model<small_network>(path);
    CHECK(copy.classes == m.classes);
    CHECK(copy.network.epsilon == 1e-4);
    CHECK(load_model<small_network>(path, 0.25).network.epsilon == 0.25);
    CHECK(detail::class_logits(copy, images(3)) == detail::class_logits(m, images(3)));
    CHECK(detail::class_logits(m, images(3)).size() == 9);
}

TEST_CASE("model_file: scaled input") {
    const support::temporary_folder folder;
    const auto path = folder / "m.safetensors";
    model<small_network> m = example();
    m.normalise = {.mean = {}, .scale = 1.0F / 255};
    save_model(path, m);
    CHECK(safetensors::read(path).metadata().at("input") == "scale");
    CHECK_FALSE(safetensors::read(path).contains("input_mean"));
    CHECK(load_model<small_network>(path).normalise.scale == 1.0F / 255);
}

TEST_CASE("model_file: several channels") {
    using colourful = network<shape{4, 6, 3}, conv2d<2, 3>, batch_norm, relu, max_pool<2>, dense<2>>;
    const support::temporary_folder folder;
    const auto path = folder / "m.safetensors";
    model<colourful> m;
    initialise(m.network, he_normal{}, 1);
    for (std::size_t e = 0; e < 72; ++e)
        m.normalise.mean.data()[e] = 0.1F * static_cast<float>(e);
    m.classes = {"a", "b"};
    save_model(path, m, {}, images(6)); // two of three channels
    const safetensors file = safetensors::read(path);
    file.require_extents("input_mean", std::vector<std::size_t>{3, 4, 6});
    file.require_extents("selftest.input", std::vector<std::size_t>{2, 3, 4, 6});
    file.require_extents("selftest.logits", std::vector<std::size_t>{2, 2});

    const model<colourful> copy = load_model<colourful>(path);
    CHECK(std::equal(copy.normalise.mean.begin(), copy.normalise.mean.end(), m.normalise.mean.begin()));
    CHECK(detail::class_logits(copy, images(3)) == detail::class_logits(m, images(3)));
}

TEST_CASE("model_file: a self-test notices what changed") {
    const support::temporary_folder folder;
    const auto path = folder / "m.safetensors";
    save_model(path, example(), {}, images(2));
    const safetensors good = safetensors::read(path);
    CHECK(error_of(good) == "no error");
    good.require_extents("selftest.input", std::vector<std::size_t>{2, 4, 6});
    good.require_extents("selftest.logits", std::vector<std::size_t>{2, 3});

    // Another epsilon gives other logits; so does one weight.
    const std::string moved = error_of(changed(good, {{"epsilon", "1"}}));
    CHECK(moved.find("m.safetensors: self-test, image 0, class ") == 0);
    CHECK(moved.find("expected the logit ") != std::string::npos);
    const auto before = good.values<float>("fc.bias");
    std::vector<float> bias(before.begin(), before.end());
    bias[2] += 0.5F;
    const auto bytes = std::as_bytes(std::span(bias));
    CHECK(error_of(changed(good, {}, "fc.bias", {bytes.begin(), bytes.end()})).find("image 0, class 2") !=
          std::string::npos);
}

TEST_CASE("model_file: a self-test that tests nothing is refused") {
    const support::temporary_folder folder;
    save_model(folder / "m.safetensors", example(), {}, images(2));
    const safetensors good = safetensors::read(folder / "m.safetensors");
    const auto with_selftest = [&](std::size_t count, std::vector<float> logits) {
        safetensors_writer writer;
        writer.metadata = good.metadata();
        for (const auto& [name, entry] : good.tensors())
            if (!name.starts_with("selftest."))
                writer.add(name, entry.type, entry.extents, good.bytes(name));
        writer.add("selftest.input", {count, 4, 6}, images(count));
        writer.add("selftest.logits", {count, 3}, logits);
        return error_of(safetensors::parse(writer.to_bytes(), "m.safetensors"));
    };
    const auto logits = good.values<float>("selftest.logits");
    CHECK(with_selftest(2, logits) == "no error");
    CHECK(with_selftest(0, {}) ==
          "m.safetensors: tensor 'selftest.input': expected one image or more, found none");
    // Any difference is within a tolerance that is a share of infinity.
    for (const float broken : {INFINITY, -INFINITY, std::nanf("")}) {
        auto wrong = logits;
        wrong[4] = broken;
        CHECK(with_selftest(2, wrong).starts_with(
            "m.safetensors: tensor 'selftest.logits', element 4: expected a finite number, found "));
    }
}

TEST_CASE("model_file: metadata that mean nothing") {
    const support::temporary_folder folder;
    save_model(folder / "m.safetensors", example());
    const safetensors good = safetensors::read(folder / "m.safetensors");
    CHECK(error_of(changed(good, {{"rows", "5"}})) ==
          "m.safetensors: metadata: expected a network for 4 x 6, found one for 5 x 6");
    CHECK(error_of(changed(good, {{"rows", "4x"}})) ==
          "m.safetensors: metadata 'rows': expected a number of rows, found '4x'");
    CHECK(error_of(changed(good, {{"epsilon", "-1"}})) ==
          "m.safetensors: metadata 'epsilon': expected a positive number, found '-1'");
    CHECK(error_of(changed(good, {{"epsilon", "inf"}})).find("expected a positive number") !=
          std::string::npos);
    CHECK(error_of(changed(good, {{"version", "2"}})) ==
          "m.safetensors: metadata 'version': expected format version 1, found '2'");
    CHECK(error_of(changed(good, {{"classes", "[\"a\",\"b\"]"}})) ==
          "m.safetensors: metadata 'classes': expected 3 names, as there are logits, found 2");
    CHECK(error_of(changed(good, {{"classes", "[\"a\",\"b"}})).find("m.safetensors: metadata 'classes': ") ==
          0);
    safetensors_writer nameless;
    nameless.metadata = {{"format", "tactnet"}, {"version", "1"}};
    const auto message = [&] { return error_of(safetensors::parse(nameless.to_bytes(), "m.safetensors")); };
    CHECK(message() == "m.safetensors: metadata 'classes': expected names as a JSON array, found none");
    nameless.metadata["machine"] = "kernel";
    CHECK(message() ==
          "m.safetensors: metadata 'classes': expected names as a JSON array, found none: a support "
          "vector machine, for load_kernel_machine or load_linear_machine");
    for (const std::string name : {"a\\u001bb", "a\\nb", "\\u0000", "\xE2\x80\xAEgpj", "\xC2\x9B", "\x7F"})
        CHECK(
            error_of(changed(good, {{"classes", "[\"x\",\"" + name + "\",\"z\"]"}}))
                .starts_with("m.safetensors: metadata 'classes': expected names without control characters, "
                             "each once, found '"));
    for (const auto& [names, found] :
         {std::pair{R"(["x","","z"])", "an empty name"}, {R"(["x","y","x"])", "'x' twice"}})
        CHECK(error_of(changed(good, {{"classes", names}}))
                  .ends_with(std::string(", each once, found ") + found));
    CHECK(error_of(changed(good, {{"classes", "[\"a\",\"Schlüssel, lang\",\"鍵 🔑\"]"}})) == "no error");
    model named = example();
    named.classes[1] = "a\nb";
    CHECK_THROWS_WITH_AS(save_model(folder / "n.safetensors", named),
                         "classes: expected names without control characters, each once, found 'a\\x0ab'",
                         std::invalid_argument);
    for (const char* wrong : {"", "cable"}) {
        named.classes[1] = wrong;
        CHECK_THROWS_AS(save_model(folder / "n.safetensors", named), std::invalid_argument);
    }
    CHECK(!std::filesystem::exists(folder / "n.safetensors"));
    CHECK(error_of(changed(good, {{"input", "guess"}})) ==
          "m.safetensors: metadata 'input': expected 'mean' or 'scale', found 'guess'");
    // What another version means by a word is not for this one to judge.
    CHECK(error_of(changed(good, {{"version", "2"}, {"rows", "4 to 8"}})) ==
          "m.safetensors: metadata 'version': expected format version 1, found '2'");
    // Files from elsewhere may use the same words for anything.
    const safetensors foreign = changed(good, {{"format", "pt"},
                                               {"classes", "alphabetical"},
                                               {"input", "counts"},
                                               {"rows", "of the table"},
                                               {"columns", "-1"},
                                               {"epsilon", "small"}});
    CHECK(error_of(foreign) == "no error");
    CHECK_FALSE(describe_model(foreign).rows);
    CHECK_FALSE(describe_model(foreign).columns);
    CHECK_FALSE(describe_model(foreign).epsilon);
    CHECK(describe_model(changed(good, {{"format", "pt"}})).epsilon == 1e-4);
}

TEST_CASE("model_file: as many names as outputs at most, and one at least") {
    const support::temporary_folder folder;
    model<small_network> m = example();
    for (const std::size_t wrong : {0u, 6u}) {
        m.classes.assign(wrong, "one of them");
        CHECK_THROWS_WITH_AS(
            save_model(folder / "m.safetensors", m, {}, images(1)),
            detail::joined({"model: expected the names of 1 to 5 classes, found ", wrong}).c_str(),
            std::invalid_argument);
    }
    CHECK_FALSE(std::filesystem::exists(folder / "m.safetensors"));
}

TEST_CASE("model_file: the same without the network's type") {
    const support::temporary_folder folder;
    const model<small_network> m = example();
    save_model(folder / "typed", m, {{"seed", "7"}}, images(2));
    const auto logits = [&](std::span<const std::uint8_t> asked) { return detail::class_logits(m, asked); };
    save_model(folder / "parts", model_parts_of(m), {{"seed", "7"}}, images(2), logits);
    CHECK(read_file(folder / "typed") == read_file(folder / "parts"));

    const safetensors file = safetensors::read(folder / "parts");
    const stored_arrays arrays = stored_arrays_of<small_network>();
    const model<small_network> copy = make_model<small_network>(read_model(file, size, arrays));
    CHECK(copy.classes == m.classes);
    CHECK(detail::class_logits(copy, images(3)) == detail::class_logits(m, images(3)));
    CHECK_NOTHROW(check_selftest(file, size, 3, logits));
    CHECK_THROWS_AS(
        check_selftest(file, size, 3, [](std::span<const std::uint8_t>) { return std::vector<float>(6); }),
        file_error);
}

TEST_CASE("model_file: the published TactNet-4 gives the published logits" * doctest::test_suite("data")) {
    const auto weights = support::find_data("published_tactnet4_14x25.safetensors");
    const auto golden = support::find_data("published_tactnet4_14x25_golden.safetensors");
    if (!weights || !golden)
        return;
    const auto m = load_model<tactnet4<shape{14, 25, 1}, 22>>(*weights);
    CHECK(m.classes.size() == 22);
    CHECK(m.classes[3] == "class_03");
    const safetensors file = safetensors::read(*golden);
    const auto expected = file.values<float>("logits");
    thread_pool alone;
    const auto found = m.logits(file.values<std::uint8_t>("inputs"), alone);
    REQUIRE(found.size() == expected.size());
    double largest = 0, difference = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        largest = std::max(largest, std::abs(static_cast<double>(expected[i])));
        difference =
            std::max(difference, std::abs(static_cast<double>(found[i]) - static_cast<double>(expected[i])));
    }
    MESSAGE("largest difference ", difference, " of ", largest);
    CHECK(difference <= 1e-4 * largest);
}

TEST_CASE("model_file: weights that no training has touched are neither saved nor loaded") {
    const support::temporary_folder folder;
    const auto path = folder.path() / "m.safetensors";
    model<small_network> untouched = example();
    untouched.network = {};
    const std::string expected = "expected a trained network, found one whose weights are all zero";
    CHECK(support::error_of<std::invalid_argument>([&] {
              save_model(path, untouched);
          }).find("model: " + expected) != std::string::npos);
    CHECK(!std::filesystem::exists(path));
    CHECK(support::error_of<std::invalid_argument>([&] {
              (void)deploy(untouched);
          }).find("deploy: " + expected) != std::string::npos);
    CHECK_NOTHROW((void)deploy(untouched.network)); // to measure its time

    save_model(path, example());
    const safetensors good = safetensors::read(path);
    safetensors zeros = changed(good, {}, "conv1.weight", std::vector<std::byte>(2 * 9 * sizeof(float)));
    zeros = changed(zeros, {}, "fc.weight", std::vector<std::byte>(3 * 2 * 2 * 3 * sizeof(float)));
    CHECK(error_of(zeros).starts_with("m.safetensors: " + expected));
}

TEST_CASE("model_file: the self-test of weights that were rounded since says so") {
    const support::temporary_folder folder;
    const auto path = folder.path() / "m.safetensors";
    save_model(path, example(), {}, images(4));
    const safetensors file = safetensors::read(path);
    safetensors_writer rounded;
    rounded.metadata = file.metadata();
    for (const auto& [name, entry] : file.tensors()) {
        const std::span<const std::byte> stored = file.bytes(name);
        if (name.starts_with("selftest.")) {
            rounded.add(name, entry.type, entry.extents, stored);
            continue;
        }
        std::vector<std::byte> halves; // the upper halves of floats: BF16
        for (std::size_t i = 0; i < stored.size(); i += 4)
            halves.insert(halves.end(), {stored[i + 2], stored[i + 3]});
        rounded.add(name, element_type::bfloat16, entry.extents, halves);
    }
    const std::string error = error_of(safetensors::parse(rounded.to_bytes(), "m.safetensors"));
    CHECK(error.find("self-test, image ") != std::string::npos);
    CHECK(error.find(": weights are stored as BF16, with fewer digits than when the self-test was made") !=
          std::string::npos);
}

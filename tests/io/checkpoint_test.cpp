#include <tactnet/io/checkpoint.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/write_file.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/training/trainer.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <support/files/temporary_folder.hpp>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape size{5, 7, 1};
using small_network = network<size, conv2d<3, 3>, batch_norm, relu, max_pool<2>, dropout<25>, dense<4>>;

/// Three classes of noise, brighter in one corner each.
struct noise {
    std::vector<std::uint8_t> pixels;
    std::vector<std::size_t> labels;

    noise() {
        random_stream random(5, random_purposes::order);
        for (std::size_t i = 0; i < 30; ++i) {
            labels.push_back(i % 3);
            for (std::size_t e = 0; e < size.size(); ++e)
                pixels.push_back(
                    static_cast<std::uint8_t>(random.below(100) + (e % 7 / 2 == i % 3 ? 60 : 0)));
        }
    }
    labelled_images view() const { return {pixels, labels, 3}; }
};

recipe short_recipe() {
    recipe r;
    r.epochs = 6;
    r.batch = 8;
    r.ranges = augmentation_ranges::published(5, 7);
    r.averaging = 0.9;
    r.patience = 50;
    return r;
}

const file_metadata settings{{"seed", "3"}, {"network", "small"}};

struct run {
    noise data;
    thread_pool threads;
    trainer<small_network> training;

    explicit run(std::size_t thread_count = 1)
        : threads(thread_count),
          training(short_recipe(), data.view(), split_data(data.labels, 3, split_rule::random, 3), 3,
                   threads) {}

    void until(std::size_t epochs) {
        while (training.history().size() < epochs)
            training.run_epoch();
    }
    /// Every bit of what the training has made.
    std::vector<std::byte> bits() {
        std::vector<std::byte> all;
        const auto append = [&](const auto* from, std::size_t count) {
            const auto bytes = std::as_bytes(std::span(from, count));
            all.insert(all.end(), bytes.begin(), bytes.end());
        };
        training.for_each_state([&](std::string_view, auto values) { append(values.data(), values.size()); });
        const auto progress = training.progress();
        append(progress.data(), progress.size());
        append(training.best().learnable_values().data(), training.best().learnable_values().size());
        return all;
    }
};

std::string error_of(const std::filesystem::path& path, run& target, const file_metadata& wanted = settings) {
    try {
        load_checkpoint(path, target.training, wanted);
    } catch (const file_error& error) {
        const std::string what = error.what();
        return what.substr(what.find(": ") + 2);
    }
    return "no error";
}

} // namespace

TEST_CASE("checkpoint: stopped and resumed gives the same bits as one go, on any number of threads") {
    const support::temporary_folder folder;
    run whole;
    whole.until(6);
    const auto expected = whole.bits();
    for (const std::size_t before : {1U, 2U})
        for (const std::size_t after : {1U, 2U}) {
            CAPTURE(before);
            CAPTURE(after);
            const auto path = folder / "t.checkpoint";
            run first(before);
            first.until(3);
            const auto untouched = first.bits();
            save_checkpoint(path, first.training, settings);
            CHECK(first.bits() == untouched);
            run second(after);
            load_checkpoint(path, second.training, settings);
            CHECK(second.bits() == untouched);
            CHECK(second.training.history().size() == 3);
            second.until(6);
            CHECK(second.training.finished());
            CHECK(second.bits() == expected);
        }
}

TEST_CASE("checkpoint: the error names the setting that differs") {
    const support::temporary_folder folder;
    const auto path = folder / "t.checkpoint";
    run first;
    first.until(1);
    save_checkpoint(path, first.training, settings);
    run second;
    const auto before = second.bits();
    CHECK(error_of(path, second, {{"seed", "4"}, {"network", "small"}}) ==
          "setting 'seed' of the stopped training: expected '4', found '3'");
    CHECK(error_of(path, second, {{"seed", "3"}, {"network", "small"}, {"data", "x"}}) ==
          "setting 'data' of the stopped training: expected 'x', found none");
    CHECK(second.bits() == before);
    // Without reading what was trained: from the header alone.
    CHECK_NOTHROW(check_checkpoint(path, settings));
    CHECK_THROWS_AS(check_checkpoint(path, {{"seed", "4"}}), file_error);
    CHECK_THROWS_AS(check_checkpoint(folder / "nothing", settings), file_error);
}

TEST_CASE("checkpoint: damaged files change nothing") {
    const support::temporary_folder folder;
    const auto path = folder / "t.checkpoint";
    run first;
    first.until(2);
    save_checkpoint(path, first.training, settings);
    const safetensors good = safetensors::read(path);
    const auto bytes = read_file(path);
    run second;
    const auto before = second.bits();

    write_file(path, std::span(bytes).first(bytes.size() - 1));
    CHECK(error_of(path, second) != "no error");
    CHECK(error_of(folder / "nothing", second) == "expected a file, found nothing of that name");

    const auto rewrite = [&](const std::string& tensor, std::vector<std::size_t> extents,
                             std::vector<double> values, bool drop_metadata = false) {
        safetensors_writer writer;
        if (!drop_metadata)
            writer.metadata = good.metadata();
        for (const auto& [name, entry] : good.tensors())
            if (name != tensor)
                writer.add(name, entry.type, entry.extents, good.bytes(name));
        writer.add(tensor, std::move(extents), std::span<const double>(values));
        writer.write(path);
    };
    rewrite("values", {1}, {1});
    CHECK(error_of(path, second).starts_with("tensor 'values': expected "));
    auto values = good.values<double>("best.statistics");
    values[2] = std::nan("");
    rewrite("best.statistics", {values.size()}, values);
    CHECK(error_of(path, second) ==
          "tensor 'best.statistics', element 2: expected a finite number, found nan");
    for (const char* name : {"statistics", "averaged.statistics", "best.statistics", "optimiser.second"}) {
        values = good.values<double>(name);
        values[5] = -0x1p-20; // the last of three variances
        rewrite(name, {values.size()}, values);
        CHECK(error_of(path, second) ==
              "tensor '" + std::string(name) +
                  "', element 5: expected a square or a variance (at least 0), found -9.536743e-07");
    }
    // Which numbers a training can have is the trainer's to say; what it says must name the file.
    const auto progress_error = [&](auto change) {
        auto progress = good.values<double>("progress");
        change(progress);
        rewrite("progress", {progress.size()}, progress);
        return error_of(path, second);
    };
    constexpr const char* refused = "tensor 'progress': expected the numbers of this training, found '";
    CHECK(progress_error([](auto& progress) { progress.resize(3); }).starts_with(refused));
    // Steps, validations since the smallest loss, whether it has stopped.
    for (const std::size_t element : {0U, 4U, 5U})
        for (const double wrong : {-1.0, 0.5, 1e300, std::nan("")})
            CHECK(progress_error([&](auto& progress) { progress[element] = wrong; }).starts_with(refused));
    for (const std::size_t element : {1U, 3U}) // losses
        CHECK(progress_error([&](auto& progress) { progress[element] = std::nan(""); }).starts_with(refused));
    const std::string too_many = progress_error([](auto& progress) {
        progress[0] *= 3.5; // as many steps as seven epochs have, of a recipe of six
        while (progress.size() < 6 + 7 * 4)
            progress.push_back(progress[progress.size() - 4]);
    });
    CHECK(too_many.starts_with(refused));
    CHECK(too_many.find("at most 6 epochs, found 7") != std::string::npos);
    rewrite("other", {1}, {1}, true);
    CHECK(error_of(path, second) == "metadata 'format': expected 'tactnet checkpoint', found none");
    CHECK(second.bits() == before);
}

TEST_CASE("checkpoint: before the first epoch, when no loss has a number yet") {
    const support::temporary_folder folder;
    const auto path = folder / "t.checkpoint";
    run first, second;
    save_checkpoint(path, first.training, settings);
    CHECK(error_of(path, second) == "no error");
    CHECK(second.bits() == first.bits());
}

// Sets of classes, faults and unknown objects, measured on made-up images and logits.

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <evaluation/decisions.hpp>
#include <numeric>
#include <string>
#include <vector>

namespace {

/// Recognises by the sum of the counts: class 1 from 8550 on.
class by_sum final : public trained_method {
public:
    const std::vector<std::string>& classes() const override { return classes_; }
    tactnet::evaluation evaluate(const tactnet::labelled_images& images, std::span<const std::size_t> chosen,
                                 tactnet::thread_pool&, tactnet::test_time_augmentation) const override {
        tactnet::evaluation result{0, tactnet::confusion_matrix(2), {}, {}};
        for (const std::size_t i : chosen) {
            const auto image = images.image<tactnet::shape{14, 25}>(i);
            result.confusion.add(images.labels[i], std::accumulate(image.begin(), image.end(), 0) >= 8550);
        }
        return result;
    }
    std::vector<scored_class> recognise(std::span<const std::uint8_t>, const tactnet::temperature_scaling&,
                                        tactnet::thread_pool&) const override {
        return {};
    }
    void save(const std::filesystem::path&, const tactnet::file_metadata&,
              std::span<const std::uint8_t>) const override {}

private:
    std::vector<std::string> classes_{"light", "heavy"};
};

} // namespace

TEST_SUITE("program") {
    TEST_CASE("faults_of_sensor: a stuck row deceives a method, and is corrected") {
        image_data data; // ten images, of which every second is pressed harder, on 90 tactels
        data.images.rows = 14, data.images.columns = 25;
        data.images.classes = by_sum().classes();
        for (std::size_t i = 0; i < 10; ++i) {
            data.images.labels.push_back(i % 2);
            for (std::size_t y = 0; y < 14; ++y)
                for (std::size_t x = 0; x < 25; ++x)
                    data.images.pixels.push_back(y < 4 || y > 9 || x < 5 || x > 19 ? 0
                                                 : i % 2 == 0                      ? 90
                                                                                   : 100);
        }
        const std::vector<std::size_t> images{0, 1, 2, 3, 4, 5, 6, 7};
        tactnet::thread_pool alone;
        const decision_means means = faults_of_sensor(by_sum{}, data, images, 3, alone);
        REQUIRE(means.size() == 4);
        for (const std::string fault : {"stuck_row", "stuck_tactels"}) {
            CHECK(means.at(fault + "_accuracy") == std::array{4.0, 8.0}); // all are heavy
            CHECK(means.at(fault + "_corrected_accuracy")[1] == 8);
            // Under an object a tactel is corrected once it has been stuck in 16 frames of air, of which
            // there are five before each image: the two light ones among the first three may still be heavy.
            CHECK(means.at(fault + "_corrected_accuracy")[0] >= 6);
        }
        data.images.rows = 7; // no size of the paper
        CHECK(faults_of_sensor(by_sum{}, data, images, 3, alone).empty());
    }

    TEST_CASE("sets_of_classes: by the validation images, of the test images") {
        image_data data;
        data.images.classes = {"a", "b", "c"};
        data.images.labels.assign(60, 0);
        tactnet::data_split split;
        tactnet::evaluation validation, test;
        for (std::size_t i = 0; i < 60; ++i) {
            (i < 40 ? split.validation : split.test).push_back(i);
            auto& logits = i < 40 ? validation.logits : test.logits;
            // Certain and right, but for one of ten, where b may be as well.
            logits.insert(logits.end(), {i % 10 == 9 ? 0.0F : 9.0F, 0.0F, -9.0F});
        }
        const decision_means means = sets_of_classes({}, validation, test, data, split);
        CHECK(means.at("set_coverage") == std::array{20.0, 20.0});
        CHECK(means.at("set_size") == std::array{22.0, 20.0}); // two classes in two of 20 images
    }

    TEST_CASE("without_classes: each class is left out as often over the seeds") {
        image_data data;
        for (std::size_t c = 0; c < 22; ++c) {
            data.images.classes.push_back(std::to_string(c));
            data.images.labels.push_back(c);
        }
        std::vector<std::size_t> left_out(22);
        for (std::uint64_t seed = 0; seed < 22; ++seed) {
            const image_data some = without_classes(data, 5, seed);
            REQUIRE(some.images.classes.size() == 17);
            for (std::size_t c = 0; c < 22; ++c)
                if (const std::size_t label = some.images.labels[c]; label == tactnet::no_class)
                    ++left_out[c];
                else
                    CHECK(some.images.classes.at(label) == std::to_string(c));
        }
        CHECK(left_out == std::vector<std::size_t>(22, 5));
    }

    TEST_CASE("split_of_classes: a training sees no image of the classes that were left out") {
        image_data data;
        for (std::size_t i = 0; i < 60; ++i)
            data.images.labels.push_back(i % 6);
        data.images.classes = {"a", "b", "c", "d", "e", "f"};
        const image_data some = without_classes(std::move(data), 2, 4);
        const auto left_out = [&](std::size_t image) {
            return some.images.labels[image] == tactnet::no_class;
        };
        for (const tactnet::split_rule rule : {tactnet::split_rule::random, tactnet::split_rule::blocked}) {
            const tactnet::data_split split = split_of_classes(some, rule, 4, {});
            for (const auto* part : {&split.training, &split.validation, &split.test})
                CHECK(std::ranges::none_of(*part, left_out));
            CHECK(split.training.size() + split.validation.size() + split.test.size() == 40);
        }
    }

    TEST_CASE("separation: by hand") {
        tactnet::evaluation known, unknown;
        // The larger logit's distance from the other one decides.
        known.logits = {5, 0, 4, 0, 3, 0, 0, 1};
        unknown.logits = {0, 3.5F, 0, 0};
        const decision_means means = separation(known, unknown, 2);
        CHECK(means.at("unknown_softmax_area") == std::array{(2 + 4) / 8.0, 1.0});
        CHECK(means.at("unknown_softmax_accepted") == std::array{0.5, 1.0});
        CHECK(separation(tactnet::evaluation(), unknown, 2).empty());
    }
}

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
}

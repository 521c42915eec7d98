// Means of sets, faults and unknown objects: what they are of.

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <evaluation/decisions.hpp>
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
            std::size_t sum = 0;
            for (const std::uint8_t count : images.image<tactnet::shape{14, 25}>(i))
                sum += count;
            result.confusion.add(images.labels[i], sum >= 8550 ? 1 : 0);
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

const tactnet::evaluation no_logits{0, tactnet::confusion_matrix(1), {}, {}};

/// Ten images, of which every second is pressed harder, on 90 tactels.
image_data pressed(std::size_t rows, std::size_t columns) {
    image_data data;
    data.images.rows = rows, data.images.columns = columns;
    data.images.classes = {"light", "heavy"};
    for (std::size_t i = 0; i < 10; ++i) {
        data.images.labels.push_back(i % 2);
        for (std::size_t y = 0; y < rows; ++y)
            for (std::size_t x = 0; x < columns; ++x)
                data.images.pixels.push_back(y < 4 || y > 9 || x < 5 || x > 19 ? 0 : i % 2 == 0 ? 90 : 100);
    }
    return data;
}

} // namespace

TEST_SUITE("program") {
    TEST_CASE("faults_of_sensor: a stuck row deceives a method, and is corrected") {
        const std::vector<std::size_t> images{0, 1, 2, 3, 4, 5, 6, 7};
        tactnet::thread_pool alone;
        const decision_means means = faults_of_sensor(by_sum{}, pressed(14, 25), images, 3, alone);
        REQUIRE(means.size() == 4);
        for (const std::string fault : {"stuck_row", "stuck_tactels"}) {
            CHECK(means.at(fault + "_accuracy").value() == 0.5); // all are heavy
            CHECK(means.at(fault + "_corrected_accuracy").count == 8);
            // Under an object a tactel is corrected once it has been stuck in 16 frames of air, of which
            // there are five before each image: the two light ones among the first three may still be heavy.
            CHECK(means.at(fault + "_corrected_accuracy").value() >= 0.75);
        }
        CHECK(faults_of_sensor(by_sum{}, pressed(8, 8), images, 3, alone).empty());
    }

    TEST_CASE("sets_of_classes: by the validation images, of the test images") {
        image_data data = pressed(2, 2);
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
        const decision_means means = sets_of_classes(validation, test, data, split);
        CHECK(means.at("set_coverage").value() == 1);
        CHECK(means.at("set_size").sum == 20 + 2); // two classes in two of 20 images
        CHECK(sets_of_classes(no_logits, no_logits, data, split).empty());
    }

    TEST_CASE("choose_classes: each class is left out as often over the seeds") {
        std::vector<std::size_t> left_out(22);
        for (std::uint64_t seed = 0; seed < 22; ++seed) {
            const class_choice choice = choose_classes(22, 5, seed);
            CHECK(choice.known.size() == 17);
            for (const std::size_t c : choice.unknown)
                ++left_out[c];
        }
        CHECK(left_out == std::vector<std::size_t>(22, 5));
    }

    TEST_CASE("images_of_classes: the images of some classes, with labels from 0") {
        image_data data = pressed(2, 3);
        data.taken.size = {1, 2};
        data.taken.pixels.resize(20, 7);
        const std::vector<std::size_t> heavy{1};
        const image_data some = images_of_classes(data, heavy);
        CHECK(some.images.classes == std::vector<std::string>{"heavy"});
        CHECK(some.images.labels == std::vector<std::size_t>(5, 0));
        CHECK(some.images.pixels.size() == 5 * 6);
        CHECK(some.images.pixels[7] == data.images.pixels[3 * 6 + 1]);
        CHECK(some.taken.pixels == std::vector<std::uint8_t>(10, 7));
    }

    TEST_CASE("separation: by hand") {
        tactnet::evaluation known, unknown;
        // Scores of the energy: minus the logarithm of the sum of two equal exponentials.
        for (const float logit : {5.0F, 4.0F, 3.0F, 1.0F})
            known.logits.insert(known.logits.end(), {logit, logit});
        for (const float logit : {3.5F, 0.0F})
            unknown.logits.insert(unknown.logits.end(), {logit, logit});
        const decision_means means = separation(known, unknown, 2);
        CHECK(means.at("unknown_energy_area").value() == (2 + 4) / 8.0);
        CHECK(means.at("unknown_energy_accepted").value() == 0.5);
        CHECK(means.at("unknown_softmax_area").value() == 0.5); // all softmax outputs are a half
        CHECK(separation(no_logits, unknown, 2).empty());
    }
}

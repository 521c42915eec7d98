// What guards a stopped training: a checkpoint is resumed only where all that decides the result is the
// same.

#include <tactnet/io/checkpoint.hpp>
#include <tactnet/io/file_error.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <methods/description.hpp>
#include <span>
#include <string>
#include <string_view>
#include <support/files/temporary_folder.hpp>
#include <vector>

namespace {

using tactnet::recipe;

/// As much of a training as a checkpoint asks for.
struct training {
    std::vector<float> values{1, 2, 3};

    template <class Visit>
    void for_each_state(Visit&& visit) {
        visit(std::string_view("values"), std::span<float>(values));
    }
    std::vector<double> progress() const { return {0}; }
    void restore(std::span<const double>) {}
};

/// Every recipe that differs from one in a single field.
std::vector<recipe> variations() {
    std::vector<recipe> all;
    const auto vary = [&](auto change) { change(all.emplace_back()); };
    vary([](recipe& r) { r.name = "other"; });
    vary([](recipe& r) { ++r.epochs; });
    vary([](recipe& r) { ++r.batch; });
    vary([](recipe& r) { r.rate *= 2; });
    vary([](recipe& r) { r.optimiser = tactnet::adamw{.beta1 = 0.8}; });
    vary([](recipe& r) { r.optimiser = tactnet::adamw{.beta2 = 0.8}; });
    vary([](recipe& r) { r.optimiser = tactnet::adamw{.decay = 0.8}; });
    vary([](recipe& r) { r.optimiser = tactnet::adamw{.epsilon = 0.8}; });
    vary([](recipe& r) { r.optimiser = tactnet::sgd{}; });
    vary([](recipe& r) { r.optimiser = tactnet::sgd{.momentum = 0.8}; });
    vary([](recipe& r) { r.optimiser = tactnet::sgd{.l2 = 0.8}; });
    vary([](recipe& r) { r.optimiser = tactnet::sgd{.l2_of_norms = true}; });
    vary([](recipe& r) { r.schedule = tactnet::constant_rate{}; });
    vary([](recipe& r) { r.schedule = tactnet::step_drop{}; });
    vary([](recipe& r) { r.schedule = tactnet::step_drop{.period = 8}; });
    vary([](recipe& r) { r.schedule = tactnet::step_drop{.factor = 0.8}; });
    vary([](recipe& r) { r.schedule = tactnet::one_cycle{.warm_up = 0.8}; });
    vary([](recipe& r) { r.initialisation = tactnet::fixed_normal{}; });
    vary([](recipe& r) { r.initialisation = tactnet::fixed_normal{.deviation = 0.8}; });
    vary([](recipe& r) { r.input = tactnet::input_rule::scale; });
    vary([](recipe& r) { r.input = tactnet::input_rule::counts; });
    vary([](recipe& r) { r.augmentation = tactnet::augmentation_rule::none; });
    vary([](recipe& r) { r.augmentation = tactnet::augmentation_rule::sixfold; });
    vary([](recipe& r) { r.ranges.reflect_rows = 0.8; });
    vary([](recipe& r) { r.ranges.reflect_columns = 0.8; });
    vary([](recipe& r) { r.ranges.translation = 0.8; });
    vary([](recipe& r) { r.ranges.rotation = 0.8; });
    vary([](recipe& r) { r.ranges.scale = 0.8; });
    vary([](recipe& r) { r.ranges.pressure = 0.8; });
    vary([](recipe& r) { r.ranges.shear = 0.8; });
    vary([](recipe& r) { r.ranges.shear = -0.8; });
    vary([](recipe& r) { r.label_smoothing = 0.8; });
    vary([](recipe& r) { r.sharpness_radius = 0.8; });
    vary([](recipe& r) { r.keeps_last = true; });
    vary([](recipe& r) { r.averaging = 0.8; });
    vary([](recipe& r) { r.epsilon = 0.8; });
    vary([](recipe& r) { r.remeasure_statistics = true; });
    vary([](recipe& r) { ++r.validate_every; });
    vary([](recipe& r) { ++r.patience; });
    return all;
}

} // namespace

TEST_SUITE("program") {
    TEST_CASE("description: a stopped training is not gone on with when any field of its recipe differs") {
        const support::temporary_folder folder;
        const auto file = folder / "checkpoint";
        training t;
        tactnet::save_checkpoint(file, t, describe_recipe(recipe{}));
        CHECK_NOTHROW(tactnet::load_checkpoint(file, t, describe_recipe(recipe{})));
        std::vector<tactnet::file_metadata> seen{describe_recipe(recipe{})};
        for (const recipe& other : variations()) {
            const auto said = describe_recipe(other);
            CAPTURE(seen.size());
            CHECK_THROWS_AS(tactnet::load_checkpoint(file, t, said), tactnet::file_error);
            for (const auto& before : seen)
                CHECK(said != before);
            seen.push_back(said);
        }
    }

    TEST_CASE("description: a checkpoint from before shears and erased parts were said is of a training "
              "without any") {
        const auto ranges = [](double shear, double erase = 0) {
            recipe r;
            r.ranges = {.reflect_rows = 0.5, .reflect_columns = 0.5, .translation = 3, .rotation = 10};
            r.ranges.shear = shear;
            r.ranges.erase = erase;
            return describe_recipe(r).at("augmentation_ranges");
        };
        const std::string before =
            "reflect rows 0.5 columns 0.5 translation 3 rotation 10 scale 0 pressure 0";
        CHECK(ranges(0) == before);
        CHECK(ranges(0.25) == before + " shear 0.25");
        CHECK(ranges(0, 0.5) == before + " erase 0.5");
    }
}

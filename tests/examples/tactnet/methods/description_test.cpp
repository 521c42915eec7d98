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
    using tactnet::adamw, tactnet::augmentation_ranges, tactnet::one_cycle, tactnet::sgd, tactnet::step_drop;
    for (const auto field : {&recipe::epochs, &recipe::batch, &recipe::validate_every, &recipe::patience})
        vary([=](recipe& r) { ++(r.*field); });
    for (const auto field : {&recipe::rate, &recipe::pretrained_rate, &recipe::label_smoothing,
                             &recipe::sharpness_radius, &recipe::averaging, &recipe::epsilon})
        vary([=](recipe& r) { r.*field += 0.8; });
    for (const auto field : {&recipe::remeasure_statistics, &recipe::keeps_last})
        vary([=](recipe& r) { r.*field = !(r.*field); });
    for (const auto field :
         {&augmentation_ranges::reflect_rows, &augmentation_ranges::reflect_columns,
          &augmentation_ranges::translation, &augmentation_ranges::rotation, &augmentation_ranges::scale,
          &augmentation_ranges::pressure, &augmentation_ranges::shear, &augmentation_ranges::erase})
        for (const double value : {0.8, -0.8})
            vary([=](recipe& r) { r.ranges.*field = value; });
    for (const decltype(recipe::optimiser)& rule : std::initializer_list<decltype(recipe::optimiser)>{
             adamw{.beta1 = 0.8}, adamw{.beta2 = 0.8}, adamw{.decay = 0.8}, adamw{.epsilon = 0.8}, sgd{},
             sgd{.momentum = 0.8}, sgd{.l2 = 0.8}, sgd{.l2_of_norms = true}})
        vary([&](recipe& r) { r.optimiser = rule; });
    for (const decltype(recipe::schedule)& rule : std::initializer_list<decltype(recipe::schedule)>{
             tactnet::constant_rate{}, step_drop{}, step_drop{.period = 8}, step_drop{.factor = 0.8},
             one_cycle{.warm_up = 0.8}})
        vary([&](recipe& r) { r.schedule = rule; });
    for (const auto rule : {tactnet::fixed_normal{}, tactnet::fixed_normal{.deviation = 0.8}})
        vary([&](recipe& r) { r.initialisation = rule; });
    for (const auto rule : {tactnet::input_rule::scale, tactnet::input_rule::counts})
        vary([&](recipe& r) { r.input = rule; });
    for (const auto rule : {tactnet::augmentation_rule::none, tactnet::augmentation_rule::sixfold})
        vary([&](recipe& r) { r.augmentation = rule; });
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

#include <tactnet/networks/tactnet6.hpp>
#include <tactnet/networks/tactresnet.hpp>
#include <tactnet/training/recipe.hpp>

#include <doctest/doctest.h>

#include <stdexcept>
#include <variant>

using namespace tactnet;

TEST_CASE("recipe::published: as in the authors' programs for pretrained networks") {
    const published_training own{.rate = 2e-3,
                                 .drop_period = 0,
                                 .patience = 4,
                                 .transfer =
                                     published_transfer{.epochs = 10, .batch = 5, .new_layer_factor = 20}};
    const recipe r = recipe::published(28, 50, own);
    CHECK(std::get<sgd>(r.optimiser).momentum == 0.9);
    CHECK(std::get<sgd>(r.optimiser).l2 == 1e-4);
    CHECK(std::holds_alternative<constant_rate>(r.schedule));
    CHECK(r.rate * r.pretrained_rate == doctest::Approx(1e-4));
    CHECK(r.epochs == 10);
    CHECK(r.batch == 5);
    CHECK(r.patience == 4);
    CHECK(r.input == input_rule::scale);
    CHECK(r.augmentation == augmentation_rule::none);
}

TEST_CASE("recipe::fine_tuning: the published one on reflected images, with one cycle, for a third "
          "longer") {
    const published_training own{.rate = 2e-3,
                                 .drop_period = 0,
                                 .patience = 4,
                                 .transfer =
                                     published_transfer{.epochs = 15, .batch = 64, .new_layer_factor = 20}};
    const recipe r = recipe::fine_tuning(own);
    CHECK(r.name == "default");
    CHECK(r.epochs == 20);
    CHECK(r.batch == 64);
    CHECK(r.rate == 4e-3);
    CHECK(r.pretrained_rate == doctest::Approx(1.0 / 20));
    CHECK(std::get<sgd>(r.optimiser).momentum == 0.9);
    CHECK(std::holds_alternative<one_cycle>(r.schedule));
    CHECK(r.input == input_rule::scale);
    CHECK(r.augmentation == augmentation_rule::each_epoch);
    CHECK(r.ranges == augmentation_ranges{.reflect_rows = 0.5, .reflect_columns = 0.5});
    CHECK(r.averaging == 0.95);
    CHECK(r.patience == 0);
    CHECK_THROWS_WITH_AS(static_cast<void>(recipe::fine_tuning(tactnet6_training({28, 50}))),
                         doctest::Contains("published_training::transfer), found none"),
                         std::invalid_argument);
}

TEST_CASE("recipe::thorough: the same with three times as many epochs, erased parts and "
          "sharpness-aware gradients; the last is kept") {
    recipe expected = recipe::default_for(14, 25);
    const recipe found = expected.thorough();
    CHECK(found.name == "thorough");
    CHECK(found.epochs == 3 * 440);
    CHECK(found.rate == expected.rate);
    expected.ranges.erase = 0.5;
    CHECK(found.ranges == expected.ranges);
    CHECK(found.averaging == expected.averaging);
    CHECK(found.sharpness_radius == 0.1);
    CHECK(found.keeps_last);
}

TEST_CASE("recipe::default_for: small images are learnt from longer, four times as long at most") {
    CHECK(recipe::default_for(28, 50).epochs == 110);
    CHECK(recipe::default_for(20, 35).epochs == 220);
    CHECK(recipe::default_for(14, 25).epochs == 440);
    CHECK(recipe::default_for(7, 13).epochs == 440);
    CHECK(recipe::default_for(1, 1).epochs == 440);
    CHECK(recipe::default_for(224, 224).epochs == 110);
    CHECK(recipe::default_for(0, 0).epochs == 440);
    CHECK(recipe::default_for(28, 50).ranges.translation == 4);
    CHECK(recipe::default_for(14, 25).ranges.translation == 2);
    CHECK(recipe::default_for(28, 50).ranges.pressure == 0.3);
}

TEST_CASE("recipe::on_features: no new samples are made, and the rate falls to nothing over few epochs") {
    const recipe r = recipe::on_features();
    CHECK(r.augmentation == augmentation_rule::none);
    CHECK(r.epochs == 30);
    CHECK(r.label_smoothing == 0.05);
    CHECK(r.epsilon == 1e-5);
    CHECK(r.rate == 3e-3);
    CHECK(r.averaging == 0);
    CHECK(std::holds_alternative<adamw>(r.optimiser));
    CHECK(std::holds_alternative<one_cycle>(r.schedule));
}

TEST_CASE("recipe::published: as in the authors' programs at 28 x 50") {
    const recipe r = recipe::published(28, 50, tactnet6_training({28, 50}));
    CHECK(std::get<sgd>(r.optimiser).momentum == 0.8);
    CHECK(std::get<sgd>(r.optimiser).l2 == 1e-4);
    CHECK(std::get<sgd>(r.optimiser).l2_of_norms);
    CHECK(std::get<step_drop>(r.schedule).period == 150);
    CHECK(std::get<step_drop>(r.schedule).factor == 0.1);
    CHECK(std::get<fixed_normal>(r.initialisation).deviation == 0.01);
    CHECK(r.epochs == 5000);
    CHECK(r.batch == 0);
    CHECK(r.rate == 0.01);
    CHECK(r.input == input_rule::subtract_mean);
    CHECK(r.validate_every == 10);
    CHECK(r.patience == 4);
    CHECK(r.label_smoothing == 0);
    CHECK(r.remeasure_statistics);
}

TEST_CASE("recipe::published: a network may have its own drops, validations and input") {
    const recipe small = recipe::published(14, 25, tactnet6_training({14, 25}));
    CHECK(std::get<step_drop>(small.schedule).factor == 0.7);
    CHECK(small.validate_every == 15);
    CHECK(small.patience == 7);
    CHECK(small.ranges.rotation == 3);
    const recipe residual = recipe::published(28, 50, tactresnet_training({28, 50}));
    CHECK(std::holds_alternative<constant_rate>(residual.schedule));
    CHECK(residual.input == input_rule::counts);
    CHECK(residual.rate == 0.002);
}

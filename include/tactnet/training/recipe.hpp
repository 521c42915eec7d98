#pragma once

#include <tactnet/image/augmentation.hpp>
#include <tactnet/lowering/input_function.hpp>
#include <tactnet/networks/published.hpp>
#include <tactnet/networks/reflection_rule.hpp>
#include <tactnet/text/message.hpp>
#include <tactnet/training/initialise.hpp>
#include <tactnet/training/optimiser.hpp>
#include <tactnet/training/schedule.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace tactnet { inline namespace TACTNET_ARCH {

/// How counts become inputs of the network.
enum class input_rule {
    subtract_mean, ///< minus the mean image of the training set, as the authors' TactNet-4 and 6
    scale,         ///< divided by 255
    counts         ///< as they are, as the authors' TactResNet
};

/// How training images are augmented.
enum class augmentation_rule {
    none,
    each_epoch, ///< a new variant of every image in every epoch
    sixfold     ///< every image and five variants, made once: the paper's 704 → 4224
};

/// The settings of a training, apart from data, split and network.
struct recipe {
    std::string_view name = "default";
    std::size_t epochs = 110;
    std::size_t batch = 32; ///< samples per step; 0 is all training images
    double rate = 1e-2;     ///< highest learning rate
    /// Share of the rate for arrays that start from weights of another network
    /// (training_loop::start_from_trunk). 0 freezes weights, while the statistics of batch norms still follow
    /// the images.
    double pretrained_rate = 1;
    tactnet::optimiser optimiser = adamw{};
    tactnet::schedule schedule = one_cycle{};
    tactnet::initialisation initialisation = he_normal{};
    input_rule input = input_rule::subtract_mean;
    input_function function{}; ///< of counts, before the rule above
    augmentation_rule augmentation = augmentation_rule::each_epoch;
    augmentation_ranges ranges{};
    /// The classes that reflected images show. Only reflections that `ranges` draw are made.
    reflection_rule reflections = reflection_rule::all();
    /// Augment the images as they were taken, if these are given, and reduce the result; else augment the
    /// small ones. Translations are in tactels of the small ones either way.
    bool augment_full_resolution = true;
    double label_smoothing = 0.1;
    /// Radius of sharpness-aware minimisation (Foret et al., 2021), a distance between parameters. 0 is off,
    /// all else doubles the time.
    double sharpness_radius = 0;
    double averaging = 0;  ///< share of the past in a running average of the parameters; 0 is off
    double epsilon = 1e-5; ///< of batch norms
    /// Recompute the statistics of batch norms from the training images without augmentation before each
    /// validation, for the network that is validated (the averaged one, if any). Use it if a batch is the
    /// whole training set: running statistics then lag behind parameters that move in large steps, and
    /// augmented images have other statistics than the images to recognise.
    bool remeasure_statistics = false;
    std::size_t validate_every = 1; ///< epochs
    std::size_t patience = 0;       ///< validations without a smaller loss before it stops; 0 never stops
    /// Keep the network of the last epoch in place of the one with the smallest validation loss. With a rate
    /// that falls to zero, accuracy still rises after the loss has begun to rise, since the network grows
    /// overconfident.
    bool keeps_last = false;

    /// The recipe that did best on the paper's images. Compared with the paper's: images also vary in size
    /// and pressure, and before they are reduced if larger ones are given; AdamW on small batches with one
    /// cycle of the learning rate, smoothed labels, averaged parameters.
    [[nodiscard]] static recipe default_for(std::size_t rows, std::size_t columns) {
        recipe r;
        const double tactel = std::min(static_cast<double>(rows) / 28, static_cast<double>(columns) / 50);
        // Smaller images take less time, so they get up to four times as many epochs.
        const std::size_t tactels = std::max<std::size_t>(rows * columns, 1);
        r.epochs = 110 * std::clamp<std::size_t>((28 * 50 + tactels / 2) / tactels, 1, 4);
        // Of an array more than twice as long as wide, 15° would turn the ends out of the image.
        const std::size_t longer = std::max<std::size_t>(std::max(rows, columns), 1);
        const double width = static_cast<double>(std::min(rows, columns)) / static_cast<double>(longer);
        r.ranges = {.reflect_rows = 0.5,
                    .reflect_columns = 0.5,
                    .translation = 4 * tactel,
                    .rotation = 15 * std::min(1.0, 2 * width),
                    .scale = 0.1,
                    .pressure = 0.3};
        r.averaging = 0.99;
        return r;
    }

    /// A more accurate variant that takes six times as long: three times as many epochs, in which a part of
    /// every other image is erased, with sharpness-aware gradients (sharpness_radius). It keeps the last
    /// network.
    [[nodiscard]] recipe thorough() const {
        recipe r = *this;
        r.name = "thorough";
        r.epochs *= 3;
        r.ranges.erase = 0.5;
        r.sharpness_radius = 0.1;
        r.keeps_last = true;
        return r;
    }

    /// For so many training images: fewer than half of the paper's 704 get more epochs, up to 16 times as
    /// many, so that the number of steps is that of 352. More change nothing.
    [[nodiscard]] recipe suited_to(std::size_t training_images) const {
        recipe r = *this;
        r.epochs = epochs * 352 / std::clamp<std::size_t>(training_images, 352 / 16, 352);
        return r;
    }

    /// For a network that is trained on precomputed features: no augmentation, and few
    /// epochs, each of which takes milliseconds.
    [[nodiscard]] static recipe on_features() {
        recipe r;
        r.epochs = 30;
        r.rate = 3e-3;
        r.augmentation = augmentation_rule::none;
        r.label_smoothing = 0.05;
        return r;
    }

    /// The authors' training, with the settings of a network, for example tactnet4_training. They come from
    /// the authors' programs, since the paper's text has none. docs/verify/paper.md lists what differs (for
    /// example which weights are kept).
    [[nodiscard]] static recipe published(std::size_t rows, std::size_t columns,
                                          const published_training& own) {
        recipe r;
        r.name = "published";
        if (own.transfer)
            return published(r, own, *own.transfer);
        r.epochs = 5000;
        r.batch = 0;
        r.rate = own.rate;
        r.optimiser = sgd{.momentum = 0.8, .l2 = 1e-4, .l2_of_norms = true};
        if (own.drop_period > 0)
            r.schedule = step_drop{.period = own.drop_period, .factor = own.drop_factor};
        else
            r.schedule = constant_rate{};
        r.input = own.subtracts_mean ? input_rule::subtract_mean : input_rule::counts;
        r.initialisation = fixed_normal{0.01};
        r.ranges = augmentation_ranges::published(rows, columns);
        r.augment_full_resolution = false;
        r.label_smoothing = 0;
        r.remeasure_statistics = true;
        r.validate_every = own.validate_every;
        r.patience = own.patience;
        return r;
    }

    /// For a network that starts from weights trained on photographs: as published, on images that are
    /// randomly reflected and not varied otherwise, with one cycle of twice the rate over 4/3 of the epochs,
    /// and averaged parameters. Throws std::invalid_argument for settings of a network that starts from
    /// random weights.
    [[nodiscard]] static recipe fine_tuning(const published_training& own) {
        if (!own.transfer)
            throw std::invalid_argument("recipe: expected published settings of transfer learning "
                                        "(published_training::transfer), found none");
        recipe r = published({}, own, *own.transfer);
        r.epochs += r.epochs / 3;
        r.rate *= 2;
        r.schedule = one_cycle{};
        r.augmentation = augmentation_rule::each_epoch;
        r.ranges = {.reflect_rows = 0.5, .reflect_columns = 0.5};
        r.averaging = 0.95;
        r.patience = 0;
        return r;
    }

    /// Which reflections the network learns, and with which partners: averages over others would not do.
    [[nodiscard]] reflection_rule learnt_reflections() const {
        reflection_rule rule = reflections;
        if (augmentation == augmentation_rule::none || ranges.reflect_rows == 0)
            rule.rows = {};
        if (augmentation == augmentation_rule::none || ranges.reflect_columns == 0)
            rule.columns = {};
        return rule;
    }

    /// Throws std::invalid_argument for settings with which nothing could be learnt, or that are no numbers
    /// of their range.
    void check() const {
        if (validate_every == 0)
            throw std::invalid_argument("trainer: expected a validation every 1 or more epochs, found 0");
        if (epochs > 1'000'000'000) // a negative number, converted
            detail::throw_invalid_argument({"trainer: expected at most 1000000000 epochs, found ", epochs});
        if (!function.valid())
            detail::throw_invalid_argument(
                {"trainer: expected an input function with a knee from 0.001 to 1000000, found ",
                 std::to_string(function.knee)});
        const auto require = [](bool (*right)(double), const char* range,
                                std::initializer_list<std::pair<const char*, double>> numbers) {
            for (const auto& [what, number] : numbers)
                if (!right(number))
                    detail::throw_invalid_argument({"trainer: expected a recipe's ", what, " ", range,
                                                    ", found ", std::to_string(number)});
        };
        const auto* const descent = std::get_if<sgd>(&optimiser);
        const auto* const adam = std::get_if<adamw>(&optimiser);
        const auto* const drop = std::get_if<step_drop>(&schedule);
        const auto* const cycle = std::get_if<one_cycle>(&schedule);
        const auto* const normal = std::get_if<fixed_normal>(&initialisation);
        require([](double x) { return x >= 0 && std::isfinite(x); }, "of 0 or more, finite",
                {{"rate", rate},
                 {"pretrained_rate", pretrained_rate},
                 {"sharpness_radius", sharpness_radius},
                 {"ranges.translation", ranges.translation},
                 {"ranges.rotation", ranges.rotation},
                 {"ranges.scale", ranges.scale},
                 {"ranges.pressure", ranges.pressure},
                 {"ranges.shear", ranges.shear},
                 {"ranges.noise.additive", ranges.noise.additive},
                 {"ranges.noise.relative", ranges.noise.relative},
                 {"l2", descent ? descent->l2 : 0},
                 {"decay", adam ? adam->decay : 0},
                 {"drop factor", drop ? drop->factor : 0},
                 {"initial deviation", normal ? normal->deviation : 0}});
        require([](double x) { return x > 0 && std::isfinite(x); }, "above 0, finite",
                {{"epsilon", epsilon},
                 {"optimiser.epsilon", adam ? adam->epsilon : 1},
                 {"drop period", drop ? drop->period : 1}});
        require([](double x) { return x >= 0 && x < 1; }, "of 0 or more and below 1",
                {{"label_smoothing", label_smoothing},
                 {"averaging", averaging},
                 {"momentum", descent ? descent->momentum : 0},
                 {"beta1", adam ? adam->beta1 : 0},
                 {"beta2", adam ? adam->beta2 : 0},
                 {"warm_up", cycle ? cycle->warm_up : 0}});
        require([](double x) { return x >= 0 && x <= 1; }, "from 0 to 1",
                {{"ranges.reflect_rows", ranges.reflect_rows},
                 {"ranges.reflect_columns", ranges.reflect_columns},
                 {"ranges.erase", ranges.erase}});
    }

private:
    /// For a network that starts from pretrained weights, as in the authors' programs.
    [[nodiscard]] static recipe published(recipe r, const published_training& own,
                                          const published_transfer& transfer) {
        r.epochs = transfer.epochs;
        r.batch = transfer.batch;
        r.rate = own.rate;
        r.pretrained_rate = 1 / transfer.new_layer_factor;
        r.optimiser = sgd{.momentum = 0.9, .l2 = 1e-4, .l2_of_norms = true};
        r.schedule = constant_rate{};
        r.initialisation = fixed_normal{0.01};
        r.input = input_rule::scale;
        r.augmentation = augmentation_rule::none;
        r.label_smoothing = 0;
        r.patience = own.patience;
        return r;
    }
};

}} // namespace tactnet

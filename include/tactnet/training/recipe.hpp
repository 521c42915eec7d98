#pragma once

#include <tactnet/image/augmentation.hpp>
#include <tactnet/networks/published.hpp>
#include <tactnet/training/initialise.hpp>
#include <tactnet/training/optimiser.hpp>
#include <tactnet/training/schedule.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string_view>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// How counts become the input of the network.
enum class input_rule {
    subtract_mean, ///< minus the mean image of the training set, as the authors' TactNet-4 and 6
    scale,         ///< divided by 255
    counts         ///< as they are, as the authors' TactResNet
};

/// Where new images come from.
enum class augmentation_rule {
    none,
    each_epoch, ///< every image is drawn anew in every epoch
    sixfold     ///< every image and five drawn ones, once and for all: the paper's 704 → 4224
};

/// Everything about a training that is not the data, the split and the network.
struct recipe {
    std::string_view name = "default";
    std::size_t epochs = 110;
    std::size_t batch = 32; ///< samples a step; 0 is as many as there are training images
    double rate = 1e-2;     ///< highest learning rate
    /// Share of the rate for arrays that begin with weights of another network
    /// (training_loop::start_from_trunk); 0 leaves weights as they are, while batch norms go on following the
    /// images.
    double pretrained_rate = 1;
    tactnet::optimiser optimiser = adamw{};
    tactnet::schedule schedule = one_cycle{};
    tactnet::initialisation initialisation = he_normal{};
    input_rule input = input_rule::subtract_mean;
    augmentation_rule augmentation = augmentation_rule::each_epoch;
    augmentation_ranges ranges{};
    /// Vary images as they were taken, where these are given, and reduce them then; else vary the small ones.
    /// Translations are in tactels of the small ones either way.
    bool varies_as_taken = true;
    double label_smoothing = 0.1;
    /// How far up the slope the gradients are taken (sharpness-aware minimisation; Foret et al., 2021), as a
    /// distance between parameters; 0 is off, all else takes twice the time.
    double sharpness_radius = 0;
    double averaging = 0;  ///< share of the past in a running average of the parameters; 0 is off
    double epsilon = 1e-5; ///< of batch norms
    /// Take the statistics of batch norms anew when a validation is due, of the network that is validated
    /// (the averaged one where there is one), from the training images without augmentation. Right where a
    /// batch is the whole training set: running ones lag behind parameters that move in large steps, and
    /// those of varied images are not those of the images to recognise.
    bool remeasure_statistics = false;
    std::size_t validate_every = 1; ///< epochs
    std::size_t patience = 0;       ///< validations without a smaller loss before it stops; 0 never stops
    /// Keep the network of the last epoch, not that of the smallest validation loss. Where the rate falls to
    /// nothing, accuracy goes on rising after the loss has begun to, since the network grows too certain.
    bool keeps_last = false;

    /// The recipe that did best on the paper's images. Against the paper's: images vary in size and pressure
    /// too, where they were taken larger as they were taken; AdamW on small batches with one cycle of the
    /// learning rate, smoothed labels, averaged parameters.
    [[nodiscard]] static recipe default_for(std::size_t rows, std::size_t columns) {
        recipe r;
        const double tactel = std::min(static_cast<double>(rows) / 28, static_cast<double>(columns) / 50);
        // Small images are learnt from longer, for about the same time: up to four times as many epochs.
        const std::size_t tactels = std::max<std::size_t>(rows * columns, 1);
        r.epochs = 110 * std::clamp<std::size_t>((28 * 50 + tactels / 2) / tactels, 1, 4);
        r.ranges = {.reflect_rows = 0.5,
                    .reflect_columns = 0.5,
                    .translation = 4 * tactel,
                    .rotation = 15,
                    .scale = 0.1,
                    .pressure = 0.3};
        r.averaging = 0.99;
        return r;
    }

    /// The same for whoever can wait: three times as many epochs, in which a part of every other image is
    /// erased, with sharpness-aware gradients (sharpness_radius). Six times the time. The last network is
    /// kept.
    [[nodiscard]] recipe thorough() const {
        recipe r = *this;
        r.name = "thorough";
        r.epochs *= 3;
        r.ranges.erase = 0.5;
        r.sharpness_radius = 0.1;
        r.keeps_last = true;
        return r;
    }

    /// For the head of a frozen trunk, which learns from features that were found once: no new images, and
    /// few epochs, each of which takes milliseconds.
    [[nodiscard]] static recipe on_features() {
        recipe r;
        r.epochs = 30;
        r.rate = 3e-3;
        r.augmentation = augmentation_rule::none;
        r.label_smoothing = 0.05;
        return r;
    }

    /// How the authors trained, with what each network has of its own: for example tactnet4_training. The
    /// settings are those of the authors' programs, since the paper's text has none. What differs (for
    /// example which weights are kept): docs/paper.md.
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
        r.varies_as_taken = false;
        r.label_smoothing = 0;
        r.remeasure_statistics = true;
        r.validate_every = own.validate_every;
        r.patience = own.patience;
        return r;
    }

    /// For a network that goes on from weights learnt from photographs: as published, on images reflected at
    /// random and varied in no other way, with one cycle of twice the rate over 4/3 of the epochs, and
    /// averaged parameters. Throws std::invalid_argument for settings of a network that begins by chance.
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

private:
    /// Of a network that begins with pretrained weights: as in the authors' programs.
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

} // namespace TACTNET_ARCH
} // namespace tactnet

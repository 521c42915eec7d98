#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/image/augmentation.hpp>
#include <tactnet/training/data/labelled_samples.hpp>
#include <tactnet/training/loop/trainable.hpp>
#include <tactnet/training/recipe.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The samples of each epoch of a training: their order, their batches and the augmentation of images, all
/// functions of (seed, epoch, sample).
class epoch_samples {
public:
    /// `chosen` are indices of samples, whose values must outlive this. Features are not augmented.
    epoch_samples(const recipe& how, const trainable& network, const labelled_samples& samples,
                  std::vector<std::size_t> chosen, std::uint64_t seed, thread_pool& threads)
        : transform_(network.image_transformer()),
          numbers_(network.input_shape().size()),
          rule_(samples.are_images() ? how.augmentation : augmentation_rule::none),
          ranges_(how.ranges),
          reflections_(how.reflections),
          samples_(samples),
          taken_(how.augment_full_resolution ? samples.taken() : images_as_taken{}),
          chosen_(std::move(chosen)),
          seed_(seed),
          batch_(how.batch == 0 ? chosen_.size() : std::min(how.batch, size())) {
        if (taken_.given())
            ranges_.translation *= taken_.tactels_for_one();
        std::vector<std::size_t> seen(samples.size());
        for (const std::size_t sample : chosen_)
            drawn_as_.push_back(static_cast<std::uint32_t>(sample + seen[sample]++ * samples.size()));
        if (rule_ != augmentation_rule::sixfold)
            return;
        sixfold_.resize(size() * numbers_);
        threads.for_each(size(), [&](std::size_t place) {
            const std::size_t copy = place % 6;
            const std::span<float> to(sixfold_.data() + place * numbers_, numbers_);
            if (copy == 0)
                vary({}, place, to.data());
            else
                vary(place, copy, to);
        });
    }

    /// Samples of an epoch. Each has a place, independent of the order.
    [[nodiscard]] std::size_t size() const { return chosen_.size() * copies(); }
    [[nodiscard]] std::size_t steps() const { return detail::ceil_div(size(), batch_); }

    /// The places in the order of an epoch.
    [[nodiscard]] std::vector<std::size_t> order(std::size_t epoch) const {
        std::vector<std::size_t> places(size());
        std::iota(places.begin(), places.end(), std::size_t{0});
        if (steps() > 1)
            random_stream(seed_, random_purposes::order, static_cast<std::uint32_t>(epoch)).shuffle(places);
        return places;
    }
    /// The places of one step. Batches have equal sizes, so that batch norms see no small rest.
    [[nodiscard]] std::span<const std::size_t> batch(std::size_t step,
                                                     std::span<const std::size_t> order) const {
        const std::size_t first = order.size() * step / steps(), last = order.size() * (step + 1) / steps();
        return order.subspan(first, last - first);
    }

    /// The class that the sample at a place shows in that epoch, since its reflection may show a partner.
    [[nodiscard]] std::size_t label(std::size_t place, std::size_t epoch) const {
        const std::size_t label = samples_.label(sample_at(place)),
                          copy = rule_ == augmentation_rule::sixfold ? place % 6 : epoch;
        if (rule_ == augmentation_rule::none || (rule_ == augmentation_rule::sixfold && copy == 0) ||
            (reflections_.rows.partners.empty() && reflections_.columns.partners.empty()))
            return label;
        const image_motion m = drawn(place, copy);
        return reflections_.partner({m.reflect_rows, m.reflect_columns}, label);
    }
    /// Writes the sample at a place as augmented in that epoch: counts, or features.
    void make(std::size_t place, std::size_t epoch, std::span<float> to) const {
        if (rule_ == augmentation_rule::sixfold) {
            std::copy_n(sixfold_.data() + place * numbers_, numbers_, to.data());
            return;
        }
        if (rule_ == augmentation_rule::none)
            samples_.copy(sample_at(place), to);
        else
            vary(place, epoch, to);
    }

private:
    [[nodiscard]] std::size_t copies() const { return rule_ == augmentation_rule::sixfold ? 6 : 1; }
    [[nodiscard]] std::size_t sample_at(std::size_t place) const { return chosen_[place / copies()]; }
    void vary(const image_transform& t, std::size_t place, float* to) const {
        if (taken_.given())
            taken_.vary(t, taken_.pixels.data() + sample_at(place) * taken_.taken.size(), to);
        else
            transform_(t, samples_.pixels().data() + sample_at(place) * numbers_, to);
    }
    void vary(std::size_t place, std::size_t time, std::span<float> to) const {
        vary(image_transform::of(drawn(place, time)), place, to.data());
        add_noise(ranges_.noise, stream(random_purposes::noise, place, time), to);
    }
    [[nodiscard]] image_motion drawn(std::size_t place, std::size_t time) const {
        random_stream random = stream(random_purposes::augmentation, place, time);
        return image_motion::draw(ranges_, random);
    }
    [[nodiscard]] random_stream stream(random_purpose purpose, std::size_t place, std::size_t time) const {
        return {seed_, purpose, static_cast<std::uint32_t>(time), drawn_as_[place / copies()]};
    }

    trainable::transformer transform_;
    std::size_t numbers_; ///< of a sample
    augmentation_rule rule_;
    augmentation_ranges ranges_;
    reflection_rule reflections_;
    labelled_samples samples_;
    images_as_taken taken_; ///< empty if the recipe does not vary them
    std::vector<std::size_t> chosen_;
    std::vector<std::uint32_t> drawn_as_; ///< the sample, or another number where it is repeated
    std::uint64_t seed_;
    std::size_t batch_;
    std::vector<float> sixfold_;
};

namespace detail {

/// Throws if batch norms of a network of features, with one value of each in a sample, would see batches of
/// one sample: of a single value they return their shift alone, whatever the value is.
inline void check_batches(trainable& network, const epoch_samples& shown) {
    const shape input = network.input_shape();
    if (input.rows * input.columns == 1 && !network.running_statistics().empty() &&
        shown.size() / shown.steps() < 2)
        throw std::invalid_argument("trainer: expected batches of two or more samples, since batch norms of "
                                    "one value learn nothing, found one of a single sample");
}

} // namespace detail

}} // namespace tactnet

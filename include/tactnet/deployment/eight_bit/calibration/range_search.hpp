#pragma once

#include <tactnet/deployment/eight_bit/calibration/fitted_weights.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

// From a description, folded numbers and images to ranges and weights of 8 bits: compiled once for all
// networks.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace detail {

/// Outputs of the network in 8 bits with these folded numbers, for images one behind the other; false if it
/// does not recognise one.
using recognise_all = bool (*)(std::span<const float> folded, std::span<const float> images,
                               std::span<float> to);

class range_search {
public:
    /// Images beyond these change ranges too little to pay for the time.
    static constexpr std::size_t most_searched = 256;

    /// `folded`: the mean frame, two places for what words hold, then the numbers of all steps with room for
    /// ranges. The input is (count − mean) × scale.
    [[gnu::cold]] range_search(plain_network&& net, std::vector<float>&& folded, float scale,
                               std::vector<float>&& images, recognise_all recognise)
        : net_(std::move(net)),
          folded_(std::move(folded)),
          scale_(scale),
          images_(std::move(images)),
          recognise_(recognise) {
        fill_words();
        check();
        choose_searched();
        observe();
        search();
        fit();
    }
    [[nodiscard]] std::span<const float> folded() const { return folded_; }
    [[nodiscard]] std::span<float> folded() { return folded_; }
    [[nodiscard]] double error() const { return error_; }
    [[nodiscard]] double error_of_rounded() const { return error_of_rounded_; }
    /// With a range of their own.
    [[nodiscard]] std::size_t maps() const {
        std::size_t maps = 0;
        for (std::size_t m = 1; m < net_.ranges; ++m)
            maps += static_cast<std::size_t>(net_.has(m));
        return maps;
    }

private:
    [[nodiscard]] shape input() const { return net_.maps[0].size; }
    [[nodiscard]] std::size_t count() const { return images_.size() / input().size(); }

    /// How many steps a count has in words of 16 bits: as many as fit, a power of two.
    [[gnu::cold]] void fill_words() {
        const std::size_t size = input().size();
        float furthest = 255;
        for (std::size_t e = 0; e < images_.size(); ++e)
            furthest = std::max(furthest, std::abs(images_[e] - folded_[e % size]));
        for (std::size_t e = 0; e < size; ++e)
            furthest = std::max({furthest, std::abs(folded_[e]), std::abs(255 - folded_[e])});
        float steps = 128;
        while (steps * furthest > 32700 && steps > 1e-30f)
            steps /= 2;
        folded_[size] = steps, folded_[size + 1] = 32700 / steps;
    }
    /// What no network has, in single precision or in 8 bits.
    [[gnu::cold]] void check() const {
        constexpr float largest = 1e30f;
        const auto refuse = [](const std::string& what, float found) {
            throw std::invalid_argument("deploy: expected " + what +
                                        " that give finite numbers up to 1e30, found " +
                                        std::to_string(found) + " once batch norms are folded in");
        };
        for (std::size_t e = 0; e < input().size(); ++e)
            if (!(std::abs(folded_[e]) <= largest))
                refuse("a mean and a scale", folded_[e]);
        if (!(std::abs(scale_) <= largest))
            refuse("a mean and a scale", scale_);
        for (std::size_t i = input().size() + 2; i < folded_.size(); ++i)
            if (!(std::abs(folded_[i]) <= largest))
                refuse("parameters and variances + epsilon above zero", folded_[i]);
        for (std::size_t e = 0; e < images_.size(); ++e)
            if (!(std::abs(images_[e]) <= largest))
                refuse_image(e / input().size());
    }
    [[noreturn, gnu::cold, gnu::noinline]] static void refuse_image(std::size_t which) {
        throw std::invalid_argument(
            "deploy: expected calibration images that the network recognises, found number " +
            std::to_string(which) + " of those taken broken");
    }
    /// Which of the images the i-th searched one is.
    [[nodiscard]] std::size_t searched(std::size_t i) const {
        return i * count() / std::min(count(), most_searched);
    }
    [[gnu::cold]] void choose_searched() {
        const std::size_t used = std::min(count(), most_searched), size = input().size();
        searched_ = std::vector<float>(used * size);
        for (std::size_t i = 0; i < used; ++i)
            std::copy_n(images_.data() + searched(i) * size, size, searched_.data() + i * size);
    }

    /// What each map held, and the outputs.
    [[gnu::cold]] void observe() {
        lowest_ = std::vector<float>(net_.ranges), highest_ = std::vector<float>(net_.ranges);
        const std::size_t size = input().size(), images = searched_.size() / size;
        wanted_ = std::vector<float>(images * net_.maps[net_.steps.back().output].size.size());
        // A step's weights are brought into order for some images at once, whose maps are kept.
        constexpr std::size_t together = 16;
        std::vector<float> maps(std::min(images, together) * net_.numbers);
        for (std::size_t first = 0; first < images; first += together) {
            const std::size_t some = std::min(images - first, together);
            for (std::size_t i = 0; i < some; ++i)
                write_plain_frame(input(), folded_, scale_, searched_.data() + (first + i) * size, false,
                                  maps.data() + i * net_.numbers);
            for (const plain_step& step : net_.steps) {
                const plain_run run(net_, step, folded_, false);
                for (std::size_t i = 0; i < some; ++i)
                    run(maps.data() + i * net_.numbers, {});
            }
            for (std::size_t i = 0; i < some; ++i) {
                observe_maps(maps.data() + i * net_.numbers);
                keep_outputs(maps.data() + i * net_.numbers + net_.maps[net_.steps.back().output].begin,
                             first + i);
            }
        }
    }
    [[gnu::cold]] void observe_maps(const float* maps) {
        for (const plain_map& map : net_.maps) {
            if (map.range == plain_network::none || map.range == 0)
                continue;
            float &lowest = lowest_[map.range], &highest = highest_[map.range];
            for (std::size_t e = map.begin; e < map.begin + map.size.size(); ++e)
                lowest = std::min(lowest, maps[e]), highest = std::max(highest, maps[e]);
        }
    }
    [[gnu::cold]] void keep_outputs(float* map, std::size_t image) {
        const shape size = net_.maps[net_.steps.back().output].size;
        if (net_.softmax != nullptr)
            for (std::size_t pixel = 0; pixel < size.area(); ++pixel)
                net_.softmax(std::span(map + pixel * size.channels, size.channels));
        float* to = wanted_.data() + image * size.size();
        for (std::size_t channel = 0; channel < size.channels; ++channel)
            for (std::size_t pixel = 0; pixel < size.area(); ++pixel) {
                const float output = map[pixel * size.channels + channel];
                if (!(std::abs(output) <= std::numeric_limits<float>::max()))
                    refuse_image(searched(image));
                *to++ = output;
            }
    }

    /// The largest fraction first, so that of equal ones it is kept.
    static constexpr std::array fractions{1.0, 0.95, 0.9, 0.85, 0.8, 0.7, 0.6, 0.5};

    [[gnu::cold]] void search() {
        std::vector<double> of_full(net_.ranges, 1.0);
        set_ranges(of_full);
        error_ = error_of(folded_);
        for (int sweep = 0; sweep < 2; ++sweep)
            for (std::size_t m = 1; m < net_.ranges; ++m) {
                if (!net_.has(m))
                    continue;
                double best = of_full[m];
                for (const double fraction : fractions) {
                    of_full[m] = fraction;
                    set_ranges(of_full);
                    if (const double error = error_of(folded_); error < error_)
                        error_ = error, best = fraction;
                }
                of_full[m] = best;
            }
        set_ranges(of_full);
        error_of_rounded_ = error_;
    }
    [[gnu::cold]] void set_ranges(const std::vector<double>& of_full) {
        ranges_ = std::vector<map_range>(net_.ranges);
        ranges_[0] = {scale_ / folded_[input().size()], 0};
        for (std::size_t m = 1; m < net_.ranges; ++m)
            ranges_[m] = map_range::of(static_cast<double>(lowest_[m]) * of_full[m],
                                       static_cast<double>(highest_[m]) * of_full[m]);
        net_.set_ranges(folded_.data(), ranges_);
    }
    [[gnu::cold]] void fit() {
        const weights_fit found(net_, ranges_, folded_, scale_, images_);
        if (const double error = error_of(found.folded()); error < error_)
            error_ = error, std::copy_n(found.folded().data(), folded_.size(), folded_.data());
    }
    /// The mean square of what outputs differ by.
    [[nodiscard]] [[gnu::cold]] double error_of(std::span<const float> folded) const {
        std::vector<float> found(wanted_.size());
        if (!recognise_(folded, searched_, found))
            return std::numeric_limits<double>::infinity();
        double sum = 0;
        for (std::size_t o = 0; o < found.size(); ++o) {
            const double difference = static_cast<double>(found[o]) - static_cast<double>(wanted_[o]);
            sum += difference * difference;
        }
        return sum / static_cast<double>(found.size());
    }

    plain_network net_;
    std::vector<float> folded_;
    float scale_;
    std::vector<float> images_, searched_, wanted_;
    recognise_all recognise_;
    std::vector<float> lowest_, highest_; ///< of each range
    std::vector<map_range> ranges_;
    double error_ = 0, error_of_rounded_ = 0;
};

} // namespace detail
} // namespace TACTNET_ARCH
} // namespace tactnet

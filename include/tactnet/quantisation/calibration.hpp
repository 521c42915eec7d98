#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/deployment/eight_bit.hpp>
#include <tactnet/operators/lowering.hpp>
#include <tactnet/quantisation/activation_observer.hpp>
#include <tactnet/quantisation/graph.hpp>
#include <tactnet/quantisation/weight_rounding.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

// Calibrates a network given as a graph: ranges, then weights. Compiled once for all networks.

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// Searches the range of each map: the fraction of the observed range with which the outputs in 8 bits come
/// closest to the outputs in single precision, map by map, the ranges of the others fixed.
class range_search {
public:
    /// The largest first, so that it wins ties. Rounding errors grow with the range: 0.95 of it saves a
    /// twentieth of them, one half as much as a further bit. Chosen, finer near 1 since clipping soon costs
    /// more than that saves. Measured with the authors' TactNet-4 at 14 × 25, calibrated on four fifths of
    /// 110 images, five times: the error of outputs with rounded weights is 0.1598, with full ranges 0.1612.
    /// Maps with outliers gain most.
    static constexpr std::array fractions{1.0, 0.95, 0.9, 0.85, 0.8, 0.7, 0.6, 0.5};
    /// The second sweep searches each range again, given the ranges found by the first. Measured as above:
    /// none of the five networks changed in it, nor in a third.
    static constexpr int sweeps = 2;

    /// Writes the ranges, and the scales that follow from them, to the folded numbers of the network, which
    /// begin with the mean and the steps per count of the words.
    [[gnu::cold]] range_search(const calibration_graph& net, const activation_observer& seen, float scale,
                               run_quantised recognise, std::span<float> folded)
        : net_(net), seen_(seen), scale_(scale), folded_(folded) {
        std::vector<double> of_full(net.ranges, fractions.front());
        set_ranges(of_full);
        error_ = seen.error_of(recognise, folded);
        for (int sweep = 0; sweep < sweeps; ++sweep)
            for (std::size_t m = 1; m < net.ranges; ++m) {
                if (!net.has(m))
                    continue;
                double best = of_full[m];
                for (const double fraction : fractions) {
                    of_full[m] = fraction;
                    set_ranges(of_full);
                    if (const double error = seen.error_of(recognise, folded); error < error_)
                        error_ = error, best = fraction;
                }
                of_full[m] = best;
            }
        set_ranges(of_full);
    }
    /// The range of the words first.
    [[nodiscard]] std::span<const map_range> ranges() const { return ranges_; }
    /// The mean squared error of the outputs with these ranges.
    [[nodiscard]] double error() const { return error_; }

private:
    [[gnu::cold]] void set_ranges(const std::vector<double>& of_full) {
        ranges_ = std::vector<map_range>(net_.ranges);
        ranges_[0] = {scale_ / folded_[net_.maps[0].size.size()], 0};
        for (std::size_t m = 1; m < net_.ranges; ++m)
            ranges_[m] = map_range::of(seen_.lowest(m) * of_full[m], seen_.highest(m) * of_full[m]);
        net_.set_ranges(folded_.data(), ranges_);
    }

    const calibration_graph& net_;
    const activation_observer& seen_;
    float scale_;
    std::span<float> folded_;
    std::vector<map_range> ranges_;
    double error_ = 0;
};

/// Writes the steps per count of words of 16 bits, the largest power of two that fits, and the largest |count
/// − mean| of such words after the mean frame.
[[gnu::cold]] inline void set_words(std::size_t size, std::span<const float> images,
                                    std::span<float> folded) {
    // Counts of 8 bits keep every bit, and the mean 1/256 of a count. 255 × 128 = 32640 must fit, and
    // rounding count and mean changes their difference by up to one step: the largest word lies between that
    // and 32767.
    constexpr float max_steps = 128, largest_word = 32700, largest_count = 255;
    // No accepted number needs fewer: 32700 / 10³⁰ is more. It ends the loop at infinity.
    constexpr float fewest_steps = 1e-30f;
    float furthest = largest_count;
    for (std::size_t e = 0; e < images.size(); ++e)
        furthest = std::max(furthest, std::abs(images[e] - folded[e % size]));
    for (std::size_t e = 0; e < size; ++e)
        furthest = std::max({furthest, std::abs(folded[e]), std::abs(largest_count - folded[e])});
    float steps = max_steps;
    while (steps * furthest > largest_word && steps > fewest_steps)
        steps /= 2;
    folded[size] = steps, folded[size + 1] = largest_word / steps;
}

/// A network with the ranges and weights of 8 bits.
class calibrated_network {
public:
    /// `folded`: the mean frame, room for two numbers of the words, then the numbers of all steps with room
    /// for ranges. The input is (count − mean) × scale.
    [[gnu::cold]] calibrated_network(const calibration_graph& net, std::vector<float>&& folded, float scale,
                                     std::span<const float> images, run_quantised recognise)
        : folded_(std::move(folded)) {
        const std::size_t size = net.maps[0].size.size();
        set_words(size, images, folded_);
        check(size, scale);
        for (std::size_t m = 1; m < net.ranges; ++m)
            maps_ += static_cast<std::size_t>(net.has(m));
        const activation_observer seen(net, folded_, scale, images);
        const range_search found(net, seen, scale, recognise, folded_);
        error_ = error_of_rounded_ = found.error();
        const weight_rounding fitted(net, found.ranges(), folded_, scale, images);
        if (const double error = seen.error_of(recognise, fitted.folded()); error < error_)
            error_ = error, std::copy_n(fitted.folded().data(), folded_.size(), folded_.data());
    }
    [[nodiscard]] std::span<const float> folded() const { return folded_; }
    [[nodiscard]] std::span<float> folded() { return folded_; }
    /// The mean squared error of the outputs relative to single precision.
    [[nodiscard]] double error() const { return error_; }
    /// The error with nearest weights.
    [[nodiscard]] double error_of_rounded() const { return error_of_rounded_; }
    /// The number of maps with a range of their own.
    [[nodiscard]] std::size_t maps() const { return maps_; }

private:
    /// Rejects numbers that no deployed network has.
    [[gnu::cold]] void check(std::size_t size, float scale) const {
        const auto require = [](bool of_input, float number) {
            if (!(std::abs(number) <= largest_number))
                throw_not_finite(of_input, number);
        };
        for (std::size_t e = 0; e < size; ++e)
            require(true, folded_[e]);
        require(true, scale);
        for (std::size_t i = size + 2; i < folded_.size(); ++i)
            require(false, folded_[i]);
    }

    std::vector<float> folded_;
    std::size_t maps_ = 0;
    double error_ = 0, error_of_rounded_ = 0;
};

}}} // namespace tactnet::detail

namespace tactnet { inline namespace TACTNET_ARCH {

/// Post-training quantisation: finds activation ranges and rounded weights of a network in 8 bits from
/// training images; keep test images out. First each map gets the range of its numbers on the images. Then,
/// map by map, the range is reduced to the fraction with which the outputs (after a softmax, probabilities)
/// have the least squared error relative to single precision. Then, step by step, weights and biases are
/// chosen with which the sums over maps in 8 bits come closest to the exact sums, if that holds on images
/// held out. There are no labels, no learning rate and no random numbers.
template <class Network>
class eight_bit_calibration {
    using plan = lowered_network<Network, eight_bit>;
    using bytes = deployed<Network, eight_bit>;
    using view = typename bytes::view_type;

public:
    static constexpr shape input_shape = Network::input_shape;
    static constexpr std::size_t outputs = view::outputs;
    /// More images change weights too little to justify the time.
    static constexpr std::size_t max_images = 1024;

    /// The input is (count − mean) × scale, of compressed counts if there is an input function. `frames`
    /// holds consecutive images, [channel][row][column]; of more than `max_images`, evenly spaced ones are
    /// used. Throws std::invalid_argument unless there is at least one whole image, and if a number of the
    /// network or of an image is not finite or beyond 1e30.
    [[gnu::cold]] eight_bit_calibration(const Network& network,
                                        std::span<const float, input_shape.size()> mean, float scale,
                                        const frames_ref<input_shape>& frames,
                                        const input_function& function = {})
        : found_(calibration_graph_of<view>(), folded_of(network, mean), scale, chosen(frames, function),
                 infer) {
        round_weights(folded_layout_of<view>(), found_.folded());
    }
    /// The folded numbers of `deployed`; weights are whole multiples of their scales.
    [[nodiscard]] std::span<const float, view::folded_elements> folded() const {
        return found_.folded().template first<view::folded_elements>();
    }
    /// The root mean squared error of the outputs relative to single precision, on the images.
    [[nodiscard]] double output_error() const { return std::sqrt(found_.error()); }
    /// The root mean squared error with nearest weights: no less.
    [[nodiscard]] double output_error_of_rounded() const { return std::sqrt(found_.error_of_rounded()); }
    /// The number of maps with a range of their own.
    [[nodiscard]] std::size_t maps() const { return found_.maps(); }

private:
    [[gnu::cold]] static std::vector<float> folded_of(const Network& network,
                                                      std::span<const float, input_shape.size()> mean) {
        std::vector<float> folded(view::folded_elements);
        std::copy_n(mean.data(), mean.size(), folded.data());
        plan::fold({network.learnable_values().data(), network.running_statistics().data(), network.epsilon},
                   folded.data() + view::steps_folded);
        return folded;
    }
    /// Compressed, so that the network is calibrated without its input function.
    [[gnu::cold]] static std::vector<float> chosen(const frames_ref<input_shape>& frames,
                                                   const input_function& function) {
        constexpr std::size_t size = input_shape.size();
        const std::size_t count = frames.size(), used = std::min(count, max_images);
        if (count == 0 || count * size != frames.elements())
            detail::throw_invalid_argument({"deploy: expected one or more calibration images of ", size,
                                            " counts, found ", frames.elements(), " counts"});
        std::vector<float> images(used * size);
        for (std::size_t i = 0; i < used; ++i)
            frames[i * count / used].visit([&](auto frame_elements) {
                for (std::size_t e = 0; e < size; ++e)
                    images[i * size + e] = static_cast<float>(frame_elements.data()[e]);
                function.apply(std::span(images).subspan(i * size, size));
            });
        return images;
    }
    static bool infer(std::span<const float> folded, std::span<const float> images, std::span<float> to) {
        const bytes network(folded.template first<view::folded_elements>());
        const std::unique_ptr<typename bytes::workspace> memory(new typename bytes::workspace); // not zeroed
        const frames_ref<input_shape> frames(images);
        for (std::size_t i = 0; i < frames.size(); ++i)
            if (network.infer(frames[i], to.subspan(i * outputs).template first<outputs>(), *memory) !=
                frame_status::ok)
                return false;
        return true;
    }

    detail::calibrated_network found_;
};

/// Deploys a trained network in 8 bits, for inputs (count − mean) × scale, of compressed counts if there is
/// an input function. `images` are training images, which set the activation ranges. Throws
/// std::invalid_argument as eight_bit_calibration.
template <class Format, class Network>
    requires std::is_same_v<Format, eight_bit>
[[nodiscard]] deployed<Network, eight_bit>
deploy(const Network& network, std::span<const float, Network::input_shape.size()> mean, float scale,
       const frames_ref<Network::input_shape>& images, const input_function& function = {}) {
    deployed<Network, eight_bit> bytes(
        eight_bit_calibration<Network>(network, mean, scale, images, function).folded());
    bytes.set_input_function(function);
    return bytes;
}

/// Deploys a trained network in 8 bits, with the names of its classes and its temperature:
///
///     const auto network = deploy<eight_bit>(model, training_images);
template <class Format, class Network>
    requires std::is_same_v<Format, eight_bit>
[[nodiscard]] deployed<Network, eight_bit> deploy(const model<Network>& trained,
                                                  const frames_ref<Network::input_shape>& images) {
    auto network = deploy<eight_bit>(trained.network, trained.normalise.mean.view().elements(),
                                     trained.normalise.scale, images, trained.normalise.function);
    network.set_classes(trained.classes);
    network.set_temperature(trained.temperature);
    network.set_reflections(trained.reflections);
    return network;
}
/// Without images it does not compile, and the error says so.
template <class Format, class Network>
    requires std::is_same_v<Format, eight_bit>
deployed<Network, eight_bit> deploy(const model<Network>&) {
    static_assert(std::is_void_v<Network>,
                  "deploy<eight_bit>: pass training images after the model: they set the activation ranges");
}

}} // namespace tactnet

#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/deployment/eight_bit.hpp>
#include <tactnet/operators/lowering.hpp>
#include <tactnet/quantisation/calibrated_network.hpp>
#include <tactnet/quantisation/graph.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

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

    /// The input is (count − mean) × scale. `frames` holds consecutive images, [channel][row][column]; of
    /// more than `max_images`, evenly spaced ones are used. Throws std::invalid_argument unless there is at
    /// least one whole image, and if a number of the network or of an image is not finite or beyond 1e30.
    [[gnu::cold]] eight_bit_calibration(const Network& network,
                                        std::span<const float, input_shape.size()> mean, float scale,
                                        const frames_ref<input_shape>& frames)
        : found_(calibration_graph_of<view>(), folded_of(network, mean), scale, chosen(frames), infer) {
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
    [[gnu::cold]] static std::vector<float> chosen(const frames_ref<input_shape>& frames) {
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

/// Deploys a trained network in 8 bits, for inputs (count − mean) × scale. `images` are training images,
/// which set the activation ranges. Throws std::invalid_argument as eight_bit_calibration.
template <class Format, class Network>
    requires std::is_same_v<Format, eight_bit>
[[nodiscard]] deployed<Network, eight_bit>
deploy(const Network& network, std::span<const float, Network::input_shape.size()> mean, float scale,
       const frames_ref<Network::input_shape>& images) {
    return deployed<Network, eight_bit>(
        eight_bit_calibration<Network>(network, mean, scale, images).folded());
}

/// Deploys a trained network in 8 bits, with the names of its classes and its temperature:
///
///     const auto network = deploy<eight_bit>(model, training_images);
template <class Format, class Network>
    requires std::is_same_v<Format, eight_bit>
[[nodiscard]] deployed<Network, eight_bit> deploy(const model<Network>& trained,
                                                  const frames_ref<Network::input_shape>& images) {
    auto network = deploy<eight_bit>(trained.network, trained.normalise.mean.view().elements(),
                                     trained.normalise.scale, images);
    network.set_classes(trained.classes);
    network.set_temperature(trained.temperature);
    return network;
}

}} // namespace tactnet

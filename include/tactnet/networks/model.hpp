#pragma once

#include <tactnet/lowering/input_function.hpp>
#include <tactnet/networks/recognition.hpp>
#include <tactnet/networks/reflection_rule.hpp>
#include <tactnet/operators/layer.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

class thread_pool;

/// Turns 8-bit counts into the input of a network: (function of count − mean) × scale. The mean is an image,
/// in the paper that of the training set; a mean of zero and a scale of 1/255 give plain scaling.
template <shape Shape>
struct normalisation {
    tensor<float, Shape> mean{};
    float scale = 1;
    input_function function{};

    /// The mean over contiguous images, summed in integers without rounding errors.
    [[nodiscard]] static tensor<float, Shape> mean_of(std::span<const std::uint8_t> images,
                                                      std::span<const std::size_t> chosen) {
        tensor<float, Shape> result;
        for (std::size_t e = 0; e < Shape.size() && !chosen.empty(); ++e) {
            std::uint64_t sum = 0;
            for (const std::size_t image : chosen)
                sum += images[image * Shape.size() + e];
            result.data()[e] =
                static_cast<float>(static_cast<double>(sum) / static_cast<double>(chosen.size()));
        }
        return result;
    }

    /// Normalises counts, as stored or augmented, in place.
    void apply(tensor_view<float, Shape> image) const {
        function.apply(image.elements());
        for (std::size_t e = 0; e < Shape.size(); ++e)
            image.data()[e] = (image.data()[e] - mean.data()[e]) * scale;
    }
    /// Returns the normalised counts.
    [[nodiscard]] tensor<float, Shape> apply(std::span<const std::uint8_t, Shape.size()> counts) const {
        tensor<float, Shape> result;
        for (std::size_t e = 0; e < Shape.size(); ++e)
            result.data()[e] = static_cast<float>(counts[e]);
        apply(result.view());
        return result;
    }
};

namespace detail {

/// How many images of `size` pixels these are. Throws std::invalid_argument unless it is a whole number, one
/// or more.
inline std::size_t count_images(std::size_t pixels, std::size_t size) {
    if (pixels == 0 || pixels % size != 0)
        throw std::invalid_argument("logits: expected images of " + std::to_string(size) + " pixels, found " +
                                    std::to_string(pixels) + " pixels");
    return pixels / size;
}

/// Throws std::invalid_argument for a network with weights of which none differs from zero.
template <class Network>
[[gnu::cold]] void check_trained(const char* caller, const Network& network) {
    bool any = false, found = false;
    network.for_each_parameter([&](const parameter& p, auto values) {
        if (p.role == parameter_role::weight)
            for (const auto value : values)
                any = true, found = found || value != 0;
    });
    if (any && !found)
        throw std::invalid_argument(std::string(caller) +
                                    ": expected a trained network, found one whose weights are all zero, as "
                                    "before training: its outputs would be the same for every frame");
}

[[gnu::cold, gnu::noinline]] inline void check_temperature(const char* caller, double temperature) {
    if (!is_temperature(temperature))
        throw std::invalid_argument(std::string(caller) +
                                    ": expected a temperature from 0.001 to 1000, found " +
                                    std::to_string(temperature));
}

[[gnu::cold, gnu::noinline]] inline void check_input_function(const char* caller,
                                                              const input_function& function) {
    if (!function.valid())
        throw std::invalid_argument(std::string(caller) +
                                    ": expected an input function with a knee from 0.001 to 1000000, found " +
                                    std::to_string(function.knee));
}

} // namespace detail

/// A trained network with its normalisation and the names of its classes.
template <class Network>
struct model {
    Network network;
    normalisation<Network::input_shape> normalise;
    /// Names of the first outputs, in order: from 1 to Network::outputs. Further outputs are unused.
    std::vector<std::string> classes;
    /// What logits are divided by for probabilities (is_temperature): 1, or as fit_temperature finds it.
    double temperature = 1;
    /// Which reflections of an image show a class, as in training.
    reflection_rule reflections = reflection_rule::all();

    /// Logits of images stored one after the other: a row of Network::outputs for each. Throws
    /// std::invalid_argument unless there is a whole number of images, one or more.
    [[nodiscard]] std::vector<float> logits(std::span<const std::uint8_t> images,
                                            thread_pool& threads) const {
        constexpr std::size_t size = Network::input_shape.size();
        const std::size_t count = detail::count_images(images.size(), size);
        typename Network::workspace space;
        typename Network::input_batch in(count);
        typename Network::output_batch out(count);
        for (std::size_t i = 0; i < count; ++i)
            in.set(i, normalise.apply(images.subspan(i * size).template first<size>()));
        network.prepare(threads, space);
        network.logits(in, out, threads, space);
        std::vector<float> result;
        result.reserve(count * Network::outputs);
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t o = 0; o < Network::outputs; ++o)
                result.push_back(out(i, o));
        return result;
    }
};

}} // namespace tactnet

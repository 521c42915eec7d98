#pragma once

#include <tactnet/deployment.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/io/safetensors.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

// Deployed networks in single precision, from the file of a model; eight_bit_file.hpp has those in 8 bits.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// The first `classes` outputs for each image.
template <class Network>
[[nodiscard]] [[gnu::cold]] std::vector<float>
logits_of(const Network& network, std::span<const std::uint8_t> images, std::size_t classes) {
    const std::unique_ptr<typename Network::workspace> memory(new typename Network::workspace); // not zeroed
    const frames_ref<Network::input_shape> frames(images);
    std::vector<float> logits(frames.size() * classes);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        std::array<float, Network::outputs> found;
        // A logit that is not finite agrees with no logit of a file.
        (void)network.infer(frames[i], found, *memory);
        std::copy_n(found.begin(), classes, logits.begin() + static_cast<std::ptrdiff_t>(i * classes));
    }
    return logits;
}

} // namespace detail

/// Loads and deploys a model from a file that `save_model` wrote: load_model and deploy in one call, with the
/// self-test run by the deployed network.
///
///     const auto network = load_deployed<net>("tactnet6.safetensors");
///
/// Throws file_error as `load_model`, and std::invalid_argument as `deploy`.
template <class Network>
[[nodiscard]] [[gnu::cold]] deployed<Network> load_deployed(const safetensors& file,
                                                            std::optional<double> epsilon = std::nullopt) {
    const model<Network> trained =
        make_model<Network>(read_model(file, Network::input_shape, stored_arrays_of<Network>(), epsilon));
    deployed<Network> network = deploy(trained);
    const std::size_t classes = trained.classes.size();
    check_selftest(file, Network::input_shape, classes, [&](std::span<const std::uint8_t> images) {
        if constexpr (Network::ends_in_softmax) { // whose outputs are no logits
            return detail::class_logits(trained, images);
        } else {
            return detail::logits_of(network, images, classes);
        }
    });
    return network;
}
/// Reads the file and deploys its network.
template <class Network>
[[nodiscard]] [[gnu::cold]] deployed<Network> load_deployed(const file_name& path,
                                                            std::optional<double> epsilon = std::nullopt) {
    return load_deployed<Network>(safetensors::read(path), epsilon);
}

}} // namespace tactnet

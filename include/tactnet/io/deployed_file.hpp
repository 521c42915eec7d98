#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/deployment/eight_bit.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/io/stored_deployed.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

// Deployed networks from files: in single precision from the file of a model, in 8 bits from a file of its
// own, which stored_deployed.hpp describes.

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

/// The first `classes` outputs for each image.
template <class Network>
[[nodiscard]] [[gnu::cold]] std::vector<float>
logits_of(const Network& network, std::span<const std::uint8_t> images, std::size_t classes) {
    const std::unique_ptr<typename Network::workspace> memory(new typename Network::workspace); // not zeroed
    const frames_ref<Network::input_shape> frames(images);
    std::vector<float> logits;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        std::array<float, Network::outputs> found;
        // A logit that is not finite agrees with no logit of a file.
        (void)network.infer(frames[i], found, *memory);
        logits.insert(logits.end(), found.begin(), found.begin() + static_cast<std::ptrdiff_t>(classes));
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
[[nodiscard]] [[gnu::cold]] deployed<Network> load_deployed(const std::filesystem::path& path,
                                                            std::optional<double> epsilon = std::nullopt) {
    return load_deployed<Network>(safetensors::read(path), epsilon);
}

/// Loads a network in 8 bits from a file that `save_deployed` wrote:
///
///     const auto network = load_deployed<net, eight_bit>("tactnet6_8bit.safetensors");
///
/// Throws file_error as `read_deployed`, also unless the self-test in the file gives exactly its logits.
template <class Network, class Format>
    requires std::is_same_v<Format, eight_bit>
[[nodiscard]] [[gnu::cold]] deployed<Network, eight_bit> load_deployed(const safetensors& file) {
    using bytes = deployed<Network, eight_bit>;
    stored_deployed stored = read_deployed(file, folded_layout_of<typename bytes::view_type>());
    constexpr std::size_t numbers = bytes::view_type::folded_elements;
    bytes network(std::span<const float, numbers>(stored.folded.data(), numbers));
    const std::size_t classes = stored.classes.size();
    check_deployed(file, Network::input_shape, classes, [&](std::span<const std::uint8_t> images) {
        return detail::logits_of(network, images, classes);
    });
    network.set_classes(std::move(stored.classes));
    return network;
}
/// Reads the file of a network in 8 bits.
template <class Network, class Format>
    requires std::is_same_v<Format, eight_bit>
[[nodiscard]] [[gnu::cold]] deployed<Network, eight_bit> load_deployed(const std::filesystem::path& path) {
    return load_deployed<Network, eight_bit>(safetensors::read(path));
}

/// Writes a network in 8 bits, all or nothing. `metadata` should state the "network" and may state more;
/// `selftest` holds images to store with their logits, which loading expects bit by bit. Throws file_error,
/// and as `add_deployed`.
template <class Network>
[[gnu::cold]] void save_deployed(const std::filesystem::path& path,
                                 const deployed<Network, eight_bit>& network, file_metadata metadata = {},
                                 std::span<const std::uint8_t> selftest = {}) {
    safetensors_writer writer;
    writer.metadata = std::move(metadata);
    add_deployed(writer, folded_layout_of<typename deployed<Network, eight_bit>::view_type>(),
                 network.folded(), network.classes(), selftest, [&](std::span<const std::uint8_t> images) {
                     return detail::logits_of(network, images, network.classes().size());
                 });
    writer.write(path);
}

} // namespace TACTNET_ARCH
} // namespace tactnet

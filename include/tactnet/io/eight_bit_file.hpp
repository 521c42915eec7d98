#pragma once

#include <tactnet/deployment/eight_bit.hpp>
#include <tactnet/io/deployed_file.hpp>
#include <tactnet/io/file_name.hpp>
#include <tactnet/io/stored_deployed.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <type_traits>
#include <utility>

// Deployed networks in 8 bits, from and to files of their own, which stored_deployed.hpp describes.

namespace tactnet { inline namespace TACTNET_ARCH {

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
    network.set_temperature(stored.temperature);
    return network;
}
/// Reads the file of a network in 8 bits.
template <class Network, class Format>
    requires std::is_same_v<Format, eight_bit>
[[nodiscard]] [[gnu::cold]] deployed<Network, eight_bit> load_deployed(const file_name& path) {
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
    add_deployed(
        writer, folded_layout_of<typename deployed<Network, eight_bit>::view_type>(), network.folded(),
        network.classes(), selftest,
        [&](std::span<const std::uint8_t> images) {
            return detail::logits_of(network, images, network.classes().size());
        },
        network.temperature());
    writer.write(path);
}

}} // namespace tactnet

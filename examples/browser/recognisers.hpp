#pragma once

#include "networks.hpp"
#include "weights.hpp"

#include <tactnet/decision/probabilities.hpp>
#include <tactnet/image/resize.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <tuple>
#include <utility>

namespace browser {

/// A network of the list in one number format, packed on first use.
template <class Network, class Format>
class recogniser {
    using view = typename tactnet::deployed<Network, Format>::view_type;

public:
    void pack(std::span<const float> folded) {
        packed_ = std::make_unique<typename view::packed_weights>();
        view::pack(folded.data(), packed_->elements.data());
        memory_ = std::make_unique<typename view::workspace>();
    }
    [[nodiscard]] bool is_packed() const { return packed_ != nullptr; }
    bool infer(const std::uint8_t* counts, std::span<float, classes> logits) const noexcept {
        constexpr std::size_t size = Network::input_shape.size();
        return view(*packed_).infer(std::span<const std::uint8_t, size>(counts, size), logits, *memory_) ==
               tactnet::frame_status::ok;
    }

private:
    std::unique_ptr<typename view::packed_weights> packed_{};
    std::unique_ptr<typename view::workspace> memory_{};
};

/// A network of the list in both formats.
template <class Network>
struct both_formats {
    static constexpr tactnet::shape input = Network::input_shape;

    stored_network<Network> stored{};
    recogniser<Network, tactnet::single_precision> floats{};
    recogniser<Network, tactnet::eight_bit> bytes{};
    std::array<std::uint8_t, input.size()> frame{};

    /// Reduces a frame of the array to the network's input, as the paper's images are reduced.
    void take(std::span<const std::uint8_t, array_shape.size()> counts) {
        tactnet::resize<array_shape, input>(
            tactnet::tensor_view<const std::uint8_t, array_shape>(counts.data()),
            tactnet::tensor_view<std::uint8_t, input>(frame.data()));
    }
    bool infer(bool in_8_bits, std::span<float, classes> logits) {
        if (in_8_bits) {
            if (!bytes.is_packed())
                bytes.pack(stored.in_bytes);
            return bytes.infer(frame.data(), logits);
        }
        if (!floats.is_packed())
            floats.pack(stored.in_floats());
        return floats.infer(frame.data(), logits);
    }
};

/// All networks of the list, from the bytes that make_weights.cpp wrote.
class recognisers {
public:
    /// Whether the bytes hold these networks, and nothing else.
    bool load(std::span<const std::uint8_t> weights) {
        detail::byte_reader from(weights);
        std::apply([&](auto&... network) { (detail::move_network(network.stored, from), ...); }, networks_);
        return from.complete() && from.rest().empty();
    }
    /// Calls visit(network) with the network at a place in the list.
    template <class Visit>
    void visit(std::size_t place, const Visit& visit) {
        std::apply([&, i = std::size_t{0}](
                       auto&... network) mutable { ((i++ == place ? visit(network) : void()), ...); },
                   networks_);
    }

private:
    template <class... Listed>
    static std::tuple<both_formats<typename Listed::network>...> all_of(const std::tuple<Listed...>&);

    decltype(all_of(networks)) networks_{};
};

} // namespace browser

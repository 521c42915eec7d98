#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The groups of elements of a sample [channel][pixel] that a norm brings to mean 0 and variance 1, each
/// group by itself. A group has `channels` × `pixels` elements, and its channels have a weight and a bias
/// each.
struct norm_groups {
    std::size_t count, channels, pixels;
    std::size_t distance;         ///< elements from one group to the next
    std::size_t channel_distance; ///< elements from one channel of a group to the next
    std::size_t weight_distance;  ///< weights from one group to the next; 0 if they share theirs

    /// Groups of as many successive channels, each with all of their pixels.
    [[nodiscard]] static constexpr norm_groups of_channels(std::size_t count, std::size_t channels,
                                                           std::size_t pixels) {
        return {count, channels, pixels, channels * pixels, pixels, channels};
    }
    /// The channels of each pixel.
    [[nodiscard]] static constexpr norm_groups of_pixels(std::size_t channels, std::size_t pixels) {
        return {pixels, channels, 1, 1, pixels, 0};
    }
    [[nodiscard]] constexpr std::size_t size() const { return channels * pixels; }

    /// body(element) for all elements of the first group.
    template <class Body>
    void for_each(const Body& body) const {
        for (std::size_t c = 0; c < channels; ++c)
            for_each_pixel(c, body);
    }
    /// body(element) for the elements of one of its channels.
    template <class Body>
    void for_each_pixel(std::size_t channel, const Body& body) const {
        for (std::size_t e = channel * channel_distance; e < channel * channel_distance + pixels; ++e)
            body(e);
    }
};

}}} // namespace tactnet::kernels

#pragma once

#include <tactnet/layers/layer.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

// In training, the layers of a list form stages, divided where a layer must see the whole batch. Within a
// stage the batch is processed in parts, a lane block for each thread, so that each layer finds the output of
// the one before in the caches. Sums over the batch add one lane block after the other in any case, so
// results do not depend on the parts.

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

/// Where the stages of a list begin and end. Forward, a stage is the layers begin … end − 1 in this order; in
/// the backward pass, end − 1 … begin.
template <class List>
class stages {
    static constexpr std::size_t size = List::size;
    struct flags {
        bool by_parts, observes;
    };
    static constexpr auto layers = []<std::size_t... I>(std::index_sequence<I...>) {
        return std::array<flags, size>{{{List::template at<I>::by_parts, List::template at<I>::observes}...}};
    }
    (std::make_index_sequence<size>{});

    /// Whether one of layer i and its predecessor must finish a batch before `next`, the other one, begins.
    static constexpr bool waits(std::size_t i, std::size_t next) {
        return layers[next].observes || !layers[i].by_parts || !layers[i - 1].by_parts;
    }

public:
    static constexpr bool starts_forward(std::size_t begin) { return begin == 0 || waits(begin, begin); }
    static constexpr std::size_t forward_end(std::size_t begin) {
        std::size_t end = begin + 1;
        while (end < size && !starts_forward(end))
            ++end;
        return end;
    }
    /// Whether a stage of the backward pass begins with layer end − 1.
    static constexpr bool starts_backward(std::size_t end) { return end == size || waits(end, end - 1); }
    static constexpr std::size_t backward_begin(std::size_t end) {
        std::size_t begin = end - 1;
        while (begin > 0 && !starts_backward(begin))
            --begin;
        return begin;
    }
};

} // namespace detail

/// Calls body(context, first, last) for the lane blocks first … last − 1 of each part of a batch, or once for
/// all of them.
template <bool ByParts, class Body>
void for_each_part(const execution_context& context, std::size_t lane_blocks, const Body& body) {
    if constexpr (!ByParts)
        return body(context, 0, lane_blocks);
    const std::size_t most = context.threads.threads();
    for (std::size_t first = 0; first < lane_blocks; first += most) {
        execution_context part = context;
        part.first_lane_block = first;
        body(part, first, std::min(first + most, lane_blocks));
    }
}

} // namespace TACTNET_ARCH
} // namespace tactnet

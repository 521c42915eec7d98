#pragma once

#include <tactnet/layers/layer.hpp>

#include <algorithm>
#include <cstddef>

// In training, the layers of a list form stages, divided where a layer must see the whole batch. Within a
// stage the batch is processed in parts, a lane block for each thread, so that each layer finds the output of
// the one before in the caches. Sums over the batch add one lane block after the other in any case, so
// results do not depend on the parts.

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

/// Where the stages of a list begin and end. Forward, a stage is the layers Begin … End − 1 in this order; in
/// the backward pass, End − 1 … Begin.
template <class List>
class stages {
    static constexpr std::size_t size = List::size;
    template <std::size_t I>
    using layer = typename List::template at<I>;

    /// Whether one of layer I and its predecessor must finish a batch before `Next`, the other one, begins.
    template <std::size_t I, std::size_t Next>
    static constexpr bool waits() {
        return layer<Next>::observes || !layer<I>::by_parts || !layer<I - 1>::by_parts;
    }

public:
    template <std::size_t Begin>
    static constexpr bool starts_forward() {
        if constexpr (Begin == 0)
            return true;
        else
            return waits<Begin, Begin>();
    }
    template <std::size_t Begin>
    static constexpr std::size_t forward_end() {
        if constexpr (Begin + 1 == size)
            return size;
        else if constexpr (starts_forward<Begin + 1>())
            return Begin + 1;
        else
            return forward_end<Begin + 1>();
    }
    /// Whether a stage of the backward pass begins with layer End − 1.
    template <std::size_t End>
    static constexpr bool starts_backward() {
        if constexpr (End == size)
            return true;
        else
            return waits<End, End - 1>();
    }
    template <std::size_t End>
    static constexpr std::size_t backward_begin() {
        if constexpr (End == 1)
            return 0;
        else if constexpr (starts_backward<End - 1>())
            return End - 1;
        else
            return backward_begin<End - 1>();
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

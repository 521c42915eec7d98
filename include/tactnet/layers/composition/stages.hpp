#pragma once

#include <tactnet/layers/layer.hpp>

#include <algorithm>
#include <cstddef>

// In training, the layers of a list form stages between those that must see the whole batch. Within a stage
// the batch passes by parts, a group of samples for each thread: what a layer writes the next one finds in
// the caches. Sums over the batch are added group after group in any case, so results do not depend on the
// parts.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Where the stages of a list begin and end. Forward, a stage is the layers Begin … End − 1 in this order; on
/// the way back, End − 1 … Begin.
template <class List>
class stages {
    static constexpr std::size_t size = List::size;
    template <std::size_t I>
    using layer = typename List::template at<I>;

    /// Whether all of a batch must be through one of layer I and its predecessor before any of it goes to
    /// `Next`, the other one.
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
    /// Whether the way back begins a stage with layer End − 1.
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

/// body(pass, first, last) for the parts of a batch, or once for all of it.
template <bool ByParts, class Body>
void for_each_part(const execution_context& p, std::size_t groups, const Body& body) {
    if constexpr (!ByParts)
        return body(p, 0, groups);
    const std::size_t most = p.threads.threads();
    for (std::size_t first = 0; first < groups; first += most) {
        execution_context part = p;
        part.first_group = first;
        body(part, first, std::min(first + most, groups));
    }
}

} // namespace TACTNET_ARCH
} // namespace tactnet

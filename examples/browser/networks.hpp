#pragma once

#include <tactnet/networks.hpp>

#include <cstddef>
#include <string_view>
#include <tuple>

// The networks of the page. To change them, edit the list and run examples/browser/make.

namespace browser {

inline constexpr std::size_t classes = 22;
inline constexpr tactnet::shape array_shape{28, 50};

/// A network with the name of its family, as the page shows it.
template <class Network>
struct listed {
    using network = Network;
    static constexpr tactnet::shape shape = Network::input_shape;
    std::string_view family;
};

/// At 28 × 50 the economical form is TactNet-6 itself.
inline constexpr std::tuple networks{
    listed<tactnet::tactnet4<tactnet::shape{7, 13}, classes>>{"TactNet-4"},
    listed<tactnet::tactnet4<tactnet::shape{14, 25}, classes>>{"TactNet-4"},
    listed<tactnet::tactnet4<tactnet::shape{28, 50}, classes>>{"TactNet-4"},
    listed<tactnet::tactnet6<tactnet::shape{14, 25}, classes>>{"TactNet-6"},
    listed<tactnet::tactnet6<tactnet::shape{28, 50}, classes>>{"TactNet-6"},
    listed<tactnet::tactnet6_economical<tactnet::shape{7, 13}, classes>>{"economical"},
    listed<tactnet::tactnet6_economical<tactnet::shape{10, 18}, classes>>{"economical"},
    listed<tactnet::tactnet6_economical<tactnet::shape{14, 25}, classes>>{"economical"},
};
inline constexpr std::size_t network_count = std::tuple_size_v<decltype(networks)>;

} // namespace browser

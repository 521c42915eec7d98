#pragma once

#include <tactnet/networks/network.hpp>

#include <array>
#include <cstddef>
#include <utility>

// The costs of networks at many sizes, as constants, computed from specifications without instantiating
// layers (operators/costs.hpp).
//
//     struct tactnet6_for_22 {
//         template <shape Input>
//         using at = tactnet6<Input, 22>;
//     };
//     constexpr auto costs = costs_at_sizes<tactnet6_for_22>(); // 7 × 13 … 28 × 50
//     static_assert(costs.at({28, 50}).parameters == 104518);

namespace tactnet { inline namespace TACTNET_ARCH {

/// The constants of a network of the same names.
struct network_costs {
    std::size_t parameters = 0;              ///< learnable
    std::size_t statistics = 0;              ///< running means and variances
    std::size_t multiply_adds = 0;           ///< of one sample, all taps
    std::size_t multiply_adds_on_pixels = 0; ///< of one sample, without taps on padding
    std::size_t parameter_bytes = 0;         ///< of parameters and statistics
    std::size_t activation_bytes = 0;        ///< the most that are alive at once, one sample at a time
    friend constexpr bool operator==(const network_costs&, const network_costs&) = default;
};

namespace detail {

template <class Network>
struct costs_of_type;
template <class T, shape Input, class... Specs>
struct costs_of_type<basic_network<T, Input, Specs...>> {
    static constexpr network_costs get() {
        const layer_costs all = sequence<Specs...>::costs(Input);
        return {.parameters = all.parameters,
                .statistics = all.statistics,
                .multiply_adds = all.multiply_adds,
                .multiply_adds_on_pixels = all.multiply_adds_on_pixels,
                .parameter_bytes = (all.parameters + all.statistics) * sizeof(T),
                .activation_bytes = (Input.size() + all.inner_activations + all.output.size()) * sizeof(T)};
    }
};

} // namespace detail

/// The costs of one network.
template <class Network>
inline constexpr network_costs costs_of_network = detail::costs_of_type<Network>::get();

/// The costs of a network at all sizes from Least to Most.
template <shape Least, shape Most>
struct size_table {
    static_assert(Least.rows <= Most.rows && Least.columns <= Most.columns,
                  "size_table: the least size must not be larger than the most");
    static constexpr std::size_t rows = Most.rows - Least.rows + 1;          ///< numbers of rows
    static constexpr std::size_t columns = Most.columns - Least.columns + 1; ///< numbers of columns
    static constexpr std::size_t size = rows * columns;                      ///< sizes in all
    /// Row by row.
    std::array<network_costs, size> costs{};

    /// The size at a place of `costs`.
    [[nodiscard]] static constexpr shape size_of(std::size_t place) {
        return {Least.rows + place / columns, Least.columns + place % columns};
    }
    /// The costs of a size within the table.
    [[nodiscard]] constexpr const network_costs& at(shape image) const {
        return costs[(image.rows - Least.rows) * columns + image.columns - Least.columns];
    }
};

/// `Sizes::at<Input>` is the network at one size. By default the 836 sizes of the paper's range.
template <class Sizes, shape Least = shape{7, 13}, shape Most = shape{28, 50}>
[[nodiscard]] constexpr size_table<Least, Most> costs_at_sizes() {
    using table = size_table<Least, Most>;
    return []<std::size_t... Place>(std::index_sequence<Place...>) {
        return table{{costs_of_network<typename Sizes::template at<table::size_of(Place)>>...}};
    }(std::make_index_sequence<table::size>{});
}

}} // namespace tactnet

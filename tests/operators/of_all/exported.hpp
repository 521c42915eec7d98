// A slice of the list: exported headers, which write_headers.hpp has written, give the bits of the deployed
// network.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <deployment/export/eight_bit_networks.hpp>
#include <memory>
#include <operators/list.hpp>
#include <string>
#include <support/same_bits.hpp>
#include <tuple>
#include <type_traits>
#include <utility>

namespace {

/// Whether a header has the type, the numbers and the outputs of the network that it was written from.
template <class Network, class Header>
void check_header(const auto& original) {
    using view = typename std::remove_cvref_t<decltype(original)>::view_type;
    static_assert(std::is_same_v<std::remove_cvref_t<decltype(Header::recogniser())>, view>);
    CHECK(Header::passes());
    CHECK(support::same_bits(Header::folded(), original.folded()));
    const auto packed = std::make_unique<typename view::packed_weights>();
    view::pack(original.folded().data(), packed->elements.data());
    CHECK(std::ranges::equal(Header::packed().elements, packed->elements));
    std::size_t different = 0;
    for (std::size_t i = 0; i < 5; ++i) {
        const auto frame = frame_of<Network>(i);
        const tactnet::tensor_view<const std::uint8_t, Network::input_shape> counts(frame);
        std::array<float, Network::outputs> expected{}, found{};
        different += original.infer(counts, expected) != tactnet::frame_status::ok ||
                     Header::recogniser().infer(counts, found) != tactnet::frame_status::ok ||
                     !support::same_bits(found, expected);
    }
    CHECK(different == 0);
}

template <class... Examples>
void check_exported(const std::tuple<Examples...>&) {
    const auto check = []<class Example, std::size_t Number>(const Example&,
                                                             std::integral_constant<std::size_t, Number>) {
        using net = typename Example::between;
        CAPTURE(std::string(Example::folder));
        check_header<net, exported<100 * TACTNET_SLICE + Number, false>>(deployed_network<net>());
        check_header<net, exported<100 * TACTNET_SLICE + Number, true>>(deployed_in_8_bits<net>());
    };
    [&]<std::size_t... I>(std::index_sequence<I...>) {
        (check(Examples{}, std::integral_constant<std::size_t, I>{}), ...);
    }(std::index_sequence_for<Examples...>{});
}

} // namespace

// A template, since doctest takes cases of one line for the same in all units.
TEST_CASE_TEMPLATE_DEFINE(
    "operators: an exported header gives the bits of the deployed network, in 8 bits, too", Slice,
    exported_of_all) {
    check_exported(support::examples_of_slice<support::deployed_example, Slice::value, TACTNET_SLICES>{});
}
TEST_CASE_TEMPLATE_APPLY(exported_of_all, std::tuple<std::integral_constant<std::size_t, TACTNET_SLICE>>);

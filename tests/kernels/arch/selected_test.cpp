#include <tactnet/kernels/arch/selected.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <cstdint>

namespace kernels = tactnet::kernels;

namespace {

/// Bytes that change when `convert` widens all 256 of them.
template <std::size_t Lanes, class Convert>
std::size_t bytes_changed(Convert convert) {
    std::size_t changed = 0;
    for (std::size_t first = 0; first < 256; first += Lanes) {
        std::array<std::uint8_t, Lanes> bytes;
        for (std::size_t lane = 0; lane < Lanes; ++lane)
            bytes[lane] = static_cast<std::uint8_t>(first + lane);
        const auto widened = convert(kernels::load_bytes_as<kernels::uint8_vec<Lanes>>(bytes.data()));
        for (std::size_t lane = 0; lane < Lanes; ++lane)
            changed += widened[lane] != bytes[lane] ? 1 : 0;
    }
    return changed;
}
template <std::size_t Lanes>
constexpr auto to_words = [](const auto& bytes) { return kernels::instructions::to_int16<Lanes>(bytes); };
template <std::size_t Lanes>
constexpr auto to_whole = [](const auto& bytes) { return kernels::instructions::to_int32<Lanes>(bytes); };

} // namespace

TEST_CASE("to_int16: every byte keeps its value and its lane, in registers of all widths") {
    constexpr std::size_t most = kernels::max_integer_lanes;
    CHECK(bytes_changed<most>(to_whole<most>) == 0);
    CHECK(bytes_changed<most>(to_words<most>) == 0);
    CHECK(bytes_changed<2 * most>(to_words<2 * most>) == 0);
    if constexpr (most > 4)
        CHECK(bytes_changed<most / 2>(to_whole<most / 2>) == 0);
}

#include <tactnet/simulation/contact/winkler.hpp>
#include <tactnet/simulation/simulate.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>

namespace {

using namespace tactnet::simulation;

/// Shows what an effect is told in place of what it does with it.
struct witness {
    static constexpr stage place = stage::film;

    template <tactnet::shape Shape>
    class bound {
    public:
        bound(const witness&, const mounting& where) : unit_(where.unit) {}
        void apply(signal<Shape> values, const moment& now) noexcept {
            float* out = values.data();
            for (std::uint64_t number : {unit_.number, now.seed, std::uint64_t{now.frame}})
                for (int part = 0; part < 4; ++part, number >>= 16) // a float holds 24 bits
                    *out++ = static_cast<float>(number & 0xFFFF);
        }

    private:
        sensor_unit unit_;
    };
};

using watched = scene<array<28, 50>, contact<winkler>, witness>;

std::uint64_t said(const watched::frames& frames, std::size_t which) {
    std::uint64_t number = 0;
    for (std::size_t part = 4; part-- > 0;)
        number = number << 16 | static_cast<std::uint64_t>(frames.measured.data()[4 * which + part]);
    return number;
}

TEST_CASE("a frame is that of the heights, the pressing and the moment") {
    const touch ball{{{rod::sphere({}, 0.02)}, {}}, {.position = {4e-3, -2e-3}}, pressing::to_depth(5e-4)};
    watched scene({}, {.number = 77});
    watched::frames result, expected;
    const moment now{.seed = 0xFEDC'BA98'7654'3210, .frame = 0xFFFF'FFFF};
    simulate(scene, ball, now, result);
    CHECK(said(result, 0) == 77);
    CHECK(said(result, 1) == now.seed);
    CHECK(said(result, 2) == now.frame);
    tactnet::tensor<float, watched::surface> heights;
    lay<watched::surface>(ball.shape, ball.at, scene.cell(), heights.view());
    scene.touch(heights.view(), ball.press, now, expected);
    CHECK(std::ranges::equal(result.clean, expected.clean));
    CHECK(result.contact.depth == doctest::Approx(5e-4).epsilon(1e-9).scale(0));
}

TEST_CASE(
    "each touch of the paper's classes has a sensor and random numbers of its own, to the seed's last bit") {
    watched scene;
    watched::frames result;
    std::set<std::uint64_t> sensors;
    std::size_t touches = 0;
    for (const std::uint64_t seed : {0ull, 1ull, 1ull << 32, ~0ull})
        for (const std::size_t label : {0u, 1u, 21u})
            for (const std::uint32_t number : {0u, 1u, 7u}) {
                simulate_paper_touch(scene, label, seed, number, result);
                CHECK(said(result, 1) == said(result, 0));
                CHECK(said(result, 2) == number);
                sensors.insert(said(result, 0));
                ++touches;
            }
    CHECK(sensors.size() == touches);
}

} // namespace

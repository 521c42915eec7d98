#include "pressed.hpp"

#include <tactnet/simulation/contact/contact.hpp>
#include <tactnet/simulation/contact/elastic.hpp>
#include <tactnet/simulation/effects/circuit/conversion.hpp>
#include <tactnet/simulation/effects/circuit/wiring.hpp>
#include <tactnet/simulation/effects/film/response.hpp>
#include <tactnet/simulation/effects/film/time.hpp>
#include <tactnet/simulation/effects/mechanics.hpp>
#include <tactnet/simulation/effects/storage.hpp>
#include <tactnet/simulation/objects/object.hpp>
#include <tactnet/simulation/scene.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <support/allocations.hpp>

namespace {

using namespace tactnet::simulation;

using plain = scene<array<8, 12>, contact<winkler>>;
using whole = scene<array<8, 12>, contact<winkler>, tactel_average<3>, saturation, quantisation<8>>;
static_assert(plain::surface == tactnet::shape{8, 12} && plain::output == plain::tactels);
static_assert(whole::surface == tactnet::shape{24, 36} && whole::output == tactnet::shape{8, 12});

TEST_CASE("scene: it presses to the force that it is given") {
    whole touch;
    tactnet::tensor<float, whole::surface> heights;
    for (std::size_t row = 0; row < whole::surface.rows; ++row)
        for (std::size_t column = 0; column < whole::surface.columns; ++column) {
            const double y = (static_cast<double>(row) - 11.5) * touch.cell(),
                         x = (static_cast<double>(column) - 17.5) * touch.cell();
            heights(row, column) = static_cast<float>((x * x + y * y) / (2 * 0.02));
        }
    whole::frames result;
    touch.touch(heights, pressing::to_force(1), {}, result);
    CHECK(result.contact.converged);
    CHECK(result.contact.force == doctest::Approx(1).epsilon(1e-9));
    double sum = 0;
    for (const float pressure : result.clean)
        sum += static_cast<double>(pressure);
    CHECK(sum * touch.sensor().tactel_area() == doctest::Approx(1).epsilon(1e-6));
}

TEST_CASE("scene: with the accurate contact and a pad") {
    using accurate = scene<array<14, 16>, contact<bonded_layer>, elastic_pad, tactel_average<2>>;
    accurate touch({}, {}, elastic_pad{.thickness = 5e-4}, contact<bonded_layer>{{.poisson = 0.4}});
    const auto heights = support::heights_of<accurate::surface>(touch.cell(), support::sphere(0.01));
    accurate::frames result;
    touch.touch(heights, pressing::to_force(2), {}, result);
    CHECK(result.contact.converged);
    CHECK(result.contact.force == doctest::Approx(2).epsilon(1e-9));
    CHECK(support::sum_of(result.measured) * touch.sensor().tactel_area() ==
          doctest::Approx(2).epsilon(1e-3));
}

TEST_CASE("scene: after a change of sensor its frames are those of that sensor") {
    using faulty =
        scene<array<8, 12>, contact<winkler>, elastic_pad, gain_map, hysteresis, noise, dead_tactels>;
    const object ball{{rod::sphere({1e-3, 2e-3}, 0.02)}, {}};
    tactnet::tensor<float, faulty::surface> heights;
    compute_heights<faulty::surface>(ball, {}, 1.9e-3, heights.view());
    const auto frame = [&](faulty& scene) {
        faulty::frames result;
        scene.touch(heights, pressing::to_force(2), {.frame = 3}, result);
        return result.measured;
    };
    const dead_tactels dead{.single = 0.1};
    faulty first({}, {1}, dead), second({}, {2}, dead);
    const auto of_second = frame(second);
    CHECK(!std::ranges::equal(frame(first), of_second));
    first.use({2});
    CHECK(std::ranges::equal(frame(first), of_second));
}

/// An effect of your own: a film that answers to the mean of this frame and of all before it, and reports on
/// which sensor and cells it is.
struct slow_film {
    static constexpr stage place = stage::film;

    float share = 0.5f; ///< of the frame before

    template <tactnet::shape Shape>
    class bound {
    public:
        bound(const slow_film& effect, const mounting& where)
            : share_(effect.share),
              unit_(where.unit),
              cell_(where.cell),
              marks_(unit_.number != sensor_unit{}.number) {}

        void apply(tactnet::simulation::signal<Shape> values, const moment&) noexcept {
            for (std::size_t i = 0; i < Shape.size(); ++i)
                values.data()[i] = before_.data()[i] += (1 - share_) * (values.data()[i] - before_.data()[i]);
            if (marks_)
                values.data()[0] = static_cast<float>(unit_.number),
                values.data()[1] = static_cast<float>(cell_);
        }
        void reset() noexcept { std::ranges::fill(before_, 0.0f); }

    private:
        float share_;
        sensor_unit unit_;
        double cell_;
        bool marks_;
        tactnet::tensor<float, Shape> before_{};
    };
};

/// Counts that an effect of storage halves in number, to see where it believes to be.
struct halved {
    static constexpr stage place = stage::storage;
    template <tactnet::shape In>
    static constexpr tactnet::shape output{In.rows / 2, In.columns / 2};

    template <tactnet::shape Shape>
    struct bound {
        static constexpr tactnet::shape half = output<Shape>;
        bound(const halved&, const mounting& where) : cell(where.cell) {}
        void apply(tactnet::tensor_view<const float, Shape>, tactnet::simulation::signal<half> to,
                   const moment&) const noexcept {
            std::fill_n(to.data(), to.elements().size(), static_cast<float>(cell));
        }
        double cell;
    };
};

const touch ball{{{rod::sphere({}, 0.02)}, {}}, {}, pressing::to_force(1)};

TEST_CASE("scene: effects with a memory go on from frame to frame, until the scene is reset") {
    scene<array<8, 12>, contact<winkler>, slow_film> touched({}, {}, slow_film{.share = 0.75f});
    decltype(touched)::frames first, second, again;
    simulate(touched, ball, {}, first);
    simulate(touched, ball, {}, second);
    CHECK(std::ranges::equal(first.clean, second.clean));
    for (std::size_t i = 0; i < first.clean.size(); ++i) {
        CHECK(first.measured.data()[i] == 0.25f * first.clean.data()[i]);
        CHECK(second.measured.data()[i] == doctest::Approx(0.4375f * first.clean.data()[i]).epsilon(1e-6));
    }
    touched.reset();
    simulate(touched, ball, {}, again);
    CHECK(std::ranges::equal(first.measured, again.measured));
}

TEST_CASE("scene: another sensor of the make begins without a memory") {
    scene<array<8, 12>, contact<winkler>, tactel_average<2>, slow_film> touched(
        array<8, 12>{.pitch = 3e-3}, sensor_unit{5}, contact<winkler>{{.modulus = 2e5}});
    decltype(touched)::frames first, other;
    simulate(touched, ball, {}, first);
    touched.use({9});
    simulate(touched, ball, {}, other);
    CHECK(other.measured(0, 0) == 9);
    CHECK(other.measured(0, 1) == 3e-3f); // metres from tactel to tactel
    CHECK(other.measured(4, 6) == first.measured(4, 6));
    CHECK(touched.cell() == 1.5e-3);
}

TEST_CASE("scene: an effect knows the cells of the map that reaches it") {
    scene<array<8, 12>, contact<winkler>, tactel_average<3>, quantisation<8>, halved, jpeg_storage> touched;
    static_assert(decltype(touched)::tactels == tactnet::shape{8, 12});
    static_assert(decltype(touched)::output == tactnet::shape{4, 6});
    scene<array<8, 12>, contact<winkler>, quantisation<8>, halved, halved> twice({.pitch = 2e-3}, {});
    decltype(twice)::frames result;
    simulate(twice, ball, {}, result);
    CHECK(result.measured(1, 2) == 4e-3f);
}

TEST_CASE("scene: clean is what reaches the film, measured what comes of it") {
    scene<array<8, 12>, contact<winkler>, elastic_pad, saturation> touched({}, {}, saturation{.limit = 2e3});
    scene<array<8, 12>, contact<winkler>, elastic_pad> endless;
    decltype(touched)::frames result;
    decltype(endless)::frames mechanics;
    simulate(touched, ball, {}, result);
    simulate(endless, ball, {}, mechanics);
    CHECK(std::ranges::equal(result.clean, mechanics.clean));
    CHECK(std::ranges::equal(mechanics.clean, mechanics.measured));
    CHECK(std::ranges::max(result.clean) > 2e3f);
    CHECK(std::ranges::max(result.measured) == 2e3f);
}

TEST_CASE("scene: parameters may be given in any order, and reach their effects") {
    using sensor = scene<array<8, 12>, contact<winkler>, saturation, quantisation<8>>;
    sensor one({}, {}, saturation{.limit = 3e3}, quantisation<8>{.full_scale = 6e3});
    sensor other({}, {}, quantisation<8>{.full_scale = 6e3}, saturation{.limit = 3e3});
    sensor::frames a, b;
    simulate(one, ball, {}, a);
    simulate(other, ball, {}, b);
    CHECK(std::ranges::max(a.measured) == 128);
    CHECK(std::ranges::equal(a.measured, b.measured));
}

TEST_CASE("scene: effects of no strength change no bit, and a frame takes no heap memory") {
    scene<array<8, 12>, contact<winkler>, quantisation<8>> without;
    scene<array<8, 12>, contact<winkler>, elastic_pad, film_texture, noise, saturation, quantisation<8>> with(
        {}, {}, elastic_pad{.thickness = 0}, film_texture{0, 0}, noise{0, 0},
        saturation{.limit = std::numeric_limits<double>::infinity()});
    decltype(without)::frames expected;
    decltype(with)::frames found;
    simulate(without, ball, {}, expected);
    const std::size_t before = support::allocations();
    simulate(with, ball, {}, found);
    CHECK(support::allocations() == before);
    CHECK(std::ranges::equal(expected.clean, found.clean));
    CHECK(std::ranges::equal(expected.measured, found.measured));
}

TEST_CASE("scene: a pressing that cannot be leaves the array untouched, and is not said to have been found") {
    constexpr double none = std::numeric_limits<double>::quiet_NaN(),
                     endless = std::numeric_limits<double>::infinity();
    const auto check = [](auto touched) {
        typename decltype(touched)::frames result;
        std::ranges::fill(result.measured, 1.0f);
        for (const pressing& press :
             {pressing::to_force(none), pressing::to_depth(none), pressing{pressing::goal::force, 1, 0},
              pressing{pressing::goal::force, 1, -1}, pressing{pressing::goal::force, 1, none},
              pressing{pressing::goal::force, 1, 1e5, -1}, pressing{pressing::goal::force, 1, 1e5, none},
              pressing{pressing::goal::force, 1, 1e5, endless}, pressing{pressing::goal::force, 1, 1e-310},
              pressing::to_force(endless), pressing::to_depth(endless)}) {
            simulate(touched, touch{ball.shape, {}, press}, {}, result);
            CHECK(!result.contact.converged);
            CHECK(result.contact.force == 0);
            CHECK(std::ranges::all_of(result.measured, [](float pressure) { return pressure == 0; }));
        }
        simulate(touched, touch{ball.shape, {}, pressing{pressing::goal::force, 1, 1e5, 0}}, {}, result);
        CHECK(result.contact.converged);
        CHECK(result.contact.force == doctest::Approx(1).epsilon(1e-3));
    };
    check(scene<array<8, 12>, contact<winkler>>());

    contact<winkler>::bound<tactnet::shape{2, 2}> alone({}, {});
    tactnet::tensor<float, tactnet::shape{2, 2}> heights, pressures;
    std::ranges::fill(pressures, 1.0f);
    CHECK(!alone.apply(heights, pressing::to_force(none), pressures.view()).converged);
    CHECK(std::ranges::all_of(pressures, [](float pressure) { return pressure == 0; }));

    check(scene<array<8, 12>, contact<elastic_half_space>>());
    check(scene<array<8, 12>, contact<bonded_layer>>());
}

TEST_CASE("scene: a touch of nothing, or with no force, leaves the array untouched") {
    scene<array<8, 12>, contact<winkler>, elastic_pad, film_texture, saturation, quantisation<8>> touched;
    decltype(touched)::frames result;
    for (const touch& faint : {touch{}, touch{ball.shape, {}, pressing::to_force(0)},
                               touch{ball.shape, {}, pressing::to_force(-1)},
                               touch{ball.shape, {.position = {1, 0}}, pressing::to_force(1)},
                               touch{ball.shape, {.angle = std::numeric_limits<double>::quiet_NaN()}, {}}}) {
        simulate(touched, faint, {}, result);
        CHECK(result.contact.force == 0);
        CHECK(std::ranges::all_of(result.measured, [](float count) { return count == 0; }));
    }
}

} // namespace

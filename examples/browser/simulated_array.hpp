#pragma once

#include <tactnet/image/resize.hpp>
#include <tactnet/simulation.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>

// An array whose effects can be switched while it is touched. A scene lists its effects when it is compiled;
// here each bound effect has a switch of its own.

namespace browser {

namespace sim = tactnet::simulation;

/// An effect with its switch. Strengths are chosen so that each can be seen; those of the paper's scene keep
/// their defaults.
template <class Effect>
struct switched {
    Effect effect{};
    bool on = false;
};

template <tactnet::shape Shape>
class simulated_array {
    using pressures = tactnet::tensor<float, Shape>;

    static constexpr sim::hysteresis wide_loop{{{{2e3, 0.2}, {4e3, 0.2}, {8e3, 0.2}, {12e3, 0.2}}}};
    inline static const std::tuple listed{
        switched<sim::elastic_pad>{{}, true},
        switched<sim::gain_map>{},
        switched<sim::film_texture>{{}, true},
        switched<sim::linearity>{{.error = 0.2}},
        switched<sim::hysteresis>{wide_loop},
        switched<sim::creep>{{.rate = 0.2}},
        switched<sim::temperature>{{.sensitivity = 0.02}},
        switched<sim::crosstalk>{{.along_row = 0.1, .along_column = 0.1}},
        switched<sim::resistive_network>{{.grounding = 1e-3}},
        switched<sim::noise>{{.additive = 1000}},
        switched<sim::threshold>{{.level = 4e3}},
        switched<sim::saturation>{{.limit = 12e3}},
        switched<sim::quantisation<8>>{{}, true}, // always: what follows needs counts
        switched<sim::jpeg_storage>{{}, true},
    };
    template <class Effect>
    using bound_of = typename Effect::template bound<Shape>;

public:
    using counts = std::array<std::uint8_t, Shape.size()>;
    static constexpr std::size_t effect_count = std::tuple_size_v<decltype(listed)>;

    explicit simulated_array(std::uint64_t unit)
        : effects_(std::apply([&](const auto&... effect) { return bind(unit, effect...); }, listed)),
          springs_({}, mounted(unit)) {
        std::apply([&, i = std::size_t{0}](const auto&... effect) mutable { ((on_[i++] = effect.on), ...); },
                   listed);
    }

    void set(std::size_t effect, bool on) {
        on_[effect] = on;
        forget();
    }
    /// An elastic layer in place of springs.
    void set_layer(bool on) { layer_on_ = on; }
    /// Begins a new touch.
    void forget() { std::get<bound_of<sim::hysteresis>>(effects_).reset(); }

    /// Computes what the object presses on the surface.
    void press(const sim::touch& some) {
        pressures heights;
        sim::compute_heights<Shape>(some.shape, some.at, sim::paper_array{}.pitch, heights.view());
        press(heights, some.press, layer_on_);
    }
    void press(const pressures& heights, const sim::pressing& how, bool layer) {
        if (layer) {
            if (!layer_)
                layer_.emplace(sim::contact<sim::bonded_layer>{}, mounted(1));
            report_ = layer_->apply(heights.view(), how, surface_.view());
        } else {
            report_ = springs_.apply(heights.view(), how, surface_.view());
        }
    }
    [[nodiscard]] const pressures& surface() const { return surface_; }
    [[nodiscard]] const sim::contact_report& report() const { return report_; }

    /// The counts of what was pressed last. Noise follows `now.frame`, and the texture of the film `touch`.
    void read(const sim::moment& now, std::uint32_t touch, counts& to) {
        pressures signal = surface_;
        run(effects_, signal, now, touch, effect_count);
        for (std::size_t i = 0; i < Shape.size(); ++i)
            to[i] = tactnet::saturate_to_count(signal.data()[i]);
    }
    /// As `read`, but leaves the memory of effects as it is.
    void read_again(const sim::moment& now, std::uint32_t touch, counts& to) {
        pressures signal = surface_;
        auto copies = effects_;
        run(copies, signal, now, touch, effect_count);
        for (std::size_t i = 0; i < Shape.size(); ++i)
            to[i] = tactnet::saturate_to_count(signal.data()[i]);
    }
    /// The counts if one effect were switched the other way. Leaves the memory of effects as it is.
    void read_without(std::size_t effect, const sim::moment& now, std::uint32_t touch, counts& to) {
        on_[effect] = !on_[effect];
        read_again(now, touch, to);
        on_[effect] = !on_[effect];
    }
    /// Applies one effect many times to what it reads, to be timed.
    void repeat(std::size_t effect, std::size_t times, const sim::moment& now) {
        pressures before = surface_;
        auto copies = effects_;
        run(copies, before, now, now.frame, effect);
        visit(copies, effect, [&](auto& bound) {
            for (std::size_t i = 0; i < times; ++i) {
                pressures signal = before;
                bound.apply(signal.view(), now);
                sink_ = signal.data()[i % Shape.size()];
            }
        });
    }

private:
    static sim::mounting mounted(std::uint64_t unit) { return {sim::paper_array{}.pitch, {unit}}; }
    template <class... Effects>
    static std::tuple<bound_of<Effects>...> bind(std::uint64_t unit,
                                                 const switched<Effects>&... listed_effect) {
        return {bound_of<Effects>(listed_effect.effect, mounted(unit))...};
    }
    template <class Tuple, class Body, std::size_t... Index>
    static void for_each(Tuple& effects, const Body& body, std::index_sequence<Index...>) {
        (body(Index, std::get<Index>(effects)), ...);
    }
    template <class Tuple, class Body>
    static void visit(Tuple& effects, std::size_t which, const Body& body) {
        for_each(
            effects,
            [&](std::size_t i, auto& bound) {
                if (i == which)
                    body(bound);
            },
            std::make_index_sequence<effect_count>{});
    }
    /// Applies the effects before `end` that are switched on.
    template <class Tuple>
    void run(Tuple& effects, pressures& signal, const sim::moment& now, std::uint32_t touch,
             std::size_t end) {
        for_each(
            effects,
            [&]<class Bound>(std::size_t i, Bound& bound) {
                if (!on_[i] || i >= end)
                    return;
                sim::moment at = now;
                if constexpr (std::is_same_v<Bound, bound_of<sim::film_texture>>)
                    at.frame = touch;
                bound.apply(signal.view(), at);
            },
            std::make_index_sequence<effect_count>{});
    }

    decltype(std::apply([](const auto&... effect) { return bind(0, effect...); }, listed)) effects_;
    typename sim::contact<sim::winkler>::template bound<Shape> springs_;
    std::optional<typename sim::contact<sim::bonded_layer>::template bound<Shape>> layer_{};
    std::array<bool, effect_count> on_{};
    bool layer_on_ = false;
    pressures surface_{};
    sim::contact_report report_{};
    volatile float sink_ = 0;
};

} // namespace browser

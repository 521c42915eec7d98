// The C++ of the page: functions for worker.js over one simulated array and the networks. Pointers are
// offsets into the memory that both share.

#include "recognisers.hpp"
#include "simulated_array.hpp"

#include <tactnet/decision/contact_detector.hpp>
#include <tactnet/decision/sensor_health.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#if defined(__EMSCRIPTEN__)
#define PAGE_FUNCTION(name) extern "C" __attribute__((export_name(#name)))
#else
#define PAGE_FUNCTION(name) extern "C" // for the tests
#endif

namespace {

using namespace browser;
using array_counts = std::array<std::uint8_t, array_shape.size()>;
using health = tactnet::sensor_health<array_shape>;

constexpr std::uint64_t touch_seed = 2; // training has seed 1
constexpr std::size_t drawing_side = 48;
constexpr double drawing_cell = 1.2 * sim::mm;

enum class fault : std::uint8_t { none, dead, stuck };

/// All that the page keeps.
struct page_state {
    recognisers networks{};
    simulated_array<array_shape> array{1};
    health sensor{};
    tactnet::contact_detector<array_shape> detector{};
    std::array<fault, array_shape.size()> faults{};
    std::uint32_t frames = 0; ///< since the page was loaded

    sim::touch drawn{};      ///< the object as it was drawn
    sim::point grip{};       ///< where the drawn object is held, from its origin
    std::uint32_t touch = 0; ///< its number
    sim::touch held{};       ///< the object as it was held last

    // What JavaScript reads, and writes before a call.
    array_counts sound{}, raw{}, clean{}, other{};
    std::array<std::int16_t, array_shape.size()> difference{};
    std::array<float, classes> logits{}, probabilities{};
    std::array<double, 16> numbers{};
    std::array<float, drawing_side * drawing_side> drawing{};
    std::vector<std::uint8_t> weights{};
};

page_state& page() {
    static const std::unique_ptr<page_state> state = std::make_unique<page_state>();
    return *state;
}

sim::moment moment_of(double seconds) {
    return {.seed = 5, .frame = page().frames, .seconds = seconds, .celsius = 37};
}

void break_tactels(array_counts& counts) {
    for (std::size_t i = 0; i < counts.size(); ++i)
        if (page().faults[i] != fault::none)
            counts[i] = page().faults[i] == fault::stuck ? 255 : 0;
}

/// Learns what the sound array counts in air.
void learn_air() {
    page_state& p = page();
    const sim::touch nothing{};
    p.array.press(nothing);
    p.sensor.forget();
    for (std::uint32_t frame = 0; frame < 50; ++frame) {
        ++p.frames;
        p.array.read(moment_of(0), p.touch, p.sound);
        p.sensor.learn(p.sound);
    }
    p.detector = tactnet::contact_detector<array_shape>{};
    p.detector.learn(p.sensor.clean(p.sound));
}

/// Holds the object by the middle of what it presses.
void take(sim::touch&& some) {
    page_state& p = page();
    p.drawn = std::move(some);
    p.array.forget();
    p.array.press(p.drawn);
    sim::point middle{};
    double sum = 0;
    for (std::size_t row = 0; row < array_shape.rows; ++row)
        for (std::size_t column = 0; column < array_shape.columns; ++column) {
            const auto pressure =
                static_cast<double>(p.array.surface().data()[row * array_shape.columns + column]);
            middle = middle + pressure * sim::point{static_cast<double>(column), static_cast<double>(row)};
            sum += pressure;
        }
    const double pitch = sim::paper_array{}.pitch;
    const sim::point centre{(array_shape.columns - 1) / 2.0, (array_shape.rows - 1) / 2.0};
    const sim::point held = sum > 0 ? pitch * ((1 / sum) * middle - centre) : p.drawn.at.position;
    p.grip = (held - p.drawn.at.position).turned(-p.drawn.at.angle);
    p.numbers = {held.x / pitch, held.y / pitch, p.drawn.press.amount};
}

/// The last frame with an effect less the frame without it.
void write_difference(bool other_is_without) {
    page_state& p = page();
    for (std::size_t i = 0; i < array_shape.size(); ++i)
        p.difference[i] = static_cast<std::int16_t>((p.sound[i] - p.other[i]) * (other_is_without ? 1 : -1));
}

} // namespace

// Memory that JavaScript reads and writes.
PAGE_FUNCTION(sound_counts) const std::uint8_t* sound_counts() {
    return page().sound.data();
}
PAGE_FUNCTION(raw_counts) std::uint8_t* raw_counts() {
    return page().raw.data();
}
PAGE_FUNCTION(clean_counts) const std::uint8_t* clean_counts() {
    return page().clean.data();
}
PAGE_FUNCTION(difference) const std::int16_t* difference() {
    return page().difference.data();
}
PAGE_FUNCTION(logits) const float* logits() {
    return page().logits.data();
}
PAGE_FUNCTION(probabilities) const float* probabilities() {
    return page().probabilities.data();
}
PAGE_FUNCTION(numbers) const double* numbers() {
    return page().numbers.data();
}
PAGE_FUNCTION(drawing) float* drawing() {
    return page().drawing.data();
}
PAGE_FUNCTION(faults) std::uint8_t* faults() {
    return reinterpret_cast<std::uint8_t*>(page().faults.data());
}
PAGE_FUNCTION(weights) std::uint8_t* weights(std::size_t size) {
    page().weights.resize(size);
    return page().weights.data();
}

/// Whether the weights are those of these networks.
PAGE_FUNCTION(load) bool load() {
    const bool fit = page().networks.load(page().weights);
    learn_air();
    return fit;
}
PAGE_FUNCTION(effect_count) std::size_t effect_count() {
    return simulated_array<array_shape>::effect_count;
}
PAGE_FUNCTION(set_effect) void set_effect(std::size_t effect, bool on) {
    page().array.set(effect, on);
}
PAGE_FUNCTION(set_layer) void set_layer(bool on) {
    page().array.set_layer(on);
}
PAGE_FUNCTION(learn) void learn() {
    learn_air();
}

/// Takes touch `number` of a class. numbers: column and row where it was drawn, from the middle; newtons.
PAGE_FUNCTION(take_object) void take_object(std::size_t label, std::uint32_t number) {
    page().touch = number * static_cast<std::uint32_t>(classes) + static_cast<std::uint32_t>(label);
    take(sim::draw_touch(label, touch_seed, number));
}
/// Takes the height map in `drawing`: millimetres, or negative where there is nothing.
PAGE_FUNCTION(take_drawing) void take_drawing() {
    sim::relief map{{}, drawing_side, drawing_side, drawing_cell, {}};
    for (const float height : page().drawing)
        map.heights.push_back(height >= 0 ? height * static_cast<float>(sim::mm)
                                          : std::numeric_limits<float>::infinity());
    take({.shape = {{std::move(map)}}, .press = sim::pressing::to_force(10)});
}

/// Simulates a frame: the object held at a place, turned, pressed. Without force nothing touches the array.
/// numbers: pressed tactels, largest count, faulty tactels that were found, whether something touches,
/// newtons, millimetres of depth.
PAGE_FUNCTION(simulate)
void simulate(double column, double row, double angle, double newtons, double seconds) {
    page_state& p = page();
    ++p.frames;
    p.held = p.drawn;
    const double pitch = sim::paper_array{}.pitch;
    p.held.at.angle += angle;
    p.held.at.position = sim::point{column * pitch, row * pitch} - p.grip.turned(p.held.at.angle);
    p.held.press.amount = newtons;
    p.array.press(p.held);
    p.array.read(moment_of(seconds), p.touch, p.sound);
    p.raw = p.sound;
    break_tactels(p.raw);
    const auto cleaned = p.sensor.clean(p.raw);
    std::copy(cleaned.begin(), cleaned.end(), p.clean.begin());
    const tactnet::contact_state& contact = p.detector.update(p.clean);
    if (!contact.touching && newtons <= 0)
        p.sensor.follow(p.raw);
    p.numbers = {static_cast<double>(contact.area),
                 static_cast<double>(*std::max_element(p.sound.begin(), p.sound.end())),
                 static_cast<double>(p.sensor.faults().size()),
                 contact.touching ? 1.0 : 0.0,
                 p.array.report().force,
                 p.array.report().depth / sim::mm};
}
/// difference: the counts of the last frame with an effect less those without it.
PAGE_FUNCTION(compare) void compare(std::size_t effect, double seconds, bool is_on) {
    page_state& p = page();
    p.array.read_without(effect, moment_of(seconds), p.touch, p.other);
    write_difference(is_on);
}
/// difference: the counts with the elastic layer less those without it, or the other way round.
PAGE_FUNCTION(compare_layer) void compare_layer(double seconds, bool is_on) {
    page_state& p = page();
    p.array.set_layer(!is_on);
    p.array.press(p.held);
    p.array.read_again(moment_of(seconds), p.touch, p.other);
    p.array.set_layer(is_on);
    p.array.press(p.held);
    write_difference(is_on);
}

/// Recognises the raw or the clean frame. Whether its logits are finite.
PAGE_FUNCTION(recognise) bool recognise(std::size_t network, bool in_8_bits, bool clean) {
    page_state& p = page();
    bool finite = false;
    p.networks.visit(network, [&](auto& chosen) {
        chosen.take(clean ? p.clean : p.raw);
        finite = chosen.infer(in_8_bits, p.logits);
        std::array<double, classes> logarithms{};
        (void)tactnet::temperature_scaling{static_cast<double>(chosen.stored.temperature)}.log_probabilities(
            p.logits, logarithms);
        for (std::size_t i = 0; i < classes; ++i)
            p.probabilities[i] = static_cast<float>(std::exp(logarithms[i]));
    });
    return finite;
}

/// The frame that a network read last.
PAGE_FUNCTION(network_frame) std::uint8_t* network_frame(std::size_t network) {
    std::uint8_t* frame = nullptr;
    page().networks.visit(network, [&](auto& chosen) { frame = chosen.frame.data(); });
    return frame;
}
/// Logits of that frame. Whether they are finite.
PAGE_FUNCTION(infer) bool infer(std::size_t network, bool in_8_bits) {
    bool finite = false;
    page().networks.visit(network, [&](auto& chosen) { finite = chosen.infer(in_8_bits, page().logits); });
    return finite;
}

/// For the tests: how many convolutions a network has. numbers: rows and columns of the Winograd tiles of
/// each, 0 by taps.
PAGE_FUNCTION(tiles) std::size_t tiles(std::size_t network) {
    std::size_t count = 0;
    page().networks.visit(network, [&]<class Network>(const both_formats<Network>&) {
        using steps = typename stored_network<Network>::float_view::steps;
        [&]<std::size_t... Index>(std::index_sequence<Index...>) {
            const auto append = [&]<class Step>(std::type_identity<Step>) {
                if constexpr (requires { Step::method::tile; }) {
                    page().numbers[count++] = static_cast<double>(Step::method::tile.rows);
                    page().numbers[count++] = static_cast<double>(Step::method::tile.columns);
                }
            };
            (append(std::type_identity<typename steps::template at<Index>>{}), ...);
        }(std::make_index_sequence<steps::size>{});
    });
    return count / 2;
}

// To be timed.
PAGE_FUNCTION(repeat_network) void repeat_network(std::size_t network, bool in_8_bits, std::size_t times) {
    page().networks.visit(network, [&](auto& chosen) {
        for (std::size_t i = 0; i < times; ++i)
            (void)chosen.infer(in_8_bits, page().logits);
    });
}
PAGE_FUNCTION(repeat_effect) void repeat_effect(std::size_t effect, std::size_t times) {
    page().array.repeat(effect, times, moment_of(1));
}
PAGE_FUNCTION(repeat_contact) void repeat_contact(bool layer, std::size_t times) {
    page_state& p = page();
    p.array.set_layer(layer);
    for (std::size_t i = 0; i < times; ++i)
        p.array.press(p.held);
    p.array.set_layer(false);
}

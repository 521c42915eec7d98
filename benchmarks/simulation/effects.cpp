// What each effect of a simulated scene costs, switched on alone: microseconds for one frame of 28×50 tactels
// on one core, in the fastest of interleaved rounds. Each result is checked: finite, and not what went in.
// Run it pinned to an idle core.

#include <tactnet/runtime/random.hpp>
#include <tactnet/simulation/contact/contact.hpp>
#include <tactnet/simulation/effects/circuit/conversion.hpp>
#include <tactnet/simulation/effects/circuit/resistive_network.hpp>
#include <tactnet/simulation/effects/circuit/wiring.hpp>
#include <tactnet/simulation/effects/film/response.hpp>
#include <tactnet/simulation/effects/film/time.hpp>
#include <tactnet/simulation/effects/storage.hpp>
#include <tactnet/simulation/scene.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <vector>

namespace {

using namespace tactnet::simulation;
using tactnet::shape;

constexpr std::size_t rounds = 201, calls = 50;
using cheap = scene<array<28, 50>, contact<winkler>>;
using everyday = scene<array<28, 50>, contact<winkler>, noise, threshold, saturation, quantisation<8>>;
using frame = tactnet::tensor<float, cheap::surface>;

struct task {
    const char* name;
    std::function<void(std::uint32_t)> run{}; ///< frame by its number
    bool good = false;
    double seconds = 1e9;
};

/// A ball pressed on the array.
const frame& heights() {
    static const frame ball = [] {
        frame drawn;
        for (std::size_t i = 0; i < drawn.size(); ++i) {
            const double y = (static_cast<double>(i / 50) - 13) * 1.9e-3,
                         x = (static_cast<double>(i % 50) - 21) * 1.9e-3;
            drawn.data()[i] = static_cast<float>((x * x + y * y) / (2 * 0.05));
        }
        return drawn;
    }();
    return ball;
}
/// Its pressures, or its counts.
template <class Effect>
const frame& input() {
    static const frame values = [] {
        frame made;
        if constexpr (Effect::place == stage::storage) {
            everyday::frames result;
            everyday{}.touch(heights(), pressing::to_force(20), {}, result);
            made = result.measured;
        } else {
            cheap::frames result;
            cheap{}.touch(heights(), pressing::to_force(20), {}, result);
            made = result.clean;
        }
        return made;
    }();
    return values;
}

bool finite(const auto& values) {
    return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
}

template <class Effect>
inline constexpr shape shape_after = output_shape<Effect, cheap::surface>();

/// An effect, and the copy of a frame that it works on.
template <class Effect>
struct applied {
    typename Effect::template bound<cheap::surface> effect;
    frame values{};
    tactnet::tensor<float, shape_after<Effect>> result{};

    explicit applied(const Effect& parameters) : effect(parameters, mounting{}) {}
    void operator()(std::uint32_t number) {
        const moment now{.frame = number, .seconds = 5, .celsius = 30};
        values = input<Effect>();
        if constexpr (cheap::surface == shape_after<Effect>)
            effect.apply(values.view(), now);
        else
            effect.apply(values.view(), result.view(), now);
    }
    [[nodiscard]] bool good() const {
        if constexpr (cheap::surface == shape_after<Effect>)
            return finite(values) && !std::equal(values.begin(), values.end(), input<Effect>().begin());
        else
            return finite(result) &&
                   std::any_of(result.begin(), result.end(), [](float count) { return count > 0; });
    }
};

template <class Effect>
task one(const char* name, const Effect& parameters = {}) {
    const auto run = std::make_shared<applied<Effect>>(parameters);
    (*run)(0);
    return {.name = name, .run = [run](std::uint32_t number) { (*run)(number); }, .good = run->good()};
}

task copy_only() {
    const auto values = std::make_shared<frame>();
    // Volatile, so that the copy is made.
    return {.name = "(the copy of a frame alone)",
            .run =
                [values](std::uint32_t number) {
                    *values = input<saturation>();
                    *static_cast<volatile float*>(values->data()) = static_cast<float>(number);
                },
            .good = true};
}

template <class Scene>
task whole(const char* name) {
    const auto scene = std::make_shared<Scene>();
    const auto result = std::make_shared<typename Scene::frames>();
    task made{.name = name, .run = [scene, result](std::uint32_t number) {
                  scene->touch(heights(), pressing::to_force(20), {.frame = number, .seconds = 5}, *result);
              }};
    made.run(0);
    made.good =
        finite(result->measured) && result->contact.converged && std::abs(result->contact.force - 20) < 1e-6;
    return made;
}

} // namespace

int main() {
    std::vector<task> tasks{
        copy_only(),
        one<gain_map>("gain_map"),
        one<linearity>("linearity"),
        one<hysteresis>("hysteresis"),
        one<creep>("creep"),
        one<drift>("drift"),
        one<temperature>("temperature"),
        one<crosstalk>("crosstalk"),
        one<resistive_network>("resistive_network"),
        one<dead_tactels>("dead_tactels", {.single = 0.1}),
        one<noise>("noise"),
        one<threshold>("threshold", {.level = 5e3}),
        one<saturation>("saturation", {.limit = 1e3}),
        one<quantisation<8>>("quantisation<8>"),
        one<quantisation_levels<15>>("quantisation_levels<15>"),
        one<resolution<14, 25>>("resolution<14, 25>"),
        one<jpeg_storage>("jpeg_storage"),
        whole<cheap>("scene: winkler"),
        whole<everyday>("scene: winkler, noise, threshold, saturation, quantisation"),
    };
    for (std::size_t round = 0; round < rounds; ++round)
        for (task& each : tasks) {
            const auto start = std::chrono::steady_clock::now();
            for (std::uint32_t call = 0; call < calls; ++call)
                each.run(call);
            const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
            each.seconds = std::min(each.seconds, passed.count() / calls);
        }
    std::printf(
        "one core, %zu lanes, microseconds a frame of 28x50 in the fastest of %zu interleaved rounds\n",
        tactnet::kernels::lanes<float>, rounds);
    bool good = true;
    for (const task& each : tasks) {
        std::printf("%-60s %8.2f%s\n", each.name, 1e6 * each.seconds, each.good ? "" : "  WRONG");
        good = good && each.good;
    }
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}

// What everything that decides costs in addition to the network that it serves: TactNet-6 at 28 × 50 in
// single precision and in 8 bits, with random weights, on a stream of touches. Each round times the network
// alone and the same with all stages, one after the other; the table has medians of rounds and of their
// ratios.
//
//     benchmark_decision_cost        on one core: taskset -c 1

#include <tactnet/decision.hpp>
#include <tactnet/quantisation.hpp>
#include <tactnet/tactnet.hpp>
#include <tactnet/training/initialise.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace {

using namespace tactnet;

constexpr shape array{28, 50};
constexpr std::size_t classes = 22, dimensions = 16, frames_per_round = 400, rounds = 201;
using net = tactnet6<array, classes>;
using frame = std::array<std::uint8_t, array.size()>;

/// A touch of another size at another place for each number.
frame touch_of(std::size_t number) {
    frame counts{};
    const auto row = static_cast<int>(8 + number % 12), column = static_cast<int>(12 + number * 3 % 26);
    for (std::size_t i = 0; i < counts.size(); ++i) {
        const int y = static_cast<int>(i / array.columns) - row,
                  x = static_cast<int>(i % array.columns) - column;
        counts[i] = static_cast<std::uint8_t>(std::max(0, 160 - 3 * (y * y + x * x)));
    }
    return counts;
}

/// All that runs before and after a network.
struct stages {
    sensor_health<array> health;
    contact_detector<array> detector;
    gain_monitor gain{force_statistics{9, 0.5}};
    touch_evidence<classes> evidence{classes, {0.7}};
    prediction_set set{{0.7}, 0.05};
    discriminant<256, dimensions> map;
    class_means<dimensions, classes> means;
};

/// The class of each touch, so that nothing is left out. A function of its own, and `hot`: GCC 12 optimises
/// what is called once, from `main`, for size, and stages would take twice their time.
template <class Network>
[[gnu::noinline, gnu::hot]] std::size_t alone(const Network& network, std::span<const frame> touches,
                                              typename Network::workspace& memory) {
    std::size_t sum = 0;
    std::array<float, classes> logits;
    for (const frame& touch : touches)
        if (network.infer(touch, logits, memory) == frame_status::ok)
            sum += classify_logits(logits, classes)->index;
    return sum;
}
template <class Network>
[[gnu::noinline, gnu::hot]] std::size_t with_stages(const Network& network, std::span<const frame> touches,
                                                    typename Network::workspace& memory, stages& all,
                                                    std::size_t& decided) {
    std::size_t sum = 0;
    std::array<float, classes> logits;
    std::array<bool, classes> members;
    std::array<float, 256> features;
    for (const frame& touch : touches) {
        const auto clean = all.health.clean(touch);
        const contact_state& contact = all.detector.update(clean);
        if (!contact.touching)
            all.health.follow(touch);
        if (network.infer(clean, logits, memory) != frame_status::ok)
            continue;
        sum += classify_logits(logits, classes)->index;
        all.gain.add_touch(contact.force);
        all.evidence.clear();
        all.evidence.add_frame(logits);
        decided += all.evidence.decide(0.01).has_value();
        decided += all.set.predict(logits, members);
        network.read_features(memory, features);
        decided += all.means.nearest(all.map.project(features))->index;
    }
    return sum;
}

template <class Network>
bool measure(const char* name, const Network& network) {
    std::vector<frame> touches;
    for (std::size_t number = 0; number < frames_per_round; ++number)
        touches.push_back(touch_of(number));
    const auto memory = std::make_unique<typename Network::workspace>();
    const auto all = std::make_unique<stages>();
    for (std::size_t d = 0; d < dimensions; ++d)
        for (std::size_t f = 0; f < 256; ++f)
            all->map.directions[f * dimensions + d] = static_cast<float>((f * 7 + d * 3) % 11) - 5;
    for (int i = 0; i < 50; ++i)
        all->health.learn(frame{});
    for (std::size_t c = 0; c < classes; ++c) {
        std::array<float, dimensions> mean{};
        mean[c % dimensions] = static_cast<float>(c + 1);
        (void)all->means.learn(c, mean);
    }
    std::vector<double> of_network, of_all, ratios;
    std::size_t decided = 0;
    bool same = true;
    for (std::size_t round = 0; round <= rounds; ++round) {
        std::size_t expected = 0, found = 0;
        // Time of this process: what else runs on the core does not count.
        const auto time = [](const auto& work) {
            const std::clock_t start = std::clock();
            work();
            return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / frames_per_round;
        };
        const double without = time([&] { expected = alone(network, touches, *memory); });
        const double with = time([&] { found = with_stages(network, touches, *memory, *all, decided); });
        same = same && expected == found; // touches are clean already
        of_network.push_back(1e6 * without), of_all.push_back(1e6 * with), ratios.push_back(with / without);
    }
    const auto median = [](std::vector<double> values) {
        std::sort(values.begin(), values.end());
        return values[values.size() / 2];
    };
    std::printf("| %s | %.2f | %.2f | %.1f |\n", name, median(of_network), median(of_all),
                100 * (median(ratios) - 1));
    return same && decided > 0 && all->health.faults().empty();
}

} // namespace

int main() {
    model<net> trained;
    initialise(trained.network, he_normal{}, 1);
    trained.normalise.scale = 1.0f / 64;
    for (std::size_t c = 0; c < classes; ++c)
        trained.classes.push_back("object" + std::to_string(c));
    std::vector<std::uint8_t> shown;
    for (std::size_t number = 0; number < 40; ++number) {
        const frame touch = touch_of(number);
        shown.insert(shown.end(), touch.begin(), touch.end());
    }
    std::printf(
        "| TactNet-6, 28 x 50 | network alone, us | with all stages, us | more, %% |\n|---|---|---|---|\n");
    const bool right = measure("single precision", deploy(trained));
    const bool right_in_bytes =
        measure("8 bits", deploy<eight_bit>(trained, std::span<const std::uint8_t>(shown)));
    if (!right || !right_in_bytes)
        std::fprintf(stderr, "benchmark_decision_cost: the stages changed an answer\n");
    return right && right_in_bytes ? 0 : 1;
}

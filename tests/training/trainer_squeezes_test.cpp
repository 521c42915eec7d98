// Simulated squeezes that only their course over time tells apart: a quick grasp with a slow release is a
// slow grasp with a quick release in reverse.

#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/quantisation/stream_calibration.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/simulation/contact/contact.hpp>
#include <tactnet/simulation/effects/circuit/conversion.hpp>
#include <tactnet/simulation/effects/film/time.hpp>
#include <tactnet/simulation/objects/object.hpp>
#include <tactnet/simulation/scene.hpp>
#include <tactnet/training.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <support/same_bits.hpp>
#include <type_traits>
#include <vector>

using namespace tactnet;

namespace {

struct squeezes {
    static constexpr shape size{16, 1, 2};
    std::vector<float> values; // of each sequence the pressure of each frame, then the area of each
    std::vector<std::size_t> labels;

    explicit squeezes(std::uint32_t count) {
        namespace sim = simulation;
        sim::scene<sim::array<14, 25>, sim::contact<sim::winkler>, sim::hysteresis, sim::noise,
                   sim::saturation, sim::quantisation<8>>
            sensor;
        values.resize(count * size.size());
        for (std::uint32_t number = 0; number < count; ++number) {
            labels.push_back(number % 2);
            random_stream random(1, random_purposes::order, number);
            const double start = random.uniform(0, 0.3), length = random.uniform(0.5, 0.7),
                         newtons = random.uniform(5, 30), peak = labels.back() == 0 ? 0.2 : 0.8;
            const sim::object ball{{sim::rod::sphere({}, random.uniform(5, 20) * sim::mm)}};
            sensor.reset();
            for (std::uint32_t frame = 0; frame < size.rows; ++frame) {
                const double time = (frame / static_cast<double>(size.rows) - start) / length;
                const double share = time < 0 || time > 1 ? 0
                                     : time < peak        ? time / peak
                                                          : (1 - time) / (1 - peak);
                const sim::touch touch{.shape = ball, .press = sim::pressing::to_force(share * newtons)};
                typename decltype(sensor)::frames seen;
                simulate(sensor, touch, {.seed = number, .frame = frame, .seconds = frame * 0.05}, seen);
                float* const at = values.data() + number * size.size() + frame;
                for (const float pressed : seen.measured) {
                    at[0] += pressed / 20000;
                    at[size.rows] += pressed > 5 ? 1.0F / 350 : 0.0F;
                }
            }
        }
    }
};

template <class Network>
trainer<Network> trained(const squeezes& data, const data_split& split, thread_pool& threads) {
    recipe how = recipe::on_features();
    how.rate = 2e-2;
    how.epochs = 120;
    trainer<Network> training(how, labelled_features{data.values, data.labels, 2}, split, 1, threads);
    while (!training.finished())
        training.run_epoch();
    return training;
}
template <class Network>
double accuracy(const squeezes& data) {
    const data_split split =
        split_data(data.labels, 2, split_rule::random, 1, {.validation = 0.2, .test = 0.3});
    thread_pool threads(1);
    const auto training = trained<Network>(data, split, threads);
    return evaluate(training.best(), training.input_normalisation(),
                    labelled_features{data.values, data.labels, 2}, split.test, threads)
        .confusion.accuracy();
}

} // namespace

TEST_CASE("trainer: a network of sequences learns the course of simulated squeezes, one of frames does not") {
    const squeezes data(240);
    CHECK(accuracy<network<squeezes::size, gru<8>, last_frame, dense<2>>>(data) > 0.9);
    CHECK(accuracy<network<squeezes::size, lstm<8>, last_frame, dense<2>>>(data) > 0.9);
    CHECK(accuracy<network<squeezes::size, causal_conv1d<8, 4>, relu, causal_conv1d<8, 4, 4>, relu,
                           last_frame, dense<2>>>(data) > 0.9);
    // Half of them by guessing; of 72, more than three quarters by chance once in 10⁵ times.
    CHECK(accuracy<network<squeezes::size, last_frame, dense<8>, relu, dense<2>>>(data) < 0.75);
    CHECK(accuracy<network<squeezes::size, causal_conv1d<8, 1>, relu, global_average_pool, dense<2>>>(data) <
          0.75);
}

namespace {

/// How many of the test squeezes a network of two classes recognises frame by frame, in single precision and
/// in 8 bits, and how many there are.
struct recognised {
    std::size_t exact = 0, in_8_bits = 0, all = 0;
};
template <class Network>
recognised recognised_in_streams(const squeezes& data) {
    const data_split split =
        split_data(data.labels, 2, split_rule::random, 1, {.validation = 0.2, .test = 0.3});
    thread_pool threads(1);
    const auto training = trained<Network>(data, split, threads);
    const auto samples_of = [&](const std::vector<std::size_t>& numbers) {
        std::vector<float> samples;
        for (const std::size_t number : numbers)
            for (std::size_t e = 0; e < squeezes::size.size(); ++e)
                samples.push_back(data.values[number * squeezes::size.size() + e]);
        return samples;
    };
    const auto exact = deploy_stream(training.best());
    const auto in_8_bits = deploy_stream<eight_bit>(training.best(), samples_of(split.training));
    recognised found;
    for (const std::size_t number : split.test) {
        const std::vector<float> sample = samples_of({number});
        const auto last_class = [&](const auto& stream) {
            typename std::remove_cvref_t<decltype(stream)>::state memory;
            std::size_t index = 0;
            for (std::size_t frame = 0; frame < squeezes::size.rows; ++frame)
                index =
                    stream.classify(std::array{sample[frame], sample[squeezes::size.rows + frame]}, memory)
                        ->index;
            return index;
        };
        found.exact += last_class(exact) == data.labels[number];
        found.in_8_bits += last_class(in_8_bits) == data.labels[number];
        ++found.all;
    }
    return found;
}

} // namespace

TEST_CASE_TEMPLATE(
    "deployed_stream: in 8 bits, recognises the squeezes that single precision recognises", Network,
    network<squeezes::size, gru<8>, last_frame, dense<2>>,
    network<squeezes::size, lstm<8>, last_frame, dense<2>>,
    network<squeezes::size, causal_conv1d<8, 4>, relu, causal_conv1d<8, 4, 4>, relu, last_frame, dense<2>>) {
    const recognised found = recognised_in_streams<Network>(squeezes(240));
    CHECK(10 * found.exact > 9 * found.all);
    CHECK(found.in_8_bits + 1 >= found.exact); // one of 72 may lie between the classes
}

TEST_CASE("trainer: training through time has the same bits on any number of threads") {
    using net = network<squeezes::size, causal_conv1d<5, 2>, relu, gru<6>, lstm<5>, last_frame, dense<2>>;
    const squeezes data(60);
    const data_split split = split_data(data.labels, 2, split_rule::random, 1);
    thread_pool one(1), three(3);
    const auto alone = trained<net>(data, split, one), shared = trained<net>(data, split, three);
    CHECK(support::same_bits(alone.latest().learnable_values(), shared.latest().learnable_values()));
}

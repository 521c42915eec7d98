// Support vector machines compared with LIBSVM and LIBLINEAR: training and prediction on synthetic clouds
// and, with a folder of images as the argument, on raw pixels. Rounds of both are interleaved, and every
// result is checked: the same answers, the same objective.

#include "../peers/support_vector_machines.hpp"
#include "../support/machine_comparison.hpp"
#include "../support/pixels.hpp"
#include "decode_image.hpp"

#include <tactnet/svm.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

namespace {

using benchmark::agreement;
using tactnet::feature_rows;

template <class Body>
double seconds_of(Body&& body) {
    const auto start = std::chrono::steady_clock::now();
    body();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The fastest of interleaved rounds of two.
struct duel {
    double own = 1e300, peer = 1e300;

    template <class Own, class Peer>
    void round(Own&& own_body, Peer&& peer_body) {
        own = std::min(own, seconds_of(own_body));
        peer = std::min(peer, seconds_of(peer_body));
    }
    void print(const char* what, double unit, const char* unit_name) const {
        std::printf("  %-28s %10.3f %10.3f %-3s %7.1f\n", what, own * unit, peer * unit, unit_name,
                    peer / own);
    }
};

/// Bytes a second that one core reads of a block of that size, again and again; the fastest of 50 rounds.
double reading_speed(std::size_t bytes) {
    const std::vector<std::uint64_t> block(bytes / sizeof(std::uint64_t), 1);
    double fastest = 1e300;
    for (std::size_t round = 0; round < 50; ++round) {
        std::uint64_t sum = 0;
        fastest =
            std::min(fastest, seconds_of([&] { sum = std::accumulate(block.begin(), block.end(), sum); }));
        if (sum != block.size())
            std::abort();
    }
    return static_cast<double>(bytes) / fastest;
}

struct sample_set {
    std::size_t features;
    std::vector<float> values;
    std::vector<std::size_t> labels;
    [[nodiscard]] feature_rows<> rows() const { return {values, features}; }
    [[nodiscard]] feature_rows<> first(std::size_t count) const {
        return {std::span(values).first(std::min(count * features, values.size())), features};
    }
};

sample_set clouds(std::size_t count, std::size_t features, std::size_t classes) {
    tactnet::random_stream random(1, tactnet::random_purposes::order);
    std::vector<double> centres(classes * features);
    for (double& value : centres)
        value = random.uniform(-3, 3);
    sample_set set{features, {}, {}};
    for (std::size_t i = 0; i < count; ++i) {
        set.labels.push_back(i % classes);
        for (std::size_t f = 0; f < features; ++f)
            set.values.push_back(static_cast<float>(centres[i % classes * features + f] + random.normal()));
    }
    return set;
}

template <std::size_t Features>
bool compare_rbf(const char* name, feature_rows<Features> rows, const std::vector<std::size_t>& labels,
                 feature_rows<Features> fresh, std::size_t rounds, bool compare_objective) {
    using machine = tactnet::kernel_machine<tactnet::rbf_kernel, Features>;
    tactnet::thread_pool one;
    const tactnet::kernel_training_options<tactnet::rbf_kernel> options{.cost = 10};
    std::optional<machine> own;
    std::optional<benchmark::libsvm_machine> peer;
    double objective = 0;
    bool converged = true;
    const double gamma = *tactnet::rbf_kernel{}.fitted(rows).gamma;
    duel training, batch, single;
    for (std::size_t r = 0; r < rounds; ++r)
        training.round(
            [&] {
                auto result = tactnet::train_kernel_machine(rows, labels, options, one);
                objective = 0;
                for (const auto& report : result.reports)
                    objective += report.objective;
                converged = result.converged();
                own.emplace(std::move(result.machine));
            },
            [&] { peer.emplace(rows, labels, gamma, options.cost); });
    std::vector<std::size_t> found, expected, alone(fresh.size());
    for (std::size_t r = 0; r < 3 * rounds; ++r) {
        batch.round([&] { found = own->predict(fresh, one); }, [&] { expected = peer->predict(fresh); });
        single.round(
            [&] {
                for (std::size_t i = 0; i < fresh.size(); ++i)
                    alone[i] = own->predict(fresh.row(i));
            },
            [&] { expected = peer->predict(fresh); });
    }
    const double same = agreement(found, expected), count = static_cast<double>(fresh.size());
    std::printf("%s: %zu rows of %zu features, C = 10; %zu and %zu support vectors, %.2f %% same answers\n",
                name, rows.size(), rows.features(), own->support_vectors(), peer->support_vectors(),
                100 * same);
    training.print("RBF, train", 1e3, "ms");
    single.print("RBF, predict, one row", 1e6 / count, "us");
    // One row meets each support vector once: it can be no faster than these are read.
    const std::size_t bytes = own->support_vectors() * rows.features() * sizeof(float);
    std::printf("    reads %.1f MB at %.0f GB/s; a sum over as many bytes, %.0f GB/s\n",
                1e-6 * static_cast<double>(bytes), 1e-9 * static_cast<double>(bytes) * count / single.own,
                1e-9 * reading_speed(bytes));
    batch.print("RBF, predict, a row of a batch", 1e6 / count, "us");
    bool good = converged && same >= 0.995 && alone == found;
    if (compare_objective) {
        const double off = std::abs(objective / peer->objective() - 1);
        std::printf("  objectives differ by %.1e\n", off);
        good = good && off <= 1e-3;
    }
    return good;
}

template <std::size_t Features>
bool compare_linear(feature_rows<Features> rows, const std::vector<std::size_t>& labels,
                    feature_rows<Features> fresh, std::size_t rounds) {
    tactnet::thread_pool one;
    const tactnet::linear_training_options options{};
    std::optional<tactnet::linear_machine<Features>> own;
    std::optional<benchmark::liblinear_machine> peer;
    duel training;
    for (std::size_t r = 0; r < rounds; ++r)
        training.round(
            [&] { own.emplace(tactnet::train_linear_machine(rows, labels, options, one).machine); },
            [&] { peer.emplace(rows, labels, options.solver.loss, options.cost, options.solver.tolerance); });
    const auto objective = [&](auto&& weights) {
        return benchmark::primal_objective(rows, labels, options.solver.loss, options.cost, own->classes(),
                                           weights);
    };
    const double own_primal =
        objective([&](std::size_t c) { return benchmark::weights_of(own->parameters(), c); });
    const double peer_primal = objective([&](std::size_t c) { return peer->weights(c); });
    training.print("linear, train (C = 1)", 1e3, "ms");
    const double same = agreement(own->predict(fresh), peer->predict(fresh));
    std::printf("  linear: primal objectives %.4f and %.4f, %.2f %% same answers\n", own_primal, peer_primal,
                100 * same);
    return own_primal <= 1.001 * peer_primal;
}

/// Mean and deviation of numbers.
struct spread {
    double sum = 0, squares = 0, count = 0;

    void add(double value) {
        sum += value;
        squares += value * value;
        count += 1;
    }
    [[nodiscard]] double mean() const { return sum / count; }
    [[nodiscard]] double deviation() const { return std::sqrt((squares - sum * mean()) / (count - 1)); }
};

/// Accuracy of RBF on raw pixels over random splits, and LIBSVM's on the same splits.
bool measure_accuracy(const tactnet::image_set& images) {
    constexpr std::size_t splits = 10;
    tactnet::thread_pool one;
    spread own, peer;
    for (std::size_t s = 1; s <= splits; ++s) {
        const auto split = benchmark::split_pixels(images, s);
        const tactnet::kernel_training_options<tactnet::rbf_kernel> options{.cost = 10};
        const auto machine =
            tactnet::train_kernel_machine(split.training.view(), split.training.labels, options, one).machine;
        const benchmark::libsvm_machine other(split.training.view(), split.training.labels,
                                              *machine.parameters().kernel.gamma, options.cost);
        own.add(100 * agreement(machine.predict(split.test.view(), one), split.test.labels));
        peer.add(100 * agreement(other.predict(split.test.view()), split.test.labels));
    }
    std::printf("  RBF, accuracy over %zu splits: %.2f ± %.2f %%, LIBSVM %.2f ± %.2f %%\n", splits,
                own.mean(), own.deviation(), peer.mean(), peer.deviation());
    return own.mean() >= peer.mean() - 0.5;
}

} // namespace

int main(int count, char** arguments) {
    try {
        std::printf("one core, fastest of interleaved rounds\n  %-28s %10s %10s     %7s\n", "", "tactnet",
                    "peer", "ratio");
        bool good = true;
        if (count > 1) {
            const auto images = benchmark::load_pixels(arguments[1], decode_image);
            const auto split = benchmark::split_pixels(images, 1);
            good = compare_rbf("raw pixels", split.training.view(), split.training.labels, split.test.view(),
                               5, true);
            good = compare_linear(split.training.view(), split.training.labels, split.test.view(), 7) && good;
            good = measure_accuracy(images) && good;
        } else {
            std::puts("(without a folder of images: no raw pixels)");
        }
        const sample_set set = clouds(20'000, 128, 22);
        good = compare_rbf("22 clouds", feature_rows<128>(set.values), set.labels,
                           feature_rows<128>(set.first(500).values()), 1, false) &&
               good;
        return good ? EXIT_SUCCESS : EXIT_FAILURE;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return EXIT_FAILURE;
    }
}

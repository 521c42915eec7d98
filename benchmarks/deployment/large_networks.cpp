// Large networks, deployed and in oneDNN, in turns: one network, batch and number of threads a run. Both must
// agree before they are timed, and give the same bits afterwards. Memory of both is kept from call to call.
// With one thread, small networks are also measured in 8 bits, in turns with single precision.
// Run it pinned to as many idle cores as it has threads; with several threads set OMP_WAIT_POLICY=passive,
// else oneDNN's waiting threads take cores from the other measurement.

#include "large_networks.hpp"

#include <tactnet/runtime/random.hpp>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <stdexcept>

namespace {

constexpr const char* usage = "benchmark_large_networks NETWORK [BATCH [THREADS [TURNS]]] [--table=FILE]\n"
                              "  1 frame, 1 thread and 15 turns unless told. --table adds a line of CSV to a "
                              "file. Networks:";

struct options {
    std::string network, table;
    std::size_t batch = 1, threads = 1, turns = 15;
};

options parse(const std::vector<std::string>& words) {
    options o;
    std::size_t* const numbers[] = {&o.batch, &o.threads, &o.turns};
    std::size_t place = 0;
    for (const std::string& word : words)
        if (word.starts_with("--table=")) {
            o.table = word.substr(8);
        } else if (place == 0) {
            o.network = word, ++place;
        } else {
            const char* const end = word.data() + word.size();
            if (place > std::size(numbers))
                throw std::invalid_argument("expected at most 4 words, found " + word + " as well");
            std::size_t& number = *numbers[place++ - 1];
            if (std::from_chars(word.data(), end, number).ptr != end || number == 0 || number > 100'000)
                throw std::invalid_argument("expected a number from 1 to 100000, found " + word);
        }
    return o;
}

const benchmark::large_network_case& find(const std::string& name) {
    for (const auto& c : benchmark::large_network_cases())
        if (c.name == name)
            return c;
    throw std::invalid_argument("expected a network of the list below, found \"" + name + '"');
}

/// Refuses results that are further apart than `bound` times the largest, and returns their distance.
double check_agreement(const std::vector<float>& ours, const std::vector<float>& theirs, double bound) {
    double distance = 0, largest = 0;
    for (std::size_t i = 0; i < ours.size(); ++i) {
        // Written so that NaN does not pass.
        const double apart = std::abs(static_cast<double>(ours[i]) - static_cast<double>(theirs[i]));
        distance = apart <= distance ? distance : apart;
        largest = std::max(largest, std::abs(static_cast<double>(theirs[i])));
    }
    if (!(distance <= bound * largest) || largest == 0)
        throw std::runtime_error("expected results within " + std::to_string(bound) +
                                 " of the largest, found " + std::to_string(distance) + " of " +
                                 std::to_string(largest));
    return distance / largest;
}

template <class Body>
double milliseconds(Body&& body) {
    const auto start = std::chrono::steady_clock::now();
    body();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// The spread is half the distance of the quartiles, as a share of the median.
struct summary {
    double fastest, median, spread;

    explicit summary(std::vector<double> times) {
        std::sort(times.begin(), times.end());
        fastest = times.front(), median = times[times.size() / 2];
        spread = (times[times.size() * 3 / 4] - times[times.size() / 4]) / 2 / median;
    }
};

void add_line(const options& o, const std::string& name, const summary& ours, const summary& theirs,
              double distance) {
    std::FILE* const file = std::fopen(o.table.c_str(), "a");
    if (!file)
        throw std::runtime_error("cannot write " + o.table);
    std::fseek(file, 0, SEEK_END);
    if (std::ftell(file) == 0)
        std::fprintf(file,
                     "network,batch,threads,turns,tactnet_ms,tactnet_spread,tactnet_fastest_ms,onednn_ms,"
                     "onednn_spread,onednn_fastest_ms,ratio,ratio_of_fastest,distance\n");
    std::fprintf(file, "%s,%zu,%zu,%zu,%.4g,%.3g,%.4g,%.4g,%.3g,%.4g,%.4g,%.4g,%.2g\n", name.c_str(), o.batch,
                 o.threads, o.turns, ours.median, ours.spread, ours.fastest, theirs.median, theirs.spread,
                 theirs.fastest, theirs.median / ours.median, theirs.fastest / ours.fastest, distance);
    if (std::fclose(file) != 0)
        throw std::runtime_error("cannot write " + o.table);
}

/// In 8 bits, on frames of bytes; both must be near single precision.
void measure_8bit(const options& o, const benchmark::large_network& network) {
    constexpr double byte_tolerance = 0.1; // as in inference.hpp
    std::vector<std::uint8_t> frames(o.batch * network.inputs);
    tactnet::random_stream random(3, tactnet::random_purposes::order);
    for (std::uint8_t& f : frames)
        f = static_cast<std::uint8_t>(random.uniform(0, 256));
    const std::vector<float> counts(frames.begin(), frames.end());
    const auto peer = network.make_peer_8bit(frames);
    std::vector<float> exact(o.batch * network.outputs), ours(exact.size()), theirs(exact.size());
    const auto single = [&] { network.deployed(counts, exact); };
    const auto own = [&] { network.deployed_8bit(frames, ours); };
    const auto run_peer = [&] { peer->run(frames, theirs); };

    single(), own(), run_peer();
    const double distance = check_agreement(ours, exact, byte_tolerance),
                 distance_of_peer = check_agreement(theirs, exact, byte_tolerance);
    const std::vector<float> first = ours, first_of_peer = theirs;
    std::vector<double> times, our_times, their_times, ratios, to_single;
    for (std::size_t turn = 0; turn < o.turns; ++turn) {
        times.push_back(milliseconds(single));
        our_times.push_back(milliseconds(own));
        their_times.push_back(milliseconds(run_peer));
        ratios.push_back(their_times.back() / our_times.back());
        to_single.push_back(times.back() / our_times.back());
    }
    if (ours != first || theirs != first_of_peer)
        throw std::runtime_error("results in 8 bits differ from turn to turn");
    const summary a(our_times), b(their_times);
    std::printf("in 8 bits: tactnet %.3f ± %.1f %%, onednn %.3f ± %.1f %%, single precision %.3f; distances "
                "from it %.1e and %.1e\n",
                a.median, 100 * a.spread, b.median, 100 * b.spread, summary(times).median, distance,
                distance_of_peer);
    const auto print_ratio = [](const char* name, std::vector<double> values) {
        std::sort(values.begin(), values.end());
        const std::size_t n = values.size();
        std::printf("  %s: median %.2f, quartiles %.2f … %.2f\n", name, values[n / 2], values[n / 4],
                    values[n * 3 / 4]);
    };
    print_ratio("onednn ÷ tactnet, both in 8 bits", ratios);
    print_ratio("tactnet, single precision ÷ 8 bits", to_single);
    if (!o.table.empty())
        add_line(o, o.network + " in 8 bits", a, b, distance);
}

void measure(const options& o) {
    const benchmark::large_network network = find(o.network).make(o.batch, o.threads);
    std::vector<float> frames(o.batch * network.inputs), ours(o.batch * network.outputs), theirs(ours.size());
    tactnet::random_stream random(3, tactnet::random_purposes::order);
    for (float& f : frames)
        f = static_cast<float>(random.uniform(-2, 2));
    const auto deployed = [&] { network.deployed(frames, ours); };
    const auto run_peer = [&] { network.peer->run(frames, theirs); };

    deployed(), run_peer();
    // What rounding explains: a unit roundoff for every term of the sums behind one output.
    const double distance = check_agreement(ours, theirs,
                                            static_cast<double>(std::numeric_limits<float>::epsilon()) / 2 *
                                                static_cast<double>(network.longest_sums));
    const std::vector<float> first = ours, first_of_peer = theirs;
    std::vector<double> our_times, their_times;
    for (std::size_t turn = 0; turn < o.turns; ++turn) {
        our_times.push_back(milliseconds(deployed));
        their_times.push_back(milliseconds(run_peer));
    }
    if (ours != first || theirs != first_of_peer)
        throw std::runtime_error("results differ from turn to turn");

    const summary a(our_times), b(their_times);
    std::printf(
        "batch %zu, threads %zu, %zu turns, milliseconds a batch (median, half the quartiles' distance; "
        "fastest)\n%-16s %28s %28s %8s %8s %9s\n",
        o.batch, o.threads, o.turns, "network", "tactnet", "onednn", "ratio", "fastest", "distance");
    std::printf("%-16s %9.2f ± %4.1f %% %9.2f %9.2f ± %4.1f %% %9.2f %8.2f %8.2f %9.1e\n", o.network.c_str(),
                a.median, 100 * a.spread, a.fastest, b.median, 100 * b.spread, b.fastest, b.median / a.median,
                b.fastest / a.fastest, distance);
    if (!o.table.empty())
        add_line(o, o.network, a, b, distance);
    if (network.deployed_8bit)
        measure_8bit(o, network);
}

} // namespace

int main(int argc, char** argv) try {
    measure(parse({argv + 1, argv + argc}));
    return EXIT_SUCCESS;
} catch (const std::invalid_argument& wrong) {
    std::fprintf(stderr, "%s\n%s", wrong.what(), usage);
    for (const auto& c : benchmark::large_network_cases())
        std::fprintf(stderr, " %s", c.name.c_str());
    std::fprintf(stderr, "\n");
    return EXIT_FAILURE;
} catch (const std::exception& wrong) {
    std::fprintf(stderr, "%s\n", wrong.what());
    return EXIT_FAILURE;
}

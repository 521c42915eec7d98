// Microseconds of the SURF baseline's features: one image of 28 × 50 tactels to its histogram of 500 words,
// on one core, and how they divide into descriptors and the search for the nearest words. Beside them, in
// turns, a loop of multiply-adds in registers: what the search could reach on this machine at this moment.

#include "../support/peak.hpp"

#include <tactnet/features.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <vector>

namespace {

constexpr tactnet::shape size{28, 50};
constexpr std::size_t words = 500, images = 44, rounds = 300;
using surf = tactnet::dense_surf<size>;

/// Bars, discs and edges at random places on sensor noise: most of an image is in contact, as with the
/// largest of the paper's objects.
std::vector<std::uint8_t> touches() {
    std::vector<std::uint8_t> pixels(images * size.size());
    for (std::uint32_t i = 0; i < images; ++i) {
        tactnet::random_stream random(1, tactnet::random_purposes::order, i);
        const double angle = random.uniform(0, 3), bend = random.uniform(0, 0.05);
        const double row = random.uniform(8, 20), column = random.uniform(15, 35),
                     width = random.uniform(2, 9);
        for (std::size_t e = 0; e < size.size(); ++e) {
            const double y = static_cast<double>(e / size.columns) - row,
                         x = static_cast<double>(e % size.columns) - column;
            const double across = std::cos(angle) * y - std::sin(angle) * x + bend * x * x;
            const double pressure = 120 * std::max(0.0, 1 - std::abs(across) / width);
            pixels[i * size.size() + e] = static_cast<std::uint8_t>(pressure + random.uniform(0, 10));
        }
    }
    return pixels;
}

/// Microseconds of body().
template <class Body>
double time(Body&& body) {
    const auto start = std::chrono::steady_clock::now();
    body();
    return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
}

void print(const char* name, const std::vector<double>& microseconds, double whole) {
    std::printf("%-22s %9.1f %9.1f %7.0f%%\n", name,
                *std::min_element(microseconds.begin(), microseconds.end()), median(microseconds),
                100 * median(microseconds) / whole);
}

} // namespace

int main() {
    const std::vector<std::uint8_t> pixels = touches();
    std::vector<std::size_t> all(images);
    std::iota(all.begin(), all.end(), std::size_t{0});
    tactnet::thread_pool one(1);
    const auto bag = tactnet::fit_surf_words<surf, words>(pixels, all, {}, one);
    const auto expected =
        tactnet::surf_histograms<surf>(std::span<const std::uint8_t>(pixels), all, bag, one);

    surf memory;
    std::array<float, words> histogram;
    std::vector<double> describing, searching, together, peak;
    std::size_t descriptors = 0;
    bool same = true;
    float check = 1;
    for (std::size_t round = 0; round < rounds; ++round) {
        const std::size_t image = round % images;
        const surf::image_view view(pixels.data() + image * size.size());
        bool finite = true;
        const double describe = time([&] { finite = memory.describe(view) && finite; });
        const double search = time([&] { bag.encode(memory.descriptors(), histogram); });
        same = same && std::equal(histogram.begin(), histogram.end(),
                                  expected.begin() + static_cast<std::ptrdiff_t>(image * words));
        const double both = time(
            [&] { finite = tactnet::surf_histogram(memory, bag, view, std::span(histogram)) && finite; });
        same = same && finite;
        const double loop = time([&] { check = std::isfinite(benchmark::run_chains(check)) ? 1.0f : 0.0f; });
        describing.push_back(describe), searching.push_back(search), together.push_back(both);
        peak.push_back(static_cast<double>(benchmark::multiply_adds_of_chains) / loop);
        descriptors += memory.places().size();
    }
    const double whole = median(together);
    std::printf("28x50, %zu words, %.0f descriptors an image, microseconds\n%-22s %9s %9s %8s\n", words,
                static_cast<double>(descriptors) / rounds, "", "fastest", "median", "share");
    print("descriptors", describing, whole);
    print("nearest words", searching, whole);
    print("image to histogram", together, whole);
    const double multiply_adds = static_cast<double>(descriptors) / rounds * words * tactnet::surf_values;
    std::printf("nearest words: %.0f %% of the core's multiply-adds a second\n",
                100 * multiply_adds / median(searching) / median(peak));
    if (!same || check != 1.0f)
        std::printf("DIFFERENT results from call to call\n");
    return same && check == 1.0f ? EXIT_SUCCESS : EXIT_FAILURE;
}

// Microseconds of what happens between an object and the film, on 28 × 50 cells and one core: the springs and
// the layer under a ball and under a tilted box, the pad, and the convolution that the layer is found with.
// All in turns, the fastest and the median of many rounds. Run it pinned to an idle core.

#include <tactnet/kernels/map/symmetric_convolution.hpp>
#include <tactnet/simulation/contact/contact.hpp>
#include <tactnet/simulation/contact/elastic.hpp>
#include <tactnet/simulation/effects/mechanics.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace {

using namespace tactnet::simulation;
using tactnet::shape;

constexpr shape size{28, 50};
constexpr double cell = 1.903e-3;
constexpr std::size_t rounds = 400;
using map = tactnet::tensor<float, size>;

template <class Height>
map heights_of(const Height& height) {
    map result;
    for (std::size_t y = 0; y < size.rows; ++y)
        for (std::size_t x = 0; x < size.columns; ++x)
            result(y, x) = static_cast<float>(
                height((static_cast<double>(y) - 13.5) * cell, (static_cast<double>(x) - 24.5) * cell));
    return result;
}
double force_of(const map& pressures) {
    double sum = 0;
    for (const float pressure : pressures)
        sum += static_cast<double>(pressure);
    return sum * cell * cell;
}

/// What is timed, and whether its last result is right.
struct entry {
    std::string name;
    std::function<void()> run;
    std::function<bool()> right;
    std::function<std::size_t()> iterations = [] { return std::size_t{0}; };
    std::vector<double> microseconds{};
};

template <class Model>
entry contact_entry(std::string name, const Model& model, const map& heights, double force) {
    struct touch {
        typename Model::template bound<size> bound;
        map heights, pressures;
        contact_report report;
    };
    const auto all =
        std::make_shared<touch>(touch{typename Model::template bound<size>(model, cell), heights, {}, {}});
    return {
        std::move(name),
        [=] {
            all->report =
                all->bound.solve(all->heights.view(), pressing::to_force(force), all->pressures.view());
        },
        [=] { return all->report.converged && std::abs(force_of(all->pressures) - force) < 1e-3 * force; },
        [=] { return all->report.iterations; }};
}

entry pad_entry(std::string name, double thickness, const map& pressures) {
    struct felt {
        elastic_pad::bound<size> bound;
        map surface, film;
    };
    const auto all = std::make_shared<felt>(
        felt{elastic_pad::bound<size>({.thickness = thickness}, {.cell = cell}), pressures, {}});
    return {std::move(name),
            [=] {
                all->film = all->surface;
                all->bound.apply(all->film.view(), {});
            },
            [=] {
                const double force = force_of(all->film), pressed = force_of(all->surface);
                return force > 0.9 * pressed && force < 1.0001 * pressed;
            }};
}

entry convolution_entry() {
    using convolution = tactnet::kernels::symmetric_convolution<size>;
    struct transform {
        convolution convolver;
        convolution::spectrum spectrum;
        tactnet::aligned_vector<double> from, to;
    };
    const auto all =
        std::make_shared<transform>(transform{{},
                                              {},
                                              tactnet::aligned_vector<double>(convolution::size, 0.0),
                                              tactnet::aligned_vector<double>(convolution::size, 0.0)});
    const auto kernel = [](std::size_t y, std::size_t x) { return half_space_influence(y, x, 1); };
    all->spectrum = all->convolver.spectrum_of(kernel);
    all->from[10 * convolution::stride + 20] = 1;
    return {"convolution", [=] { all->convolver.convolve(all->spectrum, all->from.data(), all->to.data()); },
            [=] { return std::abs(all->to[12 * convolution::stride + 27] - kernel(2, 7)) < 1e-12; }};
}

/// Microseconds of body().
double time(const std::function<void()>& body) {
    const auto start = std::chrono::steady_clock::now();
    body();
    return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

} // namespace

int main() {
    const map ball = heights_of([](double y, double x) { return (x * x + y * y) / 0.04; });
    const map box = heights_of([](double y, double x) {
        const double beyond =
            std::hypot(std::max(std::abs(y) - 0.015, 0.0), std::max(std::abs(x) - 0.03, 0.0));
        return beyond * beyond / 0.004 + 0.004 * x;
    });
    map even;
    std::fill(even.begin(), even.end(), 5000.0f);
    const bonded_layer foam{}, incompressible{.young = 1e5, .poisson = 0.5, .thickness = 3e-3};
    std::vector<entry> entries;
    entries.push_back(contact_entry("springs, ball", winkler{}, ball, 10));
    entries.push_back(contact_entry("springs, box", winkler{}, box, 30));
    entries.push_back(contact_entry("layer, ball", foam, ball, 10));
    entries.push_back(contact_entry("layer, box", foam, box, 30));
    entries.push_back(contact_entry("layer of nu 1/2, box", incompressible, box, 30));
    entries.push_back(contact_entry("half space, box", elastic_half_space{}, box, 30));
    entries.push_back(pad_entry("pad of 1 mm", 1e-3, even));
    entries.push_back(pad_entry("pad of 3 mm", 3e-3, even));
    entries.push_back(convolution_entry());

    for (std::size_t round = 0; round <= rounds; ++round)
        for (entry& each : entries) {
            const double microseconds = time(each.run);
            if (round > 0) // the first warms up
                each.microseconds.push_back(microseconds);
        }
    bool right = true;
    std::printf("28x50, microseconds\n%-24s %9s %9s %11s\n", "", "fastest", "median", "iterations");
    for (entry& each : entries) {
        std::sort(each.microseconds.begin(), each.microseconds.end());
        std::printf("%-24s %9.1f %9.1f %11zu\n", each.name.c_str(), each.microseconds.front(),
                    each.microseconds[rounds / 2], each.iterations());
        if (!each.right()) {
            std::printf("WRONG result of %s\n", each.name.c_str());
            right = false;
        }
    }
    return right ? EXIT_SUCCESS : EXIT_FAILURE;
}

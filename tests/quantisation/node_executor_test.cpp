#include <tactnet/operators/activations/function.hpp>
#include <tactnet/quantisation/node_executor.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <vector>

// One convolution by plain loops, with small whole numbers: sums are exact, so every number is known.

using namespace tactnet;
using detail::calibration_graph;
using detail::convolution_reference;
using detail::node_executor;

namespace {

/// Weights in steps of ½ with half a step between, inputs that are whole: all sums are below 2¹⁶ quarters.
struct drawn_step {
    kernels::frame_convolution kernel;
    calibration_graph net;
    std::vector<float> folded, maps;

    drawn_step(const sliding_window& window, std::size_t groups, std::size_t filters, extent2d pool,
               bool relu, bool accumulates, std::size_t first, std::uint32_t seed)
        : kernel{.window = window,
                 .filters = filters,
                 .input_stride = window.input.channels,
                 .pool = pool,
                 .activation = relu ? fused<relu_function> : &kernels::no_activation,
                 .accumulates = accumulates,
                 .groups = groups,
                 .map_offset = first} {
        net.ranges = 3;
        const shape sums{window.output_rows(), window.output_columns(), filters};
        const shape to{(sums.rows + pool.rows - 1) / pool.rows,
                       (sums.columns + pool.columns - 1) / pool.columns, filters + first};
        net.nodes.push_back({.convolution = &kernel,
                             .input = net.add_map(window.input, 0),
                             .added = net.add_map(sums, 1),
                             .output = net.add_map(to, 2),
                             .folded = 3});
        std::mt19937 draw(seed);
        const auto next = [&](int most) {
            return static_cast<float>(static_cast<int>(draw() % static_cast<unsigned>(2 * most + 1)) - most);
        };
        folded.assign(3, 1e9f); // what is in front is not its own
        for (std::size_t i = 0; i < filters * kernel.taps(); ++i)
            folded.push_back(next(9) / 4);
        for (std::size_t f = 0; f < filters; ++f)
            folded.push_back(next(20) / 4);
        folded.insert(folded.end(), filters, 0.5f);
        for (std::size_t i = 0; i < net.numbers; ++i)
            maps.push_back(next(7));
    }
    /// The sum of a filter at a pixel; none outside the map. Weights are rounded to halves, ties to the even
    /// number of them.
    [[nodiscard]] std::optional<double> sum_at(std::size_t filter, std::size_t y, std::size_t x,
                                               bool rounded) const {
        const sliding_window& w = kernel.window;
        if (y >= w.output_rows() || x >= w.output_columns())
            return {};
        const std::size_t of_group = w.input.channels / kernel.groups,
                          begin = filter / (kernel.filters / kernel.groups) * of_group;
        double sum = folded[3 + kernel.filters * kernel.taps() + filter];
        const float* weight = &folded[3 + filter * kernel.taps()];
        for (std::size_t c = begin; c < begin + of_group; ++c) // [channel][row][column]
            for (std::size_t i = 0; i < w.kernel.rows; ++i)
                for (std::size_t j = 0; j < w.kernel.columns; ++j, ++weight) {
                    const auto row = static_cast<std::ptrdiff_t>(y * w.stride.rows + i) -
                                     static_cast<std::ptrdiff_t>(w.top);
                    const auto column = static_cast<std::ptrdiff_t>(x * w.stride.columns + j) -
                                        static_cast<std::ptrdiff_t>(w.left);
                    if (row < 0 || column < 0 || row >= static_cast<std::ptrdiff_t>(w.input.rows) ||
                        column >= static_cast<std::ptrdiff_t>(w.input.columns))
                        continue;
                    const double exact = static_cast<double>(*weight);
                    const std::size_t pixel =
                        static_cast<std::size_t>(row) * w.input.columns + static_cast<std::size_t>(column);
                    sum += (rounded ? std::nearbyint(exact * 2) / 2 : exact) *
                           static_cast<double>(maps[pixel * w.input.channels + c]);
                }
        if (kernel.accumulates)
            sum += static_cast<double>(
                maps[net.maps[1].begin + (y * w.output_columns() + x) * kernel.filters + filter]);
        return sum;
    }
    /// How many numbers of all maps are others than they should be, once the step has run.
    [[nodiscard]] std::size_t wrong(bool rounded, const map_range& range) const {
        const shape to = net.maps[2].size;
        std::vector<float> expected = maps, found = maps;
        for (std::size_t y = 0; y < to.rows; ++y)
            for (std::size_t x = 0; x < to.columns; ++x)
                for (std::size_t f = 0; f < kernel.filters; ++f) {
                    std::optional<double> most;
                    for (std::size_t i = 0; i < kernel.pool.rows; ++i)
                        for (std::size_t j = 0; j < kernel.pool.columns; ++j)
                            if (const auto sum =
                                    sum_at(f, y * kernel.pool.rows + i, x * kernel.pool.columns + j, rounded))
                                most = most ? std::max(*most, *sum) : *sum;
                    double number = kernel.rectifies() ? std::max(*most, 0.0) : *most;
                    if (rounded) { // scales are powers of two: quotients are exact
                        const double byte = std::clamp(
                            std::nearbyint(number / static_cast<double>(range.scale)) + range.zero_point, 0.0,
                            255.0);
                        number =
                            (byte - static_cast<double>(range.zero_point)) * static_cast<double>(range.scale);
                    }
                    expected[net.maps[2].begin + (y * to.columns + x) * to.channels + kernel.map_offset + f] =
                        static_cast<float>(number);
                }
        node_executor(net, net.nodes[0], folded, rounded).run(found.data(), range);
        std::size_t different = 0;
        for (std::size_t i = 0; i < found.size(); ++i)
            different += found[i] != expected[i];
        return different;
    }
};

const std::array ranges{map_range{0.5f, 40}, map_range{2, 128}, map_range{0.25f, 7}};

} // namespace

TEST_CASE(
    "node_executor: a convolution writes the sums of plain loops, exact and rounded, and nothing else") {
    std::uint32_t seed = 0;
    const auto check = [&](const sliding_window& w, std::size_t groups, std::size_t filters, extent2d pool,
                           std::size_t first) {
        for (const bool relu : {false, true})
            for (const bool accumulates : {false, true}) {
                const drawn_step drawn(w, groups, filters, pool, relu, accumulates, first, ++seed);
                CAPTURE(seed);
                CHECK(drawn.wrong(false, {}) == 0);
                for (const map_range& range : ranges)
                    CHECK(drawn.wrong(true, range) == 0);
            }
    };
    check({{5, 4, 3}, extent2d(1, 1), 1}, 1, 2, 1, 0);
    check({{5, 4, 3}, extent2d(5, 4), 1}, 1, 19, 1, 0); // dense; more filters than a vector has lanes
    check({{6, 7, 2}, extent2d(2, 3), extent2d(2, 1), 1, 0, 0, 2}, 1, 3, 1, 4);
    check({{6, 7, 4}, extent2d(3, 3), 1, 1, 1, 1, 1}, 2, 6, extent2d(2, 3), 0); // pools past the last column
    check({{4, 4, 6}, extent2d(3, 2), 1, 2, 0, 1, 0}, 3, 3, 2, 5);
}

TEST_CASE("node_executor: outputs are not rounded, their weights are") {
    drawn_step drawn({{5, 4, 3}, extent2d(2, 2), 1}, 1, 4, 1, false, false, 0, 50);
    drawn.net.maps[2].range = calibration_graph::none;
    std::vector<float> found = drawn.maps;
    node_executor(drawn.net, drawn.net.nodes[0], drawn.folded, true).run(found.data(), {1000, 0});
    const shape to = drawn.net.maps[2].size;
    for (std::size_t pixel = 0; pixel < to.area(); ++pixel)
        for (std::size_t f = 0; f < 4; ++f)
            CHECK(static_cast<double>(found[drawn.net.maps[2].begin + pixel * 4 + f]) ==
                  *drawn.sum_at(f, pixel / to.columns, pixel % to.columns, true));
}

TEST_CASE("convolution_reference: the sums of a pixel lie at place_of, and each tap is visited once") {
    const drawn_step drawn({{6, 7, 4}, extent2d(3, 3), 1, 1, 1, 1, 1}, 2, 6, 1, true, true, 0, 60);
    const std::size_t taps = drawn.kernel.taps();
    const convolution_reference run(drawn.kernel, drawn.folded.data() + 3, false);
    convolution_reference::sums sums = run.make_sums();
    const float *const in = drawn.maps.data(), *const added = in + drawn.net.maps[1].begin;
    for (std::size_t y = 0; y < 6; ++y)
        for (std::size_t x = 0; x < 7; ++x) {
            run.sums_at(in, added, y, x, sums);
            for (std::size_t f = 0; f < 6; ++f)
                CHECK(static_cast<double>(sums[run.place_of(f)]) == *drawn.sum_at(f, y, x, false));
            std::vector<int> visits(2 * taps);
            run.for_each_tap(y, x, [&](std::size_t group, std::size_t tap, std::size_t place) {
                ++visits[group * taps + tap];
                CHECK(place % 4 / 2 == group);
                CHECK(place < drawn.net.maps[0].size.size());
            });
            const std::size_t rows = y == 0 || y == 5 ? 2 : 3, columns = x == 0 || x == 6 ? 2 : 3;
            CHECK(std::ranges::count(visits, 1) == static_cast<std::ptrdiff_t>(4 * rows * columns));
            CHECK(std::ranges::count(visits, 0) ==
                  static_cast<std::ptrdiff_t>(visits.size() - 4 * rows * columns));
        }
}

TEST_CASE("node_executor: any other step runs its function and rounds to even steps") {
    calibration_graph net;
    net.ranges = 2;
    // Numbers less than its one folded number become it.
    net.nodes.push_back({.reference =
                             [](const float* numbers, const float* in, const float*, float* out) {
                                 for (std::size_t e = 0; e < 5; ++e)
                                     out[e] = std::max(in[e], numbers[0]);
                             },
                         .input = net.add_map({1, 5}, 0),
                         .output = net.add_map({1, 5}, 1),
                         .folded = 1});
    const std::vector<float> folded{9, -3};
    std::vector<float> exact{-4, -2.5f, 0.25f, 0.75f, 200, 0, 0, 0, 0, 0}, rounded = exact;
    node_executor(net, net.nodes[0], folded, false).run(exact.data(), {0.5f, 4});
    CHECK(std::vector<float>(exact.begin() + 5, exact.end()) ==
          std::vector<float>{-3, -2.5f, 0.25f, 0.75f, 200});
    // Bytes are −2 (so 0), −1 (so 0), 4, 6 and 404 (so 255), of a zero of 4.
    node_executor(net, net.nodes[0], folded, true).run(rounded.data(), {0.5f, 4});
    CHECK(std::vector<float>(rounded.begin() + 5, rounded.end()) == std::vector<float>{-2, -2, 0, 1, 125.5f});
}

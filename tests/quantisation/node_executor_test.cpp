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
using detail::graph_node;
using detail::node_executor;

namespace {

/// Weights in steps of ½ with half a step between, inputs that are whole: all sums are below 2¹⁶ quarters.
struct drawn_step {
    calibration_graph net;
    std::vector<float> folded, maps;

    drawn_step(const sliding_window& window, std::size_t groups, std::size_t filters, extent2d pool,
               bool relu, bool accumulates, std::size_t first, std::uint32_t seed) {
        net.ranges = 3;
        const shape sums{window.output_rows(), window.output_columns(), filters};
        const shape to{(sums.rows + pool.rows - 1) / pool.rows,
                       (sums.columns + pool.columns - 1) / pool.columns, filters + first};
        graph_node step{.window = window, .groups = groups, .filters = filters, .pool = pool};
        step.relu = relu, step.accumulates = accumulates, step.first = first;
        step.input = net.add_map(window.input, 0);
        step.added = net.add_map(sums, 1);
        step.output = net.add_map(to, 2);
        step.from = window.input, step.to = to, step.folded = 3;
        net.nodes.push_back(step);
        std::mt19937 draw(seed);
        const auto next = [&](int most) {
            return static_cast<float>(static_cast<int>(draw() % static_cast<unsigned>(2 * most + 1)) - most);
        };
        folded.assign(3, 1e9f); // what is in front is not its own
        for (std::size_t i = 0; i < filters * step.taps(); ++i)
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
        const graph_node& step = net.nodes[0];
        const sliding_window& w = step.window;
        if (y >= w.output_rows() || x >= w.output_columns())
            return {};
        const std::size_t of_group = w.input.channels / step.groups,
                          begin = filter / (step.filters / step.groups) * of_group;
        double sum = folded[step.folded + step.filters * step.taps() + filter];
        const float* weight = &folded[step.folded + filter * step.taps()];
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
        if (step.accumulates)
            sum += static_cast<double>(
                maps[net.maps[1].begin + (y * w.output_columns() + x) * step.filters + filter]);
        return sum;
    }
    /// How many numbers of all maps are others than they should be, once the step has run.
    [[nodiscard]] std::size_t wrong(bool rounded, const map_range& range) const {
        const graph_node& step = net.nodes[0];
        std::vector<float> expected = maps, found = maps;
        for (std::size_t y = 0; y < step.to.rows; ++y)
            for (std::size_t x = 0; x < step.to.columns; ++x)
                for (std::size_t f = 0; f < step.filters; ++f) {
                    std::optional<double> most;
                    for (std::size_t i = 0; i < step.pool.rows; ++i)
                        for (std::size_t j = 0; j < step.pool.columns; ++j)
                            if (const auto sum =
                                    sum_at(f, y * step.pool.rows + i, x * step.pool.columns + j, rounded))
                                most = most ? std::max(*most, *sum) : *sum;
                    double number = step.relu ? std::max(*most, 0.0) : *most;
                    if (rounded) { // scales are powers of two: quotients are exact
                        const double byte = std::clamp(
                            std::nearbyint(number / static_cast<double>(range.scale)) + range.zero_point, 0.0,
                            255.0);
                        number =
                            (byte - static_cast<double>(range.zero_point)) * static_cast<double>(range.scale);
                    }
                    expected[net.maps[2].begin + (y * step.to.columns + x) * step.to.channels + step.first +
                             f] = static_cast<float>(number);
                }
        node_executor(net, step, folded, rounded).run(found.data(), range);
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
    const shape to = drawn.net.nodes[0].to;
    for (std::size_t pixel = 0; pixel < to.area(); ++pixel)
        for (std::size_t f = 0; f < 4; ++f)
            CHECK(static_cast<double>(found[drawn.net.maps[2].begin + pixel * 4 + f]) ==
                  *drawn.sum_at(f, pixel / to.columns, pixel % to.columns, true));
}

TEST_CASE("node_executor: the sums of a pixel lie at place_of, and each tap is visited once") {
    const drawn_step drawn({{6, 7, 4}, extent2d(3, 3), 1, 1, 1, 1, 1}, 2, 6, 1, true, true, 0, 60);
    const graph_node& step = drawn.net.nodes[0];
    const node_executor run(drawn.net, step, drawn.folded, false);
    node_executor::sums sums = run.make_sums();
    for (std::size_t y = 0; y < 6; ++y)
        for (std::size_t x = 0; x < 7; ++x) {
            run.sums_at(drawn.maps.data(), y, x, sums);
            for (std::size_t f = 0; f < 6; ++f)
                CHECK(static_cast<double>(sums[run.place_of(f)]) == *drawn.sum_at(f, y, x, false));
            std::vector<int> visits(2 * step.taps());
            run.for_each_tap(y, x, [&](std::size_t group, std::size_t tap, std::size_t place) {
                ++visits[group * step.taps() + tap];
                CHECK(place % 4 / 2 == group);
                CHECK(place < drawn.net.maps[0].size.size());
            });
            const std::size_t rows = y == 0 || y == 5 ? 2 : 3, columns = x == 0 || x == 6 ? 2 : 3;
            CHECK(std::ranges::count(visits, 1) == static_cast<std::ptrdiff_t>(4 * rows * columns));
            CHECK(std::ranges::count(visits, 0) ==
                  static_cast<std::ptrdiff_t>(visits.size() - 4 * rows * columns));
        }
}

namespace {

/// Numbers less than its one folded number become it.
struct at_least_step {
    static void reference(const graph_node& step, const float* folded, const float* in, float* out) {
        for (std::size_t e = 0; e < step.to.size(); ++e)
            out[e] = std::max(in[e], folded[0]);
    }
};

} // namespace

TEST_CASE("node_executor: any other step runs its function and rounds to even steps") {
    calibration_graph net;
    net.ranges = 2;
    graph_node step{.reference = at_least_step::reference, .input = net.add_map({1, 5}, 0)};
    step.output = net.add_map({1, 5}, 1), step.from = step.to = {1, 5}, step.folded = 1;
    net.nodes.push_back(step);
    const std::vector<float> folded{9, -3};
    std::vector<float> exact{-4, -2.5f, 0.25f, 0.75f, 200, 0, 0, 0, 0, 0}, rounded = exact;
    node_executor(net, net.nodes[0], folded, false).run(exact.data(), {0.5f, 4});
    CHECK(std::vector<float>(exact.begin() + 5, exact.end()) ==
          std::vector<float>{-3, -2.5f, 0.25f, 0.75f, 200});
    // Bytes are −2 (so 0), −1 (so 0), 4, 6 and 404 (so 255), of a zero of 4.
    node_executor(net, net.nodes[0], folded, true).run(rounded.data(), {0.5f, 4});
    CHECK(std::vector<float>(rounded.begin() + 5, rounded.end()) == std::vector<float>{-2, -2, 0, 1, 125.5f});
}

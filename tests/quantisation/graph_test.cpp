#include <tactnet/deployment.hpp>
#include <tactnet/deployment/eight_bit.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/quantisation/graph.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

// The description of a network of every kind of step: compared with one written by hand and with its layout
// in files.

using namespace tactnet;
using detail::calibration_graph;
using detail::feature_map;
using detail::graph_node;

namespace {

using every_step = network<shape{6, 5, 2}, square_root<>, conv2d<4, 3>, relu, max_pool<2>,
                           residual<sequence<conv2d<4, 3>>, sequence<conv2d<4, 1>>>,
                           concatenation<sequence<conv2d<4, 1>>, sequence<conv2d<8, 3>, relu>>, max_pool<2>,
                           batch_norm, relu, average_pool<2, 1>, dense<3>, softmax>;
using view = deployed<every_step, eight_bit>::view_type;

const calibration_graph& described() {
    static const calibration_graph net = calibration_graph_of<view>();
    return net;
}

} // namespace

TEST_CASE("calibration_graph_of: maps lie one after the other, those of one range share it") {
    struct expected_map {
        shape size;
        std::size_t range;
    };
    // A pool and a ReLU by itself leave bytes as they are, and both branches write into the range of the
    // last: the first one's own, the fifth, is that of no map.
    const std::vector<expected_map> expected{{{6, 5, 2}, 0},  // frame
                                             {{6, 5, 2}, 1},  // roots
                                             {{3, 3, 4}, 2},  // convolution, ReLU and pool
                                             {{3, 3, 4}, 3},  // sum of the residual block
                                             {{3, 3, 4}, 4},  // its skip
                                             {{3, 3, 12}, 6}, // both branches
                                             {{2, 2, 12}, 6}, // their pool
                                             {{2, 2, 12}, 7}, // batch norm and ReLU
                                             {{2, 2, 12}, 8}, // means, which round anew
                                             {{1, 1, 3}, calibration_graph::none}}; // outputs
    const calibration_graph& net = described();
    REQUIRE(net.maps.size() == expected.size());
    std::size_t begin = 0;
    for (std::size_t m = 0; m < expected.size(); ++m) {
        CAPTURE(m);
        CHECK(net.maps[m].size == expected[m].size);
        CHECK(net.maps[m].range == expected[m].range);
        CHECK(net.maps[m].begin == begin);
        begin += expected[m].size.size();
    }
    CHECK(net.numbers == begin);
    CHECK(net.ranges == 9);
    for (std::size_t range = 0; range < net.ranges; ++range)
        CHECK(net.has(range) == (range != 5));
}

TEST_CASE("calibration_graph_of: a gate multiplies its input by the map that its branch writes last") {
    using gated =
        deployed<network<shape{3, 4}, conv2d<4, 3>, squeeze_excitation<4, 2, hard_sigmoid>, dense<2>>,
                 eight_bit>::view_type;
    const calibration_graph net = calibration_graph_of<gated>();
    // Convolution; means, convolution with ReLU, convolution, sigmoid; product; outputs.
    REQUIRE(net.nodes.size() == 7);
    const graph_node& product = net.nodes[5];
    CHECK(product.convolution == nullptr);
    CHECK(product.input == net.nodes[0].output);
    CHECK(product.added == net.nodes[4].output);
    CHECK(net.maps[product.added].size == shape{1, 1, 4});
    CHECK(net.maps[product.output].size == shape{3, 4, 4});
    const folded_layout layout = folded_layout_of<gated>();
    const auto named = [&](const char* name) {
        return std::any_of(layout.steps.begin(), layout.steps.end(),
                           [&](const folded_step& step) { return step.name == name; });
    };
    CHECK(named("step2.branch.step1"));
    CHECK(named("step2.product"));
}

TEST_CASE("calibration_graph_of: steps come as they run, each with its maps and folded numbers") {
    struct expected_step {
        const char* name; ///< in files; nothing of one without folded numbers
        std::size_t input, output;
        std::size_t first = 0, filters = 0, taps = 0; ///< of a convolution
        bool accumulates = false, relu = false;
        extent2d pool = 1;
    };
    // The skip runs before the main branch, which adds to it, and follows it in files.
    const std::vector<expected_step> expected{{"step1", 0, 1},
                                              {"step2", 1, 2, 0, 4, 18, false, true, 2},
                                              {"step3.skip.step1", 2, 4, 0, 4, 4},
                                              {"step3.main.step1", 2, 3, 0, 4, 36, true},
                                              {"step4.branch1.step1", 3, 5, 0, 4, 4},
                                              {"step4.branch2.step1", 3, 5, 4, 8, 36, false, true},
                                              {"", 5, 6},
                                              {"step6", 6, 7},
                                              {"step7", 7, 8},
                                              {"step8", 8, 9, 0, 3, 48},
                                              {"", 9, 9}}; // softmax, in place
    const calibration_graph& net = described();
    const folded_layout layout = folded_layout_of<view>();
    REQUIRE(net.nodes.size() == expected.size());
    for (std::size_t s = 0; s < expected.size(); ++s) {
        const graph_node& step = net.nodes[s];
        const expected_step& as = expected[s];
        CAPTURE(s);
        CHECK(step.input == as.input);
        CHECK(step.output == as.output);
        CHECK((step.convolution != nullptr) == (as.filters > 0));
        CHECK((step.reference != nullptr) == (as.filters == 0));
        if (step.convolution != nullptr) {
            CHECK(step.convolution->map_offset == as.first);
            CHECK(step.convolution->filters == as.filters);
            CHECK(step.convolution->taps() == as.taps);
            CHECK(step.convolution->accumulates == as.accumulates);
            CHECK(step.convolution->rectifies() == as.relu);
            CHECK(step.convolution->pool == as.pool);
        }
        CHECK((step.set_ranges != nullptr) == (*as.name != 0));
        if (*as.name == 0)
            continue;
        bool found = false;
        for (const folded_step& of : layout.steps)
            if (of.arrays[0].name.starts_with(std::string(as.name) + ".")) {
                CHECK(step.folded == of.arrays[0].offset);
                found = true;
            }
        CHECK(found);
    }
    for (std::size_t s = 0; s < expected.size(); ++s)
        CHECK(net.nodes[s].added == (s == 3 ? 4 : calibration_graph::none));
}

TEST_CASE("calibration_graph_of: ranges are written where files have those of each map") {
    const calibration_graph& net = described();
    std::vector<float> folded(view::folded_elements, 1.0f);
    std::vector<map_range> ranges;
    for (std::size_t range = 0; range < net.ranges; ++range)
        ranges.push_back({static_cast<float>(range + 1), static_cast<float>(100 + range)});
    net.set_ranges(folded.data(), ranges);
    // Which range stands at which array; everything else but the scales of weights is left alone.
    struct place {
        const char* array;
        std::size_t range;
    };
    std::vector<bool> seen(folded.size());
    const folded_layout layout = folded_layout_of<view>();
    std::size_t arrays = 0;
    for (const auto& [array, range] : {place{"step1.input", 0},
                                       {"step1.output", 1},
                                       {"step2.input", 1},
                                       {"step2.output", 2},
                                       {"step3.main.step1.input", 2},
                                       {"step3.main.step1.added", 4},
                                       {"step3.main.step1.output", 3},
                                       {"step3.skip.step1.input", 2},
                                       {"step3.skip.step1.output", 4},
                                       {"step4.branch1.step1.input", 3},
                                       {"step4.branch1.step1.output", 6},
                                       {"step4.branch2.step1.input", 3},
                                       {"step4.branch2.step1.output", 6},
                                       {"step6.input", 6},
                                       {"step6.output", 7},
                                       {"step7.input", 7},
                                       {"step7.output", 8},
                                       {"step8.input", 8}})
        for (const folded_step& step : layout.steps)
            for (const folded_step::array& of : step.arrays)
                if (of.name == array) {
                    CAPTURE(of.name);
                    CHECK(folded[of.offset] == static_cast<float>(range + 1));
                    CHECK(folded[of.offset + 1] == static_cast<float>(100 + range));
                    seen[of.offset] = seen[of.offset + 1] = true;
                    ++arrays;
                }
    CHECK(arrays == 18);
    for (const folded_step& step : layout.steps)
        for (const folded_step::array& of : step.arrays)
            if (of.kind == folded_kind::scales) // weights of 1 are 127 steps, or as many as a sum bears
                for (std::size_t i = 0; i < of.size; ++i) {
                    CHECK(folded[of.offset + i] >= 1.0f / 127);
                    seen[of.offset + i] = true;
                }
    for (std::size_t i = 0; i < folded.size(); ++i)
        if (!seen[i])
            CHECK(folded[i] == 1);
}

#include "networks.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

// Folded numbers that no network in 8 bits has are refused, before they do harm.

using namespace tactnet;

namespace {

/// All kinds of arrays: of words, a batch norm, sums, branches, a pool, a dense layer.
using all_kinds =
    network<shape{6, 7, 2}, batch_norm, conv2d<4, 3>, relu, residual<sequence<conv2d<4, 3>>>,
            concatenation<sequence<conv2d<4, 1>>, sequence<conv2d<8, 3>, relu>>, average_pool<2>, dense<3>>;
using bytes = support::byte_network<all_kinds>;
using view = bytes::view_type;

std::vector<float> good_numbers() {
    all_kinds net;
    support::fill(net, 80);
    const auto calibration = support::calibrated(net, 80, 2);
    return {calibration.folded().begin(), calibration.folded().end()};
}
const folded_layout& layout() {
    static const folded_layout all = folded_layout_of<view>();
    return all;
}
std::size_t place_of(const std::string& name) {
    if (name == "input_mean" || name == "input_words")
        return name == "input_mean" ? 0 : all_kinds::input_shape.size();
    for (const folded_step& step : layout().steps)
        for (const folded_step::array& array : step.arrays)
            if (array.name == name)
                return array.offset;
    FAIL(name);
    return 0;
}
void make(const std::vector<float>& folded) {
    static_cast<void>(bytes(std::span(folded).first<view::folded_elements>()));
}
void refuses(const std::string& array, std::size_t element, float value, const std::string& expected) {
    std::vector<float> folded = good_numbers();
    folded[place_of(array) + element] = value;
    CAPTURE(array);
    CAPTURE(value);
    const std::string place = "deploy: " + array + ", element " + std::to_string(element) + ": expected ";
    CHECK_THROWS_WITH_AS(make(folded), doctest::Contains((place + expected).c_str()), std::invalid_argument);
}

constexpr float nothing = 0, denormal = 1e-40f, huge = std::numeric_limits<float>::max();

} // namespace

TEST_CASE("folded_layout: the arrays of all steps together are all folded numbers") {
    std::vector<std::string> names;
    std::size_t next = view::steps_folded;
    for (const folded_step& step : layout().steps)
        for (const folded_step::array& array : step.arrays) {
            names.push_back(array.name);
            CHECK(array.offset == next);
            next += array.size;
        }
    CHECK(next == view::folded_elements);
    CHECK(layout().numbers == next);
    CHECK(layout().ends_in_weights);
    for (const folded_step& step : layout().steps)
        CHECK((step.largest_input > 0) == (step.find("scale") != nullptr)); // of sums in 8 bits
    const std::vector<std::string> expected{"step1.weight",
                                            "step1.bias",
                                            "step1.input",
                                            "step1.output",
                                            "step2.weight",
                                            "step2.bias",
                                            "step2.scale",
                                            "step2.input",
                                            "step2.output",
                                            "step3.main.step1.weight",
                                            "step3.main.step1.bias",
                                            "step3.main.step1.scale",
                                            "step3.main.step1.input",
                                            "step3.main.step1.added",
                                            "step3.main.step1.output",
                                            "step4.branch1.step1.weight",
                                            "step4.branch1.step1.bias",
                                            "step4.branch1.step1.scale",
                                            "step4.branch1.step1.input",
                                            "step4.branch1.step1.output",
                                            "step4.branch2.step1.weight",
                                            "step4.branch2.step1.bias",
                                            "step4.branch2.step1.scale",
                                            "step4.branch2.step1.input",
                                            "step4.branch2.step1.output",
                                            "step5.input",
                                            "step5.output",
                                            "step6.weight",
                                            "step6.bias",
                                            "step6.scale",
                                            "step6.input"};
    CHECK(names == expected);
    constexpr shape last = view::steps::at<view::steps::size - 2>::output;
    CHECK(layout().steps.back().arrays[0].extents ==
          std::vector<std::size_t>{3, 12, last.rows, last.columns});
}

TEST_CASE("deployed: scales and zeros in 8 bits that cannot be are refused") {
    CHECK_NOTHROW(make(good_numbers()));
    for (const char* array :
         {"step1.input", "step1.output", "step2.input", "step2.scale", "step3.main.step1.added",
          "step4.branch2.step1.output", "step5.input", "step5.output", "step6.scale", "step6.input"})
        for (const float value : {nothing, -nothing, -0.5f, denormal, huge})
            refuses(array, 0, value, "a scale (a normal number above 0, at most 1e30), found ");
    for (const char* array : {"step1.input", "step2.output", "step3.main.step1.added", "step5.output"})
        for (const float value : {-1.0f, 256.0f, 0.5f, 1e30f})
            refuses(array, 1, value, "a zero (a whole number from 0 to 255), found ");
    refuses("step2.scale", 3, nothing, "a scale (a normal number above 0, at most 1e30), found 0");
}

TEST_CASE("deployed: NaN and infinity are refused wherever they are among folded numbers in 8 bits") {
    const std::vector<float> good = good_numbers();
    std::size_t taken = 0;
    for (std::size_t i = 0; i < good.size(); ++i)
        for (const float value :
             {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
              -std::numeric_limits<float>::infinity()}) {
            std::vector<float> folded = good;
            folded[i] = value;
            try {
                make(folded);
                ++taken;
            } catch (const std::invalid_argument&) {
            }
        }
    CHECK(taken == 0);
}

TEST_CASE("deployed: sums in 8 bits that might pass 32 bits are refused") {
    const std::string sums =
        "a filter and a bias whose sums have at most 32 bits, which are 2147483647 steps, "
        "found ";
    for (const float bias : {1e30f, -1e30f, huge, 1e15f})
        for (const char* array :
             {"step2.bias", "step3.main.step1.bias", "step4.branch1.step1.bias", "step6.bias"})
            refuses(array, 1, bias, sums);
    // Just within and just beyond.
    std::vector<float> folded = good_numbers();
    const std::size_t bias = place_of("step6.bias");
    const double unit = static_cast<double>(folded[place_of("step6.scale")]) *
                        static_cast<double>(folded[place_of("step6.input")]);
    const double of_weights = 12 * 9 * 127 * (255.0 + 383.0);
    folded[bias] = static_cast<float>((2147483000.0 - of_weights) * unit);
    CHECK_NOTHROW(make(folded));
    folded[bias] = static_cast<float>(2147484000.0 * unit);
    CHECK_THROWS_AS(make(folded), std::invalid_argument);
    // A sum adds the other map's bytes.
    folded = good_numbers();
    folded[place_of("step3.main.step1.added")] = 1e20f;
    CHECK_THROWS_AS(make(folded), std::invalid_argument);
}

TEST_CASE("deployed: weights beyond a signed byte and factors beyond single precision are refused") {
    std::vector<float> folded = good_numbers();
    const float scale = folded[place_of("step2.scale")];
    refuses("step2.weight", 5, 128 * scale, "a weight of at most 127 times the scale of its filter, found ");
    refuses("step2.weight", 5, -1e30f, "a weight of at most 127 times the scale of its filter, found ");
    refuses("step2.weight", 3 * 18 + 5, 1e30f, "a weight of at most 127 times the scale of its filter");
    folded[place_of("step2.weight") + 5] = -127 * scale;
    CHECK_NOTHROW(make(folded));
    // input · scale ÷ output.
    folded[place_of("step5.input")] = 1e30f, folded[place_of("step5.output")] = 1e-37f;
    CHECK_THROWS_WITH_AS(make(folded),
                         doctest::Contains("step5.input, element 0: expected scales whose product"),
                         std::invalid_argument);
    folded = good_numbers();
    folded[place_of("step1.input")] = 1e30f, folded[place_of("step1.output")] = 1e-37f;
    CHECK_THROWS_WITH_AS(make(folded),
                         doctest::Contains("step1.weight, element 0: expected scales whose product"),
                         std::invalid_argument);
}

TEST_CASE("deployed: words of a frame that would not hold counts of 8 bits are refused") {
    for (const float steps : {nothing, -64.0f, 3.0f, 127.0f, denormal, 32768.0f, huge})
        refuses("input_words", 0, steps, "a power of two, at most 16384, as steps of a count, found ");
    for (const float most : {nothing, -1.0f, 1e6f, huge})
        refuses("input_words", 1, most, "a number that is at most 32767 steps, found ");
    std::vector<float> folded = good_numbers();
    folded[place_of("input_words") + 1] = 200; // a count of 255 is further from any mean
    CHECK_THROWS_WITH_AS(make(folded), doctest::Contains("input_mean, element 0: expected a mean from which"),
                         std::invalid_argument);
    refuses("input_mean", 7, -5000.0f, "a mean from which no count of 8 bits is further ");
    refuses("input_mean", 83, 1e30f, "a mean from which no count of 8 bits is further ");
    // As many steps as can be are a power of two that is taken; no words would hold 255 of them.
    folded = good_numbers();
    folded[place_of("input_words")] = 16384;
    CHECK_THROWS_WITH_AS(make(folded), doctest::Contains("input_words, element 1: expected a number that is"),
                         std::invalid_argument);
    // The numbers of the words are no means: more steps of a count than the furthest count has.
    folded = good_numbers();
    std::fill_n(folded.begin(), place_of("input_words"), 127.5f);
    folded[place_of("input_words")] = 256, folded[place_of("input_words") + 1] = 127.75f;
    CHECK_NOTHROW(make(folded));
}

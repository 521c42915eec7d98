#include "bicubic.hpp"

#include <tactnet/deployment/export/deployed_header.hpp>
#include <tactnet/transfer/as_photograph.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deployment/eight_bit/networks.hpp>
#include <span>
#include <string>
#include <vector>

using namespace tactnet;

namespace {

constexpr std::int64_t one = 8192;

/// The weights in whole numbers that sum to `one`; the largest takes what is left.
std::vector<std::vector<std::int64_t>> whole_bicubic(std::size_t from, std::size_t to) {
    std::vector<std::vector<std::int64_t>> all;
    for (const std::vector<double>& exact : support::bicubic(from, to)) {
        std::vector<std::int64_t> whole;
        std::int64_t rest = one;
        for (const double w : exact) {
            whole.push_back(static_cast<std::int64_t>(std::round(w * static_cast<double>(one))));
            rest -= whole.back();
        }
        *std::max_element(whole.begin(), whole.end()) += rest;
        all.push_back(whole);
    }
    return all;
}

} // namespace

template <class Input, extent2d From, std::size_t InputStride, extent2d To>
struct support::reference_step<
    as_photograph_step<eight_bit_between<Input, std::uint8_t>, From, InputStride, To>> {
    static whole_map run(const float* folded, const whole_map& in, const whole_map&) {
        const float *const mean = folded, *const scale = folded + 3;
        folded += 6;
        const reference_range input = reference_range::next(folded), output = reference_range::next(folded);
        const std::int64_t finer = std::is_same_v<Input, std::uint8_t> ? 128 : 1;
        const double unit = input.scale / static_cast<double>(finer) / static_cast<double>(one);
        const auto down = whole_bicubic(From.rows, To.rows), along = whole_bicubic(From.columns, To.columns);
        whole_map out(shape{To.rows, To.columns, 3});
        for (std::size_t y = 0; y < To.rows; ++y)
            for (std::size_t x = 0; x < To.columns; ++x) {
                std::int64_t sum = 0;
                for (std::size_t i = 0; i < From.rows; ++i) {
                    std::int64_t of_row = one / 2; // to the nearest, ties up
                    for (std::size_t j = 0; j < From.columns; ++j)
                        of_row += along[x][j] * finer * (in.whole[in.at(i, j, 0)] - input.zero);
                    sum += down[y][i] * (of_row >> 13);
                }
                for (std::size_t c = 0; c < 3; ++c) {
                    const auto start = static_cast<float>(static_cast<double>(mean[c]) / unit),
                               factor =
                                   static_cast<float>(unit * static_cast<double>(scale[c]) / output.scale);
                    const float product = (static_cast<float>(sum) - start) * factor;
                    out.whole[out.at(y, x, c)] = static_cast<std::int64_t>(std::clamp(
                        std::nearbyint(static_cast<double>(product)) + static_cast<double>(output.zero), 0.0,
                        255.0));
                }
            }
        return out;
    }
};

TEST_CASE("as_photograph: in 8 bits every byte is that of a reference in whole numbers") {
    using larger = network<shape{6, 9, 1}, as_photograph<extent2d(17, 21)>, conv2d<5, 3, 2, padding::valid>,
                           relu, dense<4>>;
    CHECK(support::frames_that_differ<larger>(61, 5) == 0);
    using smaller =
        network<shape{13, 11, 1}, as_photograph<extent2d(7, 6)>, conv2d<9, 3>, relu, max_pool<2>, dense<3>>;
    CHECK(support::frames_that_differ<smaller>(62, 5) == 0);
    using behind_a_convolution =
        network<shape{6, 7, 2}, conv2d<1, 3>, as_photograph<extent2d(10, 8)>, max_pool<2>, dense<3>>;
    CHECK(support::frames_that_differ<behind_a_convolution>(63, 5) == 0);
}

TEST_CASE("as_photograph: in 8 bits its bytes are the nearest to the photograph in double precision") {
    constexpr extent2d from(28, 50), to(61, 83);
    using step = as_photograph_step<eight_bit::input_format, from, 1, to>;
    // A word is 1/128 of a count; the photograph is that of ImageNet, with counts from 0 to 1.
    const double unit = 1.0 / 128 / 255;
    const std::array<float, 10> folded{0.485f,     0.456f,     0.406f, // mean
                                       1 / 0.229f, 1 / 0.224f, 1 / 0.225f, static_cast<float>(unit),
                                       0,          0.0187f,    114};
    std::array<std::int8_t, step::packed_elements> packed{};
    step::pack(folded.data(), packed.data());
    support::numbers draw(65);
    std::vector<std::int16_t> words(from.area());
    for (std::int16_t& word : words)
        word = static_cast<std::int16_t>(draw.next(0, 32640));
    aligned_vector<std::uint8_t> memory(step::workspace_elements), out(to.area() * step::output_stride);
    step::run(packed.data(), reinterpret_cast<const std::uint8_t*>(words.data()), out.data(), memory.data());

    const auto down = support::bicubic(from.rows, to.rows),
               along = support::bicubic(from.columns, to.columns);
    // A tap is wrong by at most 2⁻¹⁴ and the largest of four by 4 · 2⁻¹⁴ more, on both axes; the other axis
    // enlarges by at most 1.25. Sums between the passes are rounded to one word.
    const double wrong = (2 * 8.0 / 16384 * 1.25 * 32640 + 1.25) * unit;
    double furthest = 0;
    for (std::size_t e = 0; e < 3 * to.area(); ++e) {
        const std::size_t pixel = e / 3, c = e % 3, y = pixel / to.columns, x = pixel % to.columns;
        double exact = 0;
        for (std::size_t i = 0; i < from.rows; ++i)
            for (std::size_t j = 0; j < from.columns; ++j)
                exact += down[y][i] * along[x][j] * words[i * from.columns + j] * unit;
        const double value = (exact - static_cast<double>(folded[c])) * static_cast<double>(folded[3 + c]),
                     steps = std::clamp(value / static_cast<double>(folded[8]), -114.0, 141.0) + 114;
        furthest =
            std::max(furthest, (std::abs(steps - out[pixel * step::output_stride + c]) - 0.5) *
                                   static_cast<double>(folded[8]) / static_cast<double>(folded[3 + c]));
    }
    MESSAGE("beyond half a step: " << furthest << ", bound " << wrong);
    CHECK(furthest <= wrong);
}

TEST_CASE("as_photograph: in 8 bits a constant frame gives a constant photograph") {
    using step = as_photograph_step<eight_bit::input_format, extent2d(7, 9), 1, extent2d(30, 31)>;
    const std::array<float, 10> folded{0, 0.25f, 0.5f, 1, 1, 2, 1.0f / 4096, 0, 1.0f / 32, 100};
    std::array<std::int8_t, step::packed_elements> packed{};
    step::pack(folded.data(), packed.data());
    const std::vector<std::int16_t> words(63, 4096); // the number 1
    aligned_vector<std::uint8_t> memory(step::workspace_elements), out(30 * 31 * step::output_stride);
    step::run(packed.data(), reinterpret_cast<const std::uint8_t*>(words.data()), out.data(), memory.data());
    for (std::size_t pixel = 0; pixel < 30 * 31; ++pixel) {
        REQUIRE(out[4 * pixel] == 132);
        REQUIRE(out[4 * pixel + 1] == 124);
        REQUIRE(out[4 * pixel + 2] == 132);
    }
}

TEST_CASE("as_photograph: in 8 bits an exported header names its step") {
    using net = network<shape{3, 4, 1}, as_photograph<extent2d(5, 6)>, conv2d<2, 3>, dense<2>>;
    net network;
    support::fill(network, 66);
    const auto frame = support::make_frame(12, 1);
    const std::string text =
        deployed_header(support::byte_network<net>(support::calibrated(network, 66, 3).folded()),
                        {.network = "photograph", .namespace_name = "own", .classes = {"a", "b"}},
                        std::span<const std::uint8_t, 12>(frame));
    CHECK(text.find("#include <tactnet/transfer/as_photograph_step.hpp>") != std::string::npos);
    CHECK(text.find("tactnet::as_photograph_step<") != std::string::npos);
}

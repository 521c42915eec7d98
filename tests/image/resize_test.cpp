#include <tactnet/image/resize.hpp>
#include <tactnet/runtime/random.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <support/tolerance.hpp>
#include <type_traits>
#include <vector>

using namespace tactnet;

namespace {

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

template <shape Shape>
tensor<float, Shape> draw_image(std::uint32_t item = 0) {
    random_stream random(2, random_purposes::order, item);
    tensor<float, Shape> image;
    for (float& value : image)
        value = static_cast<float>(random.uniform(-100, 255));
    return image;
}

/// The kernels once more, as their sources write them: the weight of every input for an output, in double
/// precision, without tables, folding or trimming.
double keys_weight(double x, double a) {
    x = std::abs(x);
    if (x <= 1)
        return (a + 2) * x * x * x - (a + 3) * x * x + 1;
    return x < 2 ? a * x * x * x - 5 * a * x * x + 8 * a * x - 4 * a : 0;
}
std::vector<double> normalised(std::vector<double> weights) {
    double sum = 0;
    for (const double w : weights)
        sum += w;
    for (double& w : weights)
        w /= sum;
    return weights;
}
double coordinate(std::size_t output, std::size_t from, std::size_t to) {
    return (static_cast<double>(output) + 0.5) * static_cast<double>(from) / static_cast<double>(to) - 0.5;
}

struct keys_reference {
    double a = -0.5;
    bool antialiased = true;
    resize_border border = resize_border::symmetric;

    std::vector<double> operator()(std::size_t output, std::size_t from, std::size_t to) const {
        const double narrow =
            antialiased && to < from ? static_cast<double>(to) / static_cast<double>(from) : 1;
        const int size = static_cast<int>(from);
        std::vector<double> weights(from);
        for (int p = -200; p < 200 + size; ++p) {
            int inside = p;
            while (border == resize_border::symmetric && (inside < 0 || inside >= size))
                inside = inside < 0 ? -1 - inside : 2 * size - 1 - inside;
            if (border == resize_border::replicate)
                inside = std::clamp(p, 0, size - 1);
            if (inside >= 0 && inside < size)
                weights[static_cast<std::size_t>(inside)] +=
                    keys_weight(narrow * (coordinate(output, from, to) - p), a);
        }
        return normalised(weights);
    }
};
struct lagrange_reference {
    std::vector<double> operator()(std::size_t output, std::size_t from, std::size_t to) const {
        const double x = coordinate(output, from, to);
        const int nodes = std::min(4, static_cast<int>(from));
        const int first = std::clamp(static_cast<int>(std::floor(x)) - 1, 0, static_cast<int>(from) - nodes);
        std::vector<double> weights(from);
        for (int i = first; i < first + nodes; ++i) {
            double product = 1;
            for (int j = first; j < first + nodes; ++j)
                product *= i == j ? 1 : (x - j) / (i - j);
            weights[static_cast<std::size_t>(i)] = product;
        }
        return weights;
    }
};
keys_reference reference_of(keys_cubic<>) {
    return {};
}
keys_reference reference_of(opencv_cubic) {
    return {-0.75, false, resize_border::replicate};
}
keys_reference reference_of(pillow_bicubic) {
    return {-0.5, true, resize_border::left_out};
}
keys_reference reference_of(keys_cubic<std::ratio<-1>, false>) {
    return {-1, false, resize_border::symmetric};
}
lagrange_reference reference_of(lagrange_cubic) {
    return {};
}

/// Both directions in one sum, with what it may be off by: each weight, product and sum is rounded, over all
/// terms.
support::bounded resized(const std::vector<double>& down, const std::vector<double>& along,
                         const float* image) {
    double value = 0, size = 0;
    std::size_t terms = 4;
    for (std::size_t y = 0; y < down.size(); ++y)
        terms += down[y] != 0;
    for (const double w : along)
        terms += w != 0;
    for (std::size_t y = 0; y < down.size(); ++y)
        for (std::size_t x = 0; x < along.size(); ++x) {
            const double term = down[y] * along[x] * static_cast<double>(image[y * along.size() + x]);
            value += term;
            size += std::abs(term);
        }
    return {value, support::accumulated(support::unit_roundoff<float>, static_cast<double>(terms)) * size};
}

template <class Kernel, shape From, shape To>
void check_against_reference() {
    const tensor<float, From> image = draw_image<From>();
    tensor<float, To> result;
    resize<From, To, Kernel>(image.view(), result.view());
    const auto weights = reference_of(Kernel{});
    std::size_t wrong = 0;
    for (std::size_t y = 0; y < To.rows; ++y) {
        const auto down = weights(y, From.rows, To.rows);
        for (std::size_t x = 0; x < To.columns; ++x) {
            const auto along = weights(x, From.columns, To.columns);
            for (std::size_t c = 0; c < To.channels; ++c)
                wrong += !support::within(static_cast<double>(result(y, x, c)),
                                          resized(down, along, image.data() + c * From.area()));
        }
    }
    CHECK_MESSAGE(wrong == 0,
                  "from " << From.rows << " x " << From.columns << " to " << To.rows << " x " << To.columns);
}

struct shrink {
    static constexpr shape from{28, 50}, to{14, 25};
};
struct by_three { // whole distances: weights of zero among others
    static constexpr shape from{27, 30}, to{9, 10};
};
struct grow {
    static constexpr shape from{5, 9}, to{40, 61};
};
struct none {
    static constexpr shape from{5, 9}, to{5, 9};
};

/// The largest sum of the magnitudes of an output's weights: by how much an error of the pixels grows.
template <class Kernel>
constexpr double magnitude(std::size_t from, std::size_t to) {
    double most = 0;
    for (std::size_t o = 0; o < to; ++o) {
        const double scale = static_cast<double>(to) / static_cast<double>(from);
        double sum = 0, magnitudes = 0;
        Kernel::taps((static_cast<double>(o) + 0.5) / scale - 0.5, scale, from, [&](std::size_t, double w) {
            sum += w;
            magnitudes += w < 0 ? -w : w;
        });
        most = std::max(most, magnitudes / sum);
    }
    return most;
}

} // namespace

TEST_CASE_TEMPLATE("resize: every kernel against double precision, sizes of all kinds", Kernel, keys_cubic<>,
                   opencv_cubic, pillow_bicubic, keys_cubic<std::ratio<-1>, false>, lagrange_cubic) {
    check_against_reference<Kernel, shape{28, 50}, shape{14, 25}>();
    check_against_reference<Kernel, shape{28, 50, 2}, shape{20, 35, 2}>();
    check_against_reference<Kernel, shape{28, 50}, shape{7, 13}>();
    check_against_reference<Kernel, shape{28, 50}, shape{28, 50}>();
    check_against_reference<Kernel, shape{7, 13}, shape{61, 75}>();
    check_against_reference<Kernel, shape{10, 18}, shape{5, 37}>(); // up and down at once
    check_against_reference<Kernel, shape{10, 18}, shape{31, 6}>();
    check_against_reference<Kernel, shape{1, 9}, shape{1, 4}>();
    check_against_reference<Kernel, shape{1, 9}, shape{3, 21}>();
    check_against_reference<Kernel, shape{9, 1}, shape{4, 1}>();
    check_against_reference<Kernel, shape{9, 1}, shape{20, 2}>();
    check_against_reference<Kernel, shape{9, 3, 3}, shape{20, 1, 3}>();
    check_against_reference<Kernel, shape{1, 1}, shape{1, 1}>();
    check_against_reference<Kernel, shape{1, 1}, shape{5, 17}>();
    check_against_reference<Kernel, shape{5, 17}, shape{1, 1}>();
    check_against_reference<Kernel, shape{2, 3}, shape{3, 2}>();
    check_against_reference<Kernel, shape{64, 64}, shape{3, 5}>();
}
TEST_CASE("resize: one as large as networks trained on photographs take") {
    check_against_reference<opencv_cubic, shape{28, 50}, shape{227, 227}>();
    check_against_reference<lagrange_cubic, shape{28, 50}, shape{227, 227}>();
}

TEST_CASE_TEMPLATE("resize: weights sum to one", Kernel, keys_cubic<>, opencv_cubic, pillow_bicubic,
                   lagrange_cubic) {
    const auto check = []<std::size_t From, std::size_t To>(resize_axis<Kernel, From, To>) {
        for (const auto& output : resize_axis<Kernel, From, To>::table) {
            double sum = 0, size = 0;
            for (const float w : output.weights)
                sum += static_cast<double>(w), size += std::abs(static_cast<double>(w));
            CHECK(std::abs(sum - 1) <= support::unit_roundoff<float> * size + 1e-15);
            CHECK(output.first + output.weights.size() <= From);
        }
    };
    check(resize_axis<Kernel, 28, 227>{});
    check(resize_axis<Kernel, 28, 14>{});
    check(resize_axis<Kernel, 50, 13>{});
    check(resize_axis<Kernel, 2, 7>{});
    check(resize_axis<Kernel, 1, 3>{});
}

TEST_CASE("resize: at the border Lagrange's weights stay below 6 in magnitude, Keys' at 1.25") {
    // The output half a pixel before the first of four equidistant pixels: 35/16 + 35/16 + 21/16 + 5/16.
    // Outputs come close to it, and do not reach it.
    static_assert(magnitude<lagrange_cubic>(28, 227) > 5.18 && magnitude<lagrange_cubic>(28, 227) < 5.19);
    static_assert(magnitude<lagrange_cubic>(50, 227) > 4.59 && magnitude<lagrange_cubic>(50, 227) < 4.60);
    for (std::size_t from = 1; from <= 50; ++from)
        for (const std::size_t to : {1u, 7u, 28u, 50u, 224u, 227u, 5000u})
            CHECK(magnitude<lagrange_cubic>(from, to) < 6);
    CHECK(magnitude<lagrange_cubic>(4, 5000) > 5.99);
    CHECK(magnitude<keys_cubic<>>(28, 227) <= 1.25 + 1e-12);
    CHECK(magnitude<keys_cubic<>>(50, 227) <= 1.25 + 1e-12);
}

TEST_CASE("resize: Lagrange's is exact on polynomials up to the third degree, border included") {
    constexpr shape from{9, 12}, to{31, 17};
    const auto polynomial = [](double y, double x) {
        return 3 + y - 2 * x + 0.5 * y * x - 0.25 * y * y + 0.125 * x * x * x +
               0.0625 * y * y * y * x * x * x / 64;
    };
    tensor<float, from> image;
    double largest = 0;
    for (std::size_t y = 0; y < from.rows; ++y)
        for (std::size_t x = 0; x < from.columns; ++x) {
            image(y, x) = static_cast<float>(polynomial(static_cast<double>(y), static_cast<double>(x)));
            largest = std::max(largest, std::abs(static_cast<double>(image(y, x))));
        }
    tensor<float, to> result;
    resize<from, to, lagrange_cubic>(image.view(), result.view());
    // Magnitudes of the weights sum to less than 4.2 for 9 → 31 and 2.2 for 12 → 17, most at the border.
    static_assert(magnitude<lagrange_cubic>(from.rows, to.rows) *
                      magnitude<lagrange_cubic>(from.columns, to.columns) <
                  9);
    const double bound = support::accumulated(support::unit_roundoff<float>, 12) * largest * 9;
    for (std::size_t y = 0; y < to.rows; ++y)
        for (std::size_t x = 0; x < to.columns; ++x) {
            const double exact =
                polynomial(coordinate(y, from.rows, to.rows), coordinate(x, from.columns, to.columns));
            CHECK(std::abs(static_cast<double>(result(y, x)) - exact) <= bound);
        }
}

TEST_CASE("resize: the same size is the same image, but for antialiasing nothing is done") {
    const auto image = draw_image<shape{7, 13, 2}>();
    tensor<float, shape{7, 13, 2}> result;
    resize<shape{7, 13, 2}, shape{7, 13, 2}>(image.view(), result.view());
    CHECK(std::equal(image.begin(), image.end(), result.begin()));
    resize<shape{7, 13, 2}, shape{7, 13, 2}, lagrange_cubic>(image.view(), result.view());
    CHECK(std::equal(image.begin(), image.end(), result.begin()));
}

TEST_CASE_TEMPLATE("resize: NaN and infinity reach the outputs that weigh them, and change no other", Kernel,
                   keys_cubic<>, keys_cubic<std::ratio<-1, 2>, false>, lagrange_cubic) {
    const auto run = [](auto plan, std::size_t row, std::size_t column, float value) {
        constexpr shape from = decltype(plan)::from, to = decltype(plan)::to;
        tensor<float, from> image = draw_image<from>();
        tensor<float, to> clean, broken;
        resize<from, to, Kernel>(image.view(), clean.view());
        image(row, column) = value;
        resize<from, to, Kernel>(image.view(), broken.view());
        for (std::size_t y = 0; y < to.rows; ++y)
            for (std::size_t x = 0; x < to.columns; ++x) {
                const auto holds = [](const auto& taps, std::size_t input) {
                    return input >= taps.first && input < taps.first + taps.weights.size() &&
                           taps.weights[input - taps.first] != 0;
                };
                const bool reached = holds(resize_axis<Kernel, from.rows, to.rows>::table[y], row) &&
                                     holds(resize_axis<Kernel, from.columns, to.columns>::table[x], column);
                if (reached)
                    CHECK((std::isfinite(value) || !std::isfinite(broken(y, x))));
                else
                    CHECK(broken(y, x) == clean(y, x));
            }
    };
    for (const float value : {not_a_number, infinity, -infinity}) {
        run(shrink{}, 13, 24, value);
        run(shrink{}, 0, 49, value);
        run(by_three{}, 13, 14, value);
        run(grow{}, 2, 4, value);
        run(grow{}, 4, 0, value);
        run(none{}, 3, 3, value);
    }
    // So large that products and sums are infinite: no weight of zero makes that NaN elsewhere.
    run(grow{}, 2, 4, 3e38f * 1.1f);
}

TEST_CASE("resize: counts in, and counts out: rounded and kept within their range") {
    constexpr shape from{5, 7}, to{11, 14};
    tensor<std::uint8_t, from> counts;
    tensor<float, from> numbers;
    for (std::size_t e = 0; e < from.size(); ++e) {
        counts.data()[e] = e % 3 == 0 ? 255 : e % 3 == 1 ? 0 : static_cast<std::uint8_t>(e * 7);
        numbers.data()[e] = counts.data()[e];
    }
    tensor<float, to> of_counts, of_numbers;
    resize<from, to>(tensor_view<const std::uint8_t, from>(counts), of_counts.view());
    resize<from, to>(numbers.view(), of_numbers.view());
    CHECK(std::equal(of_counts.begin(), of_counts.end(), of_numbers.begin()));
    tensor<std::uint8_t, to> rounded, rounded_numbers;
    resize<from, to>(counts, rounded.view());
    resize<from, to>(numbers, rounded_numbers.view());
    CHECK(std::equal(rounded.begin(), rounded.end(), rounded_numbers.begin()));
    bool below = false, above = false;
    for (std::size_t e = 0; e < to.size(); ++e) {
        const double kept = std::clamp(static_cast<double>(of_counts.data()[e]), 0.0, 255.0);
        CHECK(std::abs(rounded.data()[e] - kept) <= 0.5 + 255 * support::unit_roundoff<float>);
        below = below || of_counts.data()[e] < 0;
        above = above || of_counts.data()[e] > 255;
    }
    CHECK((below && above)); // the case has what must be cut off
    CHECK(saturate_to_count(not_a_number) == 0);
    CHECK(saturate_to_count(254.4f) == 254);
    CHECK(saturate_to_count(254.5f) == 255);
    CHECK(saturate_to_count(1e9f) == 255);
    CHECK(saturate_to_count(-1e9f) == 0);
}

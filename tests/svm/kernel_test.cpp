#include "samples.hpp"

#include <tactnet/svm/kernel/gram_matrix.hpp>
#include <tactnet/svm/kernel/space.hpp>
#include <tactnet/svm/kernel_training.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace {

using namespace tactnet;

/// A cache of the rows of five samples that records which were filled. Column c of sample s holds 10 s + c.
struct recorded_cache : kernel_cache {
    std::vector<std::size_t> filled;

    explicit recorded_cache(std::size_t bytes) : kernel_cache(5, bytes) {}
    const float* operator()(std::size_t sample, std::size_t columns = 5) {
        return row(sample, columns, [&](float* out) {
            filled.push_back(sample);
            for (std::size_t c = 0; c < columns; ++c)
                out[c] = static_cast<float>(10 * sample + c);
        });
    }
};

TEST_CASE("kernel_cache: the rows used last stay, and rows are cut to the columns that are left") {
    recorded_cache cache(2 * 16 * sizeof(float));
    (void)cache(0, 5);
    (void)cache(1, 5);
    (void)cache(0, 5);
    (void)cache(2, 5); // in place of 1
    CHECK(cache(0, 5)[4] == 4);
    CHECK(cache.filled == std::vector<std::size_t>{0, 1, 2});
    const std::vector<std::size_t> columns{0, 3, 4};
    cache.keep(columns, columns);
    CHECK(cache(0, 3)[1] == 3);
    CHECK(cache(0, 3)[2] == 4);
    CHECK(cache(0, 3)[3] == 0);
    CHECK(cache.filled.size() == 3);
    CHECK(cache(3, 3)[2] == 32);
    CHECK(cache.filled.back() == 3);
}

TEST_CASE("kernel_cache: a row that gave up its place is filled again, and two rows are always there") {
    recorded_cache cache(0);
    const float* const first = cache(0);
    const float* const second = cache(1);
    CHECK(first[4] == 4);
    CHECK(second[4] == 14);
    CHECK(cache(0) == first);
    CHECK(cache.filled == std::vector<std::size_t>{0, 1});
    CHECK(cache(2)[1] == 21); // in place of 1
    CHECK(cache(1)[1] == 11); // in place of 0
    CHECK(cache(0)[1] == 1);
    CHECK(cache.filled == std::vector<std::size_t>{0, 1, 2, 1, 0});
}

TEST_CASE("kernel_cache: every row that is left is cut, and one that is not is filled when it comes again") {
    recorded_cache cache(5 * 16 * sizeof(float));
    for (const std::size_t sample : {0U, 1U, 2U, 3U})
        (void)cache(sample, 5);
    const std::vector<std::size_t> columns{1, 4};
    const std::vector<std::size_t> samples{0, 1, 3};
    cache.keep(columns, samples);
    for (const std::size_t sample : samples) {
        CHECK(cache(sample, 2)[0] == static_cast<float>(10 * sample + 1));
        CHECK(cache(sample, 2)[1] == static_cast<float>(10 * sample + 4));
        CHECK(cache(sample, 2)[2] == 0);
    }
    CHECK(cache.filled.size() == 4);
    CHECK(cache(2, 2)[1] == 21);
    CHECK(cache.filled.size() == 5);
}

double squared_distance(feature_rows<> rows, std::size_t i, std::size_t j) {
    double sum = 0;
    for (std::size_t f = 0; f < rows.features(); ++f) {
        const double d = static_cast<double>(rows.row(i)[f]) - static_cast<double>(rows.row(j)[f]);
        sum += d * d;
    }
    return sum;
}

gram_matrix gram_of(feature_rows<> rows, double gamma, std::size_t threads = 1) {
    thread_pool pool(threads);
    measured_samples<rbf_kernel> measured(rows, std::size_t{1} << 30, pool);
    measured.gram->apply(rbf_kernel{gamma}, measured.space.unit(), pool);
    return *measured.gram;
}

TEST_CASE("kernel_space: distances far from the origin, at any scale, of close pairs and of equal ones") {
    support::samples s = support::blobs(150, 20, 3, 0.7);
    for (std::size_t f = 0; f < 20; ++f) {
        s.values[20 + f] = s.values[f];                                     // equal
        s.values[40 + f] = s.values[f] + 1e-4F * static_cast<float>(f % 3); // close
    }
    for (const float scale : {1e-15F, 1.0F, 1e15F})
        for (const float shift : {0.0F, 100.0F}) {
            support::samples moved = s;
            for (float& value : moved.values)
                value = (value + shift) * scale;
            const feature_rows<> rows = moved.rows();
            const double gamma = 0.05 / (static_cast<double>(scale) * static_cast<double>(scale));
            const gram_matrix gram = gram_of(rows, gamma);
            double worst = 0;
            for (std::size_t i = 0; i < 150; ++i)
                for (std::size_t j = 0; j < 150; ++j)
                    worst = std::max(worst, std::abs(static_cast<double>(gram.row(i)[j]) -
                                                     std::exp(-gamma * squared_distance(rows, i, j))));
            CAPTURE(scale);
            CAPTURE(shift);
            // The centre's rounding is that of the shift; sums of 20 terms of squares of about 2.
            const double roundings = 20 + 2 * static_cast<double>(shift);
            CHECK(worst <= roundings * 0x1p-24 * 20);
            CHECK(gram.row(0)[1] == 1);
            CHECK(gram.row(7)[7] == 1);
            const double close = 1 - std::exp(-gamma * squared_distance(rows, 0, 2));
            CHECK(1 - static_cast<double>(gram.row(0)[2]) ==
                  doctest::Approx(close).epsilon(0x1p-23).scale(1));
        }
}

TEST_CASE("kernel_space: a Gram matrix is symmetric and the same on any number of threads, and so are rows "
          "on their own") {
    const support::samples s = support::blobs(200, 30, 2, 1);
    const gram_matrix one = gram_of(s.rows(), 0.1), three = gram_of(s.rows(), 0.1, 3);
    thread_pool alone;
    const measured_samples<rbf_kernel> measured(s.rows(), 0, alone);
    REQUIRE_FALSE(measured.gram.has_value());
    computed_kernel_rows<rbf_kernel> rows(measured.rows, measured.space, {0.1});
    const std::vector<std::size_t> odd{1, 3, 5, 199};
    rows.select(odd);
    bool same = true, symmetric = true, alike = true;
    for (std::size_t i = 0; i < 200; ++i) {
        std::vector<float> row(odd.size());
        rows.fill(i, row.data());
        for (std::size_t k = 0; k < odd.size(); ++k)
            alike = alike && row[k] == one.row(i)[odd[k]];
        for (std::size_t j = 0; j < 200; ++j) {
            same = same && one.row(i)[j] == three.row(i)[j];
            symmetric = symmetric && one.row(i)[j] == one.row(j)[i];
        }
    }
    CHECK(same);
    CHECK(symmetric);
    CHECK(alike);
}

TEST_CASE("kernel_space: rows beyond all bounds are infinitely far, not NaN") {
    for (const float scale : {1.0F, 1e-15F}) {
        support::samples s = support::blobs(4, 5, 2, 1);
        for (float& value : s.values)
            value *= scale;
        const kernel_space<rbf_kernel> space(s.rows());
        std::vector<float> far(5, 3e38F);
        far[1] = -3e38F;
        const std::vector<std::size_t> all = all_samples(4);
        const kernel_columns<rbf_kernel> columns(space.place(s.rows()), all, space.scale());
        aligned_vector<float> row(columns.padded_size());
        columns.measure(space.place({far, 5}), 0, 1, row.data(), row.size());
        rbf_kernel{1e30}.apply(row.data(), row.size(), space.unit());
        for (std::size_t j = 0; j < 4; ++j)
            CHECK(row[j] == 0);
    }
}

TEST_CASE("kernel_space: products that do not fit into float are refused") {
    const support::samples s{2, {1, 2, 1e20F, 1e20F}, {0, 1}};
    CHECK(support::error_of([&] { kernel_space<linear_kernel>{s.rows()}; }).find("row 1") !=
          std::string::npos);
}

TEST_CASE("kernel_space: gamma of scale is one over features times variance, and 1 without variance") {
    const support::samples s{2, {1, 2, 3, 6}, {0, 1}};
    CHECK(*rbf_kernel{}.fitted(s.rows()).gamma == doctest::Approx(1 / (2 * 3.5)));
    const support::samples constant{2, {4, 4, 4, 4}, {0, 1}};
    CHECK(*rbf_kernel{}.fitted(constant.rows()).gamma == 1);
    CHECK(*rbf_kernel{0.25}.fitted(s.rows()).gamma == 0.25);
    for (const double gamma :
         {-1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
        CHECK_THROWS_AS((void)rbf_kernel{gamma}.fitted(s.rows()), std::invalid_argument);
}

// Where a part of the cross-validation leaves one side alone, that side is the answer to what was held out,
// which is of the other one: each of two points is labelled as the other.
TEST_CASE("kernel_training: a part that leaves one side without samples answers with the other side") {
    const support::samples two{1, {-1, 1}, {5, 9}};
    thread_pool alone;
    const auto machine =
        train_kernel_machine(two.rows(), two.labels,
                             kernel_training_options<rbf_kernel>{.probability_folds = 2}, alone)
            .machine;
    const platt_sigmoid expected = fit_platt_sigmoid(std::vector<double>{-1, 1}, std::vector<double>{1, -1}),
                        of_nothing = fit_platt_sigmoid(std::vector<double>{0, 0}, std::vector<double>{1, -1});
    REQUIRE(machine.parameters().sigmoids.size() == 1);
    const platt_sigmoid found = machine.parameters().sigmoids[0];
    CHECK(found.slope == expected.slope);
    CHECK(found.offset == expected.offset);
    CHECK(found.slope != of_nothing.slope);
    CHECK(found.slope >
          0); // the larger the value, the less likely the first class: labelled the wrong way round
}

} // namespace

#include <tactnet/svm/kernel/cache.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <vector>

using namespace tactnet;

TEST_CASE("kernel_cache: the rows used last stay, and rows are cut to the columns that are left") {
    kernel_cache cache(5, 2 * 16 * sizeof(float));
    std::vector<std::size_t> filled;
    const auto row = [&](std::size_t sample, std::size_t columns) {
        return cache.row(sample, columns, [&](float* out) {
            filled.push_back(sample);
            for (std::size_t c = 0; c < columns; ++c)
                out[c] = static_cast<float>(10 * sample + c);
        });
    };
    (void)row(0, 5);
    (void)row(1, 5);
    (void)row(0, 5);
    (void)row(2, 5); // in place of 1
    CHECK(row(0, 5)[4] == 4);
    CHECK(filled == std::vector<std::size_t>{0, 1, 2});
    const std::vector<std::size_t> columns{0, 3, 4};
    cache.keep(columns, columns);
    CHECK(row(0, 3)[1] == 3);
    CHECK(row(0, 3)[2] == 4);
    CHECK(row(0, 3)[3] == 0);
    CHECK(filled.size() == 3);
    CHECK(row(3, 3)[2] == 32);
    CHECK(filled.back() == 3);
}

TEST_CASE("kernel_cache: a row that gave up its place is filled again, and two rows are always there") {
    kernel_cache cache(5, 0);
    std::vector<std::size_t> filled;
    const auto row = [&](std::size_t sample) {
        return cache.row(sample, 5, [&](float* out) {
            filled.push_back(sample);
            for (std::size_t c = 0; c < 5; ++c)
                out[c] = static_cast<float>(10 * sample + c);
        });
    };
    const float* const first = row(0);
    const float* const second = row(1);
    CHECK(first[4] == 4);
    CHECK(second[4] == 14);
    CHECK(row(0) == first);
    CHECK(filled == std::vector<std::size_t>{0, 1});
    CHECK(row(2)[1] == 21); // in place of 1
    CHECK(row(1)[1] == 11); // in place of 0
    CHECK(row(0)[1] == 1);
    CHECK(filled == std::vector<std::size_t>{0, 1, 2, 1, 0});
}

TEST_CASE("kernel_cache: every row that is left is cut, and one that is not is filled when it comes again") {
    kernel_cache cache(5, 5 * 16 * sizeof(float));
    std::vector<std::size_t> filled;
    const auto row = [&](std::size_t sample, std::size_t columns) {
        return cache.row(sample, columns, [&](float* out) {
            filled.push_back(sample);
            for (std::size_t c = 0; c < columns; ++c)
                out[c] = static_cast<float>(10 * sample + c);
        });
    };
    for (const std::size_t sample : {0U, 1U, 2U, 3U})
        (void)row(sample, 5);
    const std::vector<std::size_t> columns{1, 4};
    const std::vector<std::size_t> samples{0, 1, 3};
    cache.keep(columns, samples);
    for (const std::size_t sample : samples) {
        CHECK(row(sample, 2)[0] == static_cast<float>(10 * sample + 1));
        CHECK(row(sample, 2)[1] == static_cast<float>(10 * sample + 4));
        CHECK(row(sample, 2)[2] == 0);
    }
    CHECK(filled.size() == 4);
    CHECK(row(2, 2)[1] == 21);
    CHECK(filled.size() == 5);
}

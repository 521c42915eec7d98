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

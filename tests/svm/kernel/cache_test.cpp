#include <tactnet/svm/kernel/cache.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <vector>

using namespace tactnet;

namespace {

/// Of five samples, with the rows that were filled. Column c of sample s holds 10 s + c.
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

} // namespace

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

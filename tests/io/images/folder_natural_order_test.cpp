#include <tactnet/io/images/folder.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <string>
#include <vector>

using tactnet::natural_less;

TEST_CASE("natural_less: runs of digits count as numbers") {
    // Each comes before all that follow it, and after none.
    const std::vector<std::string> ordered{"",
                                           "0",
                                           "00",
                                           "01",
                                           "1",
                                           "2",
                                           "010",
                                           "10",
                                           "a",
                                           "a0",
                                           "a1",
                                           "a1b",
                                           "a2",
                                           "a2a",
                                           "a2b1",
                                           "a2b10",
                                           "a10",
                                           "a10.jpg",
                                           "b",
                                           "key",
                                           "key1.jpg",
                                           "key02.jpg",
                                           "key2.jpg",
                                           "key10.jpg",
                                           "key99999999999999999999998.jpg",
                                           "key99999999999999999999999.jpg",
                                           "key100000000000000000000000.jpg",
                                           "key_1",
                                           "\xC3\xA9"};
    for (std::size_t i = 0; i < ordered.size(); ++i)
        for (std::size_t j = 0; j < ordered.size(); ++j) {
            CAPTURE(ordered[i]);
            CAPTURE(ordered[j]);
            CHECK(natural_less(ordered[i], ordered[j]) == (i < j));
        }
    // Leading zeros decide only between numbers that are otherwise the same.
    CHECK(natural_less("a01b", "a1c"));
    CHECK(natural_less("a01", "a1"));
    CHECK_FALSE(natural_less("a1", "a01"));
    CHECK(natural_less("a1b", "a01c"));
    CHECK(natural_less("1", "02"));
}

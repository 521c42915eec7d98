#include <tactnet/svm/multiclass.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

using namespace tactnet;

TEST_CASE("deal_folds: they hold about as many of each class, and are those of the seed") {
    std::vector<std::vector<std::size_t>> classes(3);
    for (std::size_t i = 0; i < 31; ++i)
        classes[i % 3].push_back(i);
    const std::vector<std::size_t> folds = deal_folds(classes, 31, 4, 1);
    for (const auto& members : classes)
        for (std::size_t f = 0; f < 4; ++f) {
            const auto count = std::count_if(members.begin(), members.end(),
                                             [&](std::size_t sample) { return folds[sample] == f; });
            CHECK(count >= 2);
            CHECK(count <= 3);
        }
    for (std::size_t f = 0; f < 4; ++f) { // and of all: the next class goes on where the last one ended
        const auto count = std::count(folds.begin(), folds.end(), f);
        CHECK(count >= 7);
        CHECK(count <= 8);
    }
    CHECK(folds == deal_folds(classes, 31, 4, 1));
    CHECK(folds != deal_folds(classes, 31, 4, 2));
}

// tactnet list.

#include "../workshop.hpp"

#include <doctest/doctest.h>

using namespace support;

TEST_SUITE("program") {
    TEST_CASE("list: every method that was compiled in, with what it costs") {
        const workshop shop;
        const outcome all = shop.succeeds("list");
        // TactNet-4 for 22 classes: 6128 parameters of convolutions and batch norms, 64 x 22 + 22 of the last
        // layer. A linear machine: 7 x 13 weights and an offset for each class.
        says(all.out, "\ntactnet4 ");
        says(all.out, " 7 558 ");
        says(all.out, "\nsvm-linear ");
        says(all.out, " 2 024 ");
        for (const char* name : {"\nsvm-rbf ", "\nsurf-svm "})
            says(all.out, name);
        says(shop.succeeds("list --classes 3").out, " 6 323 ");
        says(shop.succeeds("list --help").out, "2 to 22");
        shop.refuses("list --classes 23", "--classes: expected a whole number from 2 to 22, found '23'");
    }
}

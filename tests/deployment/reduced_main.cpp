// Runs the units that are linked (TACTNET_TEST_UNITS lists their functions) and prints what each found, one
// line a unit: the name of the instruction set, then the bits of all outputs. Fails where an output is
// further off than it may be.

#include "reduced.hpp"

#include <cstdio>

int main() {
    reduced_result (*const units[])() = {TACTNET_TEST_UNITS};
    bool good = true;
    for (const auto unit : units) {
        const reduced_result result = unit();
        std::printf("%s", result.instruction_set);
        for (const std::uint32_t bits : result.bits)
            std::printf(" %08x", static_cast<unsigned>(bits));
        std::printf("\n");
        std::fprintf(stderr, "%s: largest error %g of its bound, %g of its deviation\n",
                     result.instruction_set, result.of_bound, result.of_deviation);
        good = good && result.bits.size() == 31 && result.of_bound <= 1 && result.of_deviation <= 1;
    }
    return good ? 0 : 1;
}

// Runs the units that are linked (TACTNET_TEST_UNITS lists their functions) and prints what each found, one
// line a unit: the name of the instruction set, then the bits of all outputs. Fails where an output is
// further off than it may be, and where one in 8 bits is not the same as everywhere.

#include "unit.hpp"

#include <cstdio>

namespace {

/// The hash of all outputs in 8 bits, in their order (FNV-1a): the same with every instruction set and
/// compiler.
constexpr std::uint64_t expected_whole = 0xb7e901a7faff1916;

std::uint64_t hash_of(const std::vector<std::uint32_t>& numbers) {
    std::uint64_t hash = 14695981039346656037u;
    for (const std::uint32_t number : numbers)
        for (int byte = 0; byte < 4; ++byte)
            hash = (hash ^ (number >> 8 * byte & 255)) * 1099511628211u;
    return hash;
}

} // namespace

int main() {
    reduced_result (*const units[])() = {TACTNET_TEST_UNITS};
    bool good = true;
    for (const auto unit : units) {
        const reduced_result result = unit();
        std::printf("%s", result.instruction_set);
        for (const std::uint32_t bits : result.bits)
            std::printf(" %08x", static_cast<unsigned>(bits));
        for (const std::uint32_t bits : result.whole)
            std::printf(" %08x", static_cast<unsigned>(bits));
        std::printf("\n");
        std::fprintf(stderr, "%s: largest error %g of its bound, %g of its deviation\n",
                     result.instruction_set, result.of_bound, result.of_deviation);
        std::fprintf(stderr, "%s: in 8 bits %s, hash %016llx\n", result.instruction_set,
                     result.as_reference ? "as the plain reference" : "not as the plain reference",
                     static_cast<unsigned long long>(hash_of(result.whole)));
        if (!result.same_together)
            std::fprintf(stderr, "%s: frames together have other bits than alone\n", result.instruction_set);
        good = good && result.same_together;
        good = good && result.bits.size() == 31 && result.of_bound <= 1 && result.of_deviation <= 1;
        good = good && result.whole.size() == 334 && result.as_reference &&
               hash_of(result.whole) == expected_whole;
    }
    return good ? 0 : 1;
}

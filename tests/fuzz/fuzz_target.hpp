#pragma once

// What a fuzz target offers: the entry that fuzzing engines call, and the seed corpus.

#include <cstddef>
#include <cstdint>
#include <vector>

/// Must take any bytes. Aborts when something that holds for all inputs does not.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

/// The seed corpus: valid inputs, small, that together show all of the format.
std::vector<std::vector<std::uint8_t>> fuzz_seeds();

#pragma once

// What a fuzz target offers: the entry that fuzzing engines call, and the seed corpus.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

/// Must take any bytes. Aborts when something that holds for all inputs does not.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace fuzz {

inline void require(bool holds) {
    if (!holds)
        std::abort();
}

} // namespace fuzz

/// The seed corpus: valid inputs, small, that together show all of the format.
std::vector<std::vector<std::uint8_t>> fuzz_seeds();

/// Whether an input is taken in every form that its target knows, as the plain test does. A fuzzer takes it
/// in one, which its length says: that is a look at several times as many inputs.
inline bool fuzz_every_form = false;

/// form(i) for the forms i below `forms` that an input of `size` bytes is taken in.
template <class Form>
void fuzz_forms(std::size_t size, std::size_t forms, const Form& form) {
    // By threes, since a decoder's bytes are split according to the rest (decoder_fuzz.hpp).
    for (std::size_t i = 0; i < forms; ++i)
        if (fuzz_every_form || size / 3 % forms == i)
            form(i);
}

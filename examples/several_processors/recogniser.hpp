#pragma once

#include <cstdint>

// What the units for different instruction sets have in common: plain functions over plain memory. A type of
// the library, or a template of the standard library, would be another one in each unit.

/// One unit of the program: the same network, for one instruction set.
struct recogniser {
    const char* instruction_set; ///< as the library names it
    /// Takes the numbers of the network, deployed::folded(), and packs them in this unit's order. Once,
    /// before the first frame.
    void (*take)(const float* folded) noexcept;
    /// Logits of a frame of counts. False: the network or the frame is broken.
    bool (*recognise)(const std::uint8_t* counts, float* logits) noexcept;
};

// One for each unit; CMakeLists.txt has their flags.
extern "C" const recogniser recogniser_base, recogniser_avx2, recogniser_avx512;

#pragma once

#include <cstddef>

// What other libraries do with images; left out with a message where they are absent. Images are float, row
// after row.

namespace benchmark {

struct image_size {
    std::size_t rows, columns;
};

/// The OpenCV that was found.
[[nodiscard]] const char* opencv_version();
/// Everything on the calling thread from here on.
void opencv_on_one_thread();
/// INTER_CUBIC: a = −¾, no antialiasing.
void opencv_resize(const float* from, image_size from_size, float* to, image_size to_size);
/// warpAffine with INTER_LINEAR and zeros around, by a map from output to input: column = m[0] · x + m[1] · y
/// + m[2] and row = m[3] · x + m[4] · y + m[5], counted from the first pixel.
void opencv_affine(const float* from, float* to, image_size size, const double (&map)[6]);

} // namespace benchmark

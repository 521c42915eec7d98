#include <tactnet/image/augmentation.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/simulation/effects/storage.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <support/through_jpeg.hpp>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape size{28, 50}; // four blocks of rows and seven of columns, of which the last are cut
using pixels = tensor<float, size>;

/// Blobs on nothing, as imprints are; now and then noise all over.
pixels drawn(std::uint32_t sample) {
    random_stream random(5, random_purposes::noise, 0, sample);
    pixels counts;
    for (float& count : counts)
        count = sample % 4 == 3 ? static_cast<float>(random.below(256)) : 0;
    for (int blob = 0; blob < 4; ++blob) {
        const double y = random.uniform(0, size.rows), x = random.uniform(0, size.columns),
                     width = random.uniform(0.5, 6), peak = random.uniform(5, 400);
        for (std::size_t i = 0; i < size.size(); ++i) {
            const double dy = static_cast<double>(i / size.columns) - y,
                         dx = static_cast<double>(i % size.columns) - x;
            const double count = static_cast<double>(counts.data()[i]) +
                                 peak * std::exp(-(dx * dx + dy * dy) / (2 * width * width));
            counts.data()[i] = static_cast<float>(std::floor(std::min(count, 255.0)));
        }
    }
    return counts;
}

} // namespace

TEST_CASE("jpeg_storage: count for count what libjpeg writes and reads") {
    for (const int quality : {75, 1, 10, 49, 50, 90, 95, 100})
        for (std::uint32_t sample = 0; sample < 50; ++sample) {
            CAPTURE(quality);
            CAPTURE(sample);
            pixels counts = drawn(sample);
            const std::vector<std::uint8_t> expected =
                support::through_jpeg({counts.begin(), counts.end()}, size.rows, size.columns, quality);
            const simulation::jpeg_storage::bound<size> storage({.quality = quality}, {});
            storage.apply(counts.view(), {});
            std::size_t different = 0;
            for (std::size_t i = 0; i < size.size(); ++i)
                different += counts.data()[i] != static_cast<float>(expected[i]);
            CHECK(different == 0);
        }
}

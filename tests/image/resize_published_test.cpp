#include <tactnet/image/resize.hpp>
#include <tactnet/io/safetensors.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <decode_image.hpp>
#include <filesystem>
#include <support/data_folder.hpp>
#include <vector>

using namespace tactnet;

// The inputs of the published network's test are the authors' own small versions of some real images, five of
// each class. Which ones is not said; with the right kernel some image of the class comes out the same.
TEST_CASE("resize_bicubic: small images as the paper's authors made them") {
    const auto golden_file = support::find_data("published_tactnet4_14x25_golden.safetensors");
    const auto folder = support::find_data("tactile_images");
    if (!golden_file || !folder)
        return;
    const auto golden = safetensors::read(*golden_file).values<std::uint8_t>("inputs");
    std::vector<std::filesystem::path> classes;
    for (const auto& entry : std::filesystem::directory_iterator(*folder))
        if (entry.is_directory())
            classes.push_back(entry.path());
    std::sort(classes.begin(), classes.end());
    REQUIRE(classes.size() * 5 * 350 == golden.size());

    std::size_t exact = 0, near = 0;
    for (std::size_t label = 0; label < classes.size(); ++label) {
        std::vector<int> distances(5, 255);
        for (const auto& entry : std::filesystem::directory_iterator(classes[label])) {
            const grey_image image = decode_image(entry.path());
            const auto small = resize_bicubic(image.pixels, image.rows, image.columns, 14, 25);
            for (std::size_t i = 0; i < 5; ++i) {
                int distance = 0;
                for (std::size_t e = 0; e < 350; ++e)
                    distance = std::max(distance, std::abs(small[e] - golden[(label * 5 + i) * 350 + e]));
                distances[i] = std::min(distances[i], distance);
            }
        }
        for (const int distance : distances)
            exact += distance == 0, near += distance <= 1;
    }
    MESSAGE("of " << golden.size() / 350 << " small images " << near << " match a real one within one count, "
                  << exact << " exactly");
    CHECK(near >= 100);
}

// Whether the paper's touches, reduced to smaller arrays, are felt and left as they are by sensor_health and
// contact_detector with their defaults, and contacts that are found in noisy air.
//
//     benchmark_array_sizes FOLDER_OF_IMAGES

#include "../../tests/decision/touches_by_size.hpp"

#include <cstdio>
#include <decode_image.hpp>
#include <exception>

namespace {

template <tactnet::shape Array>
void report(const tactnet::image_set& images) {
    const auto found = touches_by_size::of_touches<Array>(images);
    std::printf("| %zu x %zu | %u | %zu | %zu | %.0f |", Array.rows, Array.columns,
                tactnet::contact_settings::begin_area_of(Array), found.felt, found.altered, 100 * found.held);
    for (const double deviation : {1.5, 6.0})
        std::printf(" %zu |", touches_by_size::contacts_in_air<Array>(deviation, 100'000, 1));
    std::printf("\n");
}

} // namespace

int main(int count, char** given) {
    if (count != 2) {
        std::fprintf(stderr, "usage: benchmark_array_sizes FOLDER_OF_IMAGES\n");
        return 2;
    }
    try {
        const auto images = tactnet::load_images(tactnet::list_image_folder(given[1]), 28, 50, decode_image);
        std::printf(
            "%zu touches of 30 frames; contacts in 100 000 frames of air, by the deviation of noise\n\n"
            "| array | begin_area | felt | altered | force left after 5 000 frames, %% | 1.5 | 6 |\n"
            "|---|---|---|---|---|---|---|\n",
            images.size());
        report<tactnet::shape{28, 50}>(images);
        report<tactnet::shape{20, 35}>(images);
        report<tactnet::shape{14, 25}>(images);
        report<tactnet::shape{16, 16}>(images);
        report<tactnet::shape{10, 18}>(images);
        report<tactnet::shape{7, 13}>(images);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "benchmark_array_sizes: %s\n", error.what());
        return 2;
    }
}

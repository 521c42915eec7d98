// Shows one tactile image at the paper's resolutions and after each augmentation, in one PNG file. Takes an
// image, or a folder with one subfolder of images a class, of which it shows the one with the most to see.

#include <tactnet/image.hpp>
#include <tactnet/io/images/folder.hpp>
#include <tactnet/io/images/set.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <decode_image.hpp>
#include <exception>
#include <filesystem>
#include <sheet.hpp>
#include <vector>

namespace {

using tactnet::shape;

constexpr shape full{28, 50};
using frame = tactnet::tensor<float, full>;

/// The image as it is, or brought to the size of the paper's sensor.
frame load(const std::filesystem::path& file) {
    const tactnet::grey_image image = decode_image(file);
    const auto pixels =
        tactnet::resize_bicubic(image.pixels, image.rows, image.columns, full.rows, full.columns);
    frame counts;
    std::copy(pixels.begin(), pixels.end(), counts.begin());
    return counts;
}

/// How much the counts of an image differ.
double variance(const frame& counts) {
    double sum = 0, squares = 0;
    for (const float count : counts) {
        sum += static_cast<double>(count);
        squares += static_cast<double>(count * count);
    }
    constexpr auto size = static_cast<double>(full.size());
    return squares / size - sum / size * sum / size;
}

/// The image of a folder with the most to see.
frame find(const std::filesystem::path& folder) {
    frame most;
    for (const auto& file : tactnet::list_image_folder(folder).files) {
        const frame counts = load(file.path);
        if (variance(counts) > variance(most))
            most = counts;
    }
    return most;
}

template <shape Shape>
void show_resized(sheet& page, std::size_t column, const frame& counts) {
    tactnet::tensor<float, Shape> small;
    tactnet::resize<full, Shape>(counts.view(), small.view());
    page.show(0, column, small);
}

void show_moved(sheet& page, std::size_t place, const frame& counts, const tactnet::image_motion& motion) {
    frame moved;
    tactnet::transform_image<full>(tactnet::image_transform::of(motion), counts.view(), moved.view());
    page.show(1 + place / 5, place % 5, moved);
}

sheet draw(const frame& counts) {
    sheet page(3, 5);
    show_resized<shape{28, 50}>(page, 0, counts);
    show_resized<shape{20, 35}>(page, 1, counts);
    show_resized<shape{14, 25}>(page, 2, counts);
    show_resized<shape{10, 18}>(page, 3, counts);
    show_resized<shape{7, 13}>(page, 4, counts);

    show_moved(page, 0, counts, {.reflect_rows = true});
    show_moved(page, 1, counts, {.reflect_columns = true});
    show_moved(page, 2, counts, {.rotation = 10});
    show_moved(page, 3, counts, {.row_shift = 3, .column_shift = -3});
    show_moved(page, 4, counts, {.zoom = 1.2});
    show_moved(page, 5, counts, {.shear = 0.3});
    show_moved(page, 6, counts, {.pressure = 0.6});

    frame noisy = counts;
    tactnet::add_noise<full>({.additive = 4, .relative = 0.1},
                             tactnet::random_stream(1, tactnet::random_purposes::noise), noisy.view());
    page.show(2, 2, noisy);

    // All at once, drawn from ranges: what a training sees.
    for (std::uint32_t sample = 0; sample < 2; ++sample) {
        tactnet::random_stream random(1, tactnet::random_purposes::augmentation, 0, sample);
        show_moved(page, 8 + sample, counts,
                   tactnet::image_motion::draw({0.5, 0.5, 4, 15, 0.1, 0.3, 0.2}, random));
    }
    return page;
}

} // namespace

int main(int count, char** arguments) {
    if (count != 3) {
        std::fprintf(stderr, "images: expected an image or a folder of images, then the PNG file to write\n");
        return 2;
    }
    try {
        const std::filesystem::path source = arguments[1];
        const sheet page = draw(std::filesystem::is_directory(source) ? find(source) : load(source));
        write_png(arguments[2], page.height(), page.width(), page.pixels());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "images: %s\n", error.what());
        return 2;
    }
    return 0;
}

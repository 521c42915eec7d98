#include "picture.hpp"

#include "decode_image.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

void draw(const std::filesystem::path& path, const tactnet::frame_view& frame, tactnet::pressure_unit unit) {
    constexpr std::size_t side = 8;
    const float largest = *std::max_element(frame.cells.begin(), frame.cells.end());
    const bool counts = unit == tactnet::pressure_unit::raw && largest <= 255;
    const float scale = counts || largest == 0 ? 1 : 255 / largest;
    std::vector<std::uint8_t> pixels;
    pixels.reserve(frame.cells.size() * side * side);
    for (std::size_t y = 0; y < frame.rows * side; ++y)
        for (std::size_t x = 0; x < frame.columns * side; ++x)
            pixels.push_back(static_cast<std::uint8_t>(std::lround(frame(y / side, x / side) * scale)));
    write_png(path, frame.rows * side, frame.columns * side, pixels);
}

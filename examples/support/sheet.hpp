#pragma once

#include <tactnet/image/resize.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

/// Pictures of tactile frames in a grid on white.
class sheet {
public:
    sheet(std::size_t rows, std::size_t columns, std::size_t zoom = 4)
        : cell_height_(28 * zoom), cell_width_(50 * zoom), rows_(rows), columns_(columns) {
        pixels_.assign(height() * width(), 255);
    }
    [[nodiscard]] std::size_t height() const { return rows_ * (cell_height_ + gap) + gap; }
    [[nodiscard]] std::size_t width() const { return columns_ * (cell_width_ + gap) + gap; }
    [[nodiscard]] const std::vector<std::uint8_t>& pixels() const { return pixels_; }

    /// Any size is drawn as large as the others, tactel by tactel; contact in dark, light touches lifted.
    template <tactnet::shape Shape>
    void show(std::size_t row, std::size_t column, const tactnet::tensor<float, Shape>& counts) {
        for (std::size_t y = 0; y < cell_height_; ++y)
            for (std::size_t x = 0; x < cell_width_; ++x) {
                const float count = counts(y * Shape.rows / cell_height_, x * Shape.columns / cell_width_);
                pixels_[(gap + row * (cell_height_ + gap) + y) * width() + gap +
                        column * (cell_width_ + gap) + x] =
                    static_cast<std::uint8_t>(240 - tactnet::saturate_to_count(count) * 240 / 255);
            }
    }

private:
    static constexpr std::size_t gap = 8;
    std::size_t cell_height_, cell_width_, rows_, columns_;
    std::vector<std::uint8_t> pixels_;
};

#pragma once

#include <tactnet/simulation/effect.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace tactnet::inline TACTNET_ARCH {
namespace simulation {

/// The cheap model of crosstalk: each tactel also reads a share of its neighbours along its row line and its
/// column line. For what a whole matrix does, see resistive_network.
struct crosstalk {
    static constexpr stage place = stage::circuit;

    double along_row = 0.02;    ///< share of each neighbour to the left and right; chosen. 0 or less is none
    double along_column = 0.02; ///< share of each neighbour above and below

    template <shape Shape>
    class bound {
    public:
        bound(const crosstalk& effect, const mounting&)
            : along_row_(static_cast<float>(std::max(0.0, effect.along_row))),
              along_column_(static_cast<float>(std::max(0.0, effect.along_column))) {}
        void apply(signal<Shape> pressures, const moment&) const noexcept {
            if (along_row_ == 0 && along_column_ == 0)
                return;
            // With a border of nothing, so that all tactels are alike.
            constexpr std::size_t stride = Shape.columns + 2;
            std::array<float, (Shape.rows + 2) * stride> from{};
            for (std::size_t row = 0; row < Shape.rows; ++row)
                std::copy_n(pressures.data() + row * Shape.columns, Shape.columns,
                            from.data() + (row + 1) * stride + 1);
            for (std::size_t row = 0; row < Shape.rows; ++row)
                for (std::size_t column = 0; column < Shape.columns; ++column) {
                    const float* const at = from.data() + (row + 1) * stride + column + 1;
                    pressures(row, column) +=
                        along_row_ * (at[-1] + at[1]) + along_column_ * (*(at - stride) + at[stride]);
                }
        }

    private:
        float along_row_, along_column_;
    };
};

} // namespace simulation
} // namespace tactnet

#pragma once

#include <tactnet/simulation/effect.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// The fast model of crosstalk: each tactel also reads a fraction of its neighbours along its row and column
/// lines. For a whole matrix of resistors, see resistive_network.
struct crosstalk {
    static constexpr stage place = stage::circuit;

    // Fractions are clamped to 0 … ¼, at which a tactel reads as much of its neighbours as of itself.
    double along_row = 0.02;    ///< fraction of each neighbour to the left and right; chosen
    double along_column = 0.02; ///< fraction of each neighbour above and below

    template <shape Shape>
    class bound {
    public:
        bound(const crosstalk& effect, const mounting&)
            : along_row_(kept(effect.along_row)), along_column_(kept(effect.along_column)) {}
        void apply(signal<Shape> pressures, const moment&) const noexcept {
            if (along_row_ == 0 && along_column_ == 0)
                return;
            // With a border of zeros, so that all tactels are alike.
            constexpr std::size_t stride = Shape.columns + 2;
            std::array<float, (Shape.rows + 2) * stride> from{};
            for (std::size_t row = 0; row < Shape.rows; ++row)
                std::copy_n(pressures.data() + row * Shape.columns, Shape.columns,
                            from.data() + (row + 1) * stride + 1);
            for (std::size_t row = 0; row < Shape.rows; ++row)
                for (std::size_t column = 0; column < Shape.columns; ++column) {
                    const float* const at = from.data() + (row + 1) * stride + column + 1;
                    pressures(row, column) += (along_row_ * at[-1] + along_row_ * at[1]) +
                                              (along_column_ * *(at - stride) + along_column_ * at[stride]);
                }
        }

    private:
        static float kept(double share) { return static_cast<float>(share > 0 ? std::min(share, 0.25) : 0); }

        float along_row_, along_column_;
    };
};

}}} // namespace tactnet::simulation

#pragma once

#include <tactnet/simulation/effect.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// Averages the pressure on each tactel. A scene with this effect computes contact and pad on `Cells` ×
/// `Cells` cells per tactel, else on one cell per tactel.
template <std::size_t Cells>
struct tactel_average {
    static_assert(Cells > 0, "tactel_average: there must be at least one cell a tactel");
    static constexpr stage place = stage::tactel;
    static constexpr std::size_t refinement = Cells;
    template <shape In>
    static constexpr shape output{In.rows / Cells, In.columns / Cells};

    template <shape Shape>
    class bound {
    public:
        static constexpr shape tactels = output<Shape>;

        bound(const tactel_average&, const mounting&) {}
        void apply(tensor_view<const float, Shape> cells, signal<tactels> means,
                   const moment&) const noexcept {
            constexpr float share = 1.0f / static_cast<float>(Cells * Cells);
            for (std::size_t row = 0; row < tactels.rows; ++row)
                for (std::size_t column = 0; column < tactels.columns; ++column) {
                    float sum = 0;
                    for (std::size_t y = 0; y < Cells; ++y)
                        for (std::size_t x = 0; x < Cells; ++x)
                            sum += cells(row * Cells + y, column * Cells + x);
                    means(row, column) = sum * share;
                }
        }
    };
};

}}} // namespace tactnet::simulation

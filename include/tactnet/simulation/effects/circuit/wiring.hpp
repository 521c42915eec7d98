#pragma once

#include <tactnet/simulation/effect.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

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

/// Tactels, rows and columns that always read zero: given ones, and random ones per sensor. A tactel that is
/// dead at one probability is also dead at every greater one.
struct dead_tactels {
    static constexpr stage place = stage::circuit;
    static constexpr effect_purpose purpose{1};

    /// The place of a tactel.
    struct tactel {
        std::size_t row, column;
    };
    /// Probabilities, 0 … 1; 0 or less is none. Chosen: three tactels of the paper's sensor.
    double single = 0.002, row = 0, column = 0;
    std::vector<tactel> tactels{};
    std::vector<std::size_t> rows{}, columns{};

    template <shape Shape>
    class bound {
    public:
        /// Throws std::invalid_argument if a given one is outside of the array. May use the heap.
        bound(const dead_tactels& effect, const mounting& where) {
            alive_.fill(true);
            for (const tactel& each : effect.tactels)
                kill(inside(each.row, Shape.rows, "row"), 1, inside(each.column, Shape.columns, "column"), 1);
            for (const std::size_t given : effect.rows)
                kill(inside(given, Shape.rows, "row"), 1, 0, Shape.columns);
            for (const std::size_t given : effect.columns)
                kill(0, Shape.rows, inside(given, Shape.columns, "column"), 1);

            random_stream random = where.unit.random(purpose);
            for (std::size_t y = 0; y < Shape.rows; ++y)
                if (random.uniform() < effect.row)
                    kill(y, 1, 0, Shape.columns);
            for (std::size_t x = 0; x < Shape.columns; ++x)
                if (random.uniform() < effect.column)
                    kill(0, Shape.rows, x, 1);
            for (bool& alive : alive_)
                alive = !(random.uniform() < effect.single) && alive;
        }
        void apply(signal<Shape> pressures, const moment&) const noexcept {
            for (std::size_t i = 0; i < Shape.size(); ++i)
                pressures.data()[i] = alive_[i] ? pressures.data()[i] : 0;
        }

    private:
        static std::size_t inside(std::size_t index, std::size_t count, const char* what) {
            if (index >= count)
                tactnet::detail::throw_invalid_argument(
                    {"dead_tactels: expected a ", what, " below ", count, ", found ", index});
            return index;
        }
        void kill(std::size_t top, std::size_t height, std::size_t left, std::size_t width) {
            for (std::size_t y = top; y < top + height; ++y)
                for (std::size_t x = left; x < left + width; ++x)
                    alive_[y * Shape.columns + x] = false;
        }

        std::array<bool, Shape.size()> alive_;
    };
};

}}} // namespace tactnet::simulation

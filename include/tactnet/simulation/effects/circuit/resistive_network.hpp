#pragma once

#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/simulation/effect.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

namespace detail {

/// Solves matrix · x = right in place for all columns of `right`, and replaces `matrix` by its inverse. Uses
/// the Cholesky decomposition and no heap. Both are row-major; `matrix` (Size × Size) is symmetric and
/// positive definite, and only its lower half is read.
template <std::size_t Size, std::size_t Columns>
void solve_and_invert(double* matrix, double* right) {
    constexpr auto size = static_cast<int>(Size), columns = static_cast<int>(Columns);
    // Eigen requires column-major order for matrices of one column.
    constexpr int square_order = size == 1 ? Eigen::ColMajor : Eigen::RowMajor;
    constexpr int right_order = columns == 1 ? Eigen::ColMajor : Eigen::RowMajor;
    using square = Eigen::Matrix<double, size, size, square_order>;
    Eigen::Map<square> inverse(matrix);
    Eigen::Map<Eigen::Matrix<double, size, columns, right_order>> solution(right);
    const Eigen::LLT<square> factors(inverse);
    factors.solveInPlace(solution);
    inverse.setIdentity();
    factors.solveInPlace(inverse);
}

} // namespace detail

/// The complete crosstalk of a matrix of resistors between row and column lines. To read a tactel, a voltage
/// is applied to its row line, and the current out of its column line, held at zero, is measured. All other
/// lines float except for a conductance to ground, so that current also flows through other tactels: three
/// pressed corners of a rectangle show a ghost at the fourth.
///
/// With K the nodal matrix of all lines and Z = K⁻¹, the tactel of row line i and column line j reads
/// Zᵢⱼ / (Zᵢᵢ Zⱼⱼ − Zᵢⱼ²), so that one inversion gives all readings of a frame. Since row lines are only
/// connected through column lines, K is solved by its Schur complement on the rows.
struct resistive_network {
    static constexpr stage place = stage::circuit;

    /// Siemens of a tactel per pascal, above zero: the conductance of such films is proportional to pressure.
    /// Chosen: 10 kΩ where the paper's sensor saturates.
    double sensitivity = 1e-4 / tekscan_6077::saturation_pressure;
    /// Siemens from each line that is not read to ground: 0 for floating lines, the worst case, infinite for
    /// grounded lines, without crosstalk. At least 10⁻⁹ of the best conducting line is used. Chosen: each
    /// line is grounded through the 100 Ω of an analogue switch.
    double grounding = 1e-2;

    template <shape Shape>
    class bound {
        static_assert(Shape.channels == 1, "resistive_network: there is one layer of tactels");

    public:
        bound(const resistive_network& effect, const mounting&)
            : grounding_(effect.sensitivity > 0 ? effect.grounding / effect.sensitivity
                                                : std::numeric_limits<double>::infinity()) {}
        void apply(signal<Shape> pressures, const moment&) const noexcept {
            if (!(grounding_ <= most))
                return;
            network lines(pressures, grounding_);
            if (!lines.conducts())
                return;
            lines.solve();
            for (std::size_t row = 0; row < Shape.rows; ++row)
                for (std::size_t column = 0; column < Shape.columns; ++column)
                    if (pressures(row, column) == pressures(row, column)) // else NaN stays
                        pressures(row, column) = lines.reading(row, column);
        }

    private:
        static constexpr double most = 1e15; // the highest conductance of a tactel, in pascals as all here

        /// The lines, in units of the highest conductance of a line.
        class network {
        public:
            network(signal<Shape> pressures, double grounding) {
                // Negative pressures, from noise, and NaN do not conduct.
                for (std::size_t i = 0; i < Shape.size(); ++i) {
                    const auto pressure = static_cast<double>(pressures.data()[i]);
                    tactels_[i] = pressure > 0 ? std::min(pressure, most) : 0;
                    rows_[i / Shape.columns] += tactels_[i];
                    columns_[i % Shape.columns] += tactels_[i];
                }
                unit_ = std::max(*std::max_element(rows_.begin(), rows_.end()),
                                 *std::max_element(columns_.begin(), columns_.end()));
                if (!conducts())
                    return;
                ground_ = std::max(grounding / unit_, 1e-9);
                for (double& tactel : tactels_)
                    tactel /= unit_;
                for (double& column : columns_)
                    column = column / unit_ + ground_;
            }
            [[nodiscard]] bool conducts() const { return unit_ > 0; }

            /// inverse_ = Z between rows, across_ = Z between rows and columns, columns_ = diagonal of Z.
            void solve() {
                for (std::size_t row = 0; row < Shape.rows; ++row)
                    for (std::size_t column = 0; column < Shape.columns; ++column)
                        across_[row * Shape.columns + column] = weight(row, column);
                eliminate_columns();
                const std::array<double, Shape.size()> weights = across_;
                detail::solve_and_invert<Shape.rows, Shape.columns>(inverse_.data(), across_.data());
                for (double& column : columns_)
                    column = 1 / column;
                for (std::size_t i = 0; i < Shape.size(); ++i)
                    columns_[i % Shape.columns] += weights[i] * across_[i];
            }
            [[nodiscard]] float reading(std::size_t row, std::size_t column) const {
                const double both = across_[row * Shape.columns + column];
                const double from = inverse_[row * Shape.rows + row] - both, to = columns_[column] - both;
                return static_cast<float>(unit_ / (from + to + from * to / both));
            }

        private:
            [[nodiscard]] double weight(std::size_t row, std::size_t column) const {
                return tactels_[row * Shape.columns + column] / columns_[column];
            }
            /// Computes the Schur complement, in which the column lines are eliminated. All sums are of
            /// positive numbers, so that floating lines lose no digits.
            void eliminate_columns() {
                for (std::size_t row = 0; row < Shape.rows; ++row)
                    for (std::size_t other = 0; other < row; ++other) {
                        double joined = 0;
                        for (std::size_t column = 0; column < Shape.columns; ++column)
                            joined += tactels_[row * Shape.columns + column] *
                                      across_[other * Shape.columns + column];
                        inverse_[row * Shape.rows + other] = -joined;
                        inverse_[row * Shape.rows + row] += joined;
                        inverse_[other * Shape.rows + other] += joined;
                    }
                for (std::size_t row = 0; row < Shape.rows; ++row) {
                    double to_ground = 1;
                    for (std::size_t column = 0; column < Shape.columns; ++column)
                        to_ground += across_[row * Shape.columns + column];
                    inverse_[row * Shape.rows + row] += ground_ * to_ground;
                }
            }

            std::array<double, Shape.size()> tactels_, across_;
            std::array<double, Shape.rows> rows_{};
            std::array<double, Shape.columns> columns_{};
            std::array<double, Shape.rows * Shape.rows> inverse_{};
            double unit_ = 0, ground_ = 0;
        };

        double grounding_; // in pascals of a tactel with that conductance
    };
};

}}} // namespace tactnet::simulation

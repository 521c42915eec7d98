#include "dense_contact.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

namespace hard_cases {

namespace {

using real = long double;
constexpr real pi = std::numbers::pi_v<real>;

/// Nodes and weights of Gauss and Legendre with ten points, by Newton's method.
struct gauss {
    static constexpr int points = 10;
    std::array<real, points> place, weight;

    gauss() {
        for (int i = 0; i < points; ++i) {
            real x = std::cos(pi * (static_cast<real>(i) + 0.75L) / (points + 0.5L)), slope = 0;
            for (int step = 0; step < 8; ++step) {
                real before = 1, now = x;
                for (int n = 2; n <= points; ++n)
                    before = std::exchange(now, ((2 * n - 1) * x * now - (n - 1) * before) / n);
                slope = points * (before - x * now) / (1 - x * x);
                x -= now / slope;
            }
            place[static_cast<std::size_t>(i)] = x;
            weight[static_cast<std::size_t>(i)] = 2 / ((1 - x * x) * slope * slope);
        }
    }
    template <class Function>
    [[nodiscard]] real over(real from, real to, const Function& f) const {
        real sum = 0;
        for (std::size_t i = 0; i < points; ++i)
            sum += weight[i] * f((from + to) / 2 + (to - from) / 2 * place[i]);
        return sum * (to - from) / 2;
    }
};

/// J₁ ÷ z: its power series up to 20, which loses seven of nineteen digits, and Hankel's beyond, whose first
/// 20 terms leave 1e-16.
real bessel_one_over(real z) {
    if (z < 20) {
        const real quarter = -z * z / 4;
        real term = 0.5L, sum = term;
        for (int n = 1; std::abs(term) > 1e-22L; ++n)
            sum += term *= quarter / (static_cast<real>(n) * (n + 1));
        return sum;
    }
    real even = 0, odd = 0, term = 1;
    for (int n = 0; n < 20; n += 2) {
        even += term;
        term *= (4 - static_cast<real>(2 * n + 1) * (2 * n + 1)) / (8 * z * (n + 1));
        odd += term;
        term *= -(4 - static_cast<real>(2 * n + 3) * (2 * n + 3)) / (8 * z * (n + 2));
    }
    const real phase = z - 3 * pi / 4;
    return std::sqrt(2 / (pi * z)) * (even * std::cos(phase) - odd * std::sin(phase)) / z;
}

/// What the base holds back within a distance: ∫₀ˢ f(r) r dr with f(r) = ∫₀^∞ (1 − M(x)) J₀(xr) dx, which is
/// s² ∫₀^∞ (1 − M(x)) J₁(xs) ÷ (xs) dx. From s = 50 on it is s − M'(0) but for e⁻³⁶.
class held_within {
public:
    explicit held_within(real poisson)
        : slope_((1 - 2 * poisson) / (2 * (1 - poisson) * (1 - poisson))),
          coarse_(25, poisson),
          fine_(100, poisson) {}

    [[nodiscard]] real operator()(real s) const {
        if (s > 50)
            return s - slope_;
        // Two periods of the Bessel function in a piece at most.
        const samples& over = s > 12 ? fine_ : coarse_;
        real sum = 0;
        for (std::size_t i = 0; i < over.places.size(); ++i)
            sum += over.weights[i] * bessel_one_over(over.places[i] * s);
        return s * s * sum;
    }

private:
    /// Of 1 − M up to 25, where it is 1e-18.
    struct samples {
        std::vector<real> places, weights;

        samples(int pieces, real poisson) {
            const gauss rule;
            const real width = real{25} / pieces;
            for (int piece = 0; piece < pieces; ++piece)
                for (std::size_t i = 0; i < gauss::points; ++i) {
                    const real x = width * (static_cast<real>(piece) + (1 + rule.place[i]) / 2);
                    places.push_back(x);
                    weights.push_back(width / 2 * rule.weight[i] * held_back(x, poisson));
                }
        }
    };

    real slope_;
    samples coarse_, fine_;
};

/// Both coordinates half whole numbers: ∬ over the rectangle from the origin to (a, b) of what depends on the
/// distance alone, by the two triangles that it is made of. `within(R)` is the integral of f(r) r up to R.
template <class Within>
class corners {
public:
    corners(std::size_t reach, const Within& within) : reach_(reach), triangles_(reach * reach) {
        const gauss rule;
        for (std::size_t a = 0; a < reach; ++a) {
            const real beside = static_cast<real>(a) + 0.5L;
            real sum = 0, from = 0;
            for (std::size_t b = 0; b < reach; ++b) {
                for (const real to = static_cast<real>(b) + 0.5L; from < to; from += 0.25L)
                    sum += rule.over(from, from + 0.25L, [&](real along) {
                        const real squared = beside * beside + along * along;
                        return within(std::sqrt(squared)) * beside / squared;
                    });
                triangles_[a * reach + b] = sum;
            }
        }
    }
    /// Over the cell so far away.
    [[nodiscard]] real cell(std::size_t row, std::size_t column) const {
        const auto signed_corner = [&](std::size_t at, bool before) {
            // The edge before the first cell lies on the other side of the origin.
            return !before ? std::pair{at, 1} : at > 0 ? std::pair{at - 1, 1} : std::pair{at, -1};
        };
        real sum = 0;
        for (const bool above : {false, true})
            for (const bool left : {false, true}) {
                const auto [y, side] = signed_corner(row, above);
                const auto [x, other] = signed_corner(column, left);
                sum += (above == left ? 1 : -1) * side * other *
                       (triangles_[y * reach_ + x] + triangles_[x * reach_ + y]);
            }
        return sum;
    }

private:
    std::size_t reach_;
    std::vector<real> triangles_;
};

template <class Within>
dense_surface surface_of(std::size_t rows, std::size_t columns, const Within& within) {
    const corners<Within> all(std::max(rows, columns), within);
    dense_surface surface{rows, columns, {}};
    for (std::size_t y = 0; y < rows; ++y)
        for (std::size_t x = 0; x < columns; ++x)
            surface.sinking.push_back(all.cell(y, x) / pi);
    return surface;
}

using matrix = std::vector<std::vector<real>>;

/// matrix · x = right by elimination with pivots, for all columns of `right`, in place.
void solve(matrix a, matrix& right) {
    const std::size_t n = a.size();
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t pivot = k;
        for (std::size_t i = k; i < n; ++i)
            pivot = std::abs(a[i][k]) > std::abs(a[pivot][k]) ? i : pivot;
        std::swap(a[k], a[pivot]), std::swap(right[k], right[pivot]);
        for (std::size_t i = 0; i < n; ++i) {
            const real factor = i == k ? 0 : a[i][k] / a[k][k];
            for (std::size_t j = k; factor != 0 && j < n; ++j)
                a[i][j] -= factor * a[k][j];
            for (std::size_t j = 0; factor != 0 && j < right[i].size(); ++j)
                right[i][j] -= factor * right[k][j];
        }
    }
    for (std::size_t k = 0; k < n; ++k)
        for (real& value : right[k])
            value /= a[k][k];
}

} // namespace

long double dense_surface::between(std::size_t a, std::size_t b) const {
    const auto apart = [](std::size_t one, std::size_t other) {
        return one > other ? one - other : other - one;
    };
    return sinking[apart(a / columns, b / columns) * columns + apart(a % columns, b % columns)];
}

long double held_back(long double x, long double poisson) {
    const real kappa = 3 - 4 * poisson, rest = (kappa * kappa + 1) / 2 + 2 * x * x;
    return (kappa * std::exp(-2 * x) + 2 * x + rest) / (kappa * std::cosh(2 * x) + rest);
}

dense_surface dense_half_space(std::size_t rows, std::size_t columns) {
    return surface_of(rows, columns, [](real distance) { return distance; });
}

dense_surface dense_layer(std::size_t rows, std::size_t columns, double thickness, double poisson) {
    const held_within held(poisson);
    const real t = thickness;
    return surface_of(rows, columns, [&](real distance) { return distance - t * held(distance / t); });
}

dense_contact pressed_to(const dense_surface& surface, const std::vector<double>& heights, long double load) {
    const std::size_t all = surface.cells();
    const double lowest = *std::min_element(heights.begin(), heights.end());
    const auto height = [&](std::size_t i) { return static_cast<real>(heights[i]) - lowest; };
    std::vector<bool> in_contact(all);
    for (std::size_t i = 0; i < all; ++i)
        in_contact[i] = std::isfinite(heights[i]);
    for (int round = 0; round < 200; ++round) {
        std::vector<std::size_t> cells;
        for (std::size_t i = 0; i < all; ++i)
            if (in_contact[i])
                cells.push_back(i);
        const std::size_t n = cells.size();
        REQUIRE(n > 0);
        // Pressures for a level of 1 and for the heights, and the inverse.
        matrix a(n, std::vector<real>(n)), right(n, std::vector<real>(n + 2));
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = 0; j < n; ++j)
                a[i][j] = surface.between(cells[i], cells[j]);
            right[i][0] = 1, right[i][1] = height(cells[i]), right[i][i + 2] = 1;
        }
        solve(a, right);
        real of_level = 0, of_heights = 0;
        dense_contact found{std::vector<real>(all), 0, 0};
        for (const auto& row : right) {
            of_level += row[0], of_heights += row[1];
            real sum = 0;
            for (std::size_t j = 2; j < row.size(); ++j)
                sum += std::abs(row[j]);
            found.sensitivity = std::max(found.sensitivity, sum);
        }
        found.depth = (load + of_heights) / of_level;
        bool changed = false;
        for (std::size_t i = 0; i < n; ++i) {
            found.pressures[cells[i]] = found.depth * right[i][0] - right[i][1];
            if (found.pressures[cells[i]] < 0)
                in_contact[cells[i]] = false, changed = true;
        }
        // Let go first; then the cell that overlaps most comes in.
        real most = 0;
        std::size_t deepest = all;
        for (std::size_t i = 0; !changed && i < all; ++i) {
            if (in_contact[i] || !std::isfinite(heights[i]))
                continue;
            real overlap = found.depth - height(i);
            for (const std::size_t j : cells)
                overlap -= surface.between(i, j) * found.pressures[j];
            if (overlap > most)
                most = overlap, deepest = i;
        }
        if (deepest < all)
            in_contact[deepest] = changed = true;
        if (!changed)
            return found;
    }
    FAIL("no contact was found");
    return {};
}

} // namespace hard_cases

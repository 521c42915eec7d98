#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/simd/unroll.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

// Finds the row of a matrix nearest to a point. ‖x − w‖² is smallest where x·w − ‖w‖²/2 is largest, so the
// search is a matrix product whose results stay in registers: it keeps only the largest of each lane.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Rows of `Values` numbers, packed for the search. The result of a point does not depend on other points.
template <std::size_t Values>
class nearest_row {
public:
    /// `rows` lie one after the other. Throws std::bad_alloc.
    explicit nearest_row(std::span<const float> rows = {})
        : panels_(ceil_div(rows.size() / Values, panel)),
          packed_(panels_ * panel * Values),
          offsets_(panels_ * panel,
                   -std::numeric_limits<float>::infinity()) { // lanes without a row never win
        for (std::size_t row = 0; row < rows.size() / Values; ++row) {
            double squares = 0;
            for (std::size_t v = 0; v < Values; ++v) {
                const float value = rows[row * Values + v];
                packed_[(row / panel * Values + v) * panel + row % panel] = value;
                squares += static_cast<double>(value) * static_cast<double>(value);
            }
            offsets_[row] = static_cast<float>(-squares / 2);
        }
    }

    /// Points that are searched together: calls with a multiple of this count are the fastest.
    static constexpr std::size_t group = 48;

    /// index[i] = the row nearest to point i by x·w − ‖w‖²/2 in single precision; the first of equally near
    /// rows. Points lie one after the other. Without rows, or for a point with NaN, the index is 0.
    void find(const float* points, std::size_t count, std::uint32_t* index) const noexcept {
        for (std::size_t first = 0; first < count; first += group)
            search(points + first * Values, std::min(group, count - first), index + first);
    }

private:
    // A block of points × vectors of sums stays in registers; a group of points and a panel of rows stay in
    // the first cache.
    static constexpr std::size_t block_points = 6;
    static constexpr std::size_t block_vectors = vector_registers >= 32 ? 4 : 2;
    static constexpr std::size_t panel = block_vectors * lanes<float>;

    struct best {
        alignas(vector_alignment) std::array<float, lanes<float>> score, row;
    };

    void search(const float* points, std::size_t count, std::uint32_t* index) const noexcept {
        std::array<best, group> found;
        for (std::size_t i = 0; i < count; ++i) {
            found[i].score.fill(-std::numeric_limits<float>::infinity());
            found[i].row.fill(0);
        }
        // The last block overlaps the one before, which is faster than single points. Comparing a point twice
        // changes nothing.
        for (std::size_t p = 0; p < panels_; ++p)
            for (std::size_t i = 0; i < count; i += count < block_points ? 1 : block_points)
                if (count < block_points) {
                    compare<1>(points + i * Values, p, &found[i]);
                } else {
                    const std::size_t first = std::min(i, count - block_points);
                    compare<block_points>(points + first * Values, p, &found[first]);
                }
        for (std::size_t i = 0; i < count; ++i)
            index[i] = first_largest(found[i]);
    }
    /// `Points` points against one panel of rows.
    template <std::size_t Points>
    [[gnu::flatten]] void compare(const float* points, std::size_t p, best* found) const noexcept {
        const float* packed = packed_.data() + p * panel * Values;
        std::array<std::array<vector<float>, block_vectors>, Points> sums;
        unroll<Points>([&](auto i) __attribute__((always_inline)) {
            unroll<block_vectors>([&](auto v) __attribute__((always_inline)) {
                sums[i][v] = load(offsets_.data() + p * panel + v * lanes<float>);
            });
        });
        for (std::size_t k = 0; k < Values; ++k, packed += panel) {
            std::array<vector<float>, block_vectors> rows;
            unroll<block_vectors>([&](auto v) __attribute__((always_inline)) {
                rows[v] = load(packed + v * lanes<float>);
            });
            unroll<Points>([&](auto i) __attribute__((always_inline)) {
                const vector<float> value(points[i * Values + k]);
                unroll<block_vectors>([&](auto v) __attribute__((always_inline)) {
                    sums[i][v] = multiply_add(rows[v], value, sums[i][v]);
                });
            });
        }
        unroll<Points>([&](auto i) __attribute__((always_inline)) {
            vector<float> score = load(found[i].score.data()), row = load(found[i].row.data());
            unroll<block_vectors>([&](auto v) __attribute__((always_inline)) {
                const auto larger = sums[i][v] > score;
                score = choose<float>(larger, sums[i][v], score);
                row = choose<float>(larger, vector<float>(static_cast<float>(p * block_vectors + v)), row);
            });
            store(found[i].score.data(), score);
            store(found[i].row.data(), row);
        });
    }
    /// The first row among the lanes with the largest score; row 0 if no score was larger than the start.
    /// Lane l holds a row of vector `row[l]`.
    [[nodiscard]] static std::uint32_t first_largest(const best& b) noexcept {
        const float score = *std::max_element(b.score.begin(), b.score.end());
        std::uint32_t result = std::numeric_limits<std::uint32_t>::max();
        for (std::size_t lane = 0; lane < lanes<float>; ++lane) {
            const auto row =
                static_cast<std::uint32_t>(static_cast<std::size_t>(b.row[lane]) * lanes<float> + lane);
            if (b.score[lane] == score)
                result = std::min(result, row);
        }
        return result;
    }

    std::size_t panels_;
    aligned_vector<float> packed_, offsets_;
};

}}} // namespace tactnet::kernels

#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/arch/compiler_vector.hpp>
#include <tactnet/kernels/panels/product.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

// A · Bᵀ, the products of every row of one matrix with every row of another, where B is packed in the order
// of use. Unlike a general matrix product, it adds in one fixed order, whatever the number of rows: a row
// alone is bit-identical with the same row in a batch.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The rows of B. The features of as many rows as fill a panel lie side by side.
class packed_rows {
public:
    /// Vectors of a panel, and rows of A that are multiplied together: all sums stay in registers.
    static constexpr std::size_t panel_vectors = vector_registers / 8, block_rows = 6;
    static constexpr std::size_t panel_width = panel_vectors * lanes<float>;

    packed_rows() = default;
    /// row(i) points to the `features` values of row i.
    template <class Row>
    packed_rows(std::size_t rows, std::size_t features, const Row& row)
        : rows_(rows), features_(features), values_(padded_rows() * features) {
        for (std::size_t i = 0; i < rows; ++i) {
            const float* from = row(i);
            float* to = values_.data() + i / panel_width * panel_width * features + i % panel_width;
            for (std::size_t f = 0; f < features; ++f)
                to[f * panel_width] = from[f];
        }
    }

    [[nodiscard]] std::size_t rows() const { return rows_; }
    [[nodiscard]] std::size_t features() const { return features_; }
    /// Rows in whole panels: the elements that `products` writes for each row of A. Those after the last row
    /// are zero.
    [[nodiscard]] std::size_t padded_rows() const { return round_up(rows_, panel_width); }

    /// out[i][j] = row i of A · row j of B. Rows of A begin `stride` floats apart, those of `out` (aligned)
    /// `out_stride`, a multiple of the panel width.
    void products(const float* a, std::size_t count, std::size_t stride, float* out,
                  std::size_t out_stride) const {
        for (std::size_t first = 0; first < rows_; first += panel_width)
            panel_products(first, a, count, stride, out + first, out_stride);
    }
    /// The columns first … first + panel_width − 1 of these products alone, to the beginning of `out`.
    void panel_products(std::size_t first, const float* a, std::size_t count, std::size_t stride, float* out,
                        std::size_t out_stride) const {
        const float* const panel = values_.data() + first * features_;
        std::size_t i = 0;
        for (; i + block_rows <= count; i += block_rows)
            block<block_rows>(panel, a + i * stride, stride, out + i * out_stride, out_stride);
        for (; i < count; ++i)
            block<1>(panel, a + i * stride, stride, out + i * out_stride, out_stride);
    }

private:
    /// Terms that are added in registers before they go to the total: the error grows with the length of a
    /// run plus the number of runs, not with their product.
    static constexpr std::size_t run = 128;

    template <std::size_t Rows>
    [[gnu::noinline]] void block(const float* panel, const float* a, std::size_t stride, float* out,
                                 std::size_t out_stride) const {
        for (std::size_t first = 0; first == 0 || first < features_; first += run)
            multiply_panel<Rows, panel_vectors>({.input = a + first,
                                                 .input_stride = stride,
                                                 .lines = 1,
                                                 .depth = std::min(run, features_ - first),
                                                 .line_distance = 0,
                                                 .output = out,
                                                 .output_stride = out_stride},
                                                panel + first * panel_width, 0, {.accumulates = first > 0});
    }

    std::size_t rows_ = 0, features_ = 0;
    aligned_vector<float> values_;
};

/// sums[c] += Σ weights[r] · rows[r · Columns + c], over `Rows` rows of `Columns` floats, of any alignment.
template <std::size_t Rows, std::size_t Columns>
[[gnu::flatten]] void add_weighted_rows(const float* weights, const float* rows, float* sums) noexcept {
    constexpr std::size_t width = std::min(std::bit_floor(Columns), lanes<float>);
    constexpr std::size_t count = ceil_div(Columns, width), most = std::min<std::size_t>(count, 4);
    using vector = float_vec<width>;
    // The last vector may begin amid the one before it: it then computes some of its sums once more.
    std::array<float, Columns> found;
    blocked<count, most>([&](auto block, std::size_t first) {
        constexpr std::size_t vectors = block, chains = std::max<std::size_t>(8 / vectors, 1);
        const auto column = [&](std::size_t v) { return std::min((first + v) * width, Columns - width); };
        register_block<vector, chains, vectors> parts{};
        const auto add = [&](std::size_t chain, std::size_t r) __attribute__((always_inline)) {
#pragma GCC unroll 8
            for (std::size_t v = 0; v < vectors; ++v)
                parts[chain][v] += weights[r] * load_bytes_as<vector>(rows + r * Columns + column(v));
        };
        for (std::size_t r = 0; r + chains <= Rows; r += chains) { // chains of additions hide their latency
#pragma GCC unroll 8
            for (std::size_t chain = 0; chain < chains; ++chain)
                add(chain, r + chain);
        }
#pragma GCC unroll 8
        for (std::size_t r = Rows / chains * chains; r < Rows; ++r)
            add(r % chains, r);
#pragma GCC unroll 8
        for (std::size_t v = 0; v < vectors; ++v) {
            vector sum{};
#pragma GCC unroll 8
            for (std::size_t chain = 0; chain < chains; ++chain)
                sum += parts[chain][v];
            store_any(found.data() + column(v), sum);
        }
    });
    for (std::size_t c = 0; c < Columns; ++c)
        sums[c] += found[c];
}

// Finds the row of a matrix nearest to a point. ‖x − w‖² is smallest where x·w − ‖w‖²/2 is largest, so the
// search is a matrix product whose results stay in registers: it keeps only the largest of each lane.

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

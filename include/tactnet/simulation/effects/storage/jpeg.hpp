#pragma once

#include <tactnet/simulation/effect.hpp>
#include <tactnet/simulation/effects/storage/jpeg_block.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace simulation {

/// Counts as they come back from a grey JPEG file, as the paper's images are stored: small counts around each
/// imprint, and edges that are not quite where they were. A value that is no count 0 … 255 is rounded to the
/// nearest; NaN is 0.
struct jpeg_storage {
    static constexpr stage place = stage::storage;

    int quality =
        75; ///< as libjpeg counts, 1 … 100: that of the paper's files. 0 or less stores without loss

    template <shape Shape>
    class bound {
        static_assert(Shape.channels == 1, "jpeg_storage: there is one grey channel");

    public:
        bound(const jpeg_storage& effect, const mounting&)
            : lossless_(effect.quality <= 0), divisors_(jpeg_divisors(effect.quality)) {
            jpeg_write_and_read(blank_, divisors_);
        }
        void apply(signal<Shape> counts, const moment&) const noexcept {
            if (lossless_)
                return;
            for (std::size_t row = 0; row < Shape.rows; row += side)
                for (std::size_t column = 0; column < Shape.columns; column += side)
                    store_block(counts, row, column);
        }

    private:
        static constexpr std::size_t side = 8;

        /// A block that reaches beyond the image repeats its last row and column, as libjpeg does.
        void store_block(signal<Shape> counts, std::size_t first_row, std::size_t first_column) const {
            jpeg_block block;
            bool blank = true;
            for (std::size_t y = 0; y < side; ++y)
                for (std::size_t x = 0; x < side; ++x) {
                    const float count = counts(std::min(first_row + y, Shape.rows - 1),
                                               std::min(first_column + x, Shape.columns - 1));
                    const float kept = count > 0 ? (count < 255 ? count : 255) : 0;
                    block[y * side + x] = static_cast<std::int32_t>(kept + 0.5f);
                    blank = blank && block[y * side + x] == 0;
                }
            if (blank) // as most are
                block = blank_;
            else
                jpeg_write_and_read(block, divisors_);
            for (std::size_t y = 0; y < std::min(side, Shape.rows - first_row); ++y)
                for (std::size_t x = 0; x < std::min(side, Shape.columns - first_column); ++x)
                    counts(first_row + y, first_column + x) = static_cast<float>(block[y * side + x]);
        }

        bool lossless_;
        jpeg_block divisors_;
        jpeg_block blank_{}; // what becomes of a block of nothing: at the lowest qualities not quite nothing
    };
};

} // namespace simulation
} // namespace TACTNET_ARCH
} // namespace tactnet

#include <tactnet/tensor/shape.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>

using namespace tactnet;

namespace {

constexpr sliding_window over(std::size_t size, std::size_t kernel, std::size_t stride,
                              padding around = padding::same) {
    return sliding_window::over({size, size, 1}, kernel, stride, around);
}

} // namespace

// Sizes are constants, so most of what there is to test about them is tested by compiling.

static_assert(shape{28, 50}.channels == 1 && shape{28, 50, 8}.area() == 1400 &&
              shape{28, 50, 8}.size() == 11200);
static_assert(shape{} == shape{1, 1, 1});
static_assert(extent2d{5} == extent2d{5, 5} && extent2d{2, 3}.area() == 6);

// An odd kernel pads alike on both sides, an even one only at the bottom and to the right.
static_assert(over(7, 3, 1).top == 1 && over(7, 3, 1).bottom == 1);
static_assert(over(7, 5, 1).left == 2 && over(7, 5, 1).right == 2);
static_assert(over(7, 2, 1).top == 0 && over(7, 2, 1).bottom == 1 && over(7, 2, 1).left == 0 &&
              over(7, 2, 1).right == 1);
static_assert(over(7, 4, 1).top == 1 && over(7, 4, 1).bottom == 2);
// With a stride only what is missing is added.
static_assert(over(8, 2, 2).bottom == 0 && over(7, 2, 2).top == 0 && over(7, 2, 2).bottom == 1);
static_assert(over(8, 3, 2).top == 0 && over(8, 3, 2).bottom == 1 && over(7, 3, 2).top == 1 &&
              over(7, 3, 2).bottom == 1);
static_assert(over(5, 1, 3).top == 0 && over(5, 1, 3).bottom == 0 && over(5, 1, 3).output_rows() == 2);
// Valid drops what does not hold a whole window; pads given are taken as they are.
static_assert(over(7, 2, 2, padding::valid).output_rows() == 3 &&
              over(7, 3, 2, padding::valid).output_rows() == 3);
static_assert(over(28, 5, 2, pad(2)).output_rows() == 14 && over(7, 3, 1, pad(2)).output_rows() == 9);
static_assert(pad(3) == pad(3, 3, 3, 3) && !(pad(0) == padding::same) && pad(0) == padding::valid);
constexpr sliding_window sides = sliding_window::over({5, 4, 1}, 3, 1, pad(0, 1, 2, 0));
static_assert(sides.top == 0 && sides.bottom == 1 && sides.left == 2 && sides.right == 0);
static_assert(sides.output_rows() == 4 && sides.output_columns() == 4);
// Too large to fit, whichever side.
static_assert(over(4, 5, 1, padding::valid).fits() == false && over(5, 5, 1, padding::valid).fits() &&
              over(4, 5, 1, pad(1)).fits());
static_assert(!sliding_window::over({9, 2, 1}, {1, 3}, 1, padding::valid).fits());
static_assert(over(1, 7, 1).fits() && over(1, 7, 1).output_rows() == 1);

TEST_CASE("sliding_window: 'same' keeps ceil(size / stride) outputs, whatever the kernel") {
    for (std::size_t size = 1; size <= 20; ++size)
        for (std::size_t kernel = 1; kernel <= 8; ++kernel)
            for (std::size_t stride = 1; stride <= 4; ++stride) {
                CAPTURE(size);
                CAPTURE(kernel);
                CAPTURE(stride);
                const sliding_window w = over(size, kernel, stride);
                CHECK(w.output_rows() == (size + stride - 1) / stride);
                CHECK(w.fits());
                CHECK(w.top <= w.bottom);
                CHECK(w.bottom <= w.top + 1);
                CHECK(w.bottom < kernel); // every window holds a pixel
            }
}

// One window after another, as a reader counts them: in ceil mode the last one may reach over the padding's
// end, but has to begin before it.
TEST_CASE("sliding_window: ceil mode adds the window that hangs over, and only that") {
    for (std::size_t size = 1; size <= 12; ++size)
        for (std::size_t kernel = 1; kernel <= 5; ++kernel)
            for (std::size_t stride = 1; stride <= 4; ++stride)
                for (std::size_t before = 0; before <= 2; ++before) {
                    // As PyTorch, which refuses padding of more than half a kernel.
                    if (size + 2 * before < kernel || 2 * before > kernel)
                        continue;
                    CAPTURE(size);
                    CAPTURE(kernel);
                    CAPTURE(stride);
                    CAPTURE(before);
                    std::size_t outputs = 1;
                    while ((outputs - 1) * stride + kernel < size + 2 * before)
                        ++outputs;
                    while (outputs > 1 && (outputs - 1) * stride >= size + before)
                        --outputs;
                    padding around = pad(before);
                    around.how = padding::rule::ceil_mode;
                    const sliding_window w =
                        sliding_window::over({size, size + stride, 1}, kernel, stride, around);
                    const std::size_t end = (outputs - 1) * stride + kernel;
                    CHECK(w.output_rows() == outputs);
                    CHECK(w.top == before);
                    CHECK(w.bottom == (end > size + 2 * before ? end - size - before : before));
                    if (end >= size + 2 * before)
                        CHECK(w.output_columns() == outputs + 1);
                }
}

TEST_CASE("sliding_window: a stride of zero counts as one") {
    for (const extent2d stride : {extent2d{0, 2}, extent2d{2, 0}, extent2d{0, 0}}) {
        const sliding_window w = sliding_window::over({7, 9, 1}, 3, stride, padding::valid);
        CHECK(w.output_rows() == (stride.rows == 0 ? 5U : 3U));
        CHECK(w.output_columns() == (stride.columns == 0 ? 7U : 4U));
    }
}

TEST_CASE("sliding_window: taps on pixels, counted one by one") {
    for (const std::size_t rows : {1u, 4u, 7u})
        for (const std::size_t columns : {1u, 5u})
            for (const extent2d kernel : {extent2d{1}, extent2d{2}, extent2d{3, 5}, extent2d{4, 1}})
                for (const extent2d stride : {extent2d{1}, extent2d{2, 1}, extent2d{3}})
                    for (const padding around :
                         {padding::same, pad(1), pad(2), pad(0, 1, 2, 0), padding::valid}) {
                        const sliding_window w =
                            sliding_window::over({rows, columns, 3}, kernel, stride, around);
                        if (!w.fits())
                            continue;
                        std::size_t taps = 0;
                        for (std::size_t y = 0; y < w.output_rows(); ++y)
                            for (std::size_t x = 0; x < w.output_columns(); ++x)
                                for (std::size_t i = 0; i < kernel.rows; ++i)
                                    for (std::size_t j = 0; j < kernel.columns; ++j) {
                                        const std::size_t row = y * stride.rows + i,
                                                          column = x * stride.columns + j;
                                        taps += row >= w.top && row < w.top + rows && column >= w.left &&
                                                column < w.left + columns;
                                    }
                        CHECK(w.taps_on_pixels() == taps);
                    }
}

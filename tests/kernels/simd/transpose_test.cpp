#include <tactnet/kernels/simd/transpose.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <cstddef>

using namespace tactnet;
using namespace tactnet::kernels;

TEST_CASE_TEMPLATE("transpose: rows become columns, at any distance from each other", T, float, double) {
    constexpr std::size_t width = lanes<T>, from_stride = 3 * width, to_stride = width + 1; // not aligned
    aligned_vector<T> from(width * from_stride), to(width * to_stride, T{-1});
    for (std::size_t i = 0; i < from.size(); ++i)
        from[i] = static_cast<T>(i);
    transpose(from.data(), from_stride, to.data(), to_stride);
    for (std::size_t i = 0; i < width; ++i) {
        for (std::size_t j = 0; j < width; ++j)
            CHECK(to[i * to_stride + j] == from[j * from_stride + i]);
        CHECK(to[i * to_stride + width] == T{-1}); // between the rows
    }
}

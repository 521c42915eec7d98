#include <tactnet/kernels/simd/transpose.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <support/whole_numbers.hpp>

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

TEST_CASE_TEMPLATE("transpose: features and samples change places, zeros after the last feature", T, float,
                   double) {
    constexpr std::size_t width = lanes<T>;
    const aligned_vector<T> from = support::whole_numbers<T>(width * width, 7919);
    for (std::size_t features = 1; features <= width; ++features) {
        aligned_vector<T> to(width * width, T{99});
        transpose(from.data(), features, to.data());
        for (std::size_t sample = 0; sample < width; ++sample)
            for (std::size_t f = 0; f < width; ++f)
                CHECK(to[sample * width + f] == (f < features ? from[f * width + sample] : T{}));
    }
}

#include <tactnet/kernels/gemm.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <support/whole_numbers.hpp>
#include <vector>

using namespace tactnet;

TEST_CASE_TEMPLATE("gemm: the three products against plain loops", T, float, double) {
    struct sizes {
        std::size_t m, k, n;
    };
    for (const sizes s :
         {sizes{1, 1, 1}, sizes{22, 280, 16}, sizes{3, 5, 7}, sizes{280, 22, 16}, sizes{1, 64, 1}}) {
        const aligned_vector<T> a = support::whole_numbers<T>(s.m * s.k, 7919),
                                b = support::whole_numbers<T>(s.k * s.n, 104729);
        aligned_vector<T> a_turned(s.m * s.k), b_turned(s.k * s.n), expected(s.m * s.n), c(s.m * s.n, T{99});
        for (std::size_t i = 0; i < s.m; ++i)
            for (std::size_t j = 0; j < s.k; ++j)
                a_turned[j * s.m + i] = a[i * s.k + j];
        for (std::size_t j = 0; j < s.k; ++j)
            for (std::size_t n = 0; n < s.n; ++n)
                b_turned[n * s.k + j] = b[j * s.n + n];
        for (std::size_t i = 0; i < s.m; ++i)
            for (std::size_t j = 0; j < s.k; ++j)
                for (std::size_t n = 0; n < s.n; ++n)
                    expected[i * s.n + n] += a[i * s.k + j] * b[j * s.n + n];
        multiply(a.data(), b.data(), c.data(), s.m, s.k, s.n);
        CHECK(c == expected);
        c.assign(c.size(), T{99});
        multiply_transposed_left(a_turned.data(), b.data(), c.data(), s.m, s.k, s.n);
        CHECK(c == expected);
        c.assign(c.size(), T{99});
        multiply_transposed_right(a.data(), b_turned.data(), c.data(), s.m, s.k, s.n);
        CHECK(c == expected);
    }
}

#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <ratio>

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Constants of a local response normalisation. The window of channel c begins `before` channels before it.
template <std::size_t Size, class Alpha, class Beta, class K>
struct response_rule {
    static constexpr std::size_t size = Size, before = Size / 2, behind = (Size - 1) / 2;
    static constexpr double beta = static_cast<double>(Beta::num) / static_cast<double>(Beta::den);
    static constexpr double share =
        static_cast<double>(Alpha::num) / static_cast<double>(Alpha::den) / static_cast<double>(Size);
    static constexpr double k = static_cast<double>(K::num) / static_cast<double>(K::den);

    /// x^−β of positive numbers. The usual exponents need square roots only; others are computed lane by
    /// lane, in double.
    template <class T>
    [[nodiscard]] static vector<T> power(const vector<T>& x) {
        const vector<T> one(T{1});
        if constexpr (std::ratio_equal_v<Beta, std::ratio<3, 4>>) {
            const vector<T> root = square_root<T>(x);
            return one / (root * square_root<T>(root));
        } else if constexpr (std::ratio_equal_v<Beta, std::ratio<1, 2>>) {
            return one / square_root<T>(x);
        } else if constexpr (std::ratio_equal_v<Beta, std::ratio<1>>) {
            return one / x;
        } else {
            alignas(alignment) std::array<T, lanes<T>> each;
            store(each.data(), x);
            for (T& value : each)
                value = static_cast<T>(std::pow(static_cast<double>(value), -beta));
            return load(each.data());
        }
    }
    /// k + α/n · Σ x² over the window of channel c; from one channel to the next it is `plane` elements.
    template <class T>
    [[nodiscard]] static vector<T> base(const T* x, std::size_t plane, std::size_t c, std::size_t channels) {
        vector<T> squares(T{});
        const std::size_t end = std::min(c + behind + 1, channels);
        for (std::size_t i = c - std::min(c, before); i < end; ++i) {
            const vector<T> value = load(x + i * plane);
            squares = multiply_add(value, value, squares);
        }
        return multiply_add(squares, vector<T>(static_cast<T>(share)), vector<T>(static_cast<T>(k)));
    }
};

}}} // namespace tactnet::kernels

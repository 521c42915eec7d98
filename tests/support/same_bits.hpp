#pragma once

#include <cstddef>
#include <cstring>
#include <span>

// Whether results are alike to the last bit: NaN is like itself, and zero is not like its negative.

namespace support {

/// How many numbers of two containers, arrays or spans differ in any bit; all of the longer one where their
/// sizes do.
template <class A, class B>
[[nodiscard]] std::size_t numbers_that_differ(const A& a, const B& b) {
    using number = typename A::value_type;
    const std::span<const number> left(a), right(b);
    if (left.size() != right.size())
        return left.size() > right.size() ? left.size() : right.size();
    std::size_t different = 0;
    for (std::size_t i = 0; i < left.size(); ++i)
        different += std::memcmp(&left[i], &right[i], sizeof(number)) != 0;
    return different;
}

template <class A, class B>
[[nodiscard]] bool same_bits(const A& a, const B& b) {
    return numbers_that_differ(a, b) == 0;
}

} // namespace support

#pragma once

#include <tactnet/tensor/aligned.hpp>

#include <cstddef>

namespace support {

/// Whole numbers from −8 to 8, so that nothing is rounded: only the order of the elements is in question.
template <class T>
tactnet::aligned_vector<T> whole_numbers(std::size_t size, std::size_t step) {
    tactnet::aligned_vector<T> v(size);
    for (std::size_t i = 0; i < size; ++i)
        v[i] = static_cast<T>(static_cast<int>(i * step % 17) - 8);
    return v;
}

} // namespace support

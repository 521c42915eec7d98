#pragma once

#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <support/guarded_map.hpp>

namespace support {

/// Numbers of either precision, NaN at first, between two guards of NaN: what is read there is seen in the
/// result, and `untouched` tells whether something was written.
template <class T>
class guarded_numbers {
public:
    explicit guarded_numbers(std::size_t elements)
        : elements_(elements), memory_(elements + 2 * width, std::numeric_limits<T>::quiet_NaN()) {}
    [[nodiscard]] T* data() { return memory_.data() + width; }
    [[nodiscard]] T* begin() { return data(); }
    [[nodiscard]] T* end() { return data() + elements_; }
    [[nodiscard]] bool untouched() {
        const auto same = [](T value) { return std::isnan(value); };
        return std::all_of(memory_.data(), data(), same) &&
               std::all_of(end(), memory_.data() + memory_.size(), same);
    }

private:
    static constexpr std::size_t width = 256;
    std::size_t elements_;
    tactnet::aligned_vector<T> memory_;
};

} // namespace support

#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace support {

/// The next number in [-1, 1), the same everywhere (Knuth's 64-bit generator).
inline float draw(std::uint64_t& state) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<float>(state >> 40) * 0x1p-23f - 1;
}

/// A map that lies pixel by pixel between two guards of numbers that must be neither read nor written.
/// Aligned, so that loads and stores of whole vectors end the program where packed numbers do not begin at a
/// vector.
class guarded_map {
public:
    guarded_map(std::size_t elements, float guard, float inside)
        : guard_(guard), elements_(elements), memory_(elements + 2 * width, guard) {
        std::fill_n(data(), elements, inside);
    }
    [[nodiscard]] float* data() { return memory_.data() + width; }
    [[nodiscard]] bool untouched() const {
        const auto same = [&](float value) { // also where the guard is NaN
            return tactnet::detail::bits_as<std::uint32_t>(value) ==
                   tactnet::detail::bits_as<std::uint32_t>(guard_);
        };
        return std::all_of(memory_.begin(), memory_.begin() + width, same) &&
               std::all_of(memory_.begin() + static_cast<std::ptrdiff_t>(width + elements_), memory_.end(),
                           same);
    }

private:
    static constexpr std::ptrdiff_t width = 256;
    float guard_;
    std::size_t elements_;
    tactnet::aligned_vector<float> memory_;
};

/// Numbers of either precision, NaN at first, between two guards of NaN: what is read there shows in the
/// result, and `untouched` returns false if something was written.
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

/// Fills `numbers` with numbers in [-1, 1), and returns them.
template <class T>
std::vector<double> draw_into(guarded_numbers<T>& numbers, std::uint64_t seed) {
    for (T& number : numbers)
        number = static_cast<T>(draw(seed));
    return {numbers.begin(), numbers.end()};
}

/// Whole numbers from −8 to 8, so that nothing is rounded: only the order of the elements is in question.
template <class T>
tactnet::aligned_vector<T> whole_numbers(std::size_t size, std::size_t step) {
    tactnet::aligned_vector<T> v(size);
    for (std::size_t i = 0; i < size; ++i)
        v[i] = static_cast<T>(static_cast<int>(i * step % 17) - 8);
    return v;
}

} // namespace support

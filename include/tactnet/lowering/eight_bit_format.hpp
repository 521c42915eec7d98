#pragma once

#include <tactnet/lowering/step.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>

// The number format of 8 bits: maps of bytes, weights of signed bytes with a scale for each filter, sums of
// 32 bits. A byte q of a map stands for (q − zero point) × scale, with one scale and one zero point a map.
//
// A step with parameters lists the arrays of its folded numbers in `arrays`, for packing, checks and files.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The format of a step in 8 bits that reads and writes such numbers: bytes between steps, words of 16 bits
/// for the frame (deployment/eight_bit/steps.hpp), floats for the outputs. Memory is counted in bytes.
template <class Input, class Output>
struct eight_bit_between {
    using activation = std::uint8_t;
    using packed_number = std::int8_t;
    using input_format = eight_bit_between<std::int16_t, std::uint8_t>;
    using hidden_format = eight_bit_between<std::uint8_t, std::uint8_t>;
    using output_format = eight_bit_between<Input, float>;
    static constexpr bool has_output_format = true;
    static constexpr bool fuses_functions = false; ///< they are tables of bytes
    /// Declares the steps in this format, for exported headers.
    static constexpr const char* steps_header = "tactnet/deployment/eight_bit/steps.hpp";
};
/// The number format of 8 bits: bytes between layers, floats at the outputs.
using eight_bit = eight_bit_between<std::uint8_t, std::uint8_t>;

/// The affine quantisation of a map: value = (byte − zero point) × scale. The zero point is an integer from 0
/// to 255.
struct map_range {
    float scale = 1, zero_point = 0;

    /// The range of values from `lowest` to `highest`, both finite. It contains 0, so that padding is exact.
    [[nodiscard]] static constexpr map_range of(double lowest, double highest) {
        lowest = std::min(lowest, 0.0), highest = std::max(highest, 0.0);
        if (!(highest - lowest > 1e-30))
            return {};
        const double scale = (highest - lowest) / 255;
        return {static_cast<float>(scale), static_cast<float>(static_cast<int>(-lowest / scale + 0.5))};
    }
    /// Reads a range from folded numbers.
    [[nodiscard]] static constexpr map_range read(const float* from) { return {from[0], from[1]}; }
    constexpr void write(float* to) const { to[0] = scale, to[1] = zero_point; }
    static constexpr std::size_t numbers = 2;
};

/// The meaning of the numbers of an array.
enum class folded_kind {
    weights,          ///< signed bytes times the scale of their filter; the first extent counts the filters
    numbers,          ///< plain numbers
    positive_numbers, ///< numbers above zero
    scales,           ///< the step of the weights of each filter, or of the words of each feature
    range             ///< scale and zero point of a map: map_range
};
/// The ranges of a step's maps: the map that it reads, the map that it adds to, and the map that it writes.
struct step_ranges {
    map_range input, added, output;
};
/// An array of the folded numbers of a step.
struct folded_array {
    const char* name = ""; ///< "weight", "bias"; of a range, that of its map
    folded_kind kind = folded_kind::numbers;
    std::array<std::size_t, 4> extents{};    ///< zeros after the last
    map_range step_ranges::*range = nullptr; ///< which range of the step it is

    [[nodiscard]] constexpr std::size_t size() const {
        std::size_t product = 1;
        for (const std::size_t extent : extents)
            product *= extent > 0 ? extent : 1;
        return product;
    }
};
/// The array of the range of a step's input.
inline constexpr folded_array range_of_input{
    "input", folded_kind::range, {map_range::numbers}, &step_ranges::input};
/// The array of the range of the map that a step adds.
inline constexpr folded_array range_of_added{
    "added", folded_kind::range, {map_range::numbers}, &step_ranges::added};
/// The array of the range of a step's output.
inline constexpr folded_array range_of_output{
    "output", folded_kind::range, {map_range::numbers}, &step_ranges::output};

/// Up to six arrays in sequence.
struct folded_arrays {
    std::array<folded_array, 6> list{}; ///< the first `count` are used
    std::size_t count = 0;

    /// An array without a name, `folded_array{}`, is left out.
    constexpr folded_arrays(std::initializer_list<folded_array> all) {
        for (const folded_array& array : all)
            if (*array.name != 0)
                list[count++] = array;
    }
    [[nodiscard]] constexpr std::size_t numbers() const {
        std::size_t sum = 0;
        for (std::size_t i = 0; i < count; ++i)
            sum += list[i].size();
        return sum;
    }
    /// Whether the map that the step writes has a range of its own.
    [[nodiscard]] constexpr bool has_output_range() const {
        return std::any_of(list.begin(), list.end(),
                           [](const folded_array& array) { return array.range == range_of_output.range; });
    }
    /// The ranges among the folded numbers of the step, and (1, 0) for maps that the step does not have.
    [[nodiscard]] constexpr step_ranges read_ranges(const float* from) const {
        step_ranges result;
        for (std::size_t i = 0; i < count; from += list[i++].size())
            if (list[i].range != nullptr)
                result.*list[i].range = map_range::read(from);
        return result;
    }
    constexpr void write_ranges(float* to, const step_ranges& values) const {
        for (std::size_t i = 0; i < count; to += list[i++].size())
            if (list[i].range != nullptr)
                (values.*list[i].range).write(to);
    }
};

namespace detail {

/// Writes ranges, and scales of weights that follow from them, to the folded numbers of a step.
template <class Step>
constexpr void write_ranges(float* to, const step_ranges& values) {
    if constexpr (requires { &Step::set_ranges; })
        Step::set_ranges(to, values);
    else
        Step::arrays.write_ranges(to, values);
}

} // namespace detail

}} // namespace tactnet

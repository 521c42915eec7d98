#pragma once

#include <tactnet/kernels/simd/float_lanes.hpp>

#include <cstddef>
#include <limits>
#include <type_traits>

// An activation function in the epilogue of a step, as a constant that a description of the step points to: a
// template argument can hold an address, but no type. Two descriptions are equal if their functions are.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

namespace detail {

/// A function of one vector.
template <class Vector>
struct function_of_vector {
    Vector (*value)(const Vector&) = nullptr;
};

/// One function for each width of vectors, from the widest to the narrowest; without SIMD there is one.
template <std::size_t Lanes, bool Narrower = (Lanes > min_lanes<float>)>
struct functions_of_vectors : function_of_vector<sized_vector<float, Lanes>> {};
template <std::size_t Lanes>
struct functions_of_vectors<Lanes, true> : function_of_vector<sized_vector<float, Lanes>>,
                                           functions_of_vectors<Lanes / 2> {};

} // namespace detail

/// `rows` × `pixels` outputs in memory, of so many filters.
struct stored_outputs {
    float* first;
    std::size_t rows, row_distance, pixels, pixel_distance, filters;

    /// Applies a function of vectors of any width to vectors of `Lanes` filters, or to the widest vectors
    /// where pixels lie side by side.
    template <std::size_t Lanes, class Function>
    [[gnu::always_inline]] void apply(const Function& function) const {
        const bool side_by_side = pixel_distance == filters;
        const std::size_t runs = side_by_side ? 1 : pixels, run = side_by_side ? pixels * filters : filters;
        for (std::size_t y = 0; y < rows; ++y)
            for (std::size_t x = 0; x < runs; ++x) {
                float* const from = first + y * row_distance + x * pixel_distance;
                std::size_t i = 0;
                for (; i + lanes<float> <= run; i += lanes<float>)
                    vector<float>(function(vector<float>::load_unaligned(from + i)))
                        .store_unaligned(from + i);
                if constexpr (Lanes < lanes<float>)
                    for (; i < run; i += Lanes)
                        store_as(from + i, function(load_as<sized_vector<float, Lanes>>(from + i)));
            }
    }
};

/// An activation function that convolutions apply to their outputs.
/// operators/activations/function.hpp makes one of each function: tactnet::fused<Function>.
struct fused_activation {
    bool exists = false; ///< false only for no_activation
    detail::functions_of_vectors<lanes<float>> functions{};
    /// Applies the function to stored outputs, whole vectors of the widest type.
    void (*apply)(const stored_outputs& outputs) = nullptr;
    /// The largest magnitude of an output for inputs of at most this magnitude.
    double (*output_bound)(double input) = nullptr;
    /// Whether it takes so few operations that register blocks compute it before they store their sums. Other
    /// functions follow on rows that were just stored: dozens of operations for each of the sums of a block
    /// would be much code, and wait for each other.
    bool in_registers = false;
    bool rectifies = false;  ///< whether it is max(x, 0): kernels of bytes know no other function
    bool monotonic = false;  ///< whether it may change places with a maximum
    bool moves_zero = false; ///< whether its value at 0 is not 0, which lanes without a filter must hold
    double largest_value = std::numeric_limits<double>::infinity(); ///< a bound of |value|
    // How exported headers spell it.
    const char *title = "", *type = "", *header = "";
    const unsigned* arguments = nullptr; ///< of the type
    std::size_t argument_count = 0;

    /// The function of vectors of this type.
    template <class Vector>
    [[nodiscard]] constexpr auto of() const {
        return static_cast<const detail::function_of_vector<Vector>&>(functions).value;
    }
    /// The object of a function of vectors of any width.
    template <class Function>
    [[nodiscard]] static constexpr fused_activation with_functions_of() {
        fused_activation fused;
        set_functions<Function, lanes<float>>(fused);
        fused.apply = [](const stored_outputs& outputs) {
            outputs.apply<lanes<float>>([](const auto& x)
                                            __attribute__((always_inline)) { return Function::value(x); });
        };
        return fused;
    }

private:
    template <class Function, std::size_t Lanes>
    static constexpr void set_functions(fused_activation& fused) {
        using wide = sized_vector<float, Lanes>;
        static_cast<detail::function_of_vector<wide>&>(fused.functions).value = [](const wide& x) {
            return Function::value(x);
        };
        if constexpr (Lanes > min_lanes<float>)
            set_functions<Function, Lanes / 2>(fused);
    }
};

/// What a description without an activation function points to. A null pointer would not do: GCC compares no
/// address with null in constants of a program that is compiled with -fsanitize=undefined.
inline constexpr fused_activation no_activation{};

/// Applies a function to stored outputs, in one function for all convolutions with vectors of so many lanes.
template <const fused_activation* Activation, std::size_t Lanes>
[[gnu::noinline]] void activate_stored(const stored_outputs& outputs) {
    outputs.apply<Lanes>([](const auto& x) __attribute__((always_inline)) {
        constexpr auto function = Activation->of<std::remove_cvref_t<decltype(x)>>();
        return function(x);
    });
}

}}} // namespace tactnet::kernels

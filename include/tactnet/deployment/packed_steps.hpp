#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/lowering/batch_executor.hpp>
#include <tactnet/lowering/step.hpp>

#include <array>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// The steps of a deployed network or of a stream over packed weights that someone else keeps: the base of
/// both views. `Input` is the input stage.
template <class Input, class Steps>
class packed_steps {
protected:
    using format = typename Steps::format;
    using packed_number = typename format::packed_number;
    using input = Input;
    static constexpr std::size_t output_map = map_distance<Steps>; ///< elements of the last map

public:
    using steps = Steps;
    using input_type = Input;
    using activation = typename format::activation; ///< an element of the maps between layers
    static constexpr std::size_t outputs = Steps::output.size();

    /// Folded numbers are those of the input, then the parameters once batch norms are folded in. They are
    /// the same on every machine.
    static constexpr std::size_t steps_folded = input::folded_elements,
                                 folded_elements = steps_folded + Steps::folded_elements;
    /// Packed weights are the folded numbers in the order of use, for one instruction set.
    static constexpr std::size_t packed_elements = input::packed_elements + Steps::packed_elements;
    static constexpr std::size_t weight_bytes = packed_elements * sizeof(packed_number);
    /// Elements that a call needs: the first map, the last one, then the memory of the steps.
    static constexpr std::size_t workspace_elements = input::map + output_map + Steps::workspace_elements;

    /// Packed weights as a value, for a constant of a program.
    struct packed_weights {
        alignas(vector_alignment) std::array<packed_number, packed_elements> elements{};
    };
    /// Packs folded_elements numbers. `packed` holds packed_elements zeros.
    static constexpr void pack(const float* folded, packed_number* packed) {
        input::pack(folded, packed);
        Steps::pack(folded + input::folded_elements, packed + input::packed_elements);
    }
    [[nodiscard]] static constexpr packed_weights pack(const std::array<float, folded_elements>& folded) {
        packed_weights result;
        pack(folded.data(), result.elements.data());
        return result;
    }

    /// `packed` must outlive the view and be aligned to `vector_alignment`. Only the first `classes` outputs
    /// stand for a class. Logits are divided by the temperature for probabilities.
    constexpr explicit packed_steps(const packed_number* packed, std::size_t classes = outputs,
                                    double temperature = 1) noexcept
        : packed_(packed), classes_(classes), temperature_(temperature) {}
    constexpr explicit packed_steps(const packed_weights& weights, std::size_t classes = outputs,
                                    double temperature = 1) noexcept
        : packed_steps(weights.elements.data(), classes, temperature) {}
    explicit packed_steps(const packed_weights&&, std::size_t = outputs,
                          double = 1) = delete; // they must outlive the view

    /// How many outputs stand for a class: the first ones.
    [[nodiscard]] constexpr std::size_t class_count() const noexcept { return classes_; }

protected:
    const packed_number* packed_;
    std::size_t classes_;
    double temperature_;
};

}}} // namespace tactnet::detail

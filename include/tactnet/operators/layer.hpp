#pragma once

#include <tactnet/operators/costs.hpp>
#include <tactnet/tensor/named_array.hpp>

#include <cstddef>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

// A list of layers holds specifications without sizes (`conv2d<8, 5>`). Bound to a number type and an input
// shape, a specification becomes a layer: constants, and names for its arrays. How it computes batches is
// described in trained_layer.hpp, what it becomes in a deployed network in lowering/lowering.hpp.

namespace tactnet { inline namespace TACTNET_ARCH {

/// What an array of a network is for.
enum class parameter_role { weight, bias, scale, shift, slope, running_mean, running_variance };

/// Whether gradient descent changes the array; running statistics are not learnable.
[[nodiscard]] constexpr bool learnable(parameter_role r) {
    return r != parameter_role::running_mean && r != parameter_role::running_variance;
}

/// The elements of an array before training; weights are then drawn at random.
[[nodiscard]] constexpr double initial_value(parameter_role r) {
    return r == parameter_role::scale || r == parameter_role::running_variance ? 1
           : r == parameter_role::slope                                        ? 0.25
                                                                               : 0;
}

/// One array of a network. Its offset, in elements, is into the learnable parameters of the network or into
/// its statistics.
struct parameter : named_array {
    parameter_role role; ///< decides how initialisation and weight decay treat it
    std::size_t fan_in;  ///< inputs of one output, for initialisation
};

/// The constants of a layer, which are what `Spec::costs` returns. `Spec::layer<T, Input>` is this, or
/// derives from it and adds what else its training and its lowering need to know. A layer with parameters
/// hides `describe`.
template <class T, shape Input, class Spec>
struct layer_base {
private:
    static constexpr layer_costs own = Spec::costs(Input);

public:
    using value_type = T;
    static constexpr shape input = Input, output = own.output;
    static constexpr std::size_t parameters = own.parameters, statistics = own.statistics;
    static constexpr std::size_t multiply_adds = own.multiply_adds,
                                 multiply_adds_on_pixels = own.multiply_adds_on_pixels;
    static constexpr std::size_t inner_activations = own.inner_activations;
    static constexpr bool in_place = own.in_place, keeps_output = own.keeps_output;

    /// Appends the layer's arrays, with offsets from its first.
    static void describe(const std::string&, std::vector<parameter>&) {}
};

// Functions on the way to a layer's output shape (detail::…_output) reject what does not fit, not the layer
// itself: Clang takes no constants from a class with a failed assertion, and would bury the sentence under
// further errors.

/// Appends the array "prefix.name" to the layer's arrays. `flattened` is the input of a fully connected
/// layer, for its weights. Not inlined, to save compile time.
[[gnu::cold, gnu::noinline]] inline void
describe_array(std::vector<parameter>& list, const std::string& prefix, const char* name, parameter_role role,
               std::initializer_list<std::size_t> extents, std::size_t offset, std::size_t fan_in = 1,
               const shape& flattened = {0, 0, 0}) {
    std::string path(prefix); // appending compiles less than adding
    path.append(".", 1).append(name);
    parameter p{{std::move(path), extents, {}, offset, 0}, role, fan_in};
    p.size = detail::product_of(p.extents);
    if (flattened.size() > 0)
        p.flattened = {flattened.channels, flattened.rows, flattened.columns};
    list.push_back(std::move(p));
}

}} // namespace tactnet

#pragma once

#include <tactnet/deployment/lowering/lowering.hpp>
#include <tactnet/deployment/steps/convolution.hpp>
#include <tactnet/deployment/steps/elementwise.hpp>
#include <tactnet/deployment/steps/parametric_relu.hpp>
#include <tactnet/deployment/steps/pooling.hpp>
#include <tactnet/layers/activations/activation.hpp>
#include <tactnet/layers/activations/parametric_relu.hpp>
#include <tactnet/layers/activations/softmax.hpp>
#include <tactnet/layers/activations/square_root.hpp>
#include <tactnet/layers/composition/named.hpp>
#include <tactnet/layers/dense.hpp>
#include <tactnet/layers/dropout.hpp>
#include <tactnet/layers/normalisation/batch_norm.hpp>
#include <tactnet/layers/normalisation/local_response_norm.hpp>
#include <tactnet/layers/pooling/adaptive_max_pool.hpp>
#include <tactnet/layers/pooling/average_pool.hpp>
#include <tactnet/layers/pooling/max_pool.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

template <name_text Name, class Spec>
struct lowering<named<Name, Spec>> : lowering<Spec> {};

template <unsigned Percent>
struct lowering<dropout<Percent>> {
    static constexpr bool inference_no_op = true;
};

/// The factor and the offset of a batch norm, from its running statistics.
template <class Place>
class norm_constants {
public:
    explicit norm_constants(const parameter_source& list) : from_(Place::parameters(list)) {}
    [[nodiscard]] double factor(std::size_t channel) const {
        return static_cast<double>(from_.values[channel]) /
               std::sqrt(static_cast<double>(from_.statistics[channels + channel]) + from_.epsilon);
    }
    /// The bias of a convolution before the norm, after the norm.
    [[nodiscard]] double shifted(std::size_t channel, double bias) const {
        return (bias - static_cast<double>(from_.statistics[channel])) * factor(channel) +
               static_cast<double>(from_.values[channels + channel]);
    }

private:
    static constexpr std::size_t channels = Place::layer::output.channels;
    parameter_source from_;
};

/// A batch norm that no convolution has fused, with the ReLU after it. `Norm` has its constants.
template <class Place, class Norm = norm_constants<Place>, bool Rectified = false>
struct lowered_norm {
    using step = norm_step<typename Place::format, Place::layer::output, Place::input_stride, Rectified>;

    static void fold(const parameter_source& list, float* to) {
        const Norm norm(list);
        for (std::size_t c = 0; c < step::output.channels; ++c) {
            to[c] = static_cast<float>(norm.factor(c));
            to[step::output.channels + c] = static_cast<float>(norm.shifted(c, 0));
        }
    }
    template <class Spec, class>
    static constexpr auto fuse() {
        return fuse_relu<Spec, lowered_norm<Place, Norm, true>>();
    }
};

template <>
struct lowering<batch_norm> {
    template <class Place>
    using channels = norm_constants<Place>;
    template <class Place>
    using at = lowered_norm<Place>;
};

/// The lowering of activation functions.
template <class Function>
struct lowered_function {
    static constexpr bool rectifies = detail::is_relu<Function>();
    template <class Place>
    using at = lowered_to<
        activation_step<typename Place::format, Function, Place::layer::output, Place::input_stride>>;
};
template <class Function>
struct lowering<activation<Function>> : lowered_function<Function> {};
template <class Function>
    requires fusible_activation<Function>
struct lowering<activation<Function>> : lowered_function<Function> {
    static constexpr const kernels::fused_activation* activation = fused<Function>;
};

/// A parametric ReLU: its slopes.
template <class Place>
struct lowered_parametric_relu {
    using step = parametric_relu_step<typename Place::format, Place::layer::output, Place::input_stride>;

    static void fold(const parameter_source& list, float* to) {
        std::copy_n(Place::parameters(list).values, Place::layer::channels, to);
    }
};
template <>
struct lowering<parametric_relu> {
    template <class Place>
    using at = lowered_parametric_relu<Place>;
};

template <class Offset>
struct lowering<square_root<Offset>> {
    // A fraction in lowest terms, so that equal ones are one step with one spelling.
    template <class Place>
    using at = lowered_to<square_root_step<typename Place::format, Place::layer::output, Place::input_stride,
                                           typename Offset::type>>;
};

template <std::size_t Size, class Alpha, class Beta, class K>
struct lowering<local_response_norm<Size, Alpha, Beta, K>> {
    // Fractions in lowest terms, as above.
    using rule = kernels::response_rule<Size, typename Alpha::type, typename Beta::type, typename K::type>;
    template <class Place>
    using at = lowered_to<
        local_response_norm_step<typename Place::format, Place::layer::output, Place::input_stride, rule>>;
};

/// A softmax of the outputs of a lowered layer, in its step. It can only write the outputs of the network.
template <class Lowered>
struct lowered_softmax {
    using step = softmax_not_last<typename Lowered::step>;
    static void fold(const parameter_source& list, float* to) { Lowered::fold(list, to); }
};
template <class Lowered>
    requires requires { typename Lowered::as_output; }
struct lowered_softmax<Lowered> {
    using step = softmax_not_last<typename Lowered::step>;
    struct as_output {
        using step = step_with_softmax<typename Lowered::as_output::step>;
        static void fold(const parameter_source& list, float* to) { Lowered::as_output::fold(list, to); }
    };
    static void fold(const parameter_source& list, float* to) { Lowered::fold(list, to); }
};

template <>
struct lowering<softmax> {
    template <class Lowered>
    using output_fused = lowered_softmax<Lowered>;
    template <class Place>
    using at = lowered_to<softmax_step<typename Place::format, Place::layer::output, Place::input_stride>>;
};

/// The lowering of max pools.
template <class Place>
using lowered_max_pool =
    lowered_to<pool_step<typename Place::format, Place::layer::window, Place::input_stride>>;

template <extent2d Window, extent2d Stride, padding Padding>
struct lowering<max_pool<Window, Stride, Padding>> {
    template <class Place>
    static constexpr sliding_window maximum = Place::layer::window;
    template <class Place>
    using at = lowered_max_pool<Place>;
};
template <>
struct lowering<global_max_pool> {
    template <class Place>
    using at = lowered_max_pool<Place>;
};

/// Equal bins are the windows of a max pool, which a convolution may fuse.
template <extent2d Output>
struct lowering<adaptive_max_pool<Output>> {
    template <class Place>
        requires(Place::layer::equal_bins)
    static constexpr sliding_window maximum = [] {
        constexpr shape input = Place::layer::input;
        constexpr extent2d bin(input.rows / Output.rows, input.columns / Output.columns);
        return sliding_window{input, bin, bin};
    }();
    template <class Place>
    struct at : lowered_to<adaptive_max_pool_step<typename Place::format, Place::layer::input, Output,
                                                  Place::input_stride>> {};
    template <class Place>
        requires(Place::layer::equal_bins)
    struct at<Place> : lowered_to<pool_step<typename Place::format, maximum<Place>, Place::input_stride>> {};
};

/// The lowering of average pools.
template <class Place>
struct lowered_average_pool
    : lowered_to<average_pool_step<typename Place::format, Place::layer::windows,
                                   Place::layer::output.channels, Place::input_stride>> {
    using as_output = lowered_average_pool<typename Place::as_output>;
};

template <extent2d Window, extent2d Stride, padding Padding, average_over Over>
struct lowering<average_pool<Window, Stride, Padding, Over>> {
    template <class Place>
    using at = lowered_average_pool<Place>;
};
template <extent2d Output>
struct lowering<adaptive_average_pool<Output>> {
    template <class Place>
    using at = lowered_average_pool<Place>;
};

/// The lowering of a fully connected layer.
template <class Place>
struct lowered_dense {
    using layer = typename Place::layer;
    using step = dense_step<typename Place::format,
                            kernels::frame_dense{layer::input, Place::input_stride, layer::output.channels}>;

    using as_output = lowered_dense<typename Place::as_output>;

    static void fold(const parameter_source& list, float* to) {
        std::copy_n(Place::parameters(list).values, layer::parameters, to);
    }
};

template <std::size_t Outputs>
struct lowering<dense<Outputs>> {
    template <class Place>
    using at = lowered_dense<Place>;
};

}} // namespace tactnet

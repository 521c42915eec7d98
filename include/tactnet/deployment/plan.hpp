#pragma once

#include <tactnet/deployment/folding.hpp>
#include <tactnet/deployment/step_chain.hpp>
#include <tactnet/layers.hpp>

#include <array>
#include <cstddef>
#include <type_traits>

// From a list of layers to the steps of its deployed form, at compile time: what can be done in one pass over
// memory becomes one step.

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

enum class layer_kind { convolution, norm, relu, pool, dense, softmax, dropout, residual, list, other };

template <class Spec>
inline constexpr layer_kind kind_of = layer_kind::other;
template <std::size_t Filters, extent Kernel, extent Stride, padding Padding>
inline constexpr layer_kind kind_of<conv2d<Filters, Kernel, Stride, Padding>> = layer_kind::convolution;
template <>
inline constexpr layer_kind kind_of<batch_norm> = layer_kind::norm;
template <>
inline constexpr layer_kind kind_of<relu> = layer_kind::relu;
template <extent Window, extent Stride, padding Padding>
inline constexpr layer_kind kind_of<max_pool<Window, Stride, Padding>> = layer_kind::pool;
template <std::size_t Outputs>
inline constexpr layer_kind kind_of<dense<Outputs>> = layer_kind::dense;
template <>
inline constexpr layer_kind kind_of<softmax> = layer_kind::softmax;
template <unsigned Percent>
inline constexpr layer_kind kind_of<dropout<Percent>> = layer_kind::dropout;
template <class Main, class Skip>
inline constexpr layer_kind kind_of<residual<Main, Skip>> = layer_kind::residual;
template <class... Specs>
inline constexpr layer_kind kind_of<sequence<Specs...>> = layer_kind::list;

/// A max pool that a convolution can take along: windows side by side, none before the image, and no more
/// pixels than a register block holds.
[[nodiscard]] constexpr bool side_by_side(const sliding_window& w) {
    return w.kernel == w.stride && w.top == 0 && w.left == 0 &&
           2 * w.kernel.area() <= kernels::frame_convolution::most_accumulators;
}

/// Which layers behind one go into its step.
struct fusion {
    std::size_t norm = no_layer, pool = no_layer;
    bool rectified = false;
    std::size_t next; ///< the first layer that does not
};

} // namespace detail

/// A layer that can be deployed.
template <class Spec>
concept has_deployed_form = (detail::kind_of<Spec> != detail::layer_kind::other);

namespace detail {

/// Layers that do nothing once a network is trained.
template <class Spec>
inline constexpr bool passes_on = kind_of<Spec> == layer_kind::dropout;
template <class... Specs>
inline constexpr bool passes_on<sequence<Specs...>> = (passes_on<Specs> && ...);

} // namespace detail

/// Plans a list. The input has `Stride` elements from one pixel to the next; `AddsLast` and `RectifiesLast`
/// are for the main branch of a residual block: what its last convolution does besides.
template <class Specification, class Layers, std::size_t Stride, bool AddsLast = false,
          bool RectifiesLast = false>
struct planned;

/// Lists that do nothing once trained need no step.
template <class... Specs, class Layers, std::size_t Stride>
    requires((detail::passes_on<Specs> && ...))
struct planned<sequence<Specs...>, Layers, Stride, false, false> {
    struct type : folded_without_parameters<no_step> {};
};

template <class... Specs, class Layers, std::size_t Stride, bool AddsLast, bool RectifiesLast>
struct planned<sequence<Specs...>, Layers, Stride, AddsLast, RectifiesLast> {
private:
    using kind = detail::layer_kind;
    static constexpr std::size_t size = sizeof...(Specs);
    static constexpr std::array<kind, size> kinds{detail::kind_of<Specs>...};
    static constexpr std::array<bool, size> passes{detail::passes_on<Specs>...};
    template <std::size_t I>
    using layer = typename Layers::template at<I>;
    template <std::size_t I>
    using spec = typename decltype(detail::type_at<I>(
        std::declval<detail::indexed_leaves<std::type_identity<Specs>...>>()))::type;

    /// Which layers from I on become one step.
    template <std::size_t I>
    static constexpr detail::fusion fuse() {
        detail::fusion f{.next = I + 1};
        constexpr bool convolves = kinds[I] == kind::convolution;
        if constexpr (convolves || kinds[I] == kind::norm || kinds[I] == kind::residual)
            kernels::unroll<size>([&](auto i) {
                if (i != f.next)
                    return;
                bool takes = passes[i];
                if (convolves && kinds[i] == kind::norm && f.norm == no_layer && f.pool == no_layer &&
                    !f.rectified)
                    f.norm = i, takes = true;
                if (kinds[i] == kind::relu)
                    f.rectified = takes = true;
                if constexpr (kinds[i] == kind::pool)
                    if (convolves && f.pool == no_layer && detail::side_by_side(layer<i>::window))
                        f.pool = i, takes = true;
                if (takes)
                    f.next = i + 1;
            });
        return f;
    }

    template <std::size_t I, bool Rectified, std::size_t InputStride, class Main, class Skip>
    static auto residual_of(std::type_identity<residual<Main, Skip>>) {
        using main = planned<as_sequence<Main>, typename layer<I>::main, InputStride, true, Rectified>;
        static_assert(
            main::ends_in_convolution,
            "deploy: the main branch of a residual block must end in a convolution, with or without "
            "batch norm");
        using skip = planned<as_sequence<Skip>, typename layer<I>::skip, InputStride>;
        return std::type_identity<
            folded_residual<Layers, I, typename main::type, typename skip::type, InputStride>>{};
    }

    template <std::size_t I, std::size_t InputStride, class... Steps>
    static constexpr auto build() {
        if constexpr (I >= size) {
            return std::type_identity<folded_chain<Steps...>>{};
        } else {
            constexpr detail::fusion f = fuse<I>();
            const auto go_on = []<class Step>(std::type_identity<Step>) {
                return build<f.next, Step::step::output_stride, Steps..., Step>();
            };
            static_assert(has_deployed_form<spec<I>>,
                          "deploy: a layer of this kind has no deployed form; has_deployed_form shows it");
            if constexpr (passes[I] || kinds[I] == kind::other) {
                return build<I + 1, InputStride, Steps...>();
            } else if constexpr (kinds[I] == kind::convolution) {
                constexpr bool is_last = f.next >= size;
                return go_on(std::type_identity<folded_convolution<Layers, I, f.norm, f.pool, InputStride,
                                                                   f.rectified || (is_last && RectifiesLast),
                                                                   is_last && AddsLast>>{});
            } else if constexpr (kinds[I] == kind::norm) {
                return go_on(std::type_identity<folded_norm<Layers, I, InputStride, f.rectified>>{});
            } else if constexpr (kinds[I] == kind::dense) {
                return go_on(std::type_identity<folded_dense<Layers, I, InputStride>>{});
            } else if constexpr (kinds[I] == kind::relu) {
                return go_on(std::type_identity<
                             folded_without_parameters<relu_step<layer<I>::output, InputStride>>>{});
            } else if constexpr (kinds[I] == kind::pool) {
                return go_on(std::type_identity<
                             folded_without_parameters<pool_step<layer<I>::window, InputStride>>>{});
            } else if constexpr (kinds[I] == kind::softmax) {
                return go_on(std::type_identity<
                             folded_without_parameters<softmax_step<layer<I>::output, InputStride>>>{});
            } else if constexpr (kinds[I] == kind::residual) {
                return go_on(residual_of<I, f.rectified, InputStride>(std::type_identity<spec<I>>{}));
            } else {
                using list = typename planned<as_sequence<spec<I>>, layer<I>, InputStride>::type;
                return go_on(std::type_identity<folded_list<Layers, I, list>>{});
            }
        }
    }

public:
    static constexpr bool ends_in_convolution = [] {
        std::size_t end = size;
        const auto take = [&](kind what) {
            while (end > 0 && passes[end - 1])
                --end;
            if (end == 0 || kinds[end - 1] != what)
                return false;
            --end;
            return true;
        };
        static_cast<void>(take(kind::norm));
        return take(kind::convolution);
    }();
    using type = typename decltype(build<0, Stride>())::type;
};

/// The steps of a network whose input lies pixel by pixel without gaps, and how its parameters fold into
/// them.
template <class Network>
    requires(!detail::passes_on<typename Network::specification>) // or there is nothing to deploy
using deployment_plan = typename planned<typename Network::specification, typename Network::layers,
                                         Network::input_shape.channels>::type;

} // namespace TACTNET_ARCH
} // namespace tactnet

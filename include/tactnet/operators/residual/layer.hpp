#pragma once

#include <tactnet/operators/activations/layer.hpp>
#include <tactnet/operators/activations/piecewise.hpp>
#include <tactnet/operators/activations/smooth.hpp>
#include <tactnet/operators/convolution/layer.hpp>
#include <tactnet/operators/pooling/layer.hpp>
#include <tactnet/operators/sequence/layer.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

template <std::size_t MainRows, std::size_t MainColumns, std::size_t MainChannels, std::size_t SkipRows,
          std::size_t SkipColumns, std::size_t SkipChannels>
concept branches_agree =
    (MainRows == SkipRows) && (MainColumns == SkipColumns) && (MainChannels == SkipChannels);

namespace detail {

template <std::size_t MainRows, std::size_t MainColumns, std::size_t MainChannels, std::size_t SkipRows,
          std::size_t SkipColumns, std::size_t SkipChannels>
[[nodiscard]] constexpr shape residual_output() {
    static_assert(
        branches_agree<MainRows, MainColumns, MainChannels, SkipRows, SkipColumns, SkipChannels>,
        "residual: both branches must give the same shape; branches_agree shows rows, columns and channels "
        "of the main branch, then those of the skip");
    return {MainRows, MainColumns, MainChannels};
}

/// The costs of the sum of two branches. A projection needs memory of its own.
[[nodiscard]] constexpr layer_costs costs_of_sum(const layer_costs& main, const layer_costs& skip,
                                                 bool projects) {
    const std::size_t map = main.output.size();
    layer_costs sum{.output = main.output,
                    .inner_activations =
                        (main.keeps_output ? map : 0) +
                        std::max(main.inner_activations, projects ? map + skip.inner_activations : 0)};
    sum.add(main);
    sum.add(skip);
    return sum;
}

} // namespace detail

/// The skip of a residual block without a projection.
using identity_layer = sequence<>;

/// Residual block (He, Zhang, Ren, Sun, 2016): main(x) + skip(x), where skip is `identity_layer` or a
/// projection. A branch is a list of layers or a single one. The ReLU after the sum is a layer of its own.
/// The arrays of the skip begin with "projection", or with the name that it is given.
template <class Main, class Skip = identity_layer>
struct residual {
    static constexpr std::string_view name = "block";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return detail::costs_of_sum(as_sequence<Main>::costs(input), as_sequence<Skip>::costs(input),
                                    as_sequence<Skip>::size > 0);
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, residual> {
        using main = typename as_sequence<Main>::template layer<T, Input>;
        using skip = typename as_sequence<Skip>::template layer<T, Input>;
        static constexpr shape output =
            detail::residual_output<main::output.rows, main::output.columns, main::output.channels,
                                    skip::output.rows, skip::output.columns, skip::output.channels>();
        static constexpr bool projects = as_sequence<Skip>::size > 0;

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            main::describe(prefix, list);
            detail::describe_inner(skip::describe, joined_name(prefix, std::string(skip_name)),
                                   {.parameters = main::parameters, .statistics = main::statistics}, list);
        }

    private:
        static constexpr std::string_view skip_name = [] {
            if constexpr (detail::has_given_name<Skip>)
                return Skip::name;
            else
                return std::string_view("projection");
        }();
    };
};

template <std::size_t BranchRows, std::size_t BranchColumns, std::size_t BranchChannels, std::size_t Channels>
concept gives_factor_per_channel = (BranchRows == 1) && (BranchColumns == 1) && (BranchChannels == Channels);

namespace detail {

template <std::size_t BranchRows, std::size_t BranchColumns, std::size_t BranchChannels, std::size_t Channels>
[[nodiscard]] constexpr shape gate_output(shape input) {
    static_assert(gives_factor_per_channel<BranchRows, BranchColumns, BranchChannels, Channels>,
                  "gate: the branch must give one factor for each channel of the input, in one pixel; "
                  "gives_factor_per_channel shows rows, columns and channels of the branch, then channels "
                  "of the input");
    return input;
}

} // namespace detail

/// The input times a factor for each channel, which a branch of layers computes from the input: y(c, p) =
/// x(c, p) · branch(x)(c). The branch gives a map of 1 × 1 with as many channels as the input: it begins with
/// a global pool and ends in a sigmoid, as in squeeze_excitation.hpp, or in another function.
template <class... Branch>
struct gate {
    static constexpr std::string_view name = "gate";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        const layer_costs branch = sequence<Branch...>::costs(input);
        layer_costs product{.output = input,
                            .inner_activations = branch.output.size() + branch.inner_activations};
        product.add(branch);
        return product;
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, gate> {
        using branch = typename sequence<Branch...>::template layer<T, Input>;
        static constexpr shape output = detail::gate_output<branch::output.rows, branch::output.columns,
                                                            branch::output.channels, Input.channels>(Input);

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            branch::describe(prefix, list);
        }
    };
};

/// Squeeze and excitation (Hu, Shen, Sun, "Squeeze-and-excitation networks", 2018): scales each channel by a
/// factor between 0 and 1, which follows from the means of all channels by way of `Squeezed` channels.
/// torchvision's SqueezeExcitation(Channels, Squeezed), with its names `fc1` and `fc2` of convolutions of
/// 1 × 1. `Channels` are those of the input; `Scale` is `sigmoid`, or `hard_sigmoid` as in MobileNetV3
/// (Howard et al., 2019), which also suits 8 bits and small processors.
template <std::size_t Channels, std::size_t Squeezed, class Scale = sigmoid>
using squeeze_excitation = gate<global_average_pool, named<"fc1", conv2d<Squeezed, 1>>, relu,
                                named<"fc2", conv2d<Channels, 1>>, Scale>;

}} // namespace tactnet

#pragma once

#include <tactnet/kernels/batch/depthwise_convolution.hpp>
#include <tactnet/kernels/batch/direct_convolution.hpp>
#include <tactnet/kernels/batch/winograd/convolution.hpp>
#include <tactnet/kernels/batch/winograd/gradient.hpp>
#include <tactnet/kernels/method_list.hpp>

#include <cstddef>

// The methods of convolution in batches, and of its weight gradient (method_list.hpp). Instead of one frame
// they compute one lane block:
//   run(packed, bias, input, output, workspace)
// and a weight gradient, instead of `pack` and `run`, has
//   pieces    of work that different threads may compute
//   totals    number of sums, in double, which begin as zeros
//   add       (input, gradient, sums, workspace, begin, end): adds one lane block, for pieces [begin, end)
//   finish    (sums, gradients): writes gradients[filter][channel][row][column] from the sums

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

template <batch_convolution C, class T>
struct separate_groups_lane_method {
    static constexpr const char* name = "separate groups";
    static constexpr bool applicable = false;
};
template <batch_convolution C, class T>
struct separate_groups_gradient {
    static constexpr const char* name = "separate groups";
    static constexpr bool applicable = false;
};

/// The cheapest method for a convolution, or its input gradient, of one lane block.
template <batch_convolution C, class T>
using lane_convolution =
    typename method_list<depthwise_lane_method<C, T>, direct_lane_method<C, T>, winograd_lane_method<C, T>,
                         separate_groups_lane_method<C, T>>::cheapest;
/// The cheapest method for the weight gradient of the convolution `C`.
template <batch_convolution C, class T>
using weight_gradient =
    typename method_list<depthwise_gradient<C, T>, tap_gradient<C, T>, winograd_gradient<C, T>,
                         separate_groups_gradient<C, T>>::cheapest;

/// A convolution in groups, one group after the other.
template <batch_convolution C, class T>
    requires(C.groups > 1)
struct separate_groups_lane_method<C, T> {
    using method = lane_convolution<C.one_group(), T>;
    static constexpr const char* name = "separate groups";
    static constexpr bool applicable = true;
    static constexpr std::size_t half_products = C.groups * method::half_products;
    static constexpr std::size_t packed_elements = C.groups * method::packed_elements;
    static constexpr std::size_t workspace_elements = method::workspace_elements;

    template <class Weight>
    static void pack(const Weight& weight, T* to) {
        for (std::size_t group = 0; group < C.groups; ++group)
            method::pack(
                [&](std::size_t output, std::size_t input, std::size_t row, std::size_t column) {
                    return weight(group * one.output.channels + output, input, row, column);
                },
                to + group * method::packed_elements);
    }
    static void run(const T* packed, const T* bias, const T* input, T* output, T* workspace) {
        for (std::size_t group = 0; group < C.groups; ++group)
            method::run(packed + group * method::packed_elements,
                        bias ? bias + group * one.output.channels : nullptr,
                        input + group * one.input.size() * lanes<T>,
                        output + group * one.output.size() * lanes<T>, workspace);
    }

private:
    static constexpr batch_convolution one = C.one_group();
};

/// The weight gradient of a convolution in groups, one group after the other.
template <batch_convolution C, class T>
    requires(C.groups > 1)
struct separate_groups_gradient<C, T> {
    using method = weight_gradient<C.one_group(), T>;
    static constexpr const char* name = "separate groups";
    static constexpr bool applicable = true;
    static constexpr std::size_t half_products = C.groups * method::half_products;
    static constexpr std::size_t pieces = method::pieces; ///< of each group
    static constexpr std::size_t totals = C.groups * method::totals;
    static constexpr std::size_t workspace_elements = method::workspace_elements;

    static void add(const T* input, const T* gradient, double* sums, T* workspace, std::size_t begin,
                    std::size_t end) {
        for (std::size_t group = 0; group < C.groups; ++group)
            method::add(input + group * one.input.size() * lanes<T>,
                        gradient + group * one.output.size() * lanes<T>, sums + group * method::totals,
                        workspace, begin, end);
    }
    static void finish(const double* sums, T* gradients) {
        for (std::size_t group = 0; group < C.groups; ++group)
            method::finish(sums + group * method::totals, gradients + group * one.weights());
    }

private:
    static constexpr batch_convolution one = C.one_group();
};

}}} // namespace tactnet::kernels

#pragma once

#include <tactnet/kernels/frame/dense.hpp>
#include <tactnet/kernels/frame/depthwise.hpp>
#include <tactnet/kernels/frame/direct.hpp>
#include <tactnet/kernels/frame/packed_pixels.hpp>
#include <tactnet/kernels/frame/winograd.hpp>
#include <tactnet/kernels/method_list.hpp>
#include <tactnet/kernels/panels/large_convolution.hpp>

#include <cstddef>
#include <cstdint>
#include <type_traits>

// The method that computes a convolution or a dense layer of one frame: the cheapest of those in the lists
// below. A method is a struct template on frame_convolution with the members of method_list.hpp and
// frame_method:
//   pack(weight, biases, to)           into zeros; weight(filter, channel of the group, row, column)
//   run(packed, in, out, workspace)    one frame; `out` is the first element of the output in its map
//   run_frames, run_share              several frames in one call; the share of one thread in a large
//   convolution

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

template <frame_convolution C>
using ungrouped_methods =
    method_list<panel_method<C>, packed_pixels_method<C>, direct_method<C>, winograd_method<C>>;

/// Runs a method for each of several groups.
template <frame_convolution C>
struct separate_groups_method;
/// Runs one convolution for all groups, with zero weights between different groups.
template <frame_convolution C>
struct joined_groups_method;

template <frame_convolution C>
using grouped_methods = method_list<depthwise_method<C>, separate_groups_method<C>, joined_groups_method<C>>;

namespace detail {
template <frame_convolution C>
constexpr auto methods_of() {
    if constexpr (C.groups > 1)
        return std::type_identity<grouped_methods<C>>{};
    else
        return std::type_identity<ungrouped_methods<C>>{};
}
} // namespace detail

/// All methods for a convolution.
template <frame_convolution C>
using convolution_methods = typename decltype(detail::methods_of<C>())::type;
/// The chosen one.
template <frame_convolution C>
using convolution_method = typename convolution_methods<C>::cheapest;

template <frame_convolution C>
struct separate_groups_method : frame_method {
    static constexpr const char* name = "group by group";
    static constexpr bool applicable = C.separable_groups();
    using method = convolution_method<applicable ? C.one_group() : C.ungrouped()>;
    static constexpr extent2d tile = method::tile;
    static constexpr bool layerwise = method::layerwise;
    static constexpr std::uint64_t product_twentieths = C.groups * method::product_twentieths;
    static constexpr std::size_t packed_elements = C.groups * method::packed_elements;
    static constexpr std::size_t workspace_elements = method::workspace_elements;

    template <class Weight>
    static constexpr void pack(const Weight& weight, const float* biases, float* to) {
        for (std::size_t group = 0; group < C.groups; ++group)
            method::pack(
                [&](std::size_t filter, std::size_t channel, std::size_t row, std::size_t column) {
                    return weight(group * filters + filter, channel, row, column);
                },
                biases + group * filters, to + group * method::packed_elements);
    }
    static void run(const float* packed, const float* in, float* out, float* workspace) noexcept {
        for (std::size_t group = 0; group < C.groups; ++group)
            method::run(packed + group * method::packed_elements, in + group * channels,
                        out + group * filters, workspace);
    }
    static void run_share(const float* packed, const float* in, float* out, float* workspace,
                          const layerwise_job& job) noexcept
        requires layerwise
    {
        for (std::size_t group = 0; group < C.groups; ++group)
            method::run_share(packed + group * method::packed_elements, in + group * channels,
                              out + group * filters, workspace, job);
    }

private:
    static constexpr std::size_t channels = C.window.input.channels / C.groups,
                                 filters = C.filters / C.groups;
};

template <frame_convolution C>
struct joined_groups_method : convolution_method<C.ungrouped()> {
    using method = convolution_method<C.ungrouped()>;
    static constexpr const char* name = "zeros between groups";
    static constexpr bool applicable = !C.separable_groups() && C.ungrouped().fits_map();

    template <class Weight>
    static constexpr void pack(const Weight& weight, const float* biases, float* to) {
        method::pack(ungrouped_weight<C>(weight), biases, to);
    }
};

/// Many weights, by panels: a convolution with a kernel as large as the map.
template <frame_dense D>
struct panel_dense_method
    : panel_method<frame_convolution{.window = {D.input, {D.input.rows, D.input.columns}, 1},
                                     .filters = D.outputs,
                                     .input_stride = D.input_stride}> {
    static constexpr frame_convolution convolution{.window = {D.input, {D.input.rows, D.input.columns}, 1},
                                                   .filters = D.outputs,
                                                   .input_stride = D.input_stride};
    static constexpr bool applicable = D.exceeds_near_caches() && large_convolution::fits(convolution);
    static constexpr std::size_t output_stride = convolution.output_stride();

    template <class Weight>
    static constexpr void pack(const Weight& weight, const float* biases, float* to) {
        panel_method<convolution>::pack(
            [&](std::size_t o, std::size_t channel, std::size_t row, std::size_t column) {
                return weight(o, channel, row * D.input.columns + column);
            },
            biases, to);
    }
};

/// The chosen one for a dense layer.
template <frame_dense D>
using dense_method = typename method_list<direct_dense_method<D>, panel_dense_method<D>>::cheapest;

}}} // namespace tactnet::kernels

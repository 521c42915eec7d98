#include <tactnet/networks.hpp>
#include <tactnet/networks/batch_passes.hpp>

using namespace tactnet;

#ifdef CASE_adaptive_max_pool_no_outputs
// expect: adaptive_max_pool: there must be at least one output
constexpr auto parameters = network<shape{7, 13, 6}, adaptive_max_pool<extent2d{3, 0}>>::parameters;

#elif defined(CASE_average_pool_window_too_large)
// expect: pool: the window is larger than the padded input; window_fits_padded_input shows window rows, window columns, padded rows, padded columns
// expect: average_pool<
constexpr auto parameters = network<shape{7, 13, 6}, average_pool<8, 1, padding::valid>>::parameters;

#elif defined(CASE_concatenation_maps_disagree)
// expect: concatenation: all branches must give the same rows and columns; maps_agree shows those of a branch, then those of the first
constexpr auto parameters =
    network<shape{7, 13, 6}, concatenation<conv2d<8, 3>, conv2d<8, 3, 2>>>::parameters;

#elif defined(CASE_conv2d_groups_do_not_divide)
// expect: conv2d: groups must divide the channels of the input and the filters; groups_divide shows groups, channels, filters
// expect: Filters = 8|groups_divide<3UL, 6UL, 8UL>
constexpr auto parameters =
    network<shape{7, 13, 6}, conv2d<8, 3, 1, padding::same, in_groups(3)>>::parameters;

#elif defined(CASE_conv2d_kernel_too_large)
// expect: conv2d: the kernel is larger than the padded input; kernel_fits_padded_input shows kernel rows, kernel columns, padded rows, padded columns
// expect: PaddedRows = 4; KernelRows = 5|kernel_fits_padded_input<5UL, 3UL, 4UL, 9UL>
constexpr auto parameters =
    network<shape{4, 9, 1}, conv2d<8, extent2d{5, 3}, 1, padding::valid>, relu, dense<3>>::parameters;

#elif defined(CASE_conv2d_no_filters)
// expect: conv2d: filters, kernel and stride must be at least 1
constexpr auto parameters = network<shape{7, 13, 1}, conv2d<0, 3>, dense<3>>::parameters;

#elif defined(CASE_conv2d_no_stride)
// expect: conv2d: filters, kernel and stride must be at least 1
constexpr auto parameters = network<shape{7, 13, 1}, conv2d<8, 3, 0>, dense<3>>::parameters;

#elif defined(CASE_causal_conv1d_no_taps)
// expect: sequence: a layer must have at least one output, one tap and a dilation of one
constexpr auto parameters = network<shape{20, 1, 3}, causal_conv1d<8, 0>>::parameters;

#elif defined(CASE_dilated_conv2d_groups_do_not_divide)
// expect: conv2d: groups must divide the channels of the input and the filters; groups_divide shows groups, channels, filters
constexpr auto parameters =
    network<shape{7, 13, 6}, dilated_conv2d<8, 3, 2, 1, padding::same, in_groups(3)>>::parameters;

#elif defined(CASE_dilated_conv2d_kernel_too_large)
// expect: dilated_conv2d: the dilated kernel is larger than the padded input; kernel_fits_padded_input shows its rows, its columns, padded rows, padded columns
// expect: PaddedRows = 4; KernelRows = 5|kernel_fits_padded_input<5UL, 7UL, 4UL, 9UL>
constexpr auto parameters =
    network<shape{4, 9, 1}, dilated_conv2d<8, 3, extent2d{2, 3}, 1, padding::valid>, dense<3>>::parameters;

#elif defined(CASE_dilated_conv2d_no_dilation)
// expect: dilated_conv2d: the dilation must be at least 1
constexpr auto parameters =
    network<shape{7, 13, 1}, dilated_conv2d<8, 3, extent2d{2, 0}>, dense<3>>::parameters;

#elif defined(CASE_dilated_conv2d_no_filters)
// expect: conv2d: filters, kernel and stride must be at least 1
constexpr auto parameters = network<shape{7, 13, 1}, dilated_conv2d<0, 3>, dense<3>>::parameters;

#elif defined(CASE_dilated_conv2d_no_kernel)
// expect: conv2d: filters, kernel and stride must be at least 1
constexpr auto parameters = network<shape{7, 13, 1}, dilated_conv2d<8, 0>, dense<3>>::parameters;

#elif defined(CASE_dense_no_outputs)
// expect: dense: there must be at least one output
constexpr auto parameters = network<shape{7, 13, 1}, dense<0>>::parameters;

#elif defined(CASE_gru_of_images)
// expect: sequence: the input must be a sequence {frames, 1, features}; one_column shows its columns
// expect: Columns = 13|'13UL == 1'
constexpr auto parameters = network<shape{7, 13}, gru<8>, last_frame, dense<3>>::parameters;

#elif defined(CASE_dropout_of_everything)
// expect: dropout: the percentage must be below 100
constexpr auto parameters = network<shape{7, 13, 1}, dropout<100>, dense<3>>::parameters;

#elif defined(CASE_gate_of_a_map)
// expect: gate: the branch must give one factor for each channel of the input, in one pixel; gives_factor_per_channel shows rows, columns and channels of the branch, then channels of the input
constexpr auto parameters = network<shape{7, 13, 6}, gate<conv2d<6, 1>, sigmoid>>::parameters;

#elif defined(CASE_gate_of_other_channels)
// expect: gate: the branch must give one factor for each channel of the input, in one pixel; gives_factor_per_channel shows rows, columns and channels of the branch, then channels of the input
// expect: BranchChannels = 8; Channels = 6|Channels = 6; .*BranchChannels = 8|gives_factor_per_channel<1UL, 1UL, 8UL, 6UL>
constexpr auto parameters = network<shape{7, 13, 6}, squeeze_excitation<8, 2>>::parameters;

#elif defined(CASE_group_norm_groups_do_not_divide)
// expect: group_norm: groups must divide the channels of the input; groups_divide_channels shows groups and channels
// expect: Channels = 6; Groups = 4|Groups = 4|groups_divide_channels<4UL, 6UL>
constexpr auto parameters = network<shape{7, 13, 6}, group_norm<4>>::parameters;

#elif defined(CASE_group_norm_no_groups)
// expect: group_norm: groups must divide the channels of the input; groups_divide_channels shows groups and channels
constexpr auto parameters = network<shape{7, 13, 6}, group_norm<0>>::parameters;

#elif defined(CASE_incomplete_layer)
// expect: network: a layer of this kind has no functions for batches: include tactnet/training.hpp, or specialise trained_layer for a layer of your own; batch_layer shows what is missing
// expect: backward
// characters: 16000
struct forward_only {
    static constexpr std::string_view name = "forward_only";
    static constexpr bool numbered = true;
    static constexpr layer_costs costs(const shape& input) { return {.output = input}; }

    template <class T, shape Input>
    using layer = layer_base<T, Input, forward_only>;
};
template <class T, shape Input>
struct tactnet::trained_layer<forward_only, T, Input> : trained_base<forward_only, T, Input> {
    static void infer(const execution_context&, const T*, const T*, no_memory&, input_view<T, Input>,
                      output_view<T, Input>) {}
};
using net = network<shape{28, 50}, conv2d<8, 5>, forward_only, dense<22>>;
void prepare(const net& network, thread_pool& threads, net::workspace& space) {
    network.prepare(threads, space);
}

#elif defined(CASE_instance_norm_of_single_values)
// expect: group_norm, instance_norm, layer_norm: a single value has no variance: there must be two or more to normalise together
constexpr auto parameters = network<shape{7, 13}, dense<4>, instance_norm>::parameters;

#elif defined(CASE_layer_norm_of_one_channel)
// expect: group_norm, instance_norm, layer_norm: a single value has no variance: there must be two or more to normalise together
constexpr auto parameters = network<shape{7, 13}, layer_norm<norm_over::channels>>::parameters;

#elif defined(CASE_local_response_norm_of_negative_alpha)
// expect: local_response_norm: alpha and beta must not be below zero
constexpr auto parameters = network<shape{8, 8, 2}, local_response_norm<5, std::ratio<-1>>>::parameters;

#elif defined(CASE_max_pool_padding_too_large)
// expect: pool: the padding must be smaller than the window, or a window holds no pixel; every_window_holds_a_pixel shows rows and columns of padding on one side, window rows, window columns
// expect: WindowRows = 2; PaddingRows = 2|every_window_holds_a_pixel<2UL, 2UL, 2UL, 2UL>
// expect: max_pool<
constexpr auto parameters = network<shape{7, 13, 1}, max_pool<2, 1, pad(2)>, dense<3>>::parameters;

#elif defined(CASE_max_pool_window_too_large)
// expect: pool: the window is larger than the padded input; window_fits_padded_input shows window rows, window columns, padded rows, padded columns
// expect: PaddedColumns = 4; WindowColumns = 5|window_fits_padded_input<5UL, 5UL, 7UL, 4UL>
// expect: max_pool<
constexpr auto parameters =
    network<shape{7, 4, 1}, conv2d<8, 3>, relu, max_pool<5, 1, padding::valid>, dense<3>>::parameters;

#elif defined(CASE_residual_branches_disagree)
// expect: residual: both branches must give the same shape; branches_agree shows rows, columns and channels of the main branch, then those of the skip
// expect: SkipChannels = 8; MainChannels = 16|branches_agree<7UL, 13UL, 16UL, 7UL, 13UL, 8UL>
constexpr auto parameters =
    network<shape{7, 13, 1}, conv2d<8, 3>, residual<sequence<conv2d<16, 3>, relu>>, dense<3>>::parameters;

#elif defined(CASE_specification_without_layer)
// expect: network: each entry of a list must be a layer specification, with name, numbered, costs.const shape&. and a template layer<class, shape>; layer_specification shows what is missing
// expect: layer
// characters: 16000
struct unbound {
    static constexpr std::string_view name = "unbound";
    static constexpr bool numbered = true;
    static constexpr layer_costs costs(const shape& input) { return {.output = input}; }
};
using net = network<shape{28, 50}, conv2d<8, 5>, residual<sequence<unbound>>, dense<22>>;
static_assert(net::outputs == 22);
const net made;

#elif defined(CASE_transposed_conv2d_ceil_mode)
// expect: transposed_conv2d: ceil_mode has no meaning here; give the padding with pad
constexpr auto parameters = network<shape{7, 13, 1}, transposed_conv2d<8, 3, 2, ceil_mode()>>::parameters;

#elif defined(CASE_transposed_conv2d_nothing_remains)
// expect: transposed_conv2d: the padding leaves no row or no column
constexpr auto parameters = network<shape{1, 13, 1}, transposed_conv2d<8, 3, 2, pad(2)>>::parameters;

#elif defined(CASE_transposed_conv2d_no_stride)
// expect: transposed_conv2d: filters, kernel and stride must be at least 1
constexpr auto parameters = network<shape{7, 13, 1}, transposed_conv2d<8, 3, 0>, dense<3>>::parameters;

#elif defined(CASE_transposed_conv2d_padding_too_large)
// expect: transposed_conv2d: the padding must be smaller than the kernel; padding_below_kernel shows kernel rows, kernel columns, rows and columns of padding on one side
// expect: KernelRows = 3; MostRowsOfPadding = 3|padding_below_kernel<3U?L?, 3U?L?, 3U?L?, 3U?L?>
constexpr auto parameters = network<shape{7, 13, 1}, transposed_conv2d<8, 3, 2, pad(3)>>::parameters;

#elif defined(CASE_type_without_specification)
// expect: network: each entry of a list must be a layer specification, with name, numbered, costs.const shape&. and a template layer<class, shape>; layer_specification shows what is missing
// expect: .Spec::name. (is|would be) invalid
// characters: 16000
using net = network<shape{28, 50}, conv2d<8, 5>, int, dense<22>>;
static_assert(net::outputs == 22);
const net made;

#elif defined(CASE_upsample_by_nothing)
// expect: upsample: the factor, or the size, must have at least one row and one column
constexpr auto parameters = network<shape{7, 13, 6}, upsample<extent2d{2, 0}>>::parameters;
#endif

#include <tactnet/networks.hpp>

#ifdef CASE_adaptive_max_pool_no_outputs
// expect: adaptive_max_pool: there must be at least one output
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13, 6}, tactnet::adaptive_max_pool<tactnet::extent2d{3, 0}>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_average_pool_window_too_large
// expect: pool: the window is larger than the padded input; window_fits_padded_input shows window rows, window columns, padded rows, padded columns
// expect: average_pool<
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13, 6}, tactnet::average_pool<8, 1, tactnet::padding::valid>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_concatenation_maps_disagree
// expect: concatenation: all branches must give the same rows and columns; maps_agree shows those of a branch, then those of the first
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13, 6},
                             tactnet::concatenation<tactnet::conv2d<8, 3>, tactnet::conv2d<8, 3, 2>>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_conv2d_groups_do_not_divide
// expect: conv2d: groups must divide the channels of the input and the filters; groups_divide shows groups, channels, filters
// expect: Filters = 8|groups_divide<3UL, 6UL, 8UL>
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13, 6},
                             tactnet::conv2d<8, 3, 1, tactnet::padding::same, tactnet::in_groups(3)>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_conv2d_kernel_too_large
// expect: conv2d: the kernel is larger than the padded input; kernel_fits_padded_input shows kernel rows, kernel columns, padded rows, padded columns
// expect: PaddedRows = 4; KernelRows = 5|kernel_fits_padded_input<5UL, 3UL, 4UL, 9UL>
// at-most: 1
using net = tactnet::network<tactnet::shape{4, 9, 1},
                             tactnet::conv2d<8, tactnet::extent2d{5, 3}, 1, tactnet::padding::valid>,
                             tactnet::relu, tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_conv2d_no_filters
// expect: conv2d: filters, kernel and stride must be at least 1
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13, 1}, tactnet::conv2d<0, 3>, tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_conv2d_no_stride
// expect: conv2d: filters, kernel and stride must be at least 1
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13, 1}, tactnet::conv2d<8, 3, 0>, tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_causal_conv1d_no_taps
// expect: sequence: a layer must have at least one output and one tap
// at-most: 1
using net = tactnet::network<tactnet::shape{20, 1, 3}, tactnet::causal_conv1d<8, 0>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_dilated_conv2d_groups_do_not_divide
// expect: conv2d: groups must divide the channels of the input and the filters; groups_divide shows groups, channels, filters
// at-most: 1
using net =
    tactnet::network<tactnet::shape{7, 13, 6},
                     tactnet::dilated_conv2d<8, 3, 2, 1, tactnet::padding::same, tactnet::in_groups(3)>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_dilated_conv2d_kernel_too_large
// expect: dilated_conv2d: the dilated kernel is larger than the padded input; kernel_fits_padded_input shows its rows, its columns, padded rows, padded columns
// expect: PaddedRows = 4; KernelRows = 5|kernel_fits_padded_input<5UL, 7UL, 4UL, 9UL>
// at-most: 1
using net =
    tactnet::network<tactnet::shape{4, 9, 1},
                     tactnet::dilated_conv2d<8, 3, tactnet::extent2d{2, 3}, 1, tactnet::padding::valid>,
                     tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_dilated_conv2d_no_dilation
// expect: dilated_conv2d: the dilation must be at least 1
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13, 1}, tactnet::dilated_conv2d<8, 3, tactnet::extent2d{2, 0}>,
                             tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_dilated_conv2d_no_filters
// expect: conv2d: filters, kernel and stride must be at least 1
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13, 1}, tactnet::dilated_conv2d<0, 3>, tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_dilated_conv2d_no_kernel
// expect: conv2d: filters, kernel and stride must be at least 1
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13, 1}, tactnet::dilated_conv2d<8, 0>, tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_dense_no_outputs
// expect: dense: there must be at least one output
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13, 1}, tactnet::dense<0>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_gru_of_images
// expect: sequence: the input must be a sequence {frames, 1, features}; one_column shows its columns
// expect: Columns = 13|'13UL == 1'
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13}, tactnet::gru<8>, tactnet::last_frame, tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_dropout_of_everything
// expect: dropout: the percentage must be below 100
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13, 1}, tactnet::dropout<100>, tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_gate_of_a_map
// expect: gate: the branch must give one factor for each channel of the input, in one pixel; gives_factor_per_channel shows rows, columns and channels of the branch, then channels of the input
// at-most: 1
using net =
    tactnet::network<tactnet::shape{7, 13, 6}, tactnet::gate<tactnet::conv2d<6, 1>, tactnet::sigmoid>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_gate_of_other_channels
// expect: gate: the branch must give one factor for each channel of the input, in one pixel; gives_factor_per_channel shows rows, columns and channels of the branch, then channels of the input
// expect: BranchChannels = 8; Channels = 6|Channels = 6; .*BranchChannels = 8|gives_factor_per_channel<1UL, 1UL, 8UL, 6UL>
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13, 6}, tactnet::squeeze_excitation<8, 2>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_group_norm_groups_do_not_divide
// expect: group_norm: groups must divide the channels of the input; groups_divide_channels shows groups and channels
// expect: Channels = 6; Groups = 4|Groups = 4|groups_divide_channels<4UL, 6UL>
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13, 6}, tactnet::group_norm<4>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_group_norm_no_groups
// expect: group_norm: groups must divide the channels of the input; groups_divide_channels shows groups and channels
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13, 6}, tactnet::group_norm<0>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_incomplete_layer
// expect: sequence: expected a layer; the concept layer shows what is missing
// expect: backward
// at-most: 1
// characters: 16000
struct forward_only {
    static constexpr std::string_view name = "forward_only";
    static constexpr bool numbered = true;
    static constexpr tactnet::layer_costs costs(const tactnet::shape& input) { return {.output = input}; }

    template <class T, tactnet::shape Input>
    struct layer : tactnet::layer_base<T, Input, forward_only> {
        static void infer(const tactnet::execution_context&, const T*, const T*, tactnet::no_memory&,
                          tactnet::input_view<T, Input>, tactnet::output_view<T, Input>) {}
    };
};
using net = tactnet::network<tactnet::shape{28, 50}, tactnet::conv2d<8, 5>, forward_only, tactnet::dense<22>>;
void prepare(const net& network, tactnet::thread_pool& threads, net::workspace& space) {
    network.prepare(threads, space);
}
#endif

#ifdef CASE_instance_norm_of_single_values
// expect: group_norm, instance_norm, layer_norm: a single value has no variance: there must be two or more to normalise together
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13}, tactnet::dense<4>, tactnet::instance_norm>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_layer_norm_of_one_channel
// expect: group_norm, instance_norm, layer_norm: a single value has no variance: there must be two or more to normalise together
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13}, tactnet::layer_norm<tactnet::norm_over::channels>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_max_pool_padding_too_large
// expect: pool: the padding must be smaller than the window, or a window holds no pixel; every_window_holds_a_pixel shows rows and columns of padding on one side, window rows, window columns
// expect: WindowRows = 2; PaddingRows = 2|every_window_holds_a_pixel<2UL, 2UL, 2UL, 2UL>
// expect: max_pool<
// at-most: 1
using net =
    tactnet::network<tactnet::shape{7, 13, 1}, tactnet::max_pool<2, 1, tactnet::pad(2)>, tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_max_pool_window_too_large
// expect: pool: the window is larger than the padded input; window_fits_padded_input shows window rows, window columns, padded rows, padded columns
// expect: PaddedColumns = 4; WindowColumns = 5|window_fits_padded_input<5UL, 5UL, 7UL, 4UL>
// expect: max_pool<
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 4, 1}, tactnet::conv2d<8, 3>, tactnet::relu,
                             tactnet::max_pool<5, 1, tactnet::padding::valid>, tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_residual_branches_disagree
// expect: residual: both branches must give the same shape; branches_agree shows rows, columns and channels of the main branch, then those of the skip
// expect: SkipChannels = 8; MainChannels = 16|branches_agree<7UL, 13UL, 16UL, 7UL, 13UL, 8UL>
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13, 1}, tactnet::conv2d<8, 3>,
                             tactnet::residual<tactnet::sequence<tactnet::conv2d<16, 3>, tactnet::relu>>,
                             tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_specification_without_layer
// expect: network: each entry of a list must be a layer specification, with name, numbered, costs.const shape&. and a template layer<class, shape>; layer_specification shows what is missing
// expect: layer
// at-most: 1
// characters: 16000
struct unbound {
    static constexpr std::string_view name = "unbound";
    static constexpr bool numbered = true;
    static constexpr tactnet::layer_costs costs(const tactnet::shape& input) { return {.output = input}; }
};
using net = tactnet::network<tactnet::shape{28, 50}, tactnet::conv2d<8, 5>,
                             tactnet::residual<tactnet::sequence<unbound>>, tactnet::dense<22>>;
static_assert(net::outputs == 22);
const net made;
#endif

#ifdef CASE_transposed_conv2d_ceil_mode
// expect: transposed_conv2d: ceil_mode has no meaning here; give the padding with pad
// at-most: 1
using net =
    tactnet::network<tactnet::shape{7, 13, 1}, tactnet::transposed_conv2d<8, 3, 2, tactnet::ceil_mode()>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_transposed_conv2d_nothing_remains
// expect: transposed_conv2d: the padding leaves no row or no column
// at-most: 1
using net = tactnet::network<tactnet::shape{1, 13, 1}, tactnet::transposed_conv2d<8, 3, 2, tactnet::pad(2)>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_transposed_conv2d_no_stride
// expect: transposed_conv2d: filters, kernel and stride must be at least 1
// at-most: 1
using net =
    tactnet::network<tactnet::shape{7, 13, 1}, tactnet::transposed_conv2d<8, 3, 0>, tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_transposed_conv2d_padding_too_large
// expect: transposed_conv2d: the padding must be smaller than the kernel; padding_below_kernel shows kernel rows, kernel columns, rows and columns of padding on one side
// expect: KernelRows = 3; MostRowsOfPadding = 3|padding_below_kernel<3U?L?, 3U?L?, 3U?L?, 3U?L?>
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13, 1}, tactnet::transposed_conv2d<8, 3, 2, tactnet::pad(3)>>;
constexpr auto parameters = net::parameters;
#endif

#ifdef CASE_type_without_specification
// expect: network: each entry of a list must be a layer specification, with name, numbered, costs.const shape&. and a template layer<class, shape>; layer_specification shows what is missing
// expect: .Spec::name. (is|would be) invalid
// at-most: 1
// characters: 16000
using net = tactnet::network<tactnet::shape{28, 50}, tactnet::conv2d<8, 5>, int, tactnet::dense<22>>;
static_assert(net::outputs == 22);
const net made;
#endif

#ifdef CASE_upsample_by_nothing
// expect: upsample: the factor, or the size, must have at least one row and one column
// at-most: 1
using net = tactnet::network<tactnet::shape{7, 13, 6}, tactnet::upsample<tactnet::extent2d{2, 0}>>;
constexpr auto parameters = net::parameters;
#endif

#include <tactnet/layers.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/quantisation/calibration.hpp>

#ifdef CASE_average_pool_first
// expect: in 8 bits a network cannot begin with a pool, an upsampling or an activation: a convolution, a dense layer or a batch norm
// at-most: 2
using net = tactnet::network<tactnet::shape{8, 8}, tactnet::average_pool<2>, tactnet::conv2d<4, 3>,
                             tactnet::dense<2>>;
constexpr std::size_t bytes = tactnet::deployed<net, tactnet::eight_bit>::weight_bytes;
#endif

#ifdef CASE_dilated_conv2d_first
// expect: in this number format a network cannot begin with a dilated convolution: a convolution, a dense layer or a batch norm must come first
// at-most: 1
using net = tactnet::network<tactnet::shape{8, 8}, tactnet::dilated_conv2d<4, 3>, tactnet::dense<2>>;
constexpr std::size_t bytes = tactnet::deployed<net, tactnet::eight_bit>::weight_bytes;
#endif

#ifdef CASE_gate_first
// expect: in 8 bits a network cannot begin with a pool, an upsampling or an activation: a convolution, a dense layer or a batch norm
// at-most: 4
using net = tactnet::network<tactnet::shape{4, 4, 2}, tactnet::squeeze_excitation<2, 1>, tactnet::dense<2>>;
constexpr std::size_t bytes = tactnet::deployed<net, tactnet::eight_bit>::weight_bytes;
#endif

#ifdef CASE_group_norm_within
// expect: deploy: in 8 bits there is no group, instance or layer norm
// at-most: 2
using net =
    tactnet::network<tactnet::shape{8, 8}, tactnet::conv2d<4, 3>, tactnet::group_norm<2>, tactnet::dense<2>>;
constexpr std::size_t bytes = tactnet::deployed<net, tactnet::eight_bit>::weight_bytes;
#endif

#ifdef CASE_pool_first
// expect: in 8 bits a network cannot begin with a pool, an upsampling or an activation: a convolution, a dense layer or a batch norm
// at-most: 2
using net =
    tactnet::network<tactnet::shape{8, 8}, tactnet::max_pool<2>, tactnet::conv2d<4, 3>, tactnet::dense<2>>;
constexpr std::size_t bytes = tactnet::deployed<net, tactnet::eight_bit>::weight_bytes;
#endif

#ifdef CASE_relu_first
// expect: in 8 bits a network cannot begin with a pool, an upsampling or an activation: a convolution, a dense layer or a batch norm
// at-most: 2
using net = tactnet::network<tactnet::shape{8, 8}, tactnet::relu, tactnet::conv2d<4, 3>, tactnet::dense<2>>;
constexpr std::size_t bytes = tactnet::deployed<net, tactnet::eight_bit>::weight_bytes;
#endif

#ifdef CASE_residual_first
// expect: in this number format a network cannot begin with a residual block that passes its input on
// at-most: 3
using net = tactnet::network<tactnet::shape{4, 4, 2},
                             tactnet::residual<tactnet::sequence<tactnet::conv2d<2, 3>>>, tactnet::dense<2>>;
constexpr std::size_t bytes = tactnet::deployed<net, tactnet::eight_bit>::weight_bytes;
#endif

#ifdef CASE_sequences
// expect: deploy: a network of sequences runs frame by frame, in single precision: use deploy_stream
// at-most: 1
using net =
    tactnet::network<tactnet::shape{20, 1, 3}, tactnet::gru<8>, tactnet::last_frame, tactnet::dense<2>>;
constexpr std::size_t bytes = tactnet::deployed<net, tactnet::eight_bit>::weight_bytes;
#endif

#ifdef CASE_softmax_within
// expect: in this number format a softmax must be the last layer
// at-most: 2
using net =
    tactnet::network<tactnet::shape{8, 8}, tactnet::conv2d<4, 3>, tactnet::softmax, tactnet::dense<2>>;
tactnet::frame_status recognise(const tactnet::deployed<net, tactnet::eight_bit>& deployed,
                                tactnet::tensor_view<const float, net::input_shape> frame,
                                std::span<float, net::outputs> logits) {
    return deployed.infer(frame, logits);
}
#endif

#ifdef CASE_upsample_first
// expect: in 8 bits a network cannot begin with a pool, an upsampling or an activation: a convolution, a dense layer or a batch norm
// at-most: 2
using net =
    tactnet::network<tactnet::shape{8, 8}, tactnet::upsample<2>, tactnet::conv2d<4, 3>, tactnet::dense<2>>;
constexpr std::size_t bytes = tactnet::deployed<net, tactnet::eight_bit>::weight_bytes;
#endif

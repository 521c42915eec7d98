// expect: in this number format a softmax must be the last layer
// at-most: 2
#include <tactnet/layers.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/quantisation/calibration.hpp>

using net =
    tactnet::network<tactnet::shape{8, 8}, tactnet::conv2d<4, 3>, tactnet::softmax, tactnet::dense<2>>;
tactnet::frame_status recognise(const tactnet::deployed<net, tactnet::eight_bit>& deployed,
                                tactnet::tensor_view<const float, net::input_shape> frame,
                                std::span<float, net::outputs> logits) {
    return deployed.infer(frame, logits);
}

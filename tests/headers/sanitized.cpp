// A deployed network with all kinds of fused steps, in both number formats.

#include <tactnet/quantisation.hpp>
#include <tactnet/tactnet.hpp>

#include <span>

namespace {

using namespace tactnet;
using net = network<shape{14, 25}, conv2d<8, 5>, batch_norm, relu, max_pool<2>, conv2d<16, 3>, silu,
                    residual<sequence<conv2d<16, 3>, batch_norm>>, relu, transposed_conv2d<16, 2, 2>, relu6,
                    dense<22>>;

} // namespace

frame_status infer(const deployed<net>& network, tensor_view<const float, net::input_shape> frame,
                   std::span<float, net::outputs> logits) {
    return network.infer(frame, logits);
}

frame_status infer(const deployed<net, eight_bit>& network, tensor_view<const float, net::input_shape> frame,
                   std::span<float, net::outputs> logits) {
    return network.infer(frame, logits);
}

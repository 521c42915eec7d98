// expect: deployed: this network needs more workspace than a stack should hold: give it some from the heap; fits_stack shows bytes needed, bytes at most
// at-most: 1
#include <tactnet/deployment.hpp>
#include <tactnet/networks/network.hpp>

using net = tactnet::network<tactnet::shape{200, 200}, tactnet::conv2d<16, 1>, tactnet::dense<1>>;

bool recognise(const tactnet::deployed<net>& fast, tactnet::tensor_view<const float, net::input_shape> frame,
               std::span<float, 1> to) {
    return fast.infer(frame, to) == tactnet::frame_status::ok;
}

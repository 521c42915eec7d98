// expect: deployed: the number of these outputs is known at run time only: check it, then pass std::span<float, network::outputs>.outputs.
// at-most: 1
#include <tactnet/tactnet.hpp>

#include <array>
#include <vector>

using net = tactnet::tactnet4<tactnet::shape{28, 50}, 22>;

bool recognise(const tactnet::deployed<net>& fast, const std::array<std::uint8_t, 28 * 50>& frame) {
    std::vector<float> outputs(22);
    return fast.infer(frame, outputs) == tactnet::frame_status::ok;
}

// expect: deployed: there is room for another number of outputs than the network has; outputs_have_size shows found, expected
// expect: ExpectedElements = 22; Elements = 21|outputs_have_size<21UL, 22UL>
// at-most: 1
#include <tactnet/tactnet.hpp>

#include <array>

using net = tactnet::tactnet4<tactnet::shape{28, 50}, 22>;

bool recognise(const tactnet::deployed<net>& fast, const std::array<std::uint8_t, 28 * 50>& frame) {
    std::array<float, 21> outputs{};
    return fast.infer(frame, outputs) == tactnet::frame_status::ok;
}

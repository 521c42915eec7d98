// expect: deployed: outputs are written to float, which must not be const; outputs_have_type shows what was found
// expect: Element = double|'double' does not satisfy 'outputs_have_type'
// at-most: 1
#include <tactnet/tactnet.hpp>

#include <array>

using net = tactnet::tactnet4<tactnet::shape{28, 50}, 22>;

bool recognise(const tactnet::deployed<net>& fast, const std::array<std::uint8_t, 28 * 50>& frame) {
    std::array<double, 22> outputs{};
    return fast.infer(frame, outputs) == tactnet::frame_status::ok;
}

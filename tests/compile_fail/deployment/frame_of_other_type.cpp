// expect: deployed: the elements of a frame are counts, std::uint8_t, or float; frame_has_type shows what was found
// expect: Element = short unsigned int|'unsigned short' does not satisfy 'frame_has_type'
// at-most: 1
#include <tactnet/tactnet.hpp>

#include <array>

using net = tactnet::tactnet4<tactnet::shape{28, 50}, 22>;

bool recognise(const tactnet::deployed<net>& fast, const std::array<std::uint16_t, 28 * 50>& frame,
               std::span<float, 22> outputs) {
    return fast.view().infer(frame, outputs) == tactnet::frame_status::ok;
}

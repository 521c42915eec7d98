// expect: deployed: the frame has another number of elements than the network's input; frame_has_size shows found, expected
// expect: ExpectedElements = 1400; Elements = 1399|frame_has_size<1399UL, 1400UL>
// at-most: 1
#include <tactnet/tactnet.hpp>

#include <array>
#include <vector>

using net = tactnet::tactnet4<tactnet::shape{28, 50}, 22>;

bool infer(const tactnet::deployed<net>& fast, const std::vector<std::array<std::uint8_t, 1399>>& frames,
           std::vector<float>& outputs, tactnet::thread_pool& pool) {
    return fast.infer(frames, outputs, pool) == tactnet::frame_status::ok;
}

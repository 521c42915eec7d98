// expect: deployed: frames for a pool are a contiguous container with data.* and size
// at-most: 2
#include <tactnet/tactnet.hpp>

#include <array>
#include <span>
#include <utility>
#include <vector>

using net = tactnet::tactnet4<tactnet::shape{28, 50}, 22>;

std::uint8_t frames[64][28][50];

bool infer(const tactnet::deployed<net>& fast, std::vector<float>& outputs, tactnet::thread_pool& pool) {
    static_cast<void>(fast.classify(&frames[0][0][0], pool));
    return fast.infer(frames, outputs, pool) == tactnet::frame_status::ok;
}

// expect: deployed: frames for a pool lie one after the other in memory, which views need not
// at-most: 1
#include <tactnet/tactnet.hpp>

#include <array>
#include <span>
#include <utility>
#include <vector>

using net = tactnet::tactnet4<tactnet::shape{28, 50}, 22>;

bool infer(const tactnet::deployed<net>& fast, const std::vector<std::span<const std::uint8_t, 1400>>& frames,
           std::vector<float>& outputs, tactnet::thread_pool& pool) {
    return fast.infer(frames, outputs, pool) == tactnet::frame_status::ok;
}

// expect: deployed: outputs are written to a contiguous container of float that outlives the call
// at-most: 3
#include <tactnet/tactnet.hpp>

#include <array>
#include <span>
#include <utility>
#include <vector>

using net = tactnet::tactnet4<tactnet::shape{28, 50}, 22>;

bool infer(const tactnet::deployed<net>& fast, const std::vector<std::uint8_t>& frames, float* outputs,
           tactnet::thread_pool& pool) {
    return fast.infer(frames, outputs, pool) == tactnet::frame_status::ok &&
           fast.infer(frames, std::vector<float>(22), pool) == tactnet::frame_status::ok &&
           fast.infer(std::array<float, 1400>(), std::array<float, 22>()) == tactnet::frame_status::ok;
}

// expect: deployed: the elements of a frame are counts, std::uint8_t, or float; frame_has_type shows what was found
// expect: Element = double|'double' does not satisfy 'frame_has_type'
// at-most: 1
#include <tactnet/tactnet.hpp>

#include <vector>

using net = tactnet::tactnet4<tactnet::shape{28, 50}, 22>;

auto classify(const tactnet::deployed<net>& fast, const std::vector<double>& frames,
              tactnet::thread_pool& pool) {
    return fast.classify(frames, pool);
}

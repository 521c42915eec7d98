// expect: deployed: the type of this frame does not tell its size: compare it by try_view<network::input_shape>.frame., which is nothing if it is another, and give what that holds
// at-most: 1
#include <tactnet/tactnet.hpp>

#include <vector>

using net = tactnet::tactnet4<tactnet::shape{28, 50}, 22>;

std::size_t recognise(const tactnet::deployed<net>& model, const std::vector<float>& frame,
                      tactnet::deployed<net>::workspace& memory) {
    if (const auto found = model.classify(frame, memory))
        return found->index;
    return 0;
}

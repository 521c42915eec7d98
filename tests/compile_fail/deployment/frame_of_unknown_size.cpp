// expect: deployed: the size of this frame is known at run time only: check it with try_view<network::input_shape>.frame., which returns nothing for another size, and pass what that holds
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

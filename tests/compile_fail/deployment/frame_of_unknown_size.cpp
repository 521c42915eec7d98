// expect: deployed: the type of this frame does not tell its shape: compare its size, then name the shape, as in tensor_view<const float, network::input_shape>.frame.data...
// at-most: 1
#include <tactnet/tactnet.hpp>

#include <vector>

using net = tactnet::tactnet4<tactnet::shape{28, 50}, 22>;

std::size_t recognise(const tactnet::deployed_model<net>& model, const std::vector<float>& frame,
                      tactnet::deployed<net>::workspace& memory) {
    if (const auto found = model(frame, memory))
        return found->index;
    return 0;
}

// expect: deployed: the size of this frame is known at run time only: check it with frame.as<network::input_shape>.., which returns nothing for another size
// at-most: 1
#include <tactnet/sensors.hpp>
#include <tactnet/tactnet.hpp>

using net = tactnet::tactnet4<tactnet::shape{28, 50}, 22>;

std::size_t recognise(const tactnet::deployed<net>& model, const tactnet::frame_view& frame) {
    if (const auto found = model.classify(frame))
        return found->index;
    return 0;
}

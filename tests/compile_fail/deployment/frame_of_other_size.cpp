// expect: deployed: the frame has another number of elements than the network's input; frame_has_size shows found, expected
// expect: ExpectedElements = 1400; Elements = 1399|frame_has_size<1399UL, 1400UL>
// at-most: 1
#include <tactnet/tactnet.hpp>

#include <array>

using net = tactnet::tactnet4<tactnet::shape{28, 50}, 22>;

std::size_t recognise(const tactnet::deployed<net>& model) {
    const std::array<std::uint8_t, 1399> frame{};
    const auto found = model.classify(frame);
    return found ? found->index : 0;
}

// expect: deployed: the frame has another shape than the network's input; frame_has_shape shows its rows, columns and channels, then those expected
// expect: Rows == ExpectedRows .with .*Rows = |frame_has_shape<50UL, 28UL, 1UL, 28UL, 50UL, 1UL>
// at-most: 1
#include <tactnet/tactnet.hpp>

using net = tactnet::tactnet4<tactnet::shape{28, 50}, 22>;

bool recognise(const tactnet::deployed<net>& fast,
               const tactnet::tensor<float, tactnet::shape{50, 28}>& frame, std::span<float, 22> outputs,
               tactnet::deployed<net>::workspace& memory) {
    return fast.infer(frame, outputs, memory) == tactnet::frame_status::ok;
}

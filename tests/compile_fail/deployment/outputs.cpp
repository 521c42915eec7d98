#include <tactnet/tactnet.hpp>

#include <array>
#include <span>
#include <vector>

using net = tactnet::tactnet4<tactnet::shape{28, 50}, 22>;

#ifdef CASE_of_other_size
// expect: deployed: there is room for another number of outputs than the network has; outputs_have_size shows found, expected
// expect: ExpectedElements = 22; Elements = 21|outputs_have_size<21UL, 22UL>
// at-most: 1
bool recognise(const tactnet::deployed<net>& fast, const std::array<std::uint8_t, 28 * 50>& frame) {
    std::array<float, 21> outputs{};
    return fast.infer(frame, outputs) == tactnet::frame_status::ok;
}
#endif

#ifdef CASE_of_other_type
// expect: deployed: outputs are written to float, which must not be const; outputs_have_type shows what was found
// expect: Element = double|'double' does not satisfy 'outputs_have_type'
// at-most: 1
bool recognise(const tactnet::deployed<net>& fast, const std::array<std::uint8_t, 28 * 50>& frame) {
    std::array<double, 22> outputs{};
    return fast.infer(frame, outputs) == tactnet::frame_status::ok;
}
#endif

#ifdef CASE_of_temporary
// expect: deployed: outputs are written to a contiguous container of float that outlives the call
// at-most: 3
bool infer(const tactnet::deployed<net>& fast, const std::vector<std::uint8_t>& frames, float* outputs,
           tactnet::thread_pool& pool) {
    return fast.infer(frames, outputs, pool) == tactnet::frame_status::ok &&
           fast.infer(frames, std::vector<float>(22), pool) == tactnet::frame_status::ok &&
           fast.infer(std::array<float, 1400>(), std::array<float, 22>()) == tactnet::frame_status::ok;
}
#endif

#ifdef CASE_of_unknown_number
// expect: deployed: the number of these outputs is known at run time only: check it, then pass std::span<float, network::outputs>.outputs.
// at-most: 1
bool recognise(const tactnet::deployed<net>& fast, const std::array<std::uint8_t, 28 * 50>& frame) {
    std::vector<float> outputs(22);
    return fast.infer(frame, outputs) == tactnet::frame_status::ok;
}
#endif

#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/sensors.hpp>
#include <tactnet/tactnet.hpp>

#include <array>
#include <span>
#include <vector>

using net = tactnet::tactnet4<tactnet::shape{28, 50}, 22>;

#ifdef CASE_frame_of_other_shape
// expect: deployed: the frame has another shape than the network's input; frame_has_shape shows its rows, columns and channels, then those expected
// expect: Rows == ExpectedRows .with .*Rows = |frame_has_shape<50UL, 28UL, 1UL, 28UL, 50UL, 1UL>
bool recognise(const tactnet::deployed<net>& fast,
               const tactnet::tensor<float, tactnet::shape{50, 28}>& frame, std::span<float, 22> outputs,
               tactnet::deployed<net>::workspace& memory) {
    return fast.infer(frame, outputs, memory) == tactnet::frame_status::ok;
}

#elif defined(CASE_frame_of_other_size)
// expect: deployed: the frame has another number of elements than the network's input; frame_has_size shows found, expected
// expect: ExpectedElements = 1400; Elements = 1399|frame_has_size<1399UL, 1400UL>
std::size_t recognise(const tactnet::deployed<net>& model) {
    const std::array<std::uint8_t, 1399> frame{};
    const auto found = model.classify(frame);
    return found ? found->index : 0;
}

#elif defined(CASE_frame_of_other_type)
// expect: deployed: the elements of a frame are counts, std::uint8_t, or float; frame_has_type shows what was found
// expect: Element = short unsigned int|'unsigned short' does not satisfy 'frame_has_type'
bool recognise(const tactnet::deployed<net>& fast, const std::array<std::uint16_t, 28 * 50>& frame,
               std::span<float, 22> outputs) {
    return fast.view().infer(frame, outputs) == tactnet::frame_status::ok;
}

#elif defined(CASE_frame_of_sensor)
// expect: deployed: the size of this frame is known at run time only: check it with frame.as<network::input_shape>.., which returns nothing for another size
std::size_t recognise(const tactnet::deployed<net>& model, const tactnet::frame_view& frame) {
    if (const auto found = model.classify(frame))
        return found->index;
    return 0;
}

#elif defined(CASE_frame_of_unknown_size)
// expect: deployed: the size of this frame is known at run time only: check it with try_view<network::input_shape>.frame., which returns nothing for another size, and pass what that holds
std::size_t recognise(const tactnet::deployed<net>& model, const std::vector<float>& frame,
                      tactnet::deployed<net>::workspace& memory) {
    if (const auto found = model.classify(frame, memory))
        return found->index;
    return 0;
}

#elif defined(CASE_frames_in_array)
// expect: deployed: frames for a pool are a contiguous container with data.* and size
// at-most: 2
std::uint8_t frames[64][28][50];

bool infer(const tactnet::deployed<net>& fast, std::vector<float>& outputs, tactnet::thread_pool& pool) {
    static_cast<void>(fast.classify(&frames[0][0][0], pool));
    return fast.infer(frames, outputs, pool) == tactnet::frame_status::ok;
}

#elif defined(CASE_frames_of_other_size)
// expect: deployed: the frame has another number of elements than the network's input; frame_has_size shows found, expected
// expect: ExpectedElements = 1400; Elements = 1399|frame_has_size<1399UL, 1400UL>
bool infer(const tactnet::deployed<net>& fast, const std::vector<std::array<std::uint8_t, 1399>>& frames,
           std::vector<float>& outputs, tactnet::thread_pool& pool) {
    return fast.infer(frames, outputs, pool) == tactnet::frame_status::ok;
}

#elif defined(CASE_frames_of_other_type)
// expect: deployed: the elements of a frame are counts, std::uint8_t, or float; frame_has_type shows what was found
// expect: Element = double|'double' does not satisfy 'frame_has_type'
auto classify(const tactnet::deployed<net>& fast, const std::vector<double>& frames,
              tactnet::thread_pool& pool) {
    return fast.classify(frames, pool);
}

#elif defined(CASE_frames_of_views)
// expect: deployed: frames for a pool lie one after the other in memory, which views need not
bool infer(const tactnet::deployed<net>& fast, const std::vector<std::span<const std::uint8_t, 1400>>& frames,
           std::vector<float>& outputs, tactnet::thread_pool& pool) {
    return fast.infer(frames, outputs, pool) == tactnet::frame_status::ok;
}

#elif defined(CASE_outputs_of_other_size)
// expect: deployed: there is room for another number of outputs than the network has; outputs_have_size shows found, expected
// expect: ExpectedElements = 22; Elements = 21|outputs_have_size<21UL, 22UL>
bool recognise(const tactnet::deployed<net>& fast, const std::array<std::uint8_t, 28 * 50>& frame) {
    std::array<float, 21> outputs{};
    return fast.infer(frame, outputs) == tactnet::frame_status::ok;
}

#elif defined(CASE_outputs_of_other_type)
// expect: deployed: outputs are written to float, which must not be const; outputs_have_type shows what was found
// expect: Element = double|'double' does not satisfy 'outputs_have_type'
bool recognise(const tactnet::deployed<net>& fast, const std::array<std::uint8_t, 28 * 50>& frame) {
    std::array<double, 22> outputs{};
    return fast.infer(frame, outputs) == tactnet::frame_status::ok;
}

#elif defined(CASE_outputs_of_temporary)
// expect: deployed: outputs are written to a contiguous container of float that outlives the call
// at-most: 3
bool infer(const tactnet::deployed<net>& fast, const std::vector<std::uint8_t>& frames, float* outputs,
           tactnet::thread_pool& pool) {
    return fast.infer(frames, outputs, pool) == tactnet::frame_status::ok &&
           fast.infer(frames, std::vector<float>(22), pool) == tactnet::frame_status::ok &&
           fast.infer(std::array<float, 1400>(), std::array<float, 22>()) == tactnet::frame_status::ok;
}

#elif defined(CASE_outputs_of_unknown_number)
// expect: deployed: the number of these outputs is known at run time only: check it, then pass std::span<float, network::outputs>.outputs.
bool recognise(const tactnet::deployed<net>& fast, const std::array<std::uint8_t, 28 * 50>& frame) {
    std::vector<float> outputs(22);
    return fast.infer(frame, outputs) == tactnet::frame_status::ok;
}
#endif

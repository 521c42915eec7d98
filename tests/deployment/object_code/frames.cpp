// Calls of deployed networks and nothing else: check.cmake reads what the compiler generates for them.

#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/networks/tactnet6.hpp>
#include <tactnet/networks/tactresnet.hpp>
#include <tactnet/quantisation.hpp>

#include <cstdint>
#include <span>

namespace {

using namespace tactnet;

template <class Network, class Format = single_precision>
using view_of = typename deployed<Network, Format>::view_type;

template <class View, class Count>
frame_status recognise(const typename View::packed_weights& weights, const Count* counts, float* logits,
                       typename View::workspace& memory, const input_function& function = {}) noexcept {
    return View(weights, View::outputs, 1, function)
        .infer(tensor_view<const Count, View::input_shape>(counts),
               std::span<float, View::outputs>(logits, View::outputs), memory);
}

using tactnet4_in_8_bits = view_of<tactnet4<shape{14, 25}, 22>, eight_bit>;
using tactnet6_in_floats = view_of<tactnet6<shape{28, 50}, 22>>;
using tactresnet_in_floats = view_of<tactresnet<shape{7, 13}, 22>>;

} // namespace

frame_status frame_of_tactnet4(const tactnet4_in_8_bits::packed_weights& weights, const std::uint8_t* counts,
                               float* logits, tactnet4_in_8_bits::workspace& memory,
                               const input_function& function) noexcept {
    return recognise<tactnet4_in_8_bits>(weights, counts, logits, memory, function);
}
frame_status frame_of_tactnet6(const tactnet6_in_floats::packed_weights& weights, const float* counts,
                               float* logits, tactnet6_in_floats::workspace& memory) noexcept {
    return recognise<tactnet6_in_floats>(weights, counts, logits, memory);
}
frame_status frame_of_tactresnet(const tactresnet_in_floats::packed_weights& weights,
                                 const std::uint8_t* counts, float* logits,
                                 tactresnet_in_floats::workspace& memory) noexcept {
    return recognise<tactresnet_in_floats>(weights, counts, logits, memory);
}

#include "network.hpp"
#include "recogniser.hpp"

#include <tactnet/detail/instruction_set.hpp>

#include <span>

// Compiled once for each instruction set; RECOGNISER is the name under which the others find it. Everything
// else that is defined here stays here: CMakeLists.txt makes it local.

namespace {

using view = tactnet::deployed<net>::view_type;
view::packed_weights weights;

void take(const float* folded) noexcept {
    weights = {};
    view::pack(folded, weights.elements.data());
}

bool recognise(const std::uint8_t* counts, float* logits) noexcept {
    return view(weights).infer(tactnet::tensor_view<const std::uint8_t, net::input_shape>(counts),
                               std::span<float, net::outputs>(logits, net::outputs)) ==
           tactnet::frame_status::ok;
}

} // namespace

extern "C" const recogniser RECOGNISER{tactnet::instruction_set.data(), take, recognise};

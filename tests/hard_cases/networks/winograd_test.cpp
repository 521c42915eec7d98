// Winograd's tiles where terms cancel, where weights differ by orders of magnitude, and in sequence.
// Held to the running error analysis
// of a tile's terms, or to the deviation of independent roundings where that is smaller.

#include "../hold.hpp"

#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deployment/deployed_network.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

using namespace tactnet;
using hard_cases::outcome;

namespace {

enum class hardness { usual, offset, cancelling, wide };

template <class Network>
void check_tiles(const std::string& name, hardness kind) {
    Network net;
    support::fill(net, 21);
    support::numbers draw(5);
    net.for_each_parameter([&](const parameter& p, auto values) {
        if (p.role != parameter_role::weight)
            return;
        // Filters that add up to nothing see no offset; others have weights from 1e-6 to 1e6.
        for (std::size_t i = 0; i < values.size(); i += 9) {
            float sum = 0;
            for (std::size_t k = 0; k < 9 && i + k < values.size(); ++k)
                sum += values[i + k];
            for (std::size_t k = 0; k < 9 && i + k < values.size(); ++k) {
                if (kind == hardness::cancelling)
                    values[i + k] -= sum / 9;
                if (kind == hardness::wide)
                    values[i + k] *= std::pow(10.0f, draw.next(-6, 6));
            }
        }
    });
    const auto layers = support::describe<Network>();
    CHECK(layers.tiles.at(0).rows > 0);
    std::vector<float> frame(Network::input_shape.size()), out(Network::outputs);
    for (float& value : frame)
        value = draw.next(-1, 1) + (kind == hardness::offset || kind == hardness::cancelling ? 1e4f : 0.0f);
    const auto fast = deploy(net);
    const auto memory = std::make_unique<typename decltype(fast)::workspace>();
    CHECK(fast.infer(tensor_view<const float, Network::input_shape>(frame.data()),
                     std::span<float, Network::outputs>(out), *memory) == frame_status::ok);
    const auto expected =
        support::bounded_outputs(layers, support::parameters_of(net), support::bounded_input(frame, {}, 1));
    std::vector<outcome> all;
    for (std::size_t o = 0; o < out.size(); ++o)
        all.push_back({expected[o].value, static_cast<double>(out[o]),
                       std::min(expected[o].error, expected[o].deviation)});
    hold(name, hard_cases::unit::absolute, all);
}

constexpr shape image{12, 12, 16};
using one = network<image, conv2d<16, 3>>;
using two = network<image, conv2d<16, 3>, conv2d<16, 3>>;
using four = network<image, conv2d<16, 3>, conv2d<16, 3>, conv2d<16, 3>, conv2d<16, 3>>;
using large = network<shape{24, 24, 64}, conv2d<64, 3>>;

} // namespace

TEST_CASE("deployed: tiles of a convolution, of usual numbers and of hard ones") {
    check_tiles<one>("typical values", hardness::usual);
    check_tiles<one>("a signal of 1 on an offset of 1e4", hardness::offset);
    check_tiles<one>("the same, filters that sum to zero", hardness::cancelling);
    check_tiles<one>("weights from 1e-6 to 1e6", hardness::wide);
    check_tiles<large>("64 channels, typical values", hardness::usual);
    check_tiles<large>("64 channels, the signal on an offset, filters that sum to zero",
                       hardness::cancelling);
}

TEST_CASE("deployed: consecutive layers by tiles") {
    check_tiles<two>("2 convolutions", hardness::usual);
    check_tiles<four>("4 convolutions", hardness::usual);
}

#include <tactnet/image/three_channels.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>

using namespace tactnet;

namespace {

template <shape Grey>
void check() {
    tensor<float, Grey> grey;
    for (std::size_t e = 0; e < Grey.size(); ++e)
        grey.data()[e] = static_cast<float>(e) * 1.25f - 20;
    const channel_normalisation normalise{{123.68f, 116.78f, 103.94f}, {1, 0.5f, 1.0f / 57}};
    tensor<float, with_three_channels(Grey)> planar;
    std::array<float, 3 * Grey.area()> last;
    batch<float, with_three_channels(Grey), 4> samples(6);
    to_three_channels<Grey>(grey.view(), normalise, planar.view());
    to_three_channels_last<Grey>(grey.view(), normalise, last);
    to_three_channels<Grey>(grey.view(), normalise, samples.view(), 5);
    std::size_t wrong = 0;
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t e = 0; e < Grey.area(); ++e) {
            const float expected = (grey.data()[e] - normalise.mean[channel]) * normalise.scale[channel];
            wrong += planar.data()[channel * Grey.area() + e] != expected;
            wrong += last[3 * e + channel] != expected;
            wrong += samples(5, channel * Grey.area() + e) != expected;
            wrong += samples(4, channel * Grey.area() + e) != 0;
        }
    CHECK_MESSAGE(wrong == 0, Grey.rows << " x " << Grey.columns);
}

} // namespace

TEST_CASE("to_three_channels: the same numbers in each layout, less the mean of each channel") {
    check<shape{7, 13}>();
    check<shape{28, 50}>();
    check<shape{1, 1}>();
    check<shape{1, 3}>();
    check<shape{2, 8}>();
    check<shape{5, 5}>();
}

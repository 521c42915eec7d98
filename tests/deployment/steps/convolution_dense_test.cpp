#include <tactnet/deployment/batch.hpp>
#include <tactnet/deployment/steps/convolution.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <support/guarded_map.hpp>
#include <vector>

using namespace tactnet;

namespace {

using step = dense_step<single_precision, kernels::frame_dense{{3, 5, 8}, 8, 22}>;
static_assert(!step::layerwise);

} // namespace

TEST_CASE(
    "dense_step: frames together, whole register blocks of them and rests, have the bits of each alone") {
    constexpr std::size_t most = 2 * kernels::dense_frames<step::kernel> + 1,
                          in_distance = step::kernel.inputs() + 16, out_distance = detail::map_distance<step>;
    std::uint64_t state = 7;
    std::vector<float> folded(step::folded_elements);
    for (float& value : folded)
        value = support::draw(state);
    aligned_vector<float> packed(step::packed_elements), inputs(most * in_distance, NAN),
        alone(most * out_distance);
    step::pack(folded.data(), packed.data());
    for (std::size_t frame = 0; frame < most; ++frame) {
        float* const in = inputs.data() + frame * in_distance;
        std::generate_n(in, step::kernel.inputs(), [&] { return support::draw(state); });
        step::run(packed.data(), in, alone.data() + frame * out_distance, nullptr);
    }
    for (std::size_t frames = 1; frames <= most; ++frames) {
        CAPTURE(frames);
        // Not even the place of a frame more is touched.
        support::guarded_map outputs((frames - 1) * out_distance + step::output_stride, 99, NAN);
        const inline_executor<most> here{};
        step::run_batch(packed.data(), inputs.data(), in_distance, outputs.data(), nullptr,
                        batch_executor<const inline_executor<most>>{here, frames});
        CHECK(outputs.untouched());
        std::size_t other = 0;
        for (std::size_t frame = 0; frame < frames; ++frame)
            for (std::size_t o = 0; o < step::output_stride; ++o) {
                const std::size_t place = frame * out_distance + o;
                other += std::bit_cast<std::uint32_t>(outputs.data()[place]) !=
                         std::bit_cast<std::uint32_t>(alone[place]);
            }
        CHECK(other == 0);
    }
}

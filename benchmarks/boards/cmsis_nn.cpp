// CMSIS-NN on the tables of a network: checks its logits, then counts what a frame takes. The frame is given
// in the type that the library takes. BYTES is 1 for 8 bits. Layers that need memory get it before the
// frames, as do sums of weights.

#include <algorithm>
#include <arm_nnfunctions.h>
#include <cmath>
#include <costs.hpp>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace {

#if BYTES
using number = std::int8_t;
using sum = std::int32_t;
using convolution_settings = cmsis_nn_conv_params;
using pool_settings = cmsis_nn_pool_params;
constexpr number least = -128, most = 127;
#else
using number = float;
using sum = float;
using convolution_settings = cmsis_nn_conv_params_f32;
using pool_settings = cmsis_nn_pool_params_f32;
constexpr number most = std::numeric_limits<float>::max(), least = -most;
#endif

struct size {
    int rows, columns, channels;
    [[nodiscard]] constexpr int all() const { return rows * columns * channels; }
    [[nodiscard]] constexpr cmsis_nn_dims with(int n) const { return {n, rows, columns, channels}; }
};
struct layer {
    size from, kernel, to, stride_and_top;
    int left;
    bool relu, packed;
    const number* weights; ///< none for a pool
    const sum* bias;
    const std::int32_t *multipliers, *shifts;
};

#include TEST_TABLES

constexpr std::size_t count = std::size(layers);
constexpr int largest = [] {
    int all = 0;
    for (const layer& l : layers)
        all = std::max({all, l.from.all(), l.to.all()});
    return all;
}();
alignas(16) number maps[2][largest];
alignas(16) std::uint8_t memory[64 * 1024];
alignas(16) number frame[std::size(counts)];
cmsis_nn_context contexts[count];

constexpr bool is_dense(const layer& l) {
    return l.to.rows * l.to.columns == 1 && l.kernel.all() == l.from.all();
}
constexpr cmsis_nn_tile stride(const layer& l) {
    return {l.stride_and_top.columns, l.stride_and_top.rows};
}
constexpr cmsis_nn_tile padding(const layer& l) {
    return {l.left, l.stride_and_top.channels};
}

#if !BYTES
constexpr arm_nn_weight_format_flt format(const layer& l) {
    return l.packed ? ARM_NN_WEIGHT_FORMAT_NT_N_PACKED : ARM_NN_WEIGHT_FORMAT_STANDARD;
}
#endif

arm_cmsis_nn_status run(const layer& l, const cmsis_nn_context& context, const number* from, number* to) {
    const cmsis_nn_dims input = l.from.with(1), output = l.to.with(1), none{};
    if (l.weights == nullptr) {
        const pool_settings settings{stride(l), padding(l), {least, most}};
        const cmsis_nn_dims window = l.kernel.with(1);
#if BYTES
        return arm_max_pool_s8(&context, &settings, &input, from, &window, &output, to);
#else
        return arm_max_pool_f32(&context, &settings, &input, from, &window, &output, to);
#endif
    }
    const cmsis_nn_dims filters = l.kernel.with(is_dense(l) ? l.from.all() : l.to.channels);
#if BYTES
    // All maps but the logits hold nothing below zero, which the lowest byte stands for.
    const int zero = l.relu ? -128 : 0;
    auto *const multipliers = const_cast<std::int32_t*>(l.multipliers), *const shifts =
                                                                            const_cast<std::int32_t*>(
                                                                                l.shifts);
    if (is_dense(l)) {
        const cmsis_nn_fc_params settings{128, 0, zero, {least, most}};
        const cmsis_nn_quant_params factors{multipliers, shifts, 1};
        return arm_fully_connected_wrapper_s8(&context, &settings, &factors, &input, from, &filters,
                                              l.weights, &none, l.bias, &output, to);
    }
    const cmsis_nn_conv_params settings{128, zero, stride(l), padding(l), {1, 1}, {least, most}};
    const cmsis_nn_per_channel_quant_params factors{multipliers, shifts};
    return arm_convolve_wrapper_s8(&context, &settings, &factors, &input, from, &filters, l.weights, &none,
                                   l.bias, &output, to);
#else
    const cmsis_nn_activation_f32 range{l.relu ? 0 : least, most};
    if (is_dense(l)) {
        const cmsis_nn_fc_params_f32 settings{range, format(l)};
        return arm_fully_connected_f32(&context, &settings, &input, from, &filters, l.weights, &none, l.bias,
                                       &output, to, ARM_NN_LAYOUT_NHWC);
    }
    const cmsis_nn_conv_params_f32 settings{stride(l), padding(l), {1, 1}, range, format(l)};
    return arm_convolve_wrapper_f32(&context, &settings, &input, from, &filters, l.weights, &none, l.bias,
                                    &output, to);
#endif
}

/// What each layer needs before the first frame. False if that is more than there is.
bool prepare() {
    for (std::size_t i = 0; i < std::size(counts); ++i)
        frame[i] = static_cast<number>(counts[i] - (BYTES ? 128 : 0));
    std::size_t used = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const layer& l = layers[i];
        if (l.weights == nullptr)
            continue;
        const cmsis_nn_dims input = l.from.with(1), output = l.to.with(1),
                            filters = l.kernel.with(is_dense(l) ? l.from.all() : l.to.channels);
        const convolution_settings settings {
#if BYTES
            128, 0,
#endif
                stride(l), padding(l), {1, 1}, {least, most}
#if !BYTES
            ,
                format(l)
#endif
        };
#if BYTES
        const std::int32_t bytes =
            is_dense(l) ? arm_fully_connected_s8_get_buffer_size(&filters)
                        : arm_convolve_wrapper_s8_get_buffer_size(&settings, &input, &filters, &output);
#else
        const std::int32_t bytes =
            is_dense(l) ? 0 : arm_convolve_wrapper_f32_get_buffer_size(&settings, &input, &filters, &output);
#endif
        contexts[i] = {memory + used, bytes};
        used += static_cast<std::size_t>(bytes + 15) / 16 * 16;
        if (used > sizeof(memory))
            return false;
#if BYTES
        if (is_dense(l) && bytes > 0)
            arm_vector_sum_s8(static_cast<std::int32_t*>(contexts[i].buf), l.from.all(), l.to.all(),
                              l.weights, 128, 0, l.bias);
#endif
    }
    return true;
}

bool recognise() {
    const number* from = frame;
    for (std::size_t i = 0; i < count; ++i) {
        number* const to = maps[i % 2];
        if (run(layers[i], contexts[i], from, to) != ARM_CMSIS_NN_SUCCESS)
            return false;
        from = to;
    }
    return true;
}

} // namespace

int main() {
    if (!prepare() || !recognise())
        return 2;
    float error = 0, highest = 0;
    for (std::size_t i = 0; i < std::size(expected); ++i) {
        const float logit = static_cast<float>(maps[(count - 1) % 2][i]) * logit_scale;
        error = std::max(error, std::abs(logit - expected[i]));
        highest = std::max(highest, std::abs(expected[i]));
    }
    if (!(error < tolerance * highest))
        return 3;
    tell_costs(recognise);
    return 0;
}

#pragma once

#include "../support/whole_numbers.hpp"

#define TINYMIND_ENABLE_FLOAT 1
#define TINYMIND_ENABLE_STD 1
#define TINYMIND_ENABLE_QUANTIZATION 1
#ifdef __AVX2__ // its AVX-512 is slower on so few channels
#define TINYMIND_ENABLE_SIMD_AVX2 1
#endif
#include <algorithm>
#include <array>
#include <conv2d.hpp>
#include <cstddef>
#include <cstdint>
#include <include/qcalibration.hpp>
#include <pool2d.hpp>
#include <qconv2d.hpp>
#include <qpad.hpp>
#include <qpool2d.hpp>
#include <span>
#include <type_traits>
#include <vector>

// TactNet-4 of TinyMind's layers, whose sizes are known when compiling: its own padding, convolutions and
// pools, in single precision and in 8 bits.

namespace benchmark {

/// A convolution of unchanged size, ReLU and a max pool of 2 × 2. Over one pixel, it is a dense layer alone.
template <class Number, std::size_t Rows, std::size_t Columns, std::size_t Channels, std::size_t Kernel,
          std::size_t Filters>
class tinymind_block {
    static constexpr bool bytes = std::is_same_v<Number, std::int8_t>, dense = Rows * Columns == 1;
    static constexpr Number zero = bytes ? -128 : 0;
    static constexpr std::size_t top = (Kernel - 1) / 2, bottom = Kernel / 2, window = dense ? 1 : 2,
                                 rows = Rows + Kernel - 1, columns = Columns + Kernel - 1;
    using padding = tinymind::QPad2D<Number, Rows, Columns, Channels, top, bottom, top, bottom>;
    using convolution = std::conditional_t<
        bytes,
        tinymind::QConv2DPerChannel<std::int8_t, std::int8_t, std::int32_t, std::int8_t, rows, columns,
                                    Channels, Kernel, Kernel, 1, 1, Filters>,
        tinymind::Conv2D<float, rows, columns, Channels, Kernel, Kernel, 1, 1, Filters>>;
    using pool =
        std::conditional_t<bytes, tinymind::QMaxPool2D<std::int8_t, Rows, Columns, Filters, window, window>,
                           tinymind::MaxPool2D<float, Rows, Columns, Filters, window, window>>;

public:
    tinymind_block(const operation& o, float input_scale, float output_scale) {
        if constexpr (bytes) {
            const whole_numbers whole = quantised(o, input_scale);
            weights_ = channels_last(o, whole.weights);
            bias_ = whole.bias;
            for (std::size_t f = 0; f < Filters; ++f)
                scales_[f] = tinymind::buildRequantizer<std::int8_t>(whole.units[f], 1, output_scale,
                                                                     dense ? 0 : zero, -128, 127);
            convolution_ = {weights_.data(), bias_.data(), zero, scales_.data()};
        } else {
            const std::vector<float> weights = channels_last(o, o.weights);
            std::size_t next = 0;
            for (std::size_t f = 0; f < Filters; ++f) {
                for (std::size_t i = 0; i < weights.size() / Filters; ++i)
                    convolution_.setWeight(next++, weights[f * (weights.size() / Filters) + i]);
                convolution_.setWeight(next++, o.bias[f]);
            }
        }
    }
    tinymind_block(const tinymind_block&) = delete;
    tinymind_block& operator=(const tinymind_block&) = delete;

    [[nodiscard]] const Number* run(const Number* in) {
        if constexpr (!dense) {
            padding_.forward(in, padded_.data());
            in = padded_.data();
        }
        convolution_.forward(in, full_.data());
        if constexpr (dense)
            return full_.data();
        pool_.forward(full_.data(), pooled_.data());
        if constexpr (!bytes) // bytes end at zero
            for (float& value : pooled_)
                value = std::max(value, 0.0f);
        return pooled_.data();
    }

private:
    padding padding_{zero};
    convolution convolution_;
    pool pool_;
    std::vector<std::int8_t> weights_;
    std::vector<std::int32_t> bias_;
    std::array<tinymind::Requantizer<std::int32_t, std::int8_t>, Filters> scales_;
    std::array<Number, padding::OutputSize> padded_;
    std::array<Number, Rows * Columns * Filters> full_;
    std::array<Number, pool::OutputSize> pooled_;
};

/// Sides are multiples of 8. Bytes of a frame are counts less 128.
template <class Number, std::size_t Rows, std::size_t Columns, std::size_t Kernel>
class tinymind_tactnet4 {
public:
    tinymind_tactnet4(const described_network& network, const std::vector<float>& scales)
        : tinymind_tactnet4(network.operations(), scales) {}
    void run(const Number* frame, std::span<float> logits) {
        const Number* const out = dense_.run(third_.run(second_.run(first_.run(frame))));
        for (std::size_t i = 0; i < logits.size(); ++i)
            logits[i] = scale_ * static_cast<float>(out[i]);
    }

private:
    tinymind_tactnet4(const std::vector<operation>& o, const std::vector<float>& s)
        : first_(o[0], s[o[0].input], s[o[0].output]),
          second_(o[2], s[o[2].input], s[o[2].output]),
          third_(o[4], s[o[4].input], s[o[4].output]),
          dense_(o[6], s[o[6].input], s[o[6].output]),
          scale_(s.back()) {}

    tinymind_block<Number, Rows, Columns, 1, Kernel, 8> first_;
    tinymind_block<Number, Rows / 2, Columns / 2, 8, 3, 16> second_;
    tinymind_block<Number, Rows / 4, Columns / 4, 16, 3, 32> third_;
    tinymind_block<Number, 1, 1, Rows * Columns / 2, 1, 22> dense_;
    float scale_;
};

} // namespace benchmark

#pragma once

// What a stream in 8 bits must give, from its folded numbers by the rules that are written in
// kernels/integer/recurrent.hpp and in deployment/eight_bit: plain loops in whole numbers of 64 bits, frame
// by frame, with none of the library's kernels nor of its packing.

#include <tactnet/deployment/eight_bit.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <support/layers/whole_reference.hpp>
#include <vector>

namespace support {

/// A frame of words or bytes, or, behind the last product, of floats.
struct stream_frame {
    std::vector<std::int64_t> whole;
    std::vector<float> floats;
};

/// A product of frames: weights [output][input], biases, scales, the range of the input and of bytes.
class stream_product {
public:
    stream_product(const float*& from, std::size_t inputs, std::size_t outputs, bool to_bytes, bool relu)
        : to_bytes_(to_bytes), relu_(relu) {
        const float *const weights = from, *const biases = from + inputs * outputs,
                           *const scales = biases + outputs;
        from = scales + outputs;
        input = reference_range::next(from);
        if (to_bytes)
            output = reference_range::next(from);
        for (std::size_t o = 0; o < outputs; ++o) {
            const auto scale = static_cast<double>(scales[o]);
            units_.push_back(scale * input.scale);
            weights_.emplace_back();
            std::int64_t start =
                static_cast<std::int64_t>(std::nearbyint(static_cast<double>(biases[o]) / units_.back()));
            for (std::size_t i = 0; i < inputs; ++i) {
                weights_.back().push_back(static_cast<std::int64_t>(
                    std::nearbyint(static_cast<double>(weights[o * inputs + i]) / scale)));
                start -= input.zero * weights_.back().back();
            }
            starts_.push_back(start);
        }
    }
    /// Inputs are [feature][frame], as the weights.
    [[nodiscard]] stream_frame operator()(const std::vector<std::int64_t>& in) const {
        stream_frame out;
        for (std::size_t o = 0; o < starts_.size(); ++o) {
            std::int64_t sum = starts_[o];
            for (std::size_t i = 0; i < in.size(); ++i)
                sum += weights_[o][i] * in[i];
            if (to_bytes_)
                out.whole.push_back(
                    reference_byte(sum, static_cast<float>(units_[o] / output.scale), output.zero, relu_));
            else
                out.floats.push_back(static_cast<float>(relu_ ? std::max<std::int64_t>(sum, 0) : sum) *
                                     static_cast<float>(units_[o]));
        }
        return out;
    }
    reference_range input, output;

private:
    bool to_bytes_, relu_;
    std::vector<std::vector<std::int64_t>> weights_;
    std::vector<std::int64_t> starts_;
    std::vector<double> units_;
};

/// a · b ÷ 2^bits, converted to single precision and rounded.
inline std::int64_t shifted_product(std::int64_t a, std::int64_t b, int bits) {
    return static_cast<std::int64_t>(std::nearbyint(std::ldexp(static_cast<float>(a * b), -bits)));
}
/// `top` ÷ (1 + e^(−x ÷ 2048)), with |x| at most `most`.
inline std::int64_t reference_logistic(std::int64_t x, std::int64_t most, std::int64_t top) {
    const std::int64_t t = std::clamp(x, -most, most) * 47274, u = (t >> 11) & 32767;
    std::int64_t p = -1316;
    for (const std::int64_t c : {7600, -22670, 32768})
        p = (p * u + c * 32768 + 16384) >> 15;
    const auto divisor =
        static_cast<float>(32768 + std::ldexp(static_cast<double>(p), static_cast<int>(-(t >> 26))));
    return static_cast<std::int64_t>(std::nearbyint(static_cast<float>(top * 32768) / divisor));
}
inline std::int64_t reference_sigmoid(std::int64_t x) {
    return reference_logistic(x, 32767, 32768);
}
inline std::int64_t reference_tanh(std::int64_t x) {
    return reference_logistic(2 * x, 24000, 65536) - 32768;
}

/// The hidden state and, of an LSTM, the content of one unit, after a frame.
struct unit_state {
    std::int64_t h = 0, c = 0;
};
template <class Cell>
void update_unit(const std::vector<std::int64_t>& in, const std::vector<std::int64_t>& hidden,
                 unit_state& s) {
    const auto both = [&](std::size_t gate) { return in[gate] + hidden[gate]; };
    if constexpr (Cell::gates == 3) {
        const std::int64_t r = reference_sigmoid(both(0)), z = reference_sigmoid(both(1)),
                           n = reference_tanh(in[2] + shifted_product(r, hidden[2], 15));
        s.h = n + shifted_product(z, s.h - n, 15);
    } else {
        const std::int64_t i = reference_sigmoid(both(0)), f = reference_sigmoid(both(1)),
                           g = reference_tanh(both(2)), o = reference_sigmoid(both(3));
        s.c =
            std::clamp<std::int64_t>(shifted_product(f, s.c, 15) + shifted_product(i, g, 19), -32767, 32767);
        s.h = shifted_product(o, reference_tanh(s.c), 15);
    }
}

using stream_function = std::function<stream_frame(const stream_frame&)>;

/// The reference of a layer, specialised below: `channels` of its input in and of its output out, the range
/// of the numbers likewise. `last` if it may write floats, `relu` if it takes the ReLU after it.
template <class Spec>
struct reference_stream_step;

struct stream_place {
    std::size_t channels;
    reference_range range;
    bool last, relu;
};

template <class Cell, std::size_t Hidden>
struct reference_stream_step<tactnet::recurrent<Cell, Hidden>> {
    static stream_function make(const float*& from, stream_place& place) {
        const std::size_t rows = Cell::gates * Hidden;
        const stream_product input(from, place.channels, rows, false, false),
            state(from, Hidden, rows, false, false);
        place.channels = Hidden, place.range = {static_cast<double>(1 / 127.0F), 128};
        const auto steps = [](float value) {
            return static_cast<std::int64_t>(
                std::nearbyint(std::clamp(static_cast<double>(value) * 2048, -32767.0, 32767.0)));
        };
        const auto byte = [](const unit_state& s) { return reference_byte(s.h, 127 / 32768.0F, 128, false); };
        return [=, last = place.last,
                units = std::vector<unit_state>(Hidden)](const stream_frame& in) mutable -> stream_frame {
            std::vector<std::int64_t> bytes;
            for (const unit_state& s : units)
                bytes.push_back(byte(s));
            const stream_frame of_input = input(in.whole), of_state = state(bytes);
            stream_frame out;
            for (std::size_t h = 0; h < Hidden; ++h) {
                std::vector<std::int64_t> a, b;
                for (std::size_t gate = 0; gate < Cell::gates; ++gate) {
                    a.push_back(steps(of_input.floats[gate * Hidden + h]));
                    b.push_back(steps(of_state.floats[gate * Hidden + h]));
                }
                update_unit<Cell>(a, b, units[h]);
                out.whole.push_back(byte(units[h]));
                if (last)
                    out.floats.push_back(static_cast<float>(units[h].h) / 32768);
            }
            return out;
        };
    }
};
template <std::size_t Filters, std::size_t Taps, std::size_t Dilation>
struct reference_stream_step<tactnet::causal_conv1d<Filters, Taps, Dilation>> {
    static stream_function make(const float*& from, stream_place& place) {
        const std::size_t features = place.channels;
        const stream_product product(from, features * Taps, Filters, !place.last, place.relu);
        place.channels = Filters, place.range = product.output;
        return [=, before = std::deque<std::vector<std::int64_t>>(
                       (Taps - 1) * Dilation + 1, std::vector<std::int64_t>(features, product.input.zero))](
                   const stream_frame& in) mutable {
            before.pop_front();
            before.push_back(in.whole);
            std::vector<std::int64_t> taps;
            for (std::size_t f = 0; f < features; ++f)
                for (std::size_t tap = 0; tap < Taps; ++tap)
                    taps.push_back(before[tap * Dilation][f]);
            return product(taps);
        };
    }
};
template <std::size_t Outputs>
struct reference_stream_step<tactnet::dense<Outputs>> {
    static stream_function make(const float*& from, stream_place& place) {
        const stream_product product(from, place.channels, Outputs, !place.last, place.relu);
        place.channels = Outputs, place.range = product.output;
        return [=](const stream_frame& in) { return product(in.whole); };
    }
};
template <class Function>
struct reference_stream_step<tactnet::activation<Function>> {
    static stream_function make(const float*& from, stream_place& place) {
        const reference_range input = reference_range::next(from);
        if constexpr (tactnet::detail::is_relu<Function>()) {
            return [=](stream_frame in) {
                for (std::int64_t& byte : in.whole)
                    byte = std::max(byte, input.zero);
                return in;
            };
        } else {
            const reference_range output = place.range = reference_range::next(from);
            return [=](stream_frame in) {
                for (std::int64_t& byte : in.whole) {
                    const double value =
                        Function::value(static_cast<double>(byte - input.zero) * input.scale);
                    byte = std::clamp<std::int64_t>(
                        static_cast<std::int64_t>(std::nearbyint(value / output.scale)) + output.zero, 0,
                        255);
                }
                return in;
            };
        }
    }
};

/// A list, whose layers' names do not count.
template <class... Specs>
struct reference_stream_list;
template <class... Specs>
struct reference_stream_step<tactnet::sequence<Specs...>>
    : reference_stream_list<tactnet::without_name<Specs>...> {};
template <class Main, class Skip>
struct reference_stream_step<tactnet::residual<Main, Skip>> {
    static stream_function make(const float*& from, stream_place& place) {
        stream_place of_main{place.channels, place.range, false, false}, of_skip = of_main;
        auto main = reference_stream_step<tactnet::as_sequence<Main>>::make(from, of_main);
        const reference_range a = reference_range::next(from), b = reference_range::next(from),
                              output = reference_range::next(from);
        auto skip = reference_stream_step<tactnet::as_sequence<Skip>>::make(from, of_skip);
        place.channels = of_main.channels, place.range = output;
        const double unit = std::max(a.scale, b.scale) / 32767;
        const auto of_a = static_cast<std::int64_t>(std::nearbyint(a.scale / unit)),
                   of_b = static_cast<std::int64_t>(std::nearbyint(b.scale / unit));
        return [=](const stream_frame& in) mutable {
            stream_frame out = main(in);
            const stream_frame added = skip(in);
            for (std::size_t i = 0; i < out.whole.size(); ++i)
                out.whole[i] =
                    reference_byte((out.whole[i] - a.zero) * of_a + (added.whole[i] - b.zero) * of_b,
                                   static_cast<float>(unit / output.scale), output.zero, false);
            return out;
        };
    }
};
template <>
struct reference_stream_list<> {
    static stream_function make(const float*&, stream_place&) {
        return [](const stream_frame& in) { return in; };
    }
};
/// A layer, the ReLU that it takes if there is one, and the others.
template <bool Relu, class Spec, class... Rest>
stream_function make_stream_chain(const float*& from, stream_place& place) {
    const bool last = place.last;
    place.last = last && (tactnet::inference_no_op<Rest> && ...);
    place.relu = Relu;
    auto first = reference_stream_step<Spec>::make(from, place);
    place.last = last;
    auto rest = reference_stream_list<Rest...>::make(from, place);
    return [=](const stream_frame& in) mutable { return rest(first(in)); };
}
template <class Spec, class... Rest>
struct reference_stream_list<Spec, Rest...> {
    static stream_function make(const float*& from, stream_place& place) {
        if constexpr (tactnet::inference_no_op<Spec>)
            return reference_stream_list<Rest...>::make(from, place);
        else
            return make_stream_chain<false, Spec, Rest...>(from, place);
    }
};
template <std::size_t Filters, std::size_t Taps, std::size_t Dilation, class... Rest>
struct reference_stream_list<tactnet::causal_conv1d<Filters, Taps, Dilation>, tactnet::relu, Rest...> {
    static stream_function make(const float*& from, stream_place& place) {
        return make_stream_chain<true, tactnet::causal_conv1d<Filters, Taps, Dilation>, Rest...>(from, place);
    }
};
template <std::size_t Outputs, class... Rest>
struct reference_stream_list<tactnet::dense<Outputs>, tactnet::relu, Rest...> {
    static stream_function make(const float*& from, stream_place& place) {
        return make_stream_chain<true, tactnet::dense<Outputs>, Rest...>(from, place);
    }
};

/// The outputs of a stream for a recording, frame after frame.
template <class Network>
std::vector<float> reference_stream_outputs(std::span<const float> folded, std::span<const float> recording) {
    constexpr std::size_t features = Network::input_shape.channels;
    const float* from = folded.data();
    std::vector<float> steps_per_unit;
    for (std::size_t f = 0; f < features; ++f)
        steps_per_unit.push_back(1 / *from++);
    stream_place place{features, {1, 0}, true, false};
    auto run = reference_stream_step<typename Network::logit_specification>::make(from, place);
    std::vector<float> outputs;
    for (std::size_t first = 0; first < recording.size(); first += features) {
        stream_frame in;
        for (std::size_t f = 0; f < features; ++f) {
            const float steps = std::clamp(recording[first + f] * steps_per_unit[f], -32767.0F, 32767.0F);
            in.whole.push_back(static_cast<std::int64_t>(std::nearbyint(steps)));
        }
        const stream_frame out = run(in);
        outputs.insert(outputs.end(), out.floats.begin(), out.floats.end());
        if (out.floats.empty())
            for (const std::int64_t byte : out.whole)
                outputs.push_back(static_cast<float>(byte - place.range.zero) *
                                  static_cast<float>(place.range.scale));
    }
    return outputs;
}

} // namespace support

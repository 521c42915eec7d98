#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <support/layers/reference/layers.hpp>
#include <vector>

namespace support {
namespace {

/// Operations on numbers with errors. Each adds its own rounding to what the errors of its operands make.
struct arithmetic {
    double roundoff;

    [[nodiscard]] bounded rounded(bounded exact, double roundings = 1) const {
        exact.error += accumulated(roundoff, roundings) * magnitude(exact) + lost;
        return exact;
    }
    [[nodiscard]] bounded add(const bounded& a, const bounded& b) const {
        return rounded({a.value + b.value, a.error + b.error});
    }
    [[nodiscard]] bounded multiply(const bounded& a, const bounded& b) const {
        return rounded({a.value * b.value, std::abs(a.value) * b.error + magnitude(b) * a.error});
    }
    /// Within 4 units in the last place. Its slope grows by less than eᵉ over a distance e.
    [[nodiscard]] bounded sigmoid(const bounded& x) const {
        const double y = 1 / (1 + std::exp(-x.value));
        const double slope = std::min(y * (1 - y) * std::exp(x.error), 0.25);
        return rounded({y, slope * x.error}, 8);
    }
    /// Within 2 units in the last place. Its slope grows by less than e²ᵉ over a distance e.
    [[nodiscard]] bounded tanh(const bounded& x) const {
        const double y = std::tanh(x.value);
        const double slope = std::min((1 - y) * (1 + y) * std::exp(2 * x.error), 1.0);
        return rounded({y, slope * x.error}, 4);
    }
    /// b + z · (a − b) with 0 ≤ z ≤ 1, in three roundings. The errors of a and b have the shares z and 1 − z.
    [[nodiscard]] bounded between(const bounded& z, const bounded& a, const bounded& b) const {
        const double distance = a.value - b.value, errors = a.error + b.error;
        bounded result{b.value + z.value * distance,
                       z.value * a.error + (1 - z.value) * b.error + z.error * (std::abs(distance) + errors)};
        result.error += accumulated(roundoff, 3) * (std::abs(distance) + errors + magnitude(result)) + lost;
        return result;
    }
    /// Σ weights · x + bias, a product and a sum for each term.
    [[nodiscard]] bounded sum(std::span<const double> weights, std::span<const bounded> x,
                              double bias) const {
        bounded result{bias, 0};
        double sizes = std::abs(bias);
        for (std::size_t i = 0; i < x.size(); ++i) {
            result.value += weights[i] * x[i].value;
            result.error += std::abs(weights[i]) * x[i].error;
            sizes += std::abs(weights[i]) * magnitude(x[i]);
        }
        result.error += accumulated(roundoff, static_cast<double>(x.size()) + 2) * sizes + lost;
        return result;
    }
};

/// A cell whose gates lie one after the other in its matrices.
class recurrence : public reference_layer {
public:
    recurrence(extents3 sequence, std::size_t hidden, std::size_t gates)
        : rows_(gates * hidden), hidden_(hidden) {
        input = sequence;
        output = {hidden, sequence.rows, 1};
        parameters = rows_ * (sequence.channels + hidden + 2);
        multiply_adds = multiply_adds_on_pixels = sequence.rows * rows_ * (sequence.channels + hidden);
    }
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const final {
        const arithmetic with{call.roundoff};
        samples out;
        for (const sample& each : in) {
            out.emplace_back(output.size());
            sample state(hidden_), content(hidden_), x(input.channels);
            for (std::size_t frame = 0; frame < input.rows; ++frame) {
                for (std::size_t f = 0; f < input.channels; ++f)
                    x[f] = each[f * input.rows + frame];
                const std::size_t matrix = rows_ * input.channels, biases = matrix + rows_ * hidden_;
                sample from_input(rows_), from_state(rows_);
                for (std::size_t r = 0; r < rows_; ++r) {
                    from_input[r] = with.sum(call.values.subspan(r * input.channels, input.channels), x,
                                             call.values[biases + r]);
                    from_state[r] = with.sum(call.values.subspan(matrix + r * hidden_, hidden_), state,
                                             call.values[biases + rows_ + r]);
                }
                for (std::size_t h = 0; h < hidden_; ++h)
                    update(with, &from_input[h], &from_state[h], hidden_, state[h], content[h]);
                for (std::size_t h = 0; h < hidden_; ++h)
                    out.back()[h * input.rows + frame] = state[h];
            }
        }
        return out;
    }

private:
    /// Gate g of the unit is at g · stride.
    virtual void update(const arithmetic& with, const bounded* in, const bounded* state_sums,
                        std::size_t stride, bounded& state, bounded& content) const = 0;

    std::size_t rows_, hidden_;
};

class gru_reference final : public recurrence {
public:
    gru_reference(extents3 sequence, std::size_t hidden) : recurrence(sequence, hidden, 3) {}

private:
    void update(const arithmetic& with, const bounded* in, const bounded* sums, std::size_t stride,
                bounded& state, bounded&) const override {
        const bounded r = with.sigmoid(with.add(in[0], sums[0]));
        const bounded z = with.sigmoid(with.add(in[stride], sums[stride]));
        const bounded n = with.tanh(with.add(in[2 * stride], with.multiply(r, sums[2 * stride])));
        state = with.between(z, state, n);
    }
};

class lstm_reference final : public recurrence {
public:
    lstm_reference(extents3 sequence, std::size_t hidden) : recurrence(sequence, hidden, 4) {}

private:
    void update(const arithmetic& with, const bounded* in, const bounded* sums, std::size_t stride,
                bounded& state, bounded& content) const override {
        const auto sum = [&](std::size_t gate) { return with.add(in[gate * stride], sums[gate * stride]); };
        content = with.add(with.multiply(with.sigmoid(sum(1)), content),
                           with.multiply(with.sigmoid(sum(0)), with.tanh(sum(2))));
        state = with.multiply(with.sigmoid(sum(3)), with.tanh(content));
    }
};

class causal_reference final : public reference_layer {
public:
    causal_reference(extents3 sequence, std::size_t filters, std::size_t taps, std::size_t dilation)
        : taps_(taps), dilation_(dilation) {
        input = sequence;
        output = {filters, sequence.rows, 1};
        parameters = filters * (sequence.channels * taps + 1);
        multiply_adds = filters * sequence.channels * taps * sequence.rows;
        for (std::size_t frame = 0; frame < sequence.rows; ++frame)
            for (std::size_t back = 0; back < taps; ++back)
                multiply_adds_on_pixels += back * dilation <= frame ? filters * sequence.channels : 0;
    }
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override {
        const std::size_t inputs = input.channels * taps_;
        samples out;
        for (const sample& each : in) {
            out.emplace_back();
            for (std::size_t o = 0; o < output.channels; ++o)
                for (std::size_t frame = 0; frame < input.rows; ++frame) {
                    sample x(inputs);
                    for_each_input(frame, [&](std::size_t i, std::size_t at) { x[i] = each[at]; });
                    out.back().push_back(
                        arithmetic{call.roundoff}.sum(call.values.subspan(o * inputs, inputs), x,
                                                      call.values[output.channels * inputs + o]));
                }
        }
        return out;
    }

private:
    /// body(feature and tap, place in the sample) for all that lie in the sequence.
    template <class Body>
    void for_each_input(std::size_t frame, Body&& body) const {
        for (std::size_t feature = 0; feature < input.channels; ++feature)
            for (std::size_t tap = 0; tap < taps_; ++tap)
                if (const std::size_t back = (taps_ - 1 - tap) * dilation_; back <= frame)
                    body(feature * taps_ + tap, feature * input.rows + frame - back);
    }

    std::size_t taps_, dilation_;
};

class last_frame_reference final : public sample_by_sample {
public:
    explicit last_frame_reference(extents3 sequence) {
        input = sequence;
        output = {sequence.channels, 1, 1};
    }
    [[nodiscard]] sample output_of(const reference_call&, const sample& in) const override {
        sample out;
        for (std::size_t f = 0; f < input.channels; ++f)
            out.push_back(in[(f + 1) * input.rows - 1]);
        return out;
    }
    [[nodiscard]] sample gradient_of(const reference_call&, const sample&,
                                     const sample& out_gradient) const override {
        sample gradient(input.size());
        for (std::size_t f = 0; f < input.channels; ++f)
            gradient[(f + 1) * input.rows - 1] = out_gradient[f];
        return gradient;
    }
};

} // namespace

reference_pointer reference_gru(extents3 input, std::size_t hidden) {
    return std::make_unique<gru_reference>(input, hidden);
}
reference_pointer reference_lstm(extents3 input, std::size_t hidden) {
    return std::make_unique<lstm_reference>(input, hidden);
}
reference_pointer reference_causal_conv1d(extents3 input, std::size_t filters, std::size_t taps,
                                          std::size_t dilation) {
    return std::make_unique<causal_reference>(input, filters, taps, dilation);
}
reference_pointer reference_last_frame(extents3 input) {
    return std::make_unique<last_frame_reference>(input);
}

} // namespace support

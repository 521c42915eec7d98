#include <algorithm>
#include <cmath>
#include <limits>
#include <support/layers/reference/layers.hpp>
#include <utility>

namespace support {

bounded folded_norm::shifted(std::size_t c, double bias) const {
    const double value = (bias - mean[c]) * factor(c) + shift[c];
    const double inside =
        0x1p-50 * ((std::abs(bias) + std::abs(mean[c])) * std::abs(factor(c)) + std::abs(shift[c]));
    return {value, inside + accumulated(roundoff, 1) * std::abs(value), inside + roundoff * std::abs(value)};
}

batch_norm::batch_norm(extents3 size) {
    input = output = size;
    parameters = statistics = 2 * size.channels;
}

folded_norm batch_norm::folded(const reference_call& call) const {
    const std::size_t channels = input.channels;
    return {call.values.first(channels),
            call.values.subspan(channels, channels),
            call.running.first(channels),
            call.running.subspan(channels, channels),
            call.epsilon,
            call.roundoff};
}

samples batch_norm::forward(const reference_call& call, const samples& in) const {
    if (call.deployed) {
        samples all;
        for (const sample& each : in)
            all.push_back(deployed(call, each));
        return all;
    }
    samples out(in.size(), sample(output.size()));
    for (std::size_t c = 0; c < input.channels; ++c) {
        const statistic m = call.training
                                ? of_batch(call, in, c)
                                : statistic{{call.running[c], 0}, {call.running[input.channels + c], 0}};
        const double inverse = 1 / std::sqrt(m.variance.value + call.epsilon);
        // d(v + ε)^-½ = −½ (v + ε)^-3/2 dv; the variance is never below zero.
        const double inverse_error =
            1 / std::sqrt(std::max(m.variance.value - m.variance.error, 0.0) + call.epsilon) - inverse;
        const double scale = call.values[c], shift = call.values[input.channels + c];
        for (std::size_t s = 0; s < in.size(); ++s)
            for (std::size_t p = c * input.area(); p < (c + 1) * input.area(); ++p) {
                const double distance = in[s][p].value - m.mean.value;
                const double moved = in[s][p].error + m.mean.error;
                out[s][p].value = distance * inverse * scale + shift;
                out[s][p].error = std::abs(scale) *
                                  (moved * (inverse + inverse_error) + std::abs(distance) * inverse_error);
                // Rounded: centre (its rest goes into the shift), distance, scale, the multiply-add.
                out[s][p].error +=
                    accumulated(call.roundoff, 5) *
                    (std::abs(scale) * (std::abs(distance) + moved) * (inverse + inverse_error) +
                     std::abs(shift));
            }
    }
    return out;
}

/// Factor, product, sum. Where nothing is folded, the mean is taken away by itself.
sample batch_norm::deployed(const reference_call& call, sample x) const {
    const folded_norm norm = folded(call);
    for (std::size_t e = 0; e < x.size(); ++e) {
        const std::size_t c = e / input.area();
        const double factor = norm.factor(c), middle = call.folded ? 0 : std::abs(factor * norm.mean[c]);
        const bounded offset = norm.shifted(c, 0);
        const double size = std::abs(factor) * magnitude(x[e]) + magnitude(offset) + middle;
        x[e] = {x[e].value * factor + offset.value,
                std::abs(factor) * x[e].error + offset.error + accumulated(call.roundoff, 3) * size +
                    3 * lost,
                std::sqrt(square(factor * x[e].deviation) + square(offset.deviation) + drift(call, 3, size))};
    }
    return x;
}

reference_gradients batch_norm::backward(const reference_call& call, const samples& in,
                                         const samples& out_gradient) const {
    reference_gradients g{samples(in.size(), sample(input.size())), sample(parameters)};
    const double count = static_cast<double>(in.size() * input.area());
    // Sums: short runs in the working precision, gathered in double. A product has three roundings of its
    // own.
    const double sum_error = accumulated(call.roundoff, 16 + 4), few = accumulated(call.roundoff, 8);
    for (std::size_t c = 0; c < input.channels; ++c) {
        const statistic m = of_batch(call, in, c);
        const double inverse = 1 / std::sqrt(m.variance.value + call.epsilon);
        const double inverse_relative =
            m.variance.error / std::max(m.variance.value - m.variance.error + call.epsilon, call.epsilon);
        double sum = 0, sum_size = 0, product = 0, product_size = 0;
        const auto normalised = [&](std::size_t s, std::size_t p) {
            return (in[s][p].value - m.mean.value) * inverse;
        };
        const auto normalised_error = [&](double x) {
            return std::abs(x) * inverse_relative + m.mean.error * inverse;
        };
        double product_error = 0;
        for_each(in, c, [&](std::size_t s, std::size_t p) {
            const double dy = out_gradient[s][p].value, x = normalised(s, p);
            sum += dy, sum_size += std::abs(dy);
            product += dy * x, product_size += std::abs(dy * x);
            product_error += std::abs(dy) * normalised_error(x);
        });
        product_error += sum_error * product_size;
        g.values[c] = {product, product_error};
        g.values[input.channels + c] = {sum, sum_error * sum_size};
        for_each(in, c, [&](std::size_t s, std::size_t p) {
            const double dy = out_gradient[s][p].value, x = normalised(s, p),
                         scale = call.values[c] * inverse;
            const double inner = std::abs(dy) + sum_size / count + std::abs(x) * product_size / count;
            g.input[s][p].value = scale * (dy - sum / count - x * product / count);
            g.input[s][p].error =
                std::abs(scale) * (inner * (few + inverse_relative) + sum_error * sum_size / count +
                                   std::abs(x) * product_error / count +
                                   normalised_error(x) * (std::abs(product) + product_error) / count);
        });
    }
    return g;
}

template <class Body>
void batch_norm::for_each(const samples& in, std::size_t channel, Body&& body) const {
    for (std::size_t s = 0; s < in.size(); ++s)
        for (std::size_t p = channel * input.area(); p < (channel + 1) * input.area(); ++p)
            body(s, p);
}

/// In two passes. The library measures from some value of the channel, so that its terms are at most the
/// range of the values; a run of 16 is added in the working precision.
batch_norm::statistic batch_norm::of_batch(const reference_call& call, const samples& in,
                                           std::size_t c) const {
    const double count = static_cast<double>(in.size() * input.area());
    double low = in[0][c * input.area()].value, high = low, sum = 0, wrong = 0;
    const double origin = low;
    for_each(in, c, [&](std::size_t s, std::size_t p) {
        low = std::min(low, in[s][p].value), high = std::max(high, in[s][p].value);
        sum += in[s][p].value - origin, wrong += in[s][p].error;
    });
    statistic m;
    m.mean.value = origin + sum / count;
    double squares = 0, moved = 0;
    for_each(in, c, [&](std::size_t s, std::size_t p) {
        const double d = in[s][p].value - m.mean.value;
        squares += d * d, moved += std::abs(d) * in[s][p].error;
    });
    const double range = high - low, terms = accumulated(call.roundoff, 16 + 3);
    // The mean itself is kept in double, and gathered group by group.
    m.mean.error =
        wrong / count + terms * range +
        accumulated(unit_roundoff<double>, static_cast<double>(in.size()) + 4) * std::abs(m.mean.value);
    m.variance.value = squares / count;
    m.variance.error = 2 * moved / count + (wrong / count) * (wrong / count) + 3 * terms * range * range;
    return m;
}

namespace {

/// y(c) = x(c) b(c)^-beta with b(c) = k + alpha / size times the sum of x² over the window.
class local_response_norm final : public sample_by_sample {
public:
    local_response_norm(extents3 in, std::size_t size, double alpha, double beta, double k)
        : size_(size), share_(alpha / static_cast<double>(size)), beta_(beta), k_(k) {
        input = output = in;
    }
    [[nodiscard]] sample output_of(const reference_call& call, const sample& in) const override {
        sample out(output.size());
        for (std::size_t i = 0; i < input.size(); ++i) {
            const bounded b = base(call, in, i);
            const double most = std::pow(std::max(b.value - b.error, k_ / 2), -beta_),
                         factor = std::pow(b.value, -beta_);
            // By the mean value theorem; then the roundings of the power (at most five) and the product.
            const double factor_error = beta_ * most / std::max(b.value - b.error, k_ / 2) * b.error +
                                        accumulated(call.roundoff, 5) * most;
            out[i] = {in[i].value * factor,
                      in[i].error * most + magnitude(in[i]) * factor_error +
                          accumulated(call.roundoff, 1) * magnitude(in[i]) * (most + factor_error),
                      std::sqrt(square(in[i].deviation * factor) +
                                square(in[i].value * beta_ * factor / b.value * b.deviation) +
                                drift(call, 6, in[i].value * factor))};
        }
        return out;
    }
    [[nodiscard]] sample gradient_of(const reference_call& call, const sample& in,
                                     const sample& out_gradient) const override {
        sample g(input.size());
        std::vector<double> sizes(input.size()); // of all terms of a gradient
        for (std::size_t i = 0; i < input.size(); ++i) {
            const double b = base(call, in, i).value, dy = out_gradient[i].value;
            g[i].value += dy * std::pow(b, -beta_);
            sizes[i] += std::abs(dy * std::pow(b, -beta_));
            for_window(i, [&](std::size_t j) {
                const double term =
                    2 * share_ * beta_ * in[j].value * dy * in[i].value * std::pow(b, -beta_ - 1);
                g[j].value -= term;
                sizes[j] += std::abs(term);
            });
        }
        // Each term passes its base (size + 3 roundings, once in the power, once in the quotient), the
        // power (5), four products and the sum.
        const double n = static_cast<double>(size_);
        for (std::size_t i = 0; i < input.size(); ++i)
            g[i].error = accumulated(call.roundoff, (1 + beta_) * (n + 3) + 5 + 4 + n + 2) * sizes[i];
        return g;
    }

private:
    /// body(j) for all j in the window of i: those before it are as many as those after it, or one more.
    template <class Body>
    void for_window(std::size_t i, Body&& body) const {
        const std::size_t c = i / input.area(), before = size_ / 2;
        for (std::size_t w = 0; w < size_; ++w)
            if (c + w >= before && c + w - before < input.channels)
                body((c + w - before) * input.area() + i % input.area());
    }
    [[nodiscard]] bounded base(const reference_call& call, const sample& x, std::size_t i) const {
        double sum = 0, wrong = 0, most = 0, squares = 0;
        for_window(i, [&](std::size_t j) {
            sum += x[j].value * x[j].value;
            squares += square(share_ * 2 * x[j].value * x[j].deviation);
            wrong += 2 * magnitude(x[j]) * x[j].error;
            most += magnitude(x[j]) * magnitude(x[j]);
        });
        // Constants are rounded as well.
        const double roundings = static_cast<double>(size_) + 3, value = k_ + share_ * sum;
        return {value, share_ * wrong + accumulated(call.roundoff, roundings) * (k_ + share_ * most),
                std::sqrt(squares + drift(call, roundings, value))};
    }
    std::size_t size_;
    double share_, beta_, k_;
};

class softmax final : public sample_by_sample {
public:
    explicit softmax(extents3 size) { input = output = size; }

    [[nodiscard]] sample output_of(const reference_call& call, const sample& in) const override {
        sample out(output.size());
        for (std::size_t p = 0; p < input.area(); ++p) {
            double largest = in[p].value, smallest = largest, wrong = 0, off = 0, sum = 0;
            for (std::size_t c = 0; c < input.channels; ++c) {
                const bounded& x = in[p + c * input.area()];
                largest = std::max(largest, x.value), smallest = std::min(smallest, x.value);
                wrong = std::max(wrong, x.error), off = std::max(off, x.deviation);
            }
            for (std::size_t c = 0; c < input.channels; ++c)
                sum += std::exp(in[p + c * input.area()].value - largest);
            for (std::size_t c = 0; c < input.channels; ++c) {
                const double distance = in[p + c * input.area()].value - largest;
                bounded& to = out[p + c * input.area()];
                to.value = std::exp(distance) / sum;
                if (call.deployed) {
                    as_deployed(call, wrong, off, largest - smallest + 2 * wrong, to);
                    continue;
                }
                // Logits off by e: numerator and sum off by a factor e^±e each. Sums and exponentials in
                // double.
                to.error =
                    to.value * (std::expm1(2 * wrong) + accumulated(call.roundoff, 2) +
                                accumulated(unit_roundoff<double>,
                                            std::abs(distance) + 4 + static_cast<double>(input.channels)));
            }
        }
        return out;
    }
    [[nodiscard]] sample gradient_of(const reference_call& call, const sample& in,
                                     const sample& out_gradient) const override {
        const sample y = output_of(call, in);
        sample g(input.size());
        for (std::size_t p = 0; p < input.area(); ++p) {
            double product = 0, size = 0, wrong = 0;
            for (std::size_t c = 0; c < input.channels; ++c) {
                const std::size_t i = p + c * input.area();
                product += y[i].value * out_gradient[i].value;
                size += std::abs(y[i].value * out_gradient[i].value);
                wrong += y[i].error * std::abs(out_gradient[i].value);
            }
            for (std::size_t c = 0; c < input.channels; ++c) {
                const std::size_t i = p + c * input.area();
                const double distance = out_gradient[i].value - product;
                const double inner = std::abs(out_gradient[i].value) + size;
                g[i].value = y[i].value * distance;
                g[i].error =
                    y[i].error * inner + y[i].value * (wrong + accumulated(call.roundoff, 2) * inner);
            }
        }
        return g;
    }

private:
    /// Inputs off by e, and their distance d to the largest rounded: each exponential is off by a factor
    /// within exp(±(e + e of the largest + u |d|)), the sum of them by as much; exponentials are right to one
    /// unit in the last place (2 u), the quotient is rounded. What is below the smallest normal number may be
    /// lost.
    static void as_deployed(const reference_call& call, double wrong, double off, double spread,
                            bounded& to) {
        const double below = static_cast<double>(std::numeric_limits<float>::min());
        to.error = to.value * (std::expm1(4 * wrong + 2 * accumulated(call.roundoff, 1) * spread) +
                               accumulated(call.roundoff, 6)) +
                   below;
        to.deviation =
            to.value * (std::expm1(4 * off + 2 * call.roundoff * spread) + std::sqrt(6) * call.roundoff) +
            below;
    }
};

} // namespace

reference_pointer reference_local_response_norm(extents3 input, std::size_t size, double alpha, double beta,
                                                double k) {
    return std::make_unique<local_response_norm>(input, size, alpha, beta, k);
}
reference_pointer reference_batch_norm(extents3 input) {
    return std::make_unique<batch_norm>(input);
}
reference_pointer reference_softmax(extents3 input) {
    return std::make_unique<softmax>(input);
}

} // namespace support

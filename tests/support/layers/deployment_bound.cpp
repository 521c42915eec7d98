#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <support/layers/deployment_bound.hpp>
#include <support/layers/tile_magnitudes.hpp>

namespace support {

namespace {

using kind = described_layer::kind;

constexpr double roundoff = unit_roundoff<float> * (1 + 0x1p-20);

/// γ(count)
double roundings(double count) {
    return accumulated(roundoff, count);
}

/// What one rounding loses below the smallest normal number, at most: half of the smallest number of all.
constexpr double lost = 0x1p-150;

double magnitude(const rounded& b) {
    return std::abs(b.value) + b.error;
}
double square(double x) {
    return x * x;
}

/// A batch norm as factor and offset in double, for folding.
struct norm {
    std::span<const float> scale, shift, mean, variance;
    double epsilon;

    [[nodiscard]] double factor(std::size_t c) const {
        return static_cast<double>(scale[c]) / std::sqrt(static_cast<double>(variance[c]) + epsilon);
    }
    /// The error is what double precision leaves where large numbers cancel, and one rounding.
    [[nodiscard]] rounded shifted(std::size_t c, double bias) const {
        const double m = static_cast<double>(mean[c]), s = static_cast<double>(shift[c]);
        const double value = (bias - m) * factor(c) + s;
        const double inside = 0x1p-50 * ((std::abs(bias) + std::abs(m)) * std::abs(factor(c)) + std::abs(s));
        return {value, inside + roundings(1) * std::abs(value), inside + roundoff * std::abs(value)};
    }
};

/// Hands out the parameters in order while a frame passes.
class frame_walk {
public:
    explicit frame_walk(const described_parameters& parameters) : left_(parameters) {}

    rounded_map through(const std::vector<described_layer>& layers, rounded_map x,
                        const rounded_map* added = nullptr) {
        for (std::size_t i = 0; i < layers.size(); ++i) {
            const described_layer& layer = layers[i];
            switch (layer.what) {
            case kind::convolution: {
                const std::size_t taps = taps_of(layer);
                const std::span<const float> w = take_values(layer.filters * taps),
                                             b = take_values(layer.bias ? layer.filters : 0);
                std::size_t behind = i + 1;
                while (behind < layers.size() && layers[behind].what == kind::dropout)
                    ++behind;
                std::vector<double> weights(w.begin(), w.end());
                std::vector<rounded> biases(layer.filters);
                std::optional<norm> folded;
                if (!layer.alone && behind < layers.size() && layers[behind].what == kind::norm)
                    folded = take_norm(layer.filters), i = behind;
                for (std::size_t f = 0; f < layer.filters; ++f) {
                    biases[f].value = layer.bias ? static_cast<double>(b[f]) : 0;
                    if (folded) {
                        biases[f] = folded->shifted(f, biases[f].value);
                        for (std::size_t t = 0; t < taps; ++t)
                            weights[f * taps + t] *= folded->factor(f);
                    }
                }
                // The sum of a residual block is taken in the last convolution of its main branch.
                const bool sums = i + 1 == layers.size() && !layer.alone;
                x = by_groups(layer, weights, biases, x, sums ? added : nullptr);
                if (sums)
                    added = nullptr;
                break;
            }
            case kind::dense: {
                const std::span<const float> w = take_values(layer.filters * x.size()),
                                             b = take_values(layer.filters);
                const std::vector<double> weights(w.begin(), w.end());
                std::vector<rounded> biases(layer.filters);
                for (std::size_t f = 0; f < layer.filters; ++f)
                    biases[f].value = static_cast<double>(b[f]);
                x = bounded_convolution(layer.window, layer.filters, weights, biases, x, nullptr, {});
                break;
            }
            case kind::norm: {
                const norm n = take_norm(layer.filters);
                const std::size_t area = x.size() / layer.filters;
                for (std::size_t e = 0; e < x.size(); ++e) {
                    const double factor = n.factor(e / area);
                    const rounded offset = n.shifted(e / area, 0);
                    const double middle =
                        layer.alone ? std::abs(factor * static_cast<double>(n.mean[e / area])) : 0;
                    const double size = std::abs(factor) * magnitude(x[e]) + magnitude(offset) + middle;
                    x[e] = {x[e].value * factor + offset.value,
                            std::abs(factor) * x[e].error + offset.error + roundings(3) * size + 3 * lost,
                            std::hypot(factor * x[e].deviation, offset.deviation,
                                       std::sqrt(3) * roundoff * size)};
                }
                break;
            }
            case kind::relu:
                x = bounded_relu(std::move(x));
                break;
            case kind::pool:
                x = bounded_max_pool(layer.window, x);
                break;
            case kind::average:
                x = average(layer, x);
                break;
            case kind::responses:
                x = responses(layer, x);
                break;
            case kind::concatenation: {
                rounded_map all;
                for (const described_layer& branch : layer.branches) {
                    const rounded_map own = through(branch.inner, x);
                    all.insert(all.end(), own.begin(), own.end());
                }
                x = std::move(all);
                break;
            }
            case kind::softmax:
                x = softmax(x, layer.filters);
                break;
            case kind::dropout:
                break;
            case kind::list:
                x = through(layer.inner, std::move(x));
                break;
            case kind::residual:
                x = residual(layer, x);
                break;
            case kind::own:
                x = own(layer, std::move(x));
                break;
            }
        }
        if (added != nullptr)
            for (std::size_t e = 0; e < x.size(); ++e) {
                const rounded& skip = (*added)[e];
                x[e] = rounded_once({x[e].value + skip.value, x[e].error + skip.error,
                                     std::hypot(x[e].deviation, skip.deviation)});
            }
        return x;
    }

private:
    rounded_map own(const described_layer& layer, rounded_map x) {
        const auto values = take_values(layer.own_values),
                   statistics = take(left_.statistics, layer.own_statistics);
        std::vector<float> parameters(values.begin(), values.end());
        parameters.insert(parameters.end(), statistics.begin(), statistics.end());
        return layer.own(std::move(x), parameters);
    }
    std::span<const float> take_values(std::size_t count) { return take(left_.values, count); }
    static std::span<const float> take(std::span<const float>& from, std::size_t count) {
        if (count > from.size())
            throw std::logic_error("frame_walk: the layers have more parameters than there are");
        const std::span<const float> taken = from.first(count);
        from = from.subspan(count);
        return taken;
    }
    norm take_norm(std::size_t channels) {
        const auto scale = take_values(channels), shift = take_values(channels);
        const auto mean = take(left_.statistics, channels), variance = take(left_.statistics, channels);
        return {scale, shift, mean, variance, left_.epsilon};
    }
    /// The skip's parameters lie behind those of the main branch, which needs its result.
    rounded_map residual(const described_layer& block, const rounded_map& x) {
        frame_walk main = *this;
        pass_over(block.inner);
        const rounded_map skip = through(block.skip, x);
        return main.through(block.inner, x, &skip);
    }
    void pass_over(const std::vector<described_layer>& layers) {
        for (const described_layer& layer : layers)
            switch (layer.what) {
            case kind::convolution:
            case kind::dense:
                take_values(layer.filters * (taps_of(layer) + layer.bias));
                break;
            case kind::norm:
                take_norm(layer.filters);
                break;
            case kind::own:
                take_values(layer.own_values);
                take(left_.statistics, layer.own_statistics);
                break;
            case kind::list:
            case kind::residual:
            case kind::concatenation:
                pass_over(layer.inner);
                pass_over(layer.skip);
                pass_over(layer.branches);
                break;
            default:
                break;
            }
    }
    static rounded_map average(const described_layer& layer, const rounded_map& x) {
        const std::size_t pixels = layer.average_pixels.size(),
                          area = x.size() / layer.average_output.channels;
        rounded_map out(layer.average_output.size());
        for (std::size_t o = 0; o < out.size(); ++o) {
            double most = 0, size = 0;
            rounded& y = out[o];
            for (const std::size_t pixel : layer.average_pixels[o % pixels]) {
                const rounded& from = x[o / pixels * area + pixel];
                y.value += from.value, y.error += from.error, y.deviation += square(from.deviation);
                most += magnitude(from), size += std::abs(from.value);
            }
            const double count = static_cast<double>(layer.average_pixels[o % pixels].size()),
                         divisor = layer.average_divisors[o % pixels];
            y = {y.value / divisor, (y.error + roundings(count + 1) * most) / divisor,
                 std::sqrt(y.deviation + (count + 1) * square(roundoff * size)) / divisor};
        }
        return out;
    }
    /// y(c) = x(c) b(c)^−β, b = k + share Σ x². Of b: size + 3 roundings, the constants' included, of the
    /// power at most five, then a product. What comes in wrong goes through the derivatives, taken where they
    /// are largest: b less its error.
    static rounded_map responses(const described_layer& layer, const rounded_map& x) {
        const std::size_t area = x.size() / layer.response_channels;
        const double beta = layer.response_beta, share = layer.response_share;
        const double count = static_cast<double>(layer.response_size) + 3;
        rounded_map out(x.size());
        for (std::size_t i = 0; i < x.size(); ++i) {
            rounded base{layer.response_k, 0, 0};
            double most = layer.response_k;
            for (std::size_t w = 0; w < layer.response_size; ++w) {
                const std::size_t place = i / area + w, before = layer.response_size / 2;
                if (place < before || place - before >= layer.response_channels)
                    continue;
                const rounded& from = x[(place - before) * area + i % area];
                base.value += share * square(from.value);
                base.error += share * 2 * magnitude(from) * from.error;
                base.deviation += square(share * 2 * from.value * from.deviation);
                most += share * square(magnitude(from));
            }
            base.error += roundings(count) * most;
            base.deviation = std::sqrt(base.deviation + count * square(roundoff * base.value));
            const double least = std::max(base.value - base.error, layer.response_k / 2);
            const double power = std::pow(base.value, -beta), largest = std::pow(least, -beta);
            const double power_error = beta * largest / least * base.error + roundings(5) * largest;
            out[i] = {x[i].value * power,
                      x[i].error * largest + magnitude(x[i]) * power_error +
                          roundings(1) * magnitude(x[i]) * (largest + power_error),
                      std::sqrt(square(x[i].deviation * power) +
                                square(x[i].value * beta * power / base.value * base.deviation) +
                                6 * square(roundoff * x[i].value * power))};
        }
        return out;
    }
    static std::size_t taps_of(const described_layer& layer) {
        return layer.window.input.channels / layer.groups * layer.window.kernel_rows *
               layer.window.kernel_columns;
    }
    /// Each group as a convolution of its own.
    static rounded_map by_groups(const described_layer& layer, std::span<const double> weights,
                                 std::span<const rounded> biases, const rounded_map& x,
                                 const rounded_map* added) {
        reference_window window = layer.window;
        window.input.channels /= layer.groups;
        const std::size_t filters = layer.filters / layer.groups;
        rounded_map out;
        for (std::size_t g = 0; g < layer.groups; ++g) {
            const auto part = [&](const rounded_map& all) {
                const auto size = static_cast<std::ptrdiff_t>(all.size() / layer.groups);
                const auto begin = all.begin() + static_cast<std::ptrdiff_t>(g) * size;
                return rounded_map(begin, begin + size);
            };
            const rounded_map own_added = added ? part(*added) : rounded_map{};
            const rounded_map own = bounded_convolution(
                window, filters, weights.subspan(g * filters * taps_of(layer), filters * taps_of(layer)),
                biases.subspan(g * filters, filters), part(x), added ? &own_added : nullptr, layer.tiled);
            out.insert(out.end(), own.begin(), own.end());
        }
        return out;
    }
    /// Inputs off by e, and their distance d to the largest rounded: each exponential is off by a factor
    /// within exp(±(e + e of the largest + u |d|)), the sum of them by as much; exponentials are right to one
    /// unit in the last place (2 u), the quotient is rounded. What is below the smallest normal number may be
    /// lost.
    static rounded_map softmax(const rounded_map& x, std::size_t channels) {
        rounded_map out(x.size());
        const std::size_t area = x.size() / channels;
        for (std::size_t p = 0; p < area; ++p) {
            double largest = x[p].value, smallest = x[p].value, wrong = 0, off = 0, sum = 0;
            for (std::size_t e = p; e < x.size(); e += area) {
                largest = std::max(largest, x[e].value), smallest = std::min(smallest, x[e].value);
                wrong = std::max(wrong, x[e].error), off = std::max(off, x[e].deviation);
            }
            for (std::size_t e = p; e < x.size(); e += area)
                sum += std::exp(x[e].value - largest);
            const double spread = largest - smallest + 2 * wrong;
            for (std::size_t e = p; e < x.size(); e += area) {
                out[e].value = std::exp(x[e].value - largest) / sum;
                const double below = static_cast<double>(std::numeric_limits<float>::min());
                out[e].error =
                    out[e].value * (std::expm1(4 * wrong + 2 * roundings(1) * spread) + roundings(6)) + below;
                out[e].deviation =
                    out[e].value * (std::expm1(4 * off + 2 * roundoff * spread) + std::sqrt(6) * roundoff) +
                    below;
            }
        }
        return out;
    }

    described_parameters left_;
};

} // namespace

rounded_map bounded_convolution(const reference_window& window, std::size_t filters,
                                std::span<const double> weights, std::span<const rounded> biases,
                                const rounded_map& in, const rounded_map* added, tile_size tiled) {
    const std::size_t area = window.output_rows() * window.output_columns(),
                      taps = window.kernel_rows * window.kernel_columns, channels = window.input.channels;
    rounded_map out(filters * area);
    // Of all terms of an output, with what their inputs are wrong by, and without.
    std::vector<double> most_sizes(out.size()), sizes(out.size());
    for (std::size_t f = 0; f < filters; ++f)
        for (std::size_t c = 0; c < channels; ++c)
            window.for_each_tap([&](std::size_t to, std::size_t from, std::size_t tap) {
                const double w = weights[(f * channels + c) * taps + tap];
                const rounded& x = in[c * window.input.area() + from];
                rounded& y = out[f * area + to];
                y.value += w * x.value;
                y.error += std::abs(w) * x.error;
                y.deviation += square(w * x.deviation);
                most_sizes[f * area + to] += std::abs(w) * magnitude(x);
                sizes[f * area + to] += std::abs(w * x.value);
            });
    double count = static_cast<double>(channels * taps) + 3, far = 1;
    if (tiled.rows > 0) {
        std::vector<double> most(in.size()), values(in.size());
        for (std::size_t i = 0; i < in.size(); ++i)
            most[i] = magnitude(in[i]), values[i] = std::abs(in[i].value);
        most_sizes = tile_magnitudes(window, filters, weights, most, tiled).sizes;
        sizes = tile_magnitudes(window, filters, weights, values, tiled).sizes;
        const bool roots =
            std::max(tiled.rows + window.kernel_rows, tiled.columns + window.kernel_columns) > 5;
        count = static_cast<double>(channels) + (roots ? 23 : 11);
        // The rows of |B|ᵀ add up to 5.2 at most, those of |G| to 2, those of |A|ᵀ to 10, in two directions.
        double all = 0;
        for (const double w : weights)
            all = std::max(all, std::abs(w));
        far = 28 * 100 * (1 + 4 * static_cast<double>(channels * taps) * all);
    }
    const double underflow = static_cast<double>(channels * taps + 3) * far * lost;
    for (std::size_t o = 0; o < out.size(); ++o) {
        const rounded& bias = biases[o / area];
        const rounded skip = added ? (*added)[o] : rounded{};
        out[o].value += bias.value + skip.value;
        out[o].error += bias.error + skip.error +
                        roundings(count) * (most_sizes[o] + magnitude(bias) + magnitude(skip)) + underflow;
        out[o].deviation =
            std::sqrt(out[o].deviation + square(bias.deviation) + square(skip.deviation) +
                      count * square(roundoff * (sizes[o] + std::abs(bias.value) + std::abs(skip.value))));
    }
    return out;
}

rounded_map bounded_max_pool(const reference_window& window, const rounded_map& in) {
    const std::size_t area = window.output_rows() * window.output_columns();
    rounded_map out(window.input.channels * area, {-std::numeric_limits<double>::infinity(), 0, 0});
    for (std::size_t c = 0; c < window.input.channels; ++c)
        window.for_each_tap([&](std::size_t to, std::size_t from, std::size_t) {
            rounded& y = out[c * area + to];
            const rounded& x = in[c * window.input.area() + from];
            y = {std::max(y.value, x.value), std::max(y.error, x.error), std::max(y.deviation, x.deviation)};
        });
    return out;
}

rounded rounded_once(rounded exact) {
    exact.error += roundings(1) * magnitude(exact);
    exact.deviation = std::hypot(exact.deviation, roundoff * exact.value);
    return exact;
}

rounded_map bounded_relu(rounded_map in) {
    for (rounded& b : in)
        b.value = std::max(b.value, 0.0);
    return in;
}

rounded_map bounded_input(std::span<const float> counts, std::span<const float> mean, float scale) {
    rounded_map in(counts.size());
    for (std::size_t i = 0; i < in.size(); ++i) {
        const double m = mean.empty() ? 0 : static_cast<double>(mean[i]);
        in[i].value = (static_cast<double>(counts[i]) - m) * static_cast<double>(scale);
        // Taking away nothing and multiplying by one do not round.
        const double size = m == 0 && scale == 1 ? 0 : std::abs(in[i].value);
        in[i].error = roundings(2) * size + (size > 0 ? lost : 0),
        in[i].deviation = std::sqrt(2) * roundoff * size;
    }
    return in;
}

rounded_map bounded_outputs(const std::vector<described_layer>& layers,
                            const described_parameters& parameters, const rounded_map& in) {
    return frame_walk(parameters).through(layers, in);
}

} // namespace support

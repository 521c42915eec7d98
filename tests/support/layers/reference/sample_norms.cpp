#include <algorithm>
#include <cmath>
#include <limits>
#include <support/layers/deployed_reference.hpp>
#include <support/layers/reference/layers.hpp>
#include <utility>

namespace support {

channel_scale::channel_scale(extents3 size) : zeros_(size.channels), ones_(size.channels, 1) {
    input = output = size;
    parameters = size.channels;
}
/// One rounding.
samples channel_scale::forward(const reference_call& call, const samples& in) const {
    samples out = in;
    for (sample& each : out)
        for (std::size_t e = 0; e < each.size(); ++e) {
            const double factor = call.values[e / input.area()];
            bounded& b = each[e];
            b = rounded_once({b.value * factor, b.error * std::abs(factor), b.deviation * std::abs(factor)},
                             call.roundoff);
            b.error += lost;
        }
    return out;
}
/// Products of their own rounding, in runs of 16 in the working precision, gathered in double.
reference_gradients channel_scale::backward(const reference_call& call, const samples& in,
                                            const samples& out_gradient) const {
    reference_gradients g{samples(in.size(), sample(input.size())), sample(parameters)};
    const double sum_error = accumulated(call.roundoff, 16 + 2);
    for (std::size_t s = 0; s < in.size(); ++s)
        for (std::size_t e = 0; e < input.size(); ++e) {
            const double x = in[s][e].value, dy = out_gradient[s][e].value;
            const std::size_t c = e / input.area();
            g.input[s][e] = rounded_once({call.values[c] * dy, 0}, call.roundoff);
            g.values[c].value += x * dy, g.values[c].error += sum_error * std::abs(x * dy);
        }
    return g;
}
folded_norm channel_scale::folded(const reference_call& call) const {
    return {call.values, zeros_, zeros_, ones_, 0, call.roundoff};
}

namespace {

/// The library computes norms of samples in double whatever its precision, and the reference rounds alike.
constexpr double of_double = 2 * unit_roundoff<double>;

/// Group, instance and layer norms: which elements are normalised together, and which weight each has.
class sample_norm final : public reference_layer {
public:
    using places = std::vector<std::size_t>;

    /// `run`: terms of a sum that a deployed network adds in single precision.
    sample_norm(extents3 size, std::vector<places> groups, places weight_of, std::size_t run)
        : groups_(std::move(groups)), weight_of_(std::move(weight_of)), run_(static_cast<double>(run)) {
        input = output = size;
        weights_ = *std::max_element(weight_of_.begin(), weight_of_.end()) + 1;
        parameters = 2 * weights_;
    }
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override {
        samples out(in.size(), sample(output.size()));
        for (std::size_t s = 0; s < in.size(); ++s)
            for (const places& group : groups_)
                if (call.deployed)
                    deployed(call, group, in[s], out[s]);
                else
                    trained(call, group, in[s], out[s]);
        return out;
    }
    [[nodiscard]] bool has_backward() const override { return true; }

    [[nodiscard]] reference_gradients backward(const reference_call& call, const samples& in,
                                               const samples& out_gradient) const override {
        reference_gradients g{samples(in.size(), sample(input.size())), sample(parameters)};
        const double terms = static_cast<double>(in.size() * input.size()) + 40,
                     inner = accumulated(of_double, terms);
        for (std::size_t s = 0; s < in.size(); ++s)
            for (const places& group : groups_) {
                const moments m = moments_of(call, group, in[s]);
                const double count = static_cast<double>(group.size());
                const auto normalised = [&](std::size_t e) { return (in[s][e].value - m.mean) * m.inverse; };
                double level = 0, slope = 0, level_size = 0, slope_size = 0;
                for (const std::size_t e : group) {
                    const double dy = out_gradient[s][e].value, x = normalised(e),
                                 weight = call.values[weight_of_[e]];
                    // What a normalised value is off by is relative to its size, and to one.
                    const double x_size = 1 + std::abs(x);
                    level += weight * dy, level_size += std::abs(weight * dy);
                    slope += weight * dy * x, slope_size += std::abs(weight * dy) * x_size;
                    bounded &of_weight = g.values[weight_of_[e]],
                            &of_bias = g.values[weights_ + weight_of_[e]];
                    of_weight.value += dy * x, of_weight.error += inner * std::abs(dy) * x_size;
                    of_bias.value += dy, of_bias.error += inner * std::abs(dy);
                }
                for (const std::size_t e : group) {
                    const double dy = out_gradient[s][e].value, x = normalised(e),
                                 weight = call.values[weight_of_[e]];
                    const double size =
                        std::abs(weight * dy) + (level_size + (1 + std::abs(x)) * slope_size) / count;
                    g.input[s][e].value = m.inverse * (weight * dy - level / count - x * slope / count);
                    g.input[s][e].error = m.inverse * inner * size +
                                          accumulated(call.roundoff, 1) * std::abs(g.input[s][e].value) +
                                          lost;
                }
            }
        for (bounded& b : g.values)
            b.error += accumulated(call.roundoff, 1) * std::abs(b.value);
        return g;
    }

private:
    /// And what the inputs are wrong by, on average: as errors, and as deviations as if all were alike.
    struct moments {
        double mean, variance, inverse;
        double size;                      ///< the mean distance from the mean
        double wrong, variance_wrong;     ///< errors
        double off = 0, variance_off = 0; ///< deviations
        double largest_inverse;           ///< with all errors
    };
    [[nodiscard]] moments moments_of(const reference_call& call, const places& group, const sample& x) const {
        const double count = static_cast<double>(group.size());
        moments m{};
        // From the first value, so that a mean far away costs nothing.
        const double origin = x[group[0]].value;
        for (const std::size_t e : group)
            m.mean += (x[e].value - origin) / count, m.wrong += x[e].error / count,
                m.off += x[e].deviation / count;
        m.mean += origin;
        for (const std::size_t e : group) {
            const double d = x[e].value - m.mean;
            m.variance += d * d / count, m.size += std::abs(d) / count;
            m.variance_wrong += (2 * std::abs(d) * x[e].error + square(x[e].error)) / count;
            m.variance_off += 2 * std::abs(d) * x[e].deviation / count;
        }
        m.inverse = 1 / std::sqrt(m.variance + call.epsilon);
        return m;
    }
    /// The largest that 1 ÷ √(variance + ε) can be when the variance is wrong.
    [[nodiscard]] static double inverse_error(const reference_call& call, const moments& m, double wrong) {
        return 1 / std::sqrt(std::max(m.variance - wrong, 0.0) + call.epsilon) - m.inverse;
    }

    /// Everything in double, and one rounding.
    void trained(const reference_call& call, const places& group, const sample& x, sample& out) const {
        moments m = moments_of(call, group, x);
        const double inner = accumulated(of_double, static_cast<double>(group.size()) + 16);
        m.wrong += inner * m.size + of_double * std::abs(m.mean);
        m.variance_wrong += inner * m.variance;
        const double of_inverse = inverse_error(call, m, m.variance_wrong) + 4 * of_double * m.inverse;
        for (const std::size_t e : group) {
            const double d = x[e].value - m.mean, weight = std::abs(call.values[weight_of_[e]]),
                         bias = call.values[weights_ + weight_of_[e]], moved = x[e].error + m.wrong;
            out[e].value = d * m.inverse * call.values[weight_of_[e]] + bias;
            const double size = weight * (std::abs(d) + moved) * (m.inverse + of_inverse) + std::abs(bias);
            out[e].error = weight * (moved * (m.inverse + of_inverse) + std::abs(d) * of_inverse) +
                           8 * of_double * size + accumulated(call.roundoff, 1) * size + lost;
        }
    }
    /// Distances from a rough mean, whose own sums of `run` terms are in single precision, and then sums of
    /// these distances and of their squares. The rough mean is off by at most what such a sum of distances
    /// from the first value is, and is rounded.
    void deployed(const reference_call& call, const places& group, const sample& x, sample& out) const {
        moments m = moments_of(call, group, x);
        double farthest = 0, farthest_wrong = 0;
        for (const std::size_t e : group) {
            farthest = std::max(farthest, std::abs(x[e].value - x[group[0]].value));
            farthest_wrong = std::max(farthest_wrong, 2 * x[e].error);
        }
        const double u = call.roundoff, terms = accumulated(u, run_ + 4), drifts = std::sqrt(run_ + 4) * u;
        const double rough = terms * (farthest + farthest_wrong) + 2 * u * std::abs(m.mean) + m.wrong,
                     rough_off = drifts * farthest + 2 * u * std::abs(m.mean) + m.off;
        // Of the distances from the rough mean, and of their squares.
        const double size = m.size + m.wrong + rough, squares = m.variance + m.variance_wrong + square(rough);
        m.variance_off += drifts * (m.variance + square(rough_off) + 2 * rough_off * (m.size + rough_off));
        m.off += drifts * (m.size + rough_off);
        m.wrong += terms * size;
        m.variance_wrong += terms * squares + 2 * rough * terms * size;
        const double of_inverse = inverse_error(call, m, m.variance_wrong) + 4 * u * m.inverse,
                     inverse_off = m.variance_off / (m.variance + call.epsilon) / 2 * m.inverse;
        for (const std::size_t e : group) {
            const double d = x[e].value - m.mean, weight = std::abs(call.values[weight_of_[e]]),
                         bias = call.values[weights_ + weight_of_[e]], moved = x[e].error + m.wrong;
            const double inverse = m.inverse + of_inverse;
            // A distance, its product with the inverse, what the rough mean is off, weight and bias: six
            // roundings, of terms no larger than these.
            const double most = weight * (std::abs(d) + moved + 2 * rough) * inverse + std::abs(bias),
                         likely = weight * (std::abs(d) + 2 * rough_off) * m.inverse + std::abs(bias);
            out[e] = {d * m.inverse * call.values[weight_of_[e]] + bias,
                      weight * (moved * inverse + std::abs(d) * of_inverse) + accumulated(u, 6) * most +
                          3 * lost,
                      std::sqrt(square(weight * m.inverse) * (square(x[e].deviation) + square(m.off)) +
                                square(weight * d * inverse_off) + drift(call, 6, likely)) +
                          3 * lost};
        }
    }

    std::vector<places> groups_;
    places weight_of_;
    std::size_t weights_ = 0;
    double run_;
};

} // namespace

reference_pointer reference_channel_scale(extents3 input) {
    return std::make_unique<channel_scale>(input);
}
reference_pointer reference_group_norm(extents3 input, std::size_t groups) {
    std::vector<sample_norm::places> together(groups);
    sample_norm::places weights;
    for (std::size_t e = 0; e < input.size(); ++e) {
        const std::size_t c = e / input.area();
        together[c / (input.channels / groups)].push_back(e);
        weights.push_back(c);
    }
    return std::make_unique<sample_norm>(input, std::move(together), std::move(weights), 16);
}
reference_pointer reference_layer_norm(extents3 input, bool over_channels) {
    std::vector<sample_norm::places> together(over_channels ? input.area() : 1);
    sample_norm::places weights;
    for (std::size_t e = 0; e < input.size(); ++e) {
        together[over_channels ? e % input.area() : 0].push_back(e);
        weights.push_back(over_channels ? e / input.area() : e);
    }
    return std::make_unique<sample_norm>(input, std::move(together), std::move(weights),
                                         over_channels ? input.channels : 16);
}

} // namespace support

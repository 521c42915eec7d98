#include <algorithm>
#include <cmath>
#include <support/layers/reference.hpp>
#include <support/layers/tile_magnitudes.hpp>
#include <utility>

namespace support {

reference_window reference_window::same(extents3 input, std::size_t kernel_rows, std::size_t kernel_columns,
                                        std::size_t stride_rows, std::size_t stride_columns) {
    const auto missing = [](std::size_t size, std::size_t kernel, std::size_t stride) -> std::size_t {
        std::size_t outputs = 0;
        while (outputs * stride < size)
            ++outputs;
        const std::size_t needed = (outputs - 1) * stride + kernel;
        return needed > size ? needed - size : 0;
    };
    const std::size_t rows = missing(input.rows, kernel_rows, stride_rows);
    const std::size_t columns = missing(input.columns, kernel_columns, stride_columns);
    return {input,    kernel_rows,     kernel_columns, stride_rows,          stride_columns,
            rows / 2, rows - rows / 2, columns / 2,    columns - columns / 2};
}

reference_window reference_window::completed() const {
    const auto behind = [](std::size_t size, std::size_t kernel, std::size_t stride, std::size_t before,
                           std::size_t after) {
        std::size_t last = 0; // where the last window begins
        while (last + kernel < size + before + after && last + stride < size + before)
            last += stride;
        return std::max(last + kernel, size + before + after) - size - before;
    };
    reference_window w = *this;
    w.bottom = behind(input.rows, kernel_rows, stride_rows, top, bottom);
    w.right = behind(input.columns, kernel_columns, stride_columns, left, right);
    return w;
}

namespace {

double magnitude(const bounded& b) {
    return std::abs(b.value) + b.error;
}

class convolution final : public reference_layer {
public:
    convolution(const reference_window& window, std::size_t filters, std::size_t groups, bool bias,
                const reference_tiles& tiles)
        : window_(window),
          tiles_(tiles),
          channels_(window.input.channels / groups),
          filters_(filters / groups),
          bias_(bias) {
        input = window.input;
        output = {filters, window.output_rows(), window.output_columns()};
        taps_ = window.kernel_rows * window.kernel_columns;
        weights_ = filters * channels_ * taps_;
        parameters = weights_ + (bias ? filters : 0);
        multiply_adds = output.size() * channels_ * taps_;
        for_each_product([&](std::size_t, std::size_t, std::size_t) { ++multiply_adds_on_pixels; });
    }

    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override {
        samples out(in.size(), sample(output.size()));
        for (std::size_t s = 0; s < in.size(); ++s) {
            std::vector<double> sizes(output.size());
            for (std::size_t o = 0; o < output.size(); ++o) {
                out[s][o].value = bias_ ? call.values[weights_ + o / output.area()] : 0;
                sizes[o] = std::abs(out[s][o].value);
            }
            for_each_product([&](std::size_t o, std::size_t i, std::size_t w) {
                out[s][o].value += call.values[w] * in[s][i].value;
                out[s][o].error += std::abs(call.values[w]) * in[s][i].error;
                sizes[o] += std::abs(call.values[w]) * magnitude(in[s][i]);
            });
            for (std::size_t o = 0; o < output.size(); ++o)
                sizes[o] *= accumulated(call.roundoff, terms() + 1);
            if (const sample& x = in[s]; tiles_.ahead.rows > 0)
                raise_to_tile(
                    sizes, accumulated(call.roundoff, static_cast<double>(channels_) + tile_roundings),
                    [&](std::size_t group) {
                        return tile_magnitudes(group_window(), filters_, group_weights(call, group),
                                               magnitudes(x, group, channels_ * input.area()), tiles_.ahead)
                            .sizes;
                    });
            for (std::size_t o = 0; o < output.size(); ++o)
                out[s][o].error += sizes[o];
        }
        return out;
    }
    [[nodiscard]] bool has_backward() const override { return true; }
    [[nodiscard]] reference_gradients backward(const reference_call& call, const samples& in,
                                               const samples& out_gradient) const override {
        reference_gradients g{samples(in.size(), sample(input.size())), sample(parameters)};
        for (std::size_t s = 0; s < in.size(); ++s) {
            for_each_product([&](std::size_t o, std::size_t i, std::size_t w) {
                const double dy = out_gradient[s][o].value;
                g.input[s][i].value += call.values[w] * dy;
                g.input[s][i].error += std::abs(call.values[w] * dy);
                g.values[w].value += in[s][i].value * dy;
                g.values[w].error += std::abs(in[s][i].value * dy);
            });
            for (std::size_t o = 0; bias_ && o < output.size(); ++o) {
                g.values[weights_ + o / output.area()].value += out_gradient[s][o].value;
                g.values[weights_ + o / output.area()].error += std::abs(out_gradient[s][o].value);
            }
        }
        // Up to here `error` is the sum of magnitudes.
        for (sample& each : g.input)
            for (bounded& b : each)
                b.error *= accumulated(call.roundoff,
                                       static_cast<double>(output.channels * std::min(taps_, output.area())));
        for (bounded& b : g.values)
            b.error *= accumulated(call.roundoff, static_cast<double>(in.size() * output.area() + 1));
        raise_gradients_to_tiles(call, in, out_gradient, g);
        return g;
    }

private:
    [[nodiscard]] double terms() const { return static_cast<double>(channels_ * taps_); }

    // deployment_bound.hpp counts the roundings of tiles. Here G g Gᵀ may be of the precision of the rest: up
    // to six more in each direction.
    static constexpr double tile_roundings = 34;
    [[nodiscard]] reference_window group_window() const {
        reference_window one = window_;
        one.input.channels = channels_;
        return one;
    }
    /// Of the input's gradient.
    [[nodiscard]] reference_window turned_window() const {
        reference_window turned = group_window();
        turned.input = {filters_, output.rows, output.columns};
        turned.top = window_.kernel_rows - 1 - window_.top,
        turned.left = window_.kernel_columns - 1 - window_.left;
        turned.bottom = input.rows + window_.kernel_rows - 1 - output.rows - turned.top;
        turned.right = input.columns + window_.kernel_columns - 1 - output.columns - turned.left;
        return turned;
    }
    [[nodiscard]] std::span<const double> group_weights(const reference_call& call, std::size_t group) const {
        return call.values.subspan(group * filters_ * channels_ * taps_, filters_ * channels_ * taps_);
    }
    [[nodiscard]] std::vector<double> turned_weights(const reference_call& call, std::size_t group) const {
        const std::span<const double> w = group_weights(call, group);
        std::vector<double> turned(w.size());
        for (std::size_t i = 0; i < w.size(); ++i) {
            const std::size_t filter = i / taps_ / channels_, channel = i / taps_ % channels_;
            turned[(channel * filters_ + filter) * taps_ + taps_ - 1 - i % taps_] = w[i];
        }
        return turned;
    }
    static std::vector<double> magnitudes(const sample& all, std::size_t group, std::size_t size) {
        std::vector<double> result(size);
        for (std::size_t i = 0; i < size; ++i)
            result[i] = magnitude(all[group * size + i]);
        return result;
    }
    /// errors[i] is at least `share` of the magnitudes by a tile; of_group(group) gives those.
    template <class Magnitudes>
    void raise_to_tile(std::vector<double>& errors, double share, Magnitudes&& of_group) const {
        for (std::size_t group = 0; group < output.channels / filters_; ++group) {
            const std::vector<double> sizes = of_group(group);
            for (std::size_t i = 0; i < sizes.size(); ++i)
                errors[group * sizes.size() + i] =
                    std::max(errors[group * sizes.size() + i], share * sizes[i]);
        }
    }
    void raise_gradients_to_tiles(const reference_call& call, const samples& in, const samples& out_gradient,
                                  reference_gradients& g) const {
        for (std::size_t s = 0; s < in.size() && tiles_.back.rows > 0; ++s) {
            std::vector<double> errors(input.size());
            raise_to_tile(errors, accumulated(call.roundoff, static_cast<double>(filters_) + tile_roundings),
                          [&](std::size_t group) {
                              return tile_magnitudes(
                                         turned_window(), channels_, turned_weights(call, group),
                                         magnitudes(out_gradient[s], group, filters_ * output.area()),
                                         tiles_.back)
                                  .sizes;
                          });
            for (std::size_t i = 0; i < input.size(); ++i)
                g.input[s][i].error = std::max(g.input[s][i].error, errors[i]);
        }
        // A term of a weight's gradient passes 4 roundings in each direction of Bᵀ d B and of A δ Aᵀ, those
        // of its product, of a sum over tiles and samples, and of Gᵀ t G. Which tile it is depends on the
        // instruction set: the largest bound of any counts.
        const double most = static_cast<double>(in.size() * output.area()) + tile_roundings;
        for (std::size_t tile = 0; tile < 16 && tiles_.of_weights; ++tile) {
            const tile_size outputs{2 + tile / 4, 2 + tile % 4};
            if (std::max(outputs.rows, outputs.columns) + window_.kernel_rows > 7)
                continue;
            for (std::size_t group = 0; group < output.channels / filters_; ++group) {
                std::vector<double> sizes(filters_ * channels_ * taps_);
                for (std::size_t s = 0; s < in.size(); ++s)
                    add_gradient_magnitudes(
                        group_window(), filters_, magnitudes(in[s], group, channels_ * input.area()),
                        magnitudes(out_gradient[s], group, filters_ * output.area()), outputs, sizes);
                for (std::size_t i = 0; i < sizes.size(); ++i) {
                    bounded& b = g.values[group * sizes.size() + i];
                    b.error = std::max(b.error, accumulated(call.roundoff, most) * sizes[i]);
                }
            }
        }
    }

    template <class Body>
    void for_each_product(Body&& body) const {
        for (std::size_t filter = 0; filter < output.channels; ++filter)
            for (std::size_t channel = 0; channel < channels_; ++channel)
                window_.for_each_tap([&](std::size_t to, std::size_t from, std::size_t tap) {
                    body(filter * output.area() + to,
                         (filter / filters_ * channels_ + channel) * input.area() + from,
                         (filter * channels_ + channel) * taps_ + tap);
                });
    }

    reference_window window_;
    reference_tiles tiles_;
    std::size_t channels_, filters_; // of a group
    bool bias_;
    std::size_t taps_, weights_;
};

class batch_norm final : public reference_layer {
public:
    explicit batch_norm(extents3 size) {
        input = output = size;
        parameters = statistics = 2 * size.channels;
    }

    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override {
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
                    out[s][p].error = std::abs(scale) * (moved * (inverse + inverse_error) +
                                                         std::abs(distance) * inverse_error);
                    // Rounded: centre (its rest goes into the shift), distance, scale, the multiply-add.
                    out[s][p].error +=
                        accumulated(call.roundoff, 5) *
                        (std::abs(scale) * (std::abs(distance) + moved) * (inverse + inverse_error) +
                         std::abs(shift));
                }
        }
        return out;
    }
    [[nodiscard]] bool has_backward() const override { return true; }
    [[nodiscard]] reference_gradients backward(const reference_call& call, const samples& in,
                                               const samples& out_gradient) const override {
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

private:
    struct statistic {
        bounded mean, variance;
    };

    template <class Body>
    void for_each(const samples& in, std::size_t channel, Body&& body) const {
        for (std::size_t s = 0; s < in.size(); ++s)
            for (std::size_t p = channel * input.area(); p < (channel + 1) * input.area(); ++p)
                body(s, p);
    }

    /// In two passes. The library measures from some value of the channel, so that its terms are at most the
    /// range of the values; a run of 16 is added in the working precision.
    [[nodiscard]] statistic of_batch(const reference_call& call, const samples& in, std::size_t c) const {
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
};

/// A layer without parameters that takes each sample by itself.
class sample_by_sample : public reference_layer {
public:
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const final {
        samples out;
        for (const sample& each : in)
            out.push_back(output_of(call, each));
        return out;
    }
    [[nodiscard]] bool has_backward() const final { return true; }
    [[nodiscard]] reference_gradients backward(const reference_call& call, const samples& in,
                                               const samples& out_gradient) const final {
        reference_gradients g;
        for (std::size_t s = 0; s < in.size(); ++s)
            g.input.push_back(gradient_of(call, in[s], out_gradient[s]));
        return g;
    }
    [[nodiscard]] virtual sample output_of(const reference_call& call, const sample& in) const = 0;
    [[nodiscard]] virtual sample gradient_of(const reference_call& call, const sample& in,
                                             const sample& out_gradient) const = 0;
};

class relu final : public sample_by_sample {
public:
    explicit relu(extents3 size) { input = output = size; }

    [[nodiscard]] sample output_of(const reference_call&, const sample& in) const override {
        sample out = in;
        for (bounded& b : out)
            b.value = b.value < 0 ? 0 : b.value;
        return out;
    }
    [[nodiscard]] sample gradient_of(const reference_call&, const sample& in,
                                     const sample& out_gradient) const override {
        sample g = out_gradient;
        for (std::size_t i = 0; i < input.size(); ++i)
            g[i] = {in[i].value > 0 ? g[i].value : 0, 0};
        return g;
    }
};

class square_root final : public sample_by_sample {
public:
    square_root(extents3 size, double offset) : offset_(offset) { input = output = size; }

    /// Offset, its sum with the input, two roots, their sum and a quotient: six roundings. What comes in
    /// wrong goes through the derivative, taken where it is largest.
    [[nodiscard]] sample output_of(const reference_call& call, const sample& in) const override {
        sample out = in;
        for (bounded& b : out) {
            const double x = std::max(b.value, 0.0), least = std::max(x - b.error, 0.0);
            b = {std::sqrt(x + offset_) - std::sqrt(offset_), b.error / (2 * std::sqrt(least + offset_))};
            b.error += accumulated(call.roundoff, 6) * magnitude(b);
        }
        return out;
    }
    /// The output's six roundings, offset and root, a sum, a product, a quotient: eleven.
    [[nodiscard]] sample gradient_of(const reference_call& call, const sample& in,
                                     const sample& out_gradient) const override {
        sample g = out_gradient;
        for (std::size_t i = 0; i < input.size(); ++i) {
            const double slope = in[i].value > 0 ? 0.5 / std::sqrt(in[i].value + offset_) : 0;
            g[i].value *= slope;
            g[i].error = g[i].error * slope + accumulated(call.roundoff, 11) * std::abs(g[i].value);
        }
        return g;
    }

private:
    double offset_;
};

class max_pool final : public sample_by_sample {
public:
    explicit max_pool(const reference_window& window) : window_(window) {
        input = window.input;
        output = {input.channels, window.output_rows(), window.output_columns()};
    }

    [[nodiscard]] sample output_of(const reference_call&, const sample& in) const override {
        sample out(output.size());
        std::vector<bool> seen(output.size());
        for_each([&](std::size_t o, std::size_t i) {
            bounded& to = out[o];
            const bounded& from = in[i];
            const double error = std::max(seen[o] ? to.error : 0, from.error);
            if (!seen[o] || from.value > to.value || std::isnan(from.value))
                to.value = std::isnan(to.value) ? to.value : from.value;
            to.error = error;
            seen[o] = true;
        });
        return out;
    }
    [[nodiscard]] sample gradient_of(const reference_call& call, const sample& in,
                                     const sample& out_gradient) const override {
        sample g(input.size());
        std::vector<std::size_t> first(output.size(), input.size()); // of the largest
        for_each([&](std::size_t o, std::size_t i) {
            if (first[o] == input.size() || in[i].value > in[first[o]].value)
                first[o] = i;
        });
        for (std::size_t o = 0; o < output.size(); ++o) {
            g[first[o]].value += out_gradient[o].value;
            g[first[o]].error +=
                std::abs(out_gradient[o].value) *
                accumulated(call.roundoff, static_cast<double>(window_.kernel_rows * window_.kernel_columns));
        }
        return g;
    }

private:
    template <class Body>
    void for_each(Body&& body) const {
        for (std::size_t c = 0; c < input.channels; ++c)
            window_.for_each_tap([&](std::size_t to, std::size_t from, std::size_t) {
                body(c * output.area() + to, c * input.area() + from);
            });
    }
    reference_window window_;
};

/// Averages of pixels: what lies in which of them, and what the sums are divided by.
class average final : public sample_by_sample {
public:
    average(extents3 in, extents3 out, std::vector<std::vector<std::size_t>> pixels,
            std::vector<double> divisors)
        : pixels_(std::move(pixels)), divisors_(std::move(divisors)) {
        input = in;
        output = out;
    }
    [[nodiscard]] sample output_of(const reference_call& call, const sample& in) const override {
        sample out(output.size());
        for (std::size_t o = 0; o < output.size(); ++o) {
            double size = 0;
            for_each(o, [&](std::size_t i) {
                out[o].value += in[i].value;
                out[o].error += in[i].error;
                size += magnitude(in[i]);
            });
            const std::size_t pixel = o % output.area();
            const double count = static_cast<double>(pixels_[pixel].size());
            out[o].error += accumulated(call.roundoff, count + 1) * size;
            out[o].value /= divisors_[pixel], out[o].error /= divisors_[pixel];
        }
        return out;
    }
    [[nodiscard]] sample gradient_of(const reference_call& call, const sample&,
                                     const sample& out_gradient) const override {
        sample g(input.size());
        for (std::size_t o = 0; o < output.size(); ++o)
            for_each(o, [&](std::size_t i) {
                const double share = out_gradient[o].value / divisors_[o % output.area()];
                g[i].value += share;
                g[i].error += std::abs(share);
            });
        for (bounded& b : g)
            b.error *= accumulated(call.roundoff, static_cast<double>(output.area()) + 1);
        return g;
    }

private:
    template <class Body>
    void for_each(std::size_t o, Body&& body) const {
        for (const std::size_t pixel : pixels_[o % output.area()])
            body(o / output.area() * input.area() + pixel);
    }
    std::vector<std::vector<std::size_t>> pixels_;
    std::vector<double> divisors_;
};

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
                          accumulated(call.roundoff, 1) * magnitude(in[i]) * (most + factor_error)};
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
    /// body(j) for all j in the window of i: those in front of it are as many as those behind, or one more.
    template <class Body>
    void for_window(std::size_t i, Body&& body) const {
        const std::size_t c = i / input.area(), before = size_ / 2;
        for (std::size_t w = 0; w < size_; ++w)
            if (c + w >= before && c + w - before < input.channels)
                body((c + w - before) * input.area() + i % input.area());
    }
    [[nodiscard]] bounded base(const reference_call& call, const sample& x, std::size_t i) const {
        double sum = 0, wrong = 0, most = 0;
        for_window(i, [&](std::size_t j) {
            sum += x[j].value * x[j].value;
            wrong += 2 * magnitude(x[j]) * x[j].error;
            most += magnitude(x[j]) * magnitude(x[j]);
        });
        // Constants are rounded as well.
        return {k_ + share_ * sum,
                share_ * wrong +
                    accumulated(call.roundoff, static_cast<double>(size_) + 3) * (k_ + share_ * most)};
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
            double largest = in[p].value, wrong = 0, sum = 0;
            for (std::size_t c = 0; c < input.channels; ++c) {
                largest = std::max(largest, in[p + c * input.area()].value);
                wrong = std::max(wrong, in[p + c * input.area()].error);
            }
            for (std::size_t c = 0; c < input.channels; ++c)
                sum += std::exp(in[p + c * input.area()].value - largest);
            for (std::size_t c = 0; c < input.channels; ++c) {
                const double distance = in[p + c * input.area()].value - largest;
                bounded& to = out[p + c * input.area()];
                to.value = std::exp(distance) / sum;
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
};

class same_again final : public reference_layer {
public:
    explicit same_again(extents3 size) { input = output = size; }
    [[nodiscard]] samples forward(const reference_call&, const samples& in) const override { return in; }
    [[nodiscard]] bool has_backward() const override { return true; }
    [[nodiscard]] reference_gradients backward(const reference_call&, const samples&,
                                               const samples& out_gradient) const override {
        return {out_gradient, {}};
    }
};

/// The part of a call's arrays that belongs to a layer behind others.
reference_call part_of(const reference_call& call, std::size_t values, std::size_t running,
                       const reference_layer& layer) {
    reference_call part = call;
    part.values = call.values.subspan(values, layer.parameters);
    part.running = call.running.subspan(running, layer.statistics);
    return part;
}

void add_costs(reference_layer& to, const reference_layer& from) {
    to.parameters += from.parameters;
    to.statistics += from.statistics;
    to.multiply_adds += from.multiply_adds;
    to.multiply_adds_on_pixels += from.multiply_adds_on_pixels;
}

class sequence final : public reference_layer {
public:
    sequence(extents3 size, std::vector<reference_pointer> layers) : layers_(std::move(layers)) {
        input = size;
        output = layers_.empty() ? size : layers_.back()->output;
        for (const reference_pointer& layer : layers_)
            add_costs(*this, *layer);
    }
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override {
        samples x = in;
        std::size_t values = 0, running = 0;
        for (const reference_pointer& layer : layers_) {
            x = layer->forward(part_of(call, values, running, *layer), x);
            values += layer->parameters, running += layer->statistics;
        }
        return x;
    }

private:
    std::vector<reference_pointer> layers_;
};

class residual final : public reference_layer {
public:
    residual(reference_pointer main, reference_pointer skip)
        : main_(std::move(main)), skip_(std::move(skip)) {
        input = main_->input;
        output = main_->output;
        add_costs(*this, *main_);
        add_costs(*this, *skip_);
    }
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override {
        samples sum = main_->forward(part_of(call, 0, 0, *main_), in);
        const samples skip = skip_->forward(part_of(call, main_->parameters, main_->statistics, *skip_), in);
        for (std::size_t s = 0; s < in.size(); ++s)
            for (std::size_t i = 0; i < output.size(); ++i) {
                sum[s][i].error +=
                    skip[s][i].error + call.roundoff * (magnitude(sum[s][i]) + magnitude(skip[s][i]));
                sum[s][i].value += skip[s][i].value;
            }
        return sum;
    }

private:
    reference_pointer main_, skip_;
};

/// Channels of all branches, one behind the other.
class concatenation final : public reference_layer {
public:
    explicit concatenation(std::vector<reference_pointer> branches) : branches_(std::move(branches)) {
        input = branches_.front()->input;
        output = branches_.front()->output;
        output.channels = 0;
        for (const reference_pointer& branch : branches_) {
            output.channels += branch->output.channels;
            add_costs(*this, *branch);
        }
    }
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override {
        samples all(in.size());
        std::size_t values = 0, running = 0;
        for (const reference_pointer& branch : branches_) {
            const samples own = branch->forward(part_of(call, values, running, *branch), in);
            for (std::size_t s = 0; s < in.size(); ++s)
                all[s].insert(all[s].end(), own[s].begin(), own[s].end());
            values += branch->parameters, running += branch->statistics;
        }
        return all;
    }

private:
    std::vector<reference_pointer> branches_;
};

/// Windows of one direction.
struct pixels_of {
    std::size_t begin, end;
};

} // namespace

reference_pointer reference_average_pool(const reference_window& window, bool counts_padding,
                                         std::size_t given_bottom, std::size_t given_right) {
    const extents3 out{window.input.channels, window.output_rows(), window.output_columns()};
    std::vector<std::vector<std::size_t>> pixels(out.area());
    std::vector<double> divisors(out.area());
    window.for_each_tap([&](std::size_t to, std::size_t from, std::size_t) { pixels[to].push_back(from); });
    for (std::size_t o = 0; o < out.area(); ++o) {
        const std::size_t row = o / out.columns * window.stride_rows,
                          column = o % out.columns * window.stride_columns;
        const std::size_t rows = std::min(row + window.kernel_rows,
                                          window.top + window.input.rows + given_bottom) -
                                 row,
                          columns = std::min(column + window.kernel_columns,
                                             window.left + window.input.columns + given_right) -
                                    column;
        divisors[o] = static_cast<double>(counts_padding ? rows * columns : pixels[o].size());
    }
    return std::make_unique<average>(window.input, out, std::move(pixels), std::move(divisors));
}
reference_pointer reference_adaptive_average(extents3 input, std::size_t rows, std::size_t columns) {
    const auto bin = [](std::size_t i, std::size_t size, std::size_t bins) -> pixels_of {
        const double width = static_cast<double>(size) / static_cast<double>(bins);
        return {static_cast<std::size_t>(std::floor(static_cast<double>(i) * width + 1e-9)),
                static_cast<std::size_t>(std::ceil(static_cast<double>(i + 1) * width - 1e-9))};
    };
    std::vector<std::vector<std::size_t>> pixels(rows * columns);
    std::vector<double> divisors(rows * columns);
    for (std::size_t o = 0; o < pixels.size(); ++o) {
        const pixels_of r = bin(o / columns, input.rows, rows), c = bin(o % columns, input.columns, columns);
        for (std::size_t y = r.begin; y < r.end; ++y)
            for (std::size_t x = c.begin; x < c.end; ++x)
                pixels[o].push_back(y * input.columns + x);
        divisors[o] = static_cast<double>(pixels[o].size());
    }
    return std::make_unique<average>(input, extents3{input.channels, rows, columns}, std::move(pixels),
                                     std::move(divisors));
}
reference_pointer reference_local_response_norm(extents3 input, std::size_t size, double alpha, double beta,
                                                double k) {
    return std::make_unique<local_response_norm>(input, size, alpha, beta, k);
}
reference_pointer reference_concatenation(std::vector<reference_pointer> branches) {
    return std::make_unique<concatenation>(std::move(branches));
}
reference_pointer reference_convolution(const reference_window& window, std::size_t filters,
                                        std::size_t groups, bool bias, const reference_tiles& tiles) {
    return std::make_unique<convolution>(window, filters, groups, bias, tiles);
}
reference_pointer reference_dense(extents3 input, std::size_t outputs) {
    // One window, as large as the image.
    return std::make_unique<convolution>(reference_window{input, input.rows, input.columns, 1, 1, 0, 0, 0, 0},
                                         outputs, 1, true, reference_tiles{});
}
reference_pointer reference_batch_norm(extents3 input) {
    return std::make_unique<batch_norm>(input);
}
reference_pointer reference_relu(extents3 input) {
    return std::make_unique<relu>(input);
}
reference_pointer reference_max_pool(const reference_window& window) {
    return std::make_unique<max_pool>(window);
}
reference_pointer reference_softmax(extents3 input) {
    return std::make_unique<softmax>(input);
}
reference_pointer reference_square_root(extents3 input, double offset) {
    return std::make_unique<square_root>(input, offset);
}
reference_pointer reference_identity(extents3 input) {
    return std::make_unique<same_again>(input);
}
reference_pointer reference_sequence(extents3 input, std::vector<reference_pointer> layers) {
    return std::make_unique<sequence>(input, std::move(layers));
}
reference_pointer reference_residual(reference_pointer main, reference_pointer skip) {
    return std::make_unique<residual>(std::move(main), std::move(skip));
}

} // namespace support

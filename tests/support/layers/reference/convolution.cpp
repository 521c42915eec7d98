#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <support/layers/deployed_reference.hpp>
#include <support/layers/reference/layers.hpp>
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

// deployed_reference.hpp counts the roundings of tiles. In batches G g Gᵀ may be of the precision of the
// rest: up to six more in each direction.
constexpr double tile_roundings = 34;

std::vector<double> magnitudes(const sample& all, std::size_t group, std::size_t size) {
    std::vector<double> result(size);
    for (std::size_t i = 0; i < size; ++i)
        result[i] = magnitude(all[group * size + i]);
    return result;
}

} // namespace

convolution::convolution(const reference_window& window, std::size_t filters, std::size_t groups, bool bias,
                         const reference_tiles& tiles, kind what)
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
    window.for_each_tap([&](std::size_t, std::size_t, std::size_t) { ++multiply_adds_on_pixels; });
    multiply_adds_on_pixels *= filters * channels_;
    convolutions = what == kind::of_windows;
}

template <class Body>
void convolution::for_each_product(Body&& body) const {
    for (std::size_t filter = 0; filter < output.channels; ++filter)
        for (std::size_t channel = 0; channel < channels_; ++channel)
            window_.for_each_tap([&](std::size_t to, std::size_t from, std::size_t tap) {
                body(filter * output.area() + to,
                     (filter / filters_ * channels_ + channel) * input.area() + from,
                     (filter * channels_ + channel) * taps_ + tap);
            });
}

convolution::sums convolution::sums_of(std::span<const double> weights, const sample& in) const {
    sums s{sample(output.size()), std::vector<double>(output.size()), std::vector<double>(output.size())};
    for_each_product([&](std::size_t o, std::size_t i, std::size_t w) {
        bounded& y = s.products[o];
        y.value += weights[w] * in[i].value;
        y.error += std::abs(weights[w]) * in[i].error;
        y.deviation += square(weights[w] * in[i].deviation);
        s.most_sizes[o] += std::abs(weights[w]) * magnitude(in[i]);
        s.sizes[o] += std::abs(weights[w] * in[i].value);
    });
    return s;
}

samples convolution::forward(const reference_call& call, const samples& in) const {
    samples out;
    for (const sample& x : in) {
        if (call.deployed) {
            out.push_back(deployed(call, x, std::nullopt, nullptr));
            continue;
        }
        sums s = sums_of(call.values, x);
        std::vector<double>& errors = s.most_sizes;
        for (std::size_t o = 0; o < output.size(); ++o) {
            const double bias = bias_ ? call.values[weights_ + o / output.area()] : 0;
            s.products[o].value += bias;
            errors[o] = accumulated(call.roundoff, terms() + 1) * (errors[o] + std::abs(bias));
        }
        if (tiles_.ahead.rows > 0)
            raise_to_tile(errors, accumulated(call.roundoff, static_cast<double>(channels_) + tile_roundings),
                          [&](std::size_t group) {
                              return tile_magnitudes(
                                         group_window(), filters_, group_weights(call.values, group),
                                         magnitudes(x, group, channels_ * input.area()), tiles_.ahead)
                                  .sizes;
                          });
        for (std::size_t o = 0; o < output.size(); ++o)
            s.products[o].error += errors[o];
        out.push_back(std::move(s.products));
    }
    return out;
}

sample convolution::deployed(const reference_call& call, const sample& in,
                             const std::optional<folded_norm>& behind, const sample* added) const {
    std::vector<double> weights(call.values.begin(),
                                call.values.begin() + static_cast<std::ptrdiff_t>(weights_));
    sample biases(output.channels);
    for (std::size_t f = 0; f < biases.size(); ++f) {
        biases[f].value = bias_ ? call.values[weights_ + f] : 0;
        if (behind) {
            biases[f] = behind->shifted(f, biases[f].value);
            for (std::size_t t = 0; t < channels_ * taps_; ++t)
                weights[f * channels_ * taps_ + t] *= behind->factor(f);
        }
    }
    return deployed(call, weights, biases, in, added);
}

sample convolution::deployed(const reference_call& call, std::span<const double> weights,
                             const sample& biases, const sample& in, const sample* added) const {
    sums s = sums_of(weights, in);
    double count = terms() + 3;
    std::vector<double> far(groups(), 1); // how far a number below the smallest one may grow
    if (const tile_size tiled = folds() && !call.tiles.empty() ? call.tiles[0] : tile_size{};
        tiled.rows > 0) {
        const bool roots =
            std::max(tiled.rows + window_.kernel_rows, tiled.columns + window_.kernel_columns) > 5;
        count = static_cast<double>(channels_) + (roots ? 23 : 11);
        sample exact = in;
        for (bounded& x : exact)
            x.error = 0;
        for (std::size_t group = 0; group < groups(); ++group) {
            const std::span<const double> own = group_weights(weights, group);
            const auto sizes_of = [&](const sample& x) {
                return tile_magnitudes(group_window(), filters_, own,
                                       magnitudes(x, group, channels_ * input.area()), tiled)
                    .sizes;
            };
            const auto at = static_cast<std::ptrdiff_t>(group * filters_ * output.area());
            std::ranges::copy(sizes_of(in), s.most_sizes.begin() + at);
            std::ranges::copy(sizes_of(exact), s.sizes.begin() + at);
            // The rows of |B|ᵀ add up to 5.2 at most, those of |G| to 2, those of |A|ᵀ to 10, in two
            // directions.
            double all = 0;
            for (const double w : own)
                all = std::max(all, std::abs(w));
            far[group] = 28 * 100 * (1 + 4 * terms() * all);
        }
    }
    sample out = std::move(s.products);
    for (std::size_t o = 0; o < out.size(); ++o) {
        const bounded& bias = biases[o / output.area()];
        const bounded skip = added ? (*added)[o] : bounded{};
        out[o].value += bias.value + skip.value;
        out[o].error +=
            bias.error + skip.error +
            accumulated(call.roundoff, count) * (s.most_sizes[o] + magnitude(bias) + magnitude(skip)) +
            (terms() + 3) * far[o / output.area() / filters_] * lost;
        out[o].deviation =
            std::sqrt(out[o].deviation + square(bias.deviation) + square(skip.deviation) +
                      drift(call, count, s.sizes[o] + std::abs(bias.value) + std::abs(skip.value)));
    }
    return out;
}

reference_gradients convolution::backward(const reference_call& call, const samples& in,
                                          const samples& out_gradient) const {
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

reference_window convolution::group_window() const {
    reference_window one = window_;
    one.input.channels = channels_;
    return one;
}
/// The window of the input's gradient.
reference_window convolution::turned_window() const {
    reference_window turned = group_window();
    turned.input = {filters_, output.rows, output.columns};
    turned.top = window_.kernel_rows - 1 - window_.top,
    turned.left = window_.kernel_columns - 1 - window_.left;
    turned.bottom = input.rows + window_.kernel_rows - 1 - output.rows - turned.top;
    turned.right = input.columns + window_.kernel_columns - 1 - output.columns - turned.left;
    return turned;
}
std::span<const double> convolution::group_weights(std::span<const double> weights, std::size_t group) const {
    return weights.subspan(group * filters_ * channels_ * taps_, filters_ * channels_ * taps_);
}
std::vector<double> convolution::turned_weights(const reference_call& call, std::size_t group) const {
    const std::span<const double> w = group_weights(call.values, group);
    std::vector<double> turned(w.size());
    for (std::size_t i = 0; i < w.size(); ++i) {
        const std::size_t filter = i / taps_ / channels_, channel = i / taps_ % channels_;
        turned[(channel * filters_ + filter) * taps_ + taps_ - 1 - i % taps_] = w[i];
    }
    return turned;
}
/// errors[i] is at least `share` of the magnitudes by a tile; of_group(group) gives those.
template <class Magnitudes>
void convolution::raise_to_tile(std::vector<double>& errors, double share, Magnitudes&& of_group) const {
    for (std::size_t group = 0; group < groups(); ++group) {
        const std::vector<double> sizes = of_group(group);
        for (std::size_t i = 0; i < sizes.size(); ++i)
            errors[group * sizes.size() + i] = std::max(errors[group * sizes.size() + i], share * sizes[i]);
    }
}
void convolution::raise_gradients_to_tiles(const reference_call& call, const samples& in,
                                           const samples& out_gradient, reference_gradients& g) const {
    for (std::size_t s = 0; s < in.size() && tiles_.back.rows > 0; ++s) {
        std::vector<double> errors(input.size());
        raise_to_tile(errors, accumulated(call.roundoff, static_cast<double>(filters_) + tile_roundings),
                      [&](std::size_t group) {
                          return tile_magnitudes(turned_window(), channels_, turned_weights(call, group),
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

reference_pointer reference_convolution(const reference_window& window, std::size_t filters,
                                        std::size_t groups, bool bias, const reference_tiles& tiles) {
    return std::make_unique<convolution>(window, filters, groups, bias, tiles);
}
reference_pointer reference_dense(extents3 input, std::size_t outputs) {
    // One window, as large as the image.
    return std::make_unique<convolution>(reference_window{input, input.rows, input.columns, 1, 1, 0, 0, 0, 0},
                                         outputs, 1, true, reference_tiles{}, convolution::kind::dense);
}
sample bounded_convolution(const reference_window& window, std::size_t filters,
                           std::span<const double> weights, const sample& biases, const sample& in,
                           const sample* added, tile_size tiled, std::size_t groups) {
    reference_call call;
    call.roundoff = deployed_roundoff;
    call.deployed = true;
    call.tiles = std::span(&tiled, 1);
    return convolution(window, filters, groups, true, {}).deployed(call, weights, biases, in, added);
}

} // namespace support

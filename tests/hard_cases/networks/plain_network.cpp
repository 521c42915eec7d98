#include "plain_network.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace hard_cases {

namespace {

using kind = support::described_layer::kind;

class plain_walk {
public:
    explicit plain_walk(const support::described_parameters& parameters) : left_(parameters) {}

    std::vector<float> through(const std::vector<support::described_layer>& layers, std::vector<float> x) {
        for (const support::described_layer& layer : layers)
            x = through(layer, std::move(x));
        return x;
    }

private:
    std::vector<float> through(const support::described_layer& layer, std::vector<float> x) {
        switch (layer.what) {
        case kind::convolution:
        case kind::dense:
            return convolution(layer, x);
        case kind::norm:
            return norm(layer.filters, std::move(x));
        case kind::relu:
            for (float& value : x)
                value = value > 0 ? value : 0;
            return x;
        case kind::pool:
            return pool(layer, x);
        case kind::list:
            return through(layer.inner, std::move(x));
        case kind::residual: {
            std::vector<float> sum = through(layer.inner, x);
            const std::vector<float> skip = through(layer.skip, std::move(x));
            for (std::size_t i = 0; i < sum.size(); ++i)
                sum[i] += skip[i];
            return sum;
        }
        default:
            throw std::logic_error("plain_outputs: a layer of a kind that no hard case has");
        }
    }
    std::vector<float> convolution(const support::described_layer& layer, const std::vector<float>& x) {
        const support::reference_window& window = layer.window;
        const std::size_t area = window.output_rows() * window.output_columns(),
                          channels = window.input.channels,
                          kernel = window.kernel_rows * window.kernel_columns;
        const auto weights = take(left_.values, layer.filters * channels * kernel);
        const auto biases = take(left_.values, layer.bias ? layer.filters : 0);
        std::vector<float> out(layer.filters * area);
        for (std::size_t f = 0; f < layer.filters; ++f) {
            if (layer.bias)
                std::fill_n(out.begin() + static_cast<std::ptrdiff_t>(f * area), area, biases[f]);
            for (std::size_t c = 0; c < channels; ++c)
                window.for_each_tap([&](std::size_t to, std::size_t from, std::size_t tap) {
                    out[f * area + to] +=
                        weights[(f * channels + c) * kernel + tap] * x[c * window.input.area() + from];
                });
        }
        return out;
    }
    std::vector<float> norm(std::size_t channels, std::vector<float> x) {
        const auto scale = take(left_.values, channels), shift = take(left_.values, channels),
                   mean = take(left_.statistics, channels), variance = take(left_.statistics, channels);
        const std::size_t area = x.size() / channels;
        const auto epsilon = static_cast<float>(left_.epsilon);
        for (std::size_t i = 0; i < x.size(); ++i) {
            const std::size_t c = i / area;
            x[i] = (x[i] - mean[c]) / std::sqrt(variance[c] + epsilon) * scale[c] + shift[c];
        }
        return x;
    }
    static std::vector<float> pool(const support::described_layer& layer, const std::vector<float>& x) {
        const std::size_t area = layer.window.output_rows() * layer.window.output_columns();
        std::vector<float> out(layer.window.input.channels * area, -std::numeric_limits<float>::infinity());
        for (std::size_t c = 0; c < layer.window.input.channels; ++c)
            layer.window.for_each_tap([&](std::size_t to, std::size_t from, std::size_t) {
                const float value = x[c * layer.window.input.area() + from];
                if (value > out[c * area + to])
                    out[c * area + to] = value;
            });
        return out;
    }
    static std::span<const float> take(std::span<const float>& from, std::size_t count) {
        const std::span<const float> taken = from.first(count);
        from = from.subspan(count);
        return taken;
    }

    support::described_parameters left_;
};

} // namespace

std::vector<float> plain_outputs(const std::vector<support::described_layer>& layers,
                                 const support::described_parameters& parameters, std::vector<float> in) {
    return plain_walk(parameters).through(layers, std::move(in));
}

std::vector<support::described_layer> as_trained(std::vector<support::described_layer> layers) {
    for (support::described_layer& layer : layers) {
        layer.alone = true;
        layer.tiled = {};
        for (auto* list : {&layer.inner, &layer.skip, &layer.branches})
            *list = as_trained(std::move(*list));
    }
    return layers;
}

} // namespace hard_cases

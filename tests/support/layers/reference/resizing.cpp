#include <algorithm>
#include <cmath>
#include <support/layers/reference/layers.hpp>
#include <utility>

namespace support {

namespace {

/// Each output is a weighted sum of pixels of its channel.
class resampling final : public sample_by_sample {
public:
    struct tap {
        std::size_t pixel;
        double weight;
    };
    using taps = std::vector<std::vector<tap>>; ///< of each output of one channel

    resampling(extents3 in, extents3 out, taps of_outputs) : taps_(std::move(of_outputs)) {
        input = in;
        output = out;
    }

    /// A weight is rounded along each axis; a product and a sum along each: six roundings.
    [[nodiscard]] sample output_of(const reference_call& call, const sample& in) const override {
        sample out(output.size());
        for (std::size_t o = 0; o < output.size(); ++o) {
            double most = 0, size = 0;
            for_each(o, [&](std::size_t i, double weight) {
                out[o].value += weight * in[i].value, out[o].error += weight * in[i].error;
                out[o].deviation += square(weight * in[i].deviation);
                most += weight * magnitude(in[i]), size += weight * std::abs(in[i].value);
            });
            const double roundings = exact(o) ? 0 : 6;
            out[o].error += accumulated(call.roundoff, roundings) * most;
            out[o].deviation = std::sqrt(out[o].deviation + drift(call, roundings, size));
        }
        return out;
    }
    /// As many additions as outputs have the pixel as a tap, and the roundings of their weights.
    [[nodiscard]] sample gradient_of(const reference_call& call, const sample&,
                                     const sample& out_gradient) const override {
        sample g(input.size());
        std::vector<std::size_t> terms(input.size());
        for (std::size_t o = 0; o < output.size(); ++o)
            for_each(o, [&](std::size_t i, double weight) {
                g[i].value += weight * out_gradient[o].value;
                g[i].error += weight * std::abs(out_gradient[o].value);
                ++terms[i];
            });
        for (std::size_t i = 0; i < input.size(); ++i)
            g[i].error *= accumulated(call.roundoff, static_cast<double>(terms[i]) + 4);
        return g;
    }

private:
    [[nodiscard]] bool exact(std::size_t o) const { return taps_[o % output.area()].size() == 1; }
    template <class Body>
    void for_each(std::size_t o, Body&& body) const {
        for (const auto& [pixel, weight] : taps_[o % output.area()])
            body(o / output.area() * input.area() + pixel, weight);
    }
    taps taps_;
};

/// PyTorch's position of an output, and the weight of the pixel after it: (output + ½) · from ÷ to − ½ for
/// linear interpolation, output · from ÷ to rounded down otherwise.
std::pair<std::size_t, double> place_of(std::size_t output, std::size_t from, std::size_t to, bool linear) {
    if (!linear)
        return {output * from / to, 0};
    const std::size_t halves = (2 * output + 1) * from, place = std::max(halves, to) - to,
                      pixel = place / (2 * to);
    const double rest = static_cast<double>(place % (2 * to)) / static_cast<double>(2 * to);
    return {pixel, pixel + 1 < from ? rest : 0};
}

} // namespace

reference_pointer reference_upsampling(extents3 input, std::size_t rows, std::size_t columns, bool linear) {
    resampling::taps taps(rows * columns);
    for (std::size_t o = 0; o < taps.size(); ++o) {
        const auto [row, below] = place_of(o / columns, input.rows, rows, linear);
        const auto [column, beside] = place_of(o % columns, input.columns, columns, linear);
        for (std::size_t y = 0; y < 2; ++y)
            for (std::size_t x = 0; x < 2; ++x)
                if (const double weight = (y == 0 ? 1 - below : below) * (x == 0 ? 1 - beside : beside);
                    weight > 0)
                    taps[o].push_back({(row + y) * input.columns + column + x, weight});
    }
    return std::make_unique<resampling>(input, extents3{input.channels, rows, columns}, std::move(taps));
}

} // namespace support

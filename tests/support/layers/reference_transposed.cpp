#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <support/layers/reference_layers.hpp>
#include <utility>
#include <vector>

namespace support {

namespace {

/// A transposed convolution as an ordinary one with filters for each phase of the stride, [phase][filter]:
/// the output at row stride × q + r − crop_top is a sum over the taps r, r + stride, … of the kernel. Bounds
/// are those of its sums.
class transposed_convolution final : public folding_layer {
public:
    transposed_convolution(const reference_enlargement& geometry, bool bias, const reference_tiles& tiles)
        : geometry_(geometry),
          phases_(phases_of(geometry), geometry.stride_rows * geometry.stride_columns * geometry.filters, 1,
                  true, tiles),
          phase_map_(phases_.output),
          biased_(bias),
          own_weights_(geometry.input.channels * geometry.filters * geometry.kernel_rows *
                       geometry.kernel_columns) {
        input = geometry.input;
        output = {geometry.filters, geometry.rows, geometry.columns};
        convolutions = 1;
        parameters = own_weights_ + (bias ? geometry.filters : 0);
        multiply_adds = input.area() * own_weights_;
        multiply_adds_on_pixels = 0;
        for (std::size_t i = 0; i < input.area() * geometry.kernel_rows * geometry.kernel_columns; ++i) {
            const std::size_t pixel = i % input.area(), tap = i / input.area(),
                              y = pixel / input.columns * geometry.stride_rows +
                                  tap / geometry.kernel_columns,
                              x = pixel % input.columns * geometry.stride_columns +
                                  tap % geometry.kernel_columns;
            multiply_adds_on_pixels += y >= geometry.crop_top && y - geometry.crop_top < geometry.rows &&
                                               x >= geometry.crop_left &&
                                               x - geometry.crop_left < geometry.columns
                                           ? input.channels * geometry.filters
                                           : 0;
        }
    }

    [[nodiscard]] bool folds() const override { return true; }
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override {
        reference_call of_phases = call;
        const std::vector<double> values = spread(call.values);
        of_phases.values = values;
        samples out;
        for (const sample& x : in)
            if (call.deployed)
                out.push_back(deployed(call, x, std::nullopt, nullptr));
            else
                out.push_back(joined(phases_.forward(of_phases, {x}).front()));
        check(call, in, out);
        return out;
    }
    [[nodiscard]] bool has_backward() const override { return true; }
    [[nodiscard]] reference_gradients backward(const reference_call& call, const samples& in,
                                               const samples& out_gradient) const override {
        reference_call of_phases = call;
        const std::vector<double> values = spread(call.values);
        of_phases.values = values;
        samples of_phase_maps;
        for (const sample& each : out_gradient) {
            sample phases(phase_map_.size());
            for_each_output([&](std::size_t o, std::size_t p) { phases[p] = each[o]; });
            of_phase_maps.push_back(std::move(phases));
        }
        const reference_gradients found = phases_.backward(of_phases, in, of_phase_maps);
        reference_gradients g{found.input, sample(parameters)};
        for_each_weight([&](std::size_t own, std::size_t p) { g.values[own] = found.values[p]; });
        for (std::size_t f = 0; biased_ && f < output.channels; ++f) {
            bounded& b = g.values[own_weights_ + f];
            for (const sample& each : out_gradient)
                for (std::size_t p = 0; p < output.area(); ++p) {
                    b.value += each[f * output.area() + p].value;
                    b.error += std::abs(each[f * output.area() + p].value);
                }
            b.error *= accumulated(call.roundoff, static_cast<double>(in.size() * output.area()));
        }
        return g;
    }
    [[nodiscard]] sample deployed(const reference_call& call, const sample& in,
                                  const std::optional<folded_norm>& behind,
                                  const sample* added) const override {
        if (added != nullptr)
            throw std::logic_error("reference: a transposed convolution adds nothing");
        std::vector<double> values = spread(call.values);
        const std::size_t phases = phase_map_.channels, weights = values.size() - phases;
        sample biases(phases);
        for (std::size_t p = 0; p < phases; ++p) {
            const std::size_t f = p % output.channels;
            biases[p].value = values[weights + p];
            if (!behind)
                continue;
            biases[p] = behind->shifted(f, biases[p].value);
            for (std::size_t w = p * (weights / phases); w < (p + 1) * (weights / phases); ++w)
                values[w] *= behind->factor(f);
        }
        values.resize(weights);
        return joined(phases_.deployed(call, values, biases, in, nullptr));
    }

private:
    static reference_window phases_of(const reference_enlargement& g) {
        // Rows q from the first to the last that have an output; input row q − t is under tap t of a phase.
        struct axis {
            std::size_t kernel, before, after;
        };
        const auto along = [](std::size_t size, std::size_t out, std::size_t kernel, std::size_t stride,
                              std::size_t crop) -> axis {
            const std::size_t taps = (kernel + stride - 1) / stride, first = crop / stride,
                              last = (out - 1 + crop) / stride;
            return {taps, taps - 1 - first, last + 1 - size};
        };
        const axis down = along(g.input.rows, g.rows, g.kernel_rows, g.stride_rows, g.crop_top),
                   beside =
                       along(g.input.columns, g.columns, g.kernel_columns, g.stride_columns, g.crop_left);
        return {g.input,     down.kernel, beside.kernel, 1,           1,
                down.before, down.after,  beside.before, beside.after};
    }
    /// body(output, place in the maps of all phases)
    template <class Body>
    void for_each_output(Body&& body) const {
        const reference_enlargement& g = geometry_;
        for (std::size_t o = 0; o < output.size(); ++o) {
            const std::size_t f = o / output.area(), y = o % output.area() / output.columns + g.crop_top,
                              x = o % output.columns + g.crop_left;
            const std::size_t phase = y % g.stride_rows * g.stride_columns + x % g.stride_columns,
                              row = y / g.stride_rows - g.crop_top / g.stride_rows,
                              column = x / g.stride_columns - g.crop_left / g.stride_columns;
            body(o, (phase * g.filters + f) * phase_map_.area() + row * phase_map_.columns + column);
        }
    }
    /// body(weight [channel][filter][row][column], weight of a phase)
    template <class Body>
    void for_each_weight(Body&& body) const {
        const reference_enlargement& g = geometry_;
        const std::size_t rows = (g.kernel_rows + g.stride_rows - 1) / g.stride_rows,
                          columns = (g.kernel_columns + g.stride_columns - 1) / g.stride_columns;
        for (std::size_t own = 0; own < own_weights_; ++own) {
            const std::size_t column = own % g.kernel_columns, row = own / g.kernel_columns % g.kernel_rows,
                              f = own / g.kernel_columns / g.kernel_rows % g.filters,
                              c = own / g.kernel_columns / g.kernel_rows / g.filters;
            const std::size_t phase = row % g.stride_rows * g.stride_columns + column % g.stride_columns;
            body(own,
                 (((phase * g.filters + f) * input.channels + c) * rows + rows - 1 - row / g.stride_rows) *
                         columns +
                     columns - 1 - column / g.stride_columns);
        }
    }
    /// The weights and biases of all phases; taps that the kernel does not have are zero.
    [[nodiscard]] std::vector<double> spread(std::span<const double> values) const {
        const reference_enlargement& g = geometry_;
        const std::size_t taps = ((g.kernel_rows + g.stride_rows - 1) / g.stride_rows) *
                                 ((g.kernel_columns + g.stride_columns - 1) / g.stride_columns);
        std::vector<double> all(phase_map_.channels * (input.channels * taps + 1));
        for_each_weight([&](std::size_t own, std::size_t p) { all[p] = values[own]; });
        for (std::size_t p = 0; biased_ && p < phase_map_.channels; ++p)
            all[all.size() - phase_map_.channels + p] = values[own_weights_ + p % g.filters];
        return all;
    }
    [[nodiscard]] sample joined(const sample& phases) const {
        sample out(output.size());
        for_each_output([&](std::size_t o, std::size_t p) { out[o] = phases[p]; });
        return out;
    }
    /// The values by the definition: each pixel adds its multiple of the kernel.
    void check(const reference_call& call, const samples& in, const samples& out) const {
        const reference_enlargement& g = geometry_;
        for (std::size_t s = 0; s < in.size(); ++s) {
            std::vector<double> by_definition(output.size()), sizes(output.size());
            for (std::size_t own = 0; own < own_weights_; ++own)
                for (std::size_t pixel = 0; pixel < input.area(); ++pixel) {
                    const std::size_t f = own / g.kernel_columns / g.kernel_rows % g.filters,
                                      c = own / g.kernel_columns / g.kernel_rows / g.filters,
                                      y = pixel / input.columns * g.stride_rows +
                                          own / g.kernel_columns % g.kernel_rows,
                                      x = pixel % input.columns * g.stride_columns + own % g.kernel_columns;
                    if (y < g.crop_top || y >= g.crop_top + g.rows || x < g.crop_left ||
                        x >= g.crop_left + g.columns)
                        continue;
                    const std::size_t o = (f * g.rows + y - g.crop_top) * g.columns + x - g.crop_left;
                    const double term = call.values[own] * in[s][c * input.area() + pixel].value;
                    by_definition[o] += term, sizes[o] += std::abs(term);
                }
            for (std::size_t o = 0; o < sizes.size(); ++o) {
                const double bias = biased_ ? call.values[own_weights_ + o / output.area()] : 0;
                if (std::abs(by_definition[o] + bias - out[s][o].value) > 1e-12 * (sizes[o] + std::abs(bias)))
                    throw std::logic_error("reference: phases differ from the definition");
            }
        }
    }

    reference_enlargement geometry_;
    convolution phases_;
    extents3 phase_map_; ///< of all phases
    bool biased_;
    std::size_t own_weights_;
};

} // namespace

reference_pointer reference_transposed_convolution(const reference_enlargement& geometry, bool bias,
                                                   const reference_tiles& tiles) {
    return std::make_unique<transposed_convolution>(geometry, bias, tiles);
}

} // namespace support

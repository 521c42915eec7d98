#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>
#include <support/layers/reference/layers.hpp>
#include <utility>
#include <vector>

namespace support {

namespace {

constexpr std::size_t none = static_cast<std::size_t>(-1);

/// Where the numbers of a convolution are among those of an ordinary one over maps of phases.
struct phase_plan {
    extents3 input, output;
    std::size_t groups, multiply_adds;
    bool bias, weights_by_channel;        ///< weights [channel][filter][tap], not [filter][channel][tap]
    std::vector<std::size_t> input_at{};  ///< of each pixel of the phases' map; none for a zero
    std::vector<std::size_t> output_at{}; ///< of each output
    std::vector<std::size_t> weight_at{}; ///< of each weight
    /// By the definition: the output that sees a pixel under a tap of the kernel.
    struct tap {
        std::size_t output, tap, pixel;
    };
    std::vector<tap> taps{};
};

/// A convolution whose bounds are those of an ordinary one over the maps of its phases. Its values are
/// compared with the definition.
class phased_convolution final : public folding_layer {
public:
    phased_convolution(phase_plan plan, const convolution& phases)
        : plan_(std::move(plan)),
          phases_(phases),
          phase_map_(phases.output),
          channels_(plan_.input.channels / plan_.groups) {
        input = plan_.input;
        output = plan_.output;
        convolutions = 1;
        parameters = plan_.weight_at.size() + (plan_.bias ? output.channels : 0);
        multiply_adds = plan_.multiply_adds;
        multiply_adds_on_pixels = plan_.taps.size() * channels_ * output.channels;
    }

    [[nodiscard]] bool folds() const override { return true; }
    [[nodiscard]] bool adds() const override { return false; }
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override {
        reference_call of_phases = call;
        const std::vector<double> values = spread(call.values);
        of_phases.values = values;
        samples out;
        for (const sample& x : in)
            out.push_back(call.deployed ? deployed(call, x, std::nullopt, nullptr)
                                        : merged(phases_.forward(of_phases, {split(x)}).front()));
        check(call, in, out);
        return out;
    }
    [[nodiscard]] bool has_backward() const override { return true; }
    [[nodiscard]] reference_gradients backward(const reference_call& call, const samples& in,
                                               const samples& out_gradient) const override {
        reference_call of_phases = call;
        const std::vector<double> values = spread(call.values);
        of_phases.values = values;
        samples maps, gradients;
        for (std::size_t s = 0; s < in.size(); ++s) {
            maps.push_back(split(in[s]));
            gradients.emplace_back(phase_map_.size());
            for (std::size_t o = 0; o < output.size(); ++o)
                gradients[s][plan_.output_at[o]] = out_gradient[s][o];
        }
        const reference_gradients found = phases_.backward(of_phases, maps, gradients);
        reference_gradients g{samples(in.size(), sample(input.size())), sample(parameters)};
        for (std::size_t s = 0; s < in.size(); ++s)
            for_each_pixel(
                [&](std::size_t phase, std::size_t own) { g.input[s][own] = found.input[s][phase]; });
        for (std::size_t w = 0; w < plan_.weight_at.size(); ++w)
            g.values[w] = found.values[plan_.weight_at[w]];
        for (std::size_t f = 0; plan_.bias && f < output.channels; ++f) {
            bounded& b = g.values[plan_.weight_at.size() + f];
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
            throw std::logic_error("reference: a convolution by phases adds nothing");
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
        return merged(phases_.deployed(call, values, biases, split(in), nullptr));
    }

private:
    /// The weights and biases of all phases; taps that the kernel does not have are zero.
    [[nodiscard]] std::vector<double> spread(std::span<const double> values) const {
        std::vector<double> all(phases_.parameters);
        for (std::size_t w = 0; w < plan_.weight_at.size(); ++w)
            all[plan_.weight_at[w]] = values[w];
        for (std::size_t p = 0; plan_.bias && p < phase_map_.channels; ++p)
            all[all.size() - phase_map_.channels + p] = values[plan_.weight_at.size() + p % output.channels];
        return all;
    }
    /// body(pixel of the phases' maps, pixel of the input)
    template <class Body>
    void for_each_pixel(Body&& body) const {
        const std::size_t area = plan_.input_at.size();
        for (std::size_t i = 0; i < input.channels * area; ++i)
            if (const std::size_t pixel = plan_.input_at[i % area]; pixel != none)
                body(i, i / area * input.area() + pixel);
    }
    [[nodiscard]] sample split(const sample& in) const {
        sample all(input.channels * plan_.input_at.size());
        for_each_pixel([&](std::size_t phase, std::size_t own) { all[phase] = in[own]; });
        return all;
    }
    [[nodiscard]] sample merged(const sample& phases) const {
        sample out(output.size());
        for (std::size_t o = 0; o < out.size(); ++o)
            out[o] = phases[plan_.output_at[o]];
        return out;
    }
    void check(const reference_call& call, const samples& in, const samples& out) const {
        const std::size_t filters = output.channels / plan_.groups, weights = plan_.weight_at.size(),
                          kernel = weights / output.channels / channels_;
        for (std::size_t s = 0; s < in.size(); ++s)
            for (std::size_t f = 0; f < output.channels; ++f) {
                std::vector<double> sums(output.area(), plan_.bias ? call.values[weights + f] : 0), sizes;
                for (const double bias : sums)
                    sizes.push_back(std::abs(bias));
                for (std::size_t c = 0; c < channels_; ++c)
                    for (const auto& [o, tap, pixel] : plan_.taps) {
                        const std::size_t pair =
                            plan_.weights_by_channel ? c * output.channels + f : f * channels_ + c;
                        const double term = call.values[pair * kernel + tap] *
                                            in[s][(f / filters * channels_ + c) * input.area() + pixel].value;
                        sums[o] += term, sizes[o] += std::abs(term);
                    }
                for (std::size_t o = 0; o < sums.size(); ++o)
                    if (std::abs(sums[o] - out[s][f * output.area() + o].value) > 1e-12 * sizes[o])
                        throw std::logic_error("reference: phases differ from the definition");
            }
    }

    phase_plan plan_;
    convolution phases_;
    extents3 phase_map_;   ///< of all phases
    std::size_t channels_; ///< of a group
};

/// Over the map of its phases, whose pixels follow from the definition.
phased_convolution dilated_convolution(const reference_dilation& g, const reference_dilation::layout& layout,
                                       std::size_t filters, std::size_t groups, bool bias,
                                       const reference_tiles& tiles) {
    const reference_window& w = g.window;
    const convolution phases(layout.phases, filters, groups, true, tiles);
    const std::size_t taps = w.kernel_rows * w.kernel_columns, area = g.output_rows * g.output_columns,
                      weights = filters * (w.input.channels / groups) * taps;
    phase_plan plan{.input = w.input,
                    .output = {filters, g.output_rows, g.output_columns},
                    .groups = groups,
                    .multiply_adds = area * weights,
                    .bias = bias,
                    .weights_by_channel = false};
    plan.input_at.assign(phases.input.area(), none);
    plan.weight_at.resize(weights);
    std::iota(plan.weight_at.begin(), plan.weight_at.end(), std::size_t{0});
    // Each output has a place among those of the phases; under each tap of it lies the pixel that the
    // definition says.
    for (std::size_t o = 0; o < filters * area; ++o)
        plan.output_at.push_back(o / area * phases.output.area() + layout.sums.at(o % area));
    for (std::size_t o = 0; o < area; ++o)
        for (std::size_t tap = 0; tap < taps; ++tap) {
            const std::size_t i = tap / w.kernel_columns, j = tap % w.kernel_columns,
                              y = o / g.output_columns * w.stride_rows + i * g.dilation_rows,
                              x = o % g.output_columns * w.stride_columns + j * g.dilation_columns;
            if (y < w.top || y - w.top >= w.input.rows || x < w.left || x - w.left >= w.input.columns)
                continue;
            const std::size_t pixel = (y - w.top) * w.input.columns + x - w.left;
            plan.taps.push_back({o, tap, pixel});
            // The padding of the convolution of the phases holds no pixel.
            const std::size_t sum = layout.sums.at(o);
            const std::size_t row = sum / phases.output.columns * layout.phases.stride_rows + i -
                                    layout.phases.top,
                              column = sum % phases.output.columns * layout.phases.stride_columns + j -
                                       layout.phases.left;
            std::size_t& at = plan.input_at.at(row * phases.input.columns + column);
            if (at != none && at != pixel)
                throw std::logic_error("reference: phases of a dilated convolution collide");
            at = pixel;
        }
    return {std::move(plan), phases};
}

/// A dilated convolution, whose phases lie in different ways in training and deployed.
class dilated_reference final : public folding_layer {
public:
    dilated_reference(const reference_dilation& g, std::size_t filters, std::size_t groups, bool bias,
                      const reference_tiles& tiles)
        : trained_(dilated_convolution(g, g.trained, filters, groups, bias, tiles)),
          deployed_(dilated_convolution(g, g.deployed, filters, groups, bias, tiles)) {
        static_cast<reference_layer&>(*this) = trained_;
    }
    [[nodiscard]] bool folds() const override { return true; }
    [[nodiscard]] bool adds() const override { return false; }
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override {
        return (call.deployed ? deployed_ : trained_).forward(call, in);
    }
    [[nodiscard]] bool has_backward() const override { return true; }
    [[nodiscard]] reference_gradients backward(const reference_call& call, const samples& in,
                                               const samples& out_gradient) const override {
        return trained_.backward(call, in, out_gradient);
    }
    [[nodiscard]] sample deployed(const reference_call& call, const sample& in,
                                  const std::optional<folded_norm>& behind,
                                  const sample* added) const override {
        return deployed_.deployed(call, in, behind, added);
    }

private:
    phased_convolution trained_, deployed_;
};

} // namespace

reference_pointer reference_dilated_convolution(const reference_dilation& geometry, std::size_t filters,
                                                std::size_t groups, bool bias, const reference_tiles& tiles) {
    return std::make_unique<dilated_reference>(geometry, filters, groups, bias, tiles);
}

/// With filters for each phase of the stride, [phase][filter]: the output at row stride × q + r − crop_top is
/// a sum over the taps r, r + stride, … of the kernel.
reference_pointer reference_transposed_convolution(const reference_enlargement& g, bool bias,
                                                   const reference_tiles& tiles) {
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
               beside = along(g.input.columns, g.columns, g.kernel_columns, g.stride_columns, g.crop_left);
    const convolution phases(
        {g.input, down.kernel, beside.kernel, 1, 1, down.before, down.after, beside.before, beside.after},
        g.stride_rows * g.stride_columns * g.filters, 1, true, tiles);
    const std::size_t taps = g.kernel_rows * g.kernel_columns, area = g.rows * g.columns,
                      weights = g.input.channels * g.filters * taps;
    phase_plan plan{.input = g.input,
                    .output = {g.filters, g.rows, g.columns},
                    .groups = 1,
                    .multiply_adds = g.input.area() * weights,
                    .bias = bias,
                    .weights_by_channel = true};
    plan.input_at.resize(g.input.area());
    std::iota(plan.input_at.begin(), plan.input_at.end(), std::size_t{0});
    const auto phase_of = [&](std::size_t row, std::size_t column) {
        return row % g.stride_rows * g.stride_columns + column % g.stride_columns;
    };
    for (std::size_t o = 0; o < g.filters * area; ++o) {
        const std::size_t y = o % area / g.columns + g.crop_top, x = o % g.columns + g.crop_left,
                          row = y / g.stride_rows - g.crop_top / g.stride_rows,
                          column = x / g.stride_columns - g.crop_left / g.stride_columns;
        plan.output_at.push_back((phase_of(y, x) * g.filters + o / area) * phases.output.area() +
                                 row * phases.output.columns + column);
    }
    for (std::size_t w = 0; w < weights; ++w) {
        const std::size_t row = w % taps / g.kernel_columns, column = w % g.kernel_columns,
                          f = w / taps % g.filters, c = w / taps / g.filters;
        plan.weight_at.push_back(
            (((phase_of(row, column) * g.filters + f) * g.input.channels + c) * down.kernel + down.kernel -
             1 - row / g.stride_rows) *
                beside.kernel +
            beside.kernel - 1 - column / g.stride_columns);
    }
    // By the definition each pixel adds its multiple of the kernel.
    for (std::size_t pixel = 0; pixel < g.input.area(); ++pixel)
        for (std::size_t tap = 0; tap < taps; ++tap) {
            const std::size_t y = pixel / g.input.columns * g.stride_rows + tap / g.kernel_columns,
                              x = pixel % g.input.columns * g.stride_columns + tap % g.kernel_columns;
            if (y >= g.crop_top && y - g.crop_top < g.rows && x >= g.crop_left && x - g.crop_left < g.columns)
                plan.taps.push_back({(y - g.crop_top) * g.columns + x - g.crop_left, tap, pixel});
        }
    return std::make_unique<phased_convolution>(std::move(plan), phases);
}

} // namespace support

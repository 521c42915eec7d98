#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <support/layers/reference_layers.hpp>
#include <utility>
#include <vector>

namespace support {

namespace {

/// A dilated convolution as an ordinary one over the map of its phases, whose bounds are its own; which
/// pixels these are follows from the definition, and so do the values that results are checked against.
class dilated_convolution final : public folding_layer {
public:
    dilated_convolution(const reference_dilation& geometry, std::size_t filters, std::size_t groups,
                        bool bias, const reference_tiles& tiles)
        : window_(geometry.window),
          geometry_(geometry),
          groups_(groups),
          biased_(bias),
          phases_(geometry.phases, filters, groups, bias, tiles),
          input_at_(phases_.input.area(), none) {
        input = window_.input;
        output = {filters, geometry.output_rows, geometry.output_columns};
        convolutions = 1;
        parameters = phases_.parameters;
        taps_ = window_.kernel_rows * window_.kernel_columns;
        const std::size_t weights = filters * (input.channels / groups) * taps_;
        multiply_adds = output.area() * weights;
        multiply_adds_on_pixels = 0;
        // Each output has a place among those of the phases; under each tap of it lies the pixel that the
        // definition says.
        for_each_tap([&](std::size_t o, std::size_t tap, std::size_t pixel) {
            const std::size_t place = place_of(o),
                              row = place / phases_.output.columns * geometry.phases.stride_rows +
                                    tap / window_.kernel_columns,
                              column = place % phases_.output.columns * geometry.phases.stride_columns +
                                       tap % window_.kernel_columns;
            std::size_t& at = input_at_[row * phases_.input.columns + column];
            if (at != none && at != pixel)
                throw std::logic_error("reference: phases of a dilated convolution collide");
            at = pixel;
            multiply_adds_on_pixels += weights / taps_;
        });
    }

    [[nodiscard]] bool folds() const override { return true; }
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override {
        samples out;
        for (const sample& x : in)
            out.push_back(call.deployed ? deployed(call, x, std::nullopt, nullptr)
                                        : merged(phases_.forward(call, {split(x)}).front()));
        check(call, in, out);
        return out;
    }
    [[nodiscard]] bool has_backward() const override { return true; }
    [[nodiscard]] reference_gradients backward(const reference_call& call, const samples& in,
                                               const samples& out_gradient) const override {
        samples maps, gradients;
        for (std::size_t s = 0; s < in.size(); ++s) {
            maps.push_back(split(in[s]));
            gradients.emplace_back(phases_.output.size());
            for (std::size_t o = 0; o < output.size(); ++o)
                gradients[s][o / output.area() * phases_.output.area() + place_of(o % output.area())] =
                    out_gradient[s][o];
        }
        const reference_gradients found = phases_.backward(call, maps, gradients);
        reference_gradients g{samples(in.size(), sample(input.size())), found.values};
        for (std::size_t s = 0; s < in.size(); ++s)
            for (std::size_t i = 0; i < found.input[s].size(); ++i)
                if (const std::size_t pixel = input_at_[i % input_at_.size()]; pixel != none)
                    g.input[s][i / input_at_.size() * input.area() + pixel] = found.input[s][i];
        return g;
    }
    [[nodiscard]] sample deployed(const reference_call& call, const sample& in,
                                  const std::optional<folded_norm>& behind,
                                  const sample* added) const override {
        if (added != nullptr)
            throw std::logic_error("reference: a dilated convolution adds nothing");
        return merged(phases_.deployed(call, split(in), behind, nullptr));
    }

private:
    static constexpr std::size_t none = static_cast<std::size_t>(-1);

    /// body(output pixel, tap, input pixel) for all taps on pixels, by the definition
    template <class Body>
    void for_each_tap(Body&& body) const {
        const reference_window& w = window_;
        for (std::size_t o = 0; o < output.area(); ++o)
            for (std::size_t tap = 0; tap < taps_; ++tap) {
                const std::size_t y = o / output.columns * w.stride_rows +
                                      tap / w.kernel_columns * geometry_.dilation_rows,
                                  x = o % output.columns * w.stride_columns +
                                      tap % w.kernel_columns * geometry_.dilation_columns;
                if (y >= w.top && y - w.top < input.rows && x >= w.left && x - w.left < input.columns)
                    body(o, tap, (y - w.top) * input.columns + x - w.left);
            }
    }
    [[nodiscard]] std::size_t place_of(std::size_t o) const {
        return geometry_.rows.at(o / output.columns) * phases_.output.columns +
               geometry_.columns.at(o % output.columns);
    }
    [[nodiscard]] sample split(const sample& in) const {
        sample all(phases_.input.size());
        for (std::size_t i = 0; i < all.size(); ++i)
            if (const std::size_t pixel = input_at_[i % input_at_.size()]; pixel != none)
                all[i] = in[i / input_at_.size() * input.area() + pixel];
        return all;
    }
    [[nodiscard]] sample merged(const sample& phases) const {
        sample out(output.size());
        for (std::size_t o = 0; o < out.size(); ++o)
            out[o] = phases[o / output.area() * phases_.output.area() + place_of(o % output.area())];
        return out;
    }
    void check(const reference_call& call, const samples& in, const samples& out) const {
        const std::size_t channels = input.channels / groups_, filters = output.channels / groups_,
                          weights = output.channels * channels * taps_;
        for (std::size_t s = 0; s < in.size(); ++s)
            for (std::size_t f = 0; f < output.channels; ++f) {
                std::vector<double> sums(output.area(), biased_ ? call.values[weights + f] : 0), sizes(sums);
                for (std::size_t c = 0; c < channels; ++c)
                    for_each_tap([&](std::size_t o, std::size_t tap, std::size_t pixel) {
                        const double term = call.values[(f * channels + c) * taps_ + tap] *
                                            in[s][(f / filters * channels + c) * input.area() + pixel].value;
                        sums[o] += term, sizes[o] = std::abs(sizes[o]) + std::abs(term);
                    });
                for (std::size_t o = 0; o < sums.size(); ++o)
                    if (std::abs(sums[o] - out[s][f * output.area() + o].value) > 1e-12 * std::abs(sizes[o]))
                        throw std::logic_error("reference: phases differ from the definition");
            }
    }

    reference_window window_;
    reference_dilation geometry_;
    std::size_t groups_, taps_ = 0;
    bool biased_;
    convolution phases_;
    std::vector<std::size_t> input_at_; ///< of each pixel of the phases; none for a zero
};

} // namespace

reference_pointer reference_dilated_convolution(const reference_dilation& geometry, std::size_t filters,
                                                std::size_t groups, bool bias, const reference_tiles& tiles) {
    return std::make_unique<dilated_convolution>(geometry, filters, groups, bias, tiles);
}

} // namespace support

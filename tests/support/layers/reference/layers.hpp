#pragma once

// The classes of the reference that its lists of layers look into.

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <support/layers/reference.hpp>
#include <vector>

namespace support {

inline double square(double x) {
    return x * x;
}
inline double magnitude(const bounded& b) {
    return std::abs(b.value) + b.error;
}
/// The square of the deviation that `count` independent roundings of a number of that size make.
inline double drift(const reference_call& call, double count, double size) {
    return count * square(call.roundoff * size);
}

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

/// Dropout of nothing.
class same_again final : public sample_by_sample {
public:
    explicit same_again(extents3 size) { input = output = size; }
    [[nodiscard]] sample output_of(const reference_call&, const sample& in) const override { return in; }
    [[nodiscard]] sample gradient_of(const reference_call&, const sample&,
                                     const sample& out_gradient) const override {
        return out_gradient;
    }
};

/// A batch norm as factor and offset in double, for folding.
struct folded_norm {
    std::span<const double> scale, shift, mean, variance;
    double epsilon, roundoff;

    [[nodiscard]] double factor(std::size_t c) const { return scale[c] / std::sqrt(variance[c] + epsilon); }
    /// The error is what double precision leaves where large numbers cancel, and one rounding.
    [[nodiscard]] bounded shifted(std::size_t c, double bias) const;
};

class batch_norm final : public reference_layer {
public:
    explicit batch_norm(extents3 size);
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override;
    [[nodiscard]] bool has_backward() const override { return true; }
    [[nodiscard]] reference_gradients backward(const reference_call& call, const samples& in,
                                               const samples& out_gradient) const override;
    [[nodiscard]] folded_norm folded(const reference_call& call) const;

private:
    struct statistic {
        bounded mean, variance;
    };
    template <class Body>
    void for_each(const samples& in, std::size_t channel, Body&& body) const;
    [[nodiscard]] statistic of_batch(const reference_call& call, const samples& in, std::size_t c) const;
    [[nodiscard]] sample deployed(const reference_call& call, sample x) const;
};

/// A layer of which a deployed network folds a batch norm after it, and adds a skip in its sums.
class folding_layer : public reference_layer {
public:
    [[nodiscard]] virtual bool folds() const = 0;
    /// Whether what is added goes into its sums.
    [[nodiscard]] virtual bool adds() const { return true; }
    /// Deployed. `added` may be null.
    [[nodiscard]] virtual sample deployed(const reference_call& call, const sample& in,
                                          const std::optional<folded_norm>& behind,
                                          const sample* added) const = 0;
};

/// Each channel times a number: a norm with mean 0 and variance 1, to fold.
class channel_scale final : public reference_layer {
public:
    explicit channel_scale(extents3 size);
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override;
    [[nodiscard]] bool has_backward() const override { return true; }
    [[nodiscard]] reference_gradients backward(const reference_call& call, const samples& in,
                                               const samples& out_gradient) const override;
    [[nodiscard]] folded_norm folded(const reference_call& call) const;

private:
    std::vector<double> zeros_, ones_;
};

/// Convolutions, and dense layers as those whose one window is as large as the image.
class convolution final : public folding_layer {
public:
    enum class kind { of_windows, dense };
    convolution(const reference_window& window, std::size_t filters, std::size_t groups, bool bias,
                const reference_tiles& tiles, kind what = kind::of_windows);

    [[nodiscard]] bool folds() const override { return convolutions > 0; }
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override;
    [[nodiscard]] bool has_backward() const override { return true; }
    [[nodiscard]] reference_gradients backward(const reference_call& call, const samples& in,
                                               const samples& out_gradient) const override;
    [[nodiscard]] sample deployed(const reference_call& call, const sample& in,
                                  const std::optional<folded_norm>& behind,
                                  const sample* added) const override;
    [[nodiscard]] sample deployed(const reference_call& call, std::span<const double> weights,
                                  const sample& biases, const sample& in, const sample* added) const;

private:
    /// For each output the sum of its products, its deviation squared; and the sum of all magnitudes, with
    /// what their inputs are wrong by, and without.
    struct sums {
        sample products;
        std::vector<double> most_sizes, sizes;
    };
    [[nodiscard]] sums sums_of(std::span<const double> weights, const sample& in) const;
    template <class Body>
    void for_each_product(Body&& body) const;
    [[nodiscard]] double terms() const { return static_cast<double>(channels_ * taps_); }
    [[nodiscard]] std::size_t groups() const { return output.channels / filters_; }
    [[nodiscard]] reference_window group_window() const;
    [[nodiscard]] reference_window turned_window() const;
    [[nodiscard]] std::span<const double> group_weights(std::span<const double> weights,
                                                        std::size_t group) const;
    [[nodiscard]] std::vector<double> turned_weights(const reference_call& call, std::size_t group) const;
    template <class Magnitudes>
    void raise_to_tile(std::vector<double>& errors, double share, Magnitudes&& of_group) const;
    void raise_gradients_to_tiles(const reference_call& call, const samples& in, const samples& out_gradient,
                                  reference_gradients& g) const;

    reference_window window_;
    reference_tiles tiles_;
    std::size_t channels_, filters_; // of a group
    bool bias_;
    std::size_t taps_, weights_;
};

} // namespace support

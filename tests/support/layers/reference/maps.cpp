#include <algorithm>
#include <cmath>
#include <limits>
#include <support/layers/deployed_reference.hpp>
#include <support/layers/reference/layers.hpp>
#include <utility>

namespace support {

namespace {

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

class parametric_relu final : public reference_layer {
public:
    explicit parametric_relu(extents3 size) {
        input = output = size;
        parameters = size.channels;
    }

    /// One product.
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override {
        samples out = in;
        for (sample& each : out)
            for (std::size_t i = 0; i < each.size(); ++i) {
                bounded& b = each[i];
                const double slope = call.values[i / input.area()], steepest = std::max(1.0, std::abs(slope));
                b = {b.value > 0 ? b.value : slope * b.value, b.error * steepest, b.deviation * steepest};
                b.error += accumulated(call.roundoff, 1) * magnitude(b) + lost;
                b.deviation = std::sqrt(square(b.deviation) + drift(call, 1, b.value)) + lost;
            }
        return out;
    }
    [[nodiscard]] bool has_backward() const override { return true; }
    /// One product. Those of a slope are summed in runs of 16, then in double.
    [[nodiscard]] reference_gradients backward(const reference_call& call, const samples& in,
                                               const samples& out_gradient) const override {
        reference_gradients g{out_gradient, sample(parameters)};
        std::vector<double> sizes(parameters);
        for (std::size_t s = 0; s < in.size(); ++s)
            for (std::size_t i = 0; i < input.size(); ++i) {
                const std::size_t c = i / input.area();
                const double x = in[s][i].value, dy = out_gradient[s][i].value;
                if (x > 0)
                    continue;
                g.input[s][i].value = call.values[c] * dy;
                g.input[s][i].error = accumulated(call.roundoff, 1) * std::abs(call.values[c] * dy);
                g.values[c].value += x * dy;
                sizes[c] += std::abs(x * dy);
            }
        const auto terms = static_cast<double>(in.size() * input.area());
        for (std::size_t c = 0; c < parameters; ++c)
            g.values[c].error =
                (accumulated(call.roundoff, 16 + 2) + accumulated(unit_roundoff<double>, terms)) * sizes[c];
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
            b = {std::sqrt(x + offset_) - std::sqrt(offset_), b.error / (2 * std::sqrt(least + offset_)),
                 b.deviation / (2 * std::sqrt(x + offset_))};
            b.error += accumulated(call.roundoff, 6) * magnitude(b);
            b.deviation = std::sqrt(square(b.deviation) + drift(call, 6, b.value));
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

class activation final : public sample_by_sample {
public:
    activation(extents3 size, const reference_function& function) : function_(function) {
        input = output = size;
    }

    [[nodiscard]] sample output_of(const reference_call& call, const sample& in) const override {
        sample out = in;
        for (bounded& b : out) {
            const double roundings = function_.value_roundings;
            b = {function_.value(b.value), b.error * function_.largest_slope,
                 b.deviation * function_.largest_slope};
            b.error += accumulated(call.roundoff, roundings) * magnitude(b) + lost;
            b.deviation = std::sqrt(square(b.deviation) + drift(call, roundings, b.value)) + lost;
        }
        return out;
    }
    [[nodiscard]] sample gradient_of(const reference_call& call, const sample& in,
                                     const sample& out_gradient) const override {
        sample g = out_gradient;
        for (std::size_t i = 0; i < input.size(); ++i) {
            const double slope = function_.derivative(in[i].value);
            g[i].error = std::abs(slope) * g[i].error +
                         accumulated(call.roundoff, function_.derivative_roundings) * std::abs(g[i].value);
            g[i].value *= slope;
        }
        return g;
    }

private:
    reference_function function_;
};

/// The pixels of each output of one channel.
using pixel_lists = std::vector<std::vector<std::size_t>>;

pixel_lists pixels_of_windows(const reference_window& window) {
    pixel_lists pixels(window.output_rows() * window.output_columns());
    window.for_each_tap([&](std::size_t to, std::size_t from, std::size_t) { pixels[to].push_back(from); });
    return pixels;
}
/// PyTorch's bins: from floor(i · size ÷ bins) to ceil((i + 1) · size ÷ bins).
pixel_lists pixels_of_bins(extents3 input, std::size_t rows, std::size_t columns) {
    struct range {
        std::size_t begin, end;
    };
    const auto bin = [](std::size_t i, std::size_t size, std::size_t bins) -> range {
        const double width = static_cast<double>(size) / static_cast<double>(bins);
        return {static_cast<std::size_t>(std::floor(static_cast<double>(i) * width + 1e-9)),
                static_cast<std::size_t>(std::ceil(static_cast<double>(i + 1) * width - 1e-9))};
    };
    pixel_lists pixels(rows * columns);
    for (std::size_t o = 0; o < pixels.size(); ++o) {
        const range r = bin(o / columns, input.rows, rows), c = bin(o % columns, input.columns, columns);
        for (std::size_t y = r.begin; y < r.end; ++y)
            for (std::size_t x = c.begin; x < c.end; ++x)
                pixels[o].push_back(y * input.columns + x);
    }
    return pixels;
}

class max_pool final : public sample_by_sample {
public:
    max_pool(extents3 in, extents3 out, pixel_lists pixels) : pixels_(std::move(pixels)) {
        input = in;
        output = out;
    }
    explicit max_pool(const reference_window& window)
        : max_pool(window.input, {window.input.channels, window.output_rows(), window.output_columns()},
                   pixels_of_windows(window)) {}

    [[nodiscard]] sample output_of(const reference_call&, const sample& in) const override {
        sample out(output.size());
        std::vector<bool> seen(output.size());
        for_each([&](std::size_t o, std::size_t i) {
            bounded& to = out[o];
            const bounded& from = in[i];
            const double error = std::max(to.error, from.error);
            to.deviation = std::max(to.deviation, from.deviation);
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
        std::vector<std::size_t> lists(input.size());                // that hold a pixel
        for_each([&](std::size_t o, std::size_t i) {
            ++lists[i];
            if (first[o] == input.size() || in[i].value > in[first[o]].value)
                first[o] = i;
        });
        const auto additions = static_cast<double>(*std::max_element(lists.begin(), lists.end()));
        for (std::size_t o = 0; o < output.size(); ++o) {
            g[first[o]].value += out_gradient[o].value;
            g[first[o]].error += std::abs(out_gradient[o].value) * accumulated(call.roundoff, additions);
        }
        return g;
    }

private:
    template <class Body>
    void for_each(Body&& body) const {
        for (std::size_t o = 0; o < output.size(); ++o)
            for (const std::size_t pixel : pixels_[o % output.area()])
                body(o, o / output.area() * input.area() + pixel);
    }
    pixel_lists pixels_;
};

/// Averages of pixels: what lies in which of them, and what the sums are divided by.
class average final : public sample_by_sample {
public:
    average(extents3 in, extents3 out, pixel_lists pixels, std::vector<double> divisors)
        : pixels_(std::move(pixels)), divisors_(std::move(divisors)) {
        input = in;
        output = out;
    }
    [[nodiscard]] sample output_of(const reference_call& call, const sample& in) const override {
        sample out(output.size());
        for (std::size_t o = 0; o < output.size(); ++o) {
            double most = 0, size = 0;
            for_each(o, [&](std::size_t i) {
                out[o].value += in[i].value, out[o].error += in[i].error;
                out[o].deviation += square(in[i].deviation);
                most += magnitude(in[i]), size += std::abs(in[i].value);
            });
            const std::size_t pixel = o % output.area();
            const double count = static_cast<double>(pixels_[pixel].size());
            out[o].error += accumulated(call.roundoff, count + 1) * most;
            out[o].deviation = std::sqrt(out[o].deviation + drift(call, count + 1, size));
            for (double* each : {&out[o].value, &out[o].error, &out[o].deviation})
                *each /= divisors_[pixel];
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
    pixel_lists pixels_;
    std::vector<double> divisors_;
};

} // namespace

reference_pointer reference_average_pool(const reference_window& window, bool counts_padding,
                                         std::size_t given_bottom, std::size_t given_right) {
    const extents3 out{window.input.channels, window.output_rows(), window.output_columns()};
    pixel_lists pixels = pixels_of_windows(window);
    std::vector<double> divisors(out.area());
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
    pixel_lists pixels = pixels_of_bins(input, rows, columns);
    std::vector<double> divisors;
    for (const std::vector<std::size_t>& bin : pixels)
        divisors.push_back(static_cast<double>(bin.size()));
    return std::make_unique<average>(input, extents3{input.channels, rows, columns}, std::move(pixels),
                                     std::move(divisors));
}
reference_pointer reference_adaptive_max(extents3 input, std::size_t rows, std::size_t columns) {
    return std::make_unique<max_pool>(input, extents3{input.channels, rows, columns},
                                      pixels_of_bins(input, rows, columns));
}
reference_pointer reference_relu(extents3 input) {
    return std::make_unique<relu>(input);
}
reference_pointer reference_parametric_relu(extents3 input) {
    return std::make_unique<parametric_relu>(input);
}
reference_pointer reference_max_pool(const reference_window& window) {
    return std::make_unique<max_pool>(window);
}
reference_pointer reference_square_root(extents3 input, double offset) {
    return std::make_unique<square_root>(input, offset);
}
reference_pointer reference_activation(extents3 input, const reference_function& function) {
    return std::make_unique<activation>(input, function);
}
sample bounded_max_pool(const reference_window& window, const sample& in) {
    return max_pool(window).output_of({}, in);
}
std::size_t outputs_outside(const sample& expected, std::size_t area, const float* found,
                            std::size_t stride) {
    std::size_t wrong = expected.size() % area;
    for (std::size_t p = 0; p < area; ++p)
        for (std::size_t c = 0; c < stride; ++c) {
            const bounded right = c < expected.size() / area ? expected[c * area + p] : bounded{};
            const double error = std::abs(static_cast<double>(found[p * stride + c]) - right.value);
            wrong += !(error <= right.error && error <= 2 * right.deviation);
        }
    return wrong;
}
sample bounded_relu(sample in) {
    return relu({1, 1, in.size()}).output_of({}, in);
}

} // namespace support

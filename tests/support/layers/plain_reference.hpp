#pragma once

// The reference of an operator that says itself what it computes (`compute` of its lowering, by plain loops
// for any type of numbers): the loops run with numbers that carry a bound of their error and a deviation
// (running error analysis). Sums may then be taken in any order, since each rounding is taken for as large as
// all terms of a sum together.

#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/layer.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <support/layers/reference.hpp>
#include <vector>

namespace support {

/// A number with what is known of its error: the parts that came in and those of `roundings` in a row, each
/// of at most `size`, the sum of the magnitudes of all terms.
class tracked_number {
public:
    explicit tracked_number(double value = 0) : exact_{value, 0, 0}, size_(std::abs(value)) {}
    tracked_number(const bounded& exact, double roundoff)
        : exact_(exact), size_(std::abs(exact.value)), roundoff_(roundoff) {}

    [[nodiscard]] bounded result() const {
        return {exact_.value, exact_.error + own(), std::hypot(exact_.deviation, own_deviation())};
    }
    friend tracked_number operator+(const tracked_number& a, const tracked_number& b) {
        tracked_number sum = joined(a, b, a.exact_.value + b.exact_.value, a.size_ + b.size_);
        sum.roundings_ = std::max(a.roundings_, b.roundings_) + 1;
        sum.exact_.error = a.exact_.error + b.exact_.error;
        sum.exact_.deviation = a.exact_.deviation + b.exact_.deviation;
        return sum;
    }
    friend tracked_number operator*(const tracked_number& a, const tracked_number& b) {
        tracked_number product = joined(a, b, a.exact_.value * b.exact_.value, a.size_ * b.size_);
        product.roundings_ = a.roundings_ + b.roundings_ + 1;
        const double most_a = a.size_ + a.own(), most_b = b.size_ + b.own();
        product.exact_.error = a.exact_.error * (most_b + b.exact_.error) + b.exact_.error * most_a + lost;
        product.exact_.deviation = a.exact_.deviation * b.size_ + b.exact_.deviation * a.size_ + lost;
        return product;
    }
    friend tracked_number operator/(const tracked_number& a, const tracked_number& b) {
        const bounded over = a.result(), under = b.result();
        const double value = over.value / under.value, least = std::abs(under.value) - under.error,
                     magnitude = std::abs(value);
        tracked_number quotient = joined(a, b, value, magnitude);
        quotient.exact_.error = (over.error + magnitude * under.error) / std::max(least, 0.0) + lost;
        quotient.exact_.deviation =
            (over.deviation + magnitude * under.deviation) / std::abs(under.value) + lost;
        return quotient;
    }
    friend tracked_number sqrt(const tracked_number& a) {
        const bounded of = a.result();
        const double value = std::sqrt(of.value);
        tracked_number root = joined(a, a, value, value);
        root.exact_.error = value - std::sqrt(std::max(of.value - of.error, 0.0));
        root.exact_.deviation = value > 0 ? of.deviation / value / 2 : 0;
        return root;
    }

private:
    /// Rounded once.
    static tracked_number joined(const tracked_number& a, const tracked_number& b, double value,
                                 double size) {
        tracked_number result(value);
        result.size_ = size, result.roundings_ = 1, result.roundoff_ = std::max(a.roundoff_, b.roundoff_);
        return result;
    }
    [[nodiscard]] double own() const { return accumulated(roundoff_, roundings_) * size_; }
    [[nodiscard]] double own_deviation() const { return std::sqrt(roundings_) * roundoff_ * size_; }

    bounded exact_; ///< and the error that came in
    double size_, roundings_ = 0, roundoff_ = 0;
};

template <class Spec>
class plain_reference final : public reference_layer {
public:
    explicit plain_reference(extents3 in) : shape_{in.rows, in.columns, in.channels} {
        const tactnet::layer_costs costs = Spec::costs(shape_);
        input = in;
        output = {costs.output.channels, costs.output.rows, costs.output.columns};
        parameters = costs.parameters;
        multiply_adds = costs.multiply_adds, multiply_adds_on_pixels = costs.multiply_adds_on_pixels;
    }
    [[nodiscard]] bool compares_precisions() const override { return true; }
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override {
        std::vector<tracked_number> values, x(input.size()), y(output.size());
        for (const double value : call.values)
            values.emplace_back(bounded{value}, call.roundoff);
        samples out;
        for (const sample& each : in) {
            for (std::size_t e = 0; e < x.size(); ++e)
                x[e % input.area() * input.channels + e / input.area()] = {each[e], call.roundoff};
            tactnet::lowering<Spec>::compute(
                shape_, values.data(), tracked_number({call.epsilon}, call.roundoff), x.data(), y.data());
            out.emplace_back();
            for (std::size_t e = 0; e < y.size(); ++e)
                out.back().push_back(y[e % output.area() * output.channels + e / output.area()].result());
        }
        return out;
    }

private:
    tactnet::shape shape_;
};

} // namespace support

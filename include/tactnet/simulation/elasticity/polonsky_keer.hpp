#pragma once

#include <tactnet/kernels/map/symmetric_convolution.hpp>
#include <tactnet/simulation/contact/contact.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

// The contact of a shape with an elastic surface whose cells influence each other: pressures p ≥ 0 and gaps g
// ≥ 0, one of which is zero in each cell. Conjugate gradients on the cells in contact, which change as
// pressures fall to zero and gaps close (Polonsky and Keer, Wear 231, 1999, 206-219).

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// When the iteration stops.
struct contact_accuracy {
    /// The largest gap under pressure, or overlap without, as a fraction of the depth.
    double tolerance = 1e-6;
    std::size_t max_iterations = 500; ///< then the report says that it has not converged
};

/// The solver of all models whose cells influence each other. Allocates only when constructed.
template <shape Shape>
class polonsky_keer {
    using v = kernels::vector<double>;
    using convolution = kernels::symmetric_convolution<Shape>;
    using field = aligned_vector<double>;
    static constexpr std::size_t stride = convolution::stride, size = convolution::size;

public:
    /// `surface(rows, columns)` and `object(rows, columns)` are the deflections in metres of a cell that many
    /// cells away under 1 Pa on a cell, of the surface and of an object with E / (1 − ν²) = 1 Pa. `cell` is
    /// in metres.
    template <class Surface, class Object>
    polonsky_keer(const Surface& surface, const Object& object, double cell, contact_accuracy accuracy)
        : surface_(convolution_.spectrum_of(surface)),
          object_(convolution_.spectrum_of(object)),
          combined_(surface_),
          area_(cell * cell),
          self_influence_(surface(0, 0)),
          object_self_influence_(object(0, 0)),
          accuracy_(accuracy) {
        for (std::size_t y = 0; y < std::min<std::size_t>(Shape.rows, 5); ++y)
            for (std::size_t x = 0; x < std::min<std::size_t>(Shape.columns, 5); ++x)
                nearby_ += surface(y, x) * (y > 0 ? 2 : 1) * (x > 0 ? 2 : 1);
    }

    /// Presses an object with `heights` in metres, not finite where there is none, into the surface until
    /// `press` is reached, and writes the pressures in pascals. Force and pressures agree to the last digits;
    /// gaps are closed to the accuracy. The report says whether that was reached.
    contact_report solve(tensor_view<const float, Shape> heights, const pressing& press,
                         signal<Shape> pressures) noexcept {
        contact_report report;
        std::fill(pressures.elements().begin(), pressures.elements().end(), 0.0f);
        const bool touches = set_heights(heights), pressed = press.amount > 0;
        if (!touches || !pressed || !(press.amount < largest_amount)) {
            report.converged = !pressed; // no object, or an infinite amount
            return report;
        }
        set_object_softness(press.object_softness());
        guess(heights, press, pressures);
        iterate(press, report);
        for (std::size_t y = 0; y < Shape.rows; ++y)
            for (std::size_t x = 0; x < Shape.columns; ++x) {
                const double pressure = pressure_[y * stride + x];
                pressures(y, x) = static_cast<float>(pressure);
                report.force += pressure * area_;
                report.cells += pressure > 0 ? 1 : 0;
            }
        return report;
    }

private:
    /// The limit of forces and depths.
    static constexpr double largest_amount = std::numeric_limits<float>::max();
    /// A height above any depth, with which arithmetic does not overflow.
    static constexpr double no_object = 1e200;

    /// Calls body(i) for the first element i of each vector of a field.
    template <class Body>
    static void for_each_vector(const Body& body) {
        for (std::size_t i = 0; i < size; i += kernels::lanes<double>)
            body(i);
    }
    static v load(const field& from, std::size_t i) { return kernels::load(from.data() + i); }
    static void store(field& to, std::size_t i, const v& values) { kernels::store(to.data() + i, values); }
    static double total(const v& values) {
        alignas(vector_alignment) std::array<double, kernels::lanes<double>> all;
        kernels::store(all.data(), values);
        return std::accumulate(all.begin(), all.end(), 0.0);
    }
    static v where(const kernels::mask<double>& condition, const v& values) {
        return kernels::choose<double>(condition, values, v(0.0));
    }

    /// Stores heights above the lowest, `no_object` where there is none. Returns whether there is an object.
    bool set_heights(tensor_view<const float, Shape> heights) {
        constexpr float highest = std::numeric_limits<float>::max();
        float lowest = highest;
        for (const float height : heights.elements())
            lowest = height < lowest && height >= -highest ? height : lowest;
        for (std::size_t y = 0; y < Shape.rows; ++y)
            for (std::size_t x = 0; x < Shape.columns; ++x) {
                const float height = heights(y, x);
                heights_[y * stride + x] = height >= lowest && height < highest
                                               ? static_cast<double>(height) - static_cast<double>(lowest)
                                               : no_object;
            }
        return lowest < highest;
    }
    /// Sums the influences of surface and object into those of both.
    void set_object_softness(double object_softness) {
        softness_ = object_softness;
        for (std::size_t i = 0; softness_ > 0 && i < combined_.size(); i += kernels::lanes<double>)
            store(combined_, i,
                  kernels::multiply_add<double>(v(softness_), load(object_, i), load(surface_, i)));
    }
    void deflect(const field& pressures, field& result) {
        convolution_.convolve(softness_ > 0 ? combined_ : surface_, pressures.data(), result.data());
    }

    /// The initial guess: springs that yield as a patch of cells does.
    void guess(tensor_view<const float, Shape> heights, const pressing& press, signal<Shape> springs) {
        typename winkler::template bound<Shape>({.modulus = 1, .thickness = nearby_}, std::sqrt(area_))
            .solve(heights, {press.until, press.amount}, springs);
        for (std::size_t y = 0; y < Shape.rows; ++y)
            for (std::size_t x = 0; x < Shape.columns; ++x)
                pressure_[y * stride + x] = static_cast<double>(springs(y, x));
    }

    struct state {
        double level;   ///< depth of the lowest point
        double squares; ///< sum over the gaps in contact
        double worst;   ///< largest gap in contact or overlap elsewhere
    };

    void iterate(const pressing& press, contact_report& report) {
        const bool to_force = press.until == pressing::goal::force;
        const double pressure_sum = to_force ? press.amount / area_ : 0;
        if (to_force)
            scale_to(pressure_sum);
        deflect(pressure_, deflection_);
        double before = 0; // squares, or 0 to restart the search
        for (;;) {
            const state now = gaps(to_force ? level() : press.amount);
            report.depth = now.level;
            report.converged = now.worst <= accuracy_.tolerance * now.level;
            if (report.converged || report.iterations == accuracy_.max_iterations)
                return;
            ++report.iterations;
            update_direction(before > 0 ? now.squares / before : 0);
            deflect(direction_, response_);
            const double length = step_length();
            const moved change = move(length);
            const double factor = to_force ? scale_to(pressure_sum) : 1;
            if (change.cells_changed || !(factor > 0))
                deflect(pressure_, deflection_);
            else
                for_each_vector([&](std::size_t i) {
                    store(deflection_, i,
                          (load(deflection_, i) - v(length) * load(response_, i)) * v(factor));
                });
            before = change.grown ? 0 : now.squares;
        }
    }

    /// The level at which the mean gap in contact is zero.
    double level() const {
        v sum(0.0), count(0.0);
        for_each_vector([&](std::size_t i) {
            const auto contact = load(pressure_, i) > v(0.0);
            sum += where(contact, load(deflection_, i) + load(heights_, i));
            count += where(contact, v(1.0));
        });
        return total(sum) / total(count);
    }
    state gaps(double level) {
        v squares(0.0), worst(0.0);
        for_each_vector([&](std::size_t i) {
            const v gap = load(deflection_, i) + load(heights_, i) - v(level), overlap = v(0.0) - gap;
            const auto contact = load(pressure_, i) > v(0.0);
            store(gap_, i, gap);
            squares += where(contact, gap * gap);
            worst = kernels::maximum_keeping_nan<double>(
                worst, kernels::maximum_keeping_nan<double>(overlap, where(contact, gap)));
        });
        alignas(vector_alignment) std::array<double, kernels::lanes<double>> all;
        kernels::store(all.data(), worst);
        return {level, total(squares), *std::max_element(all.begin(), all.end())};
    }
    void update_direction(double share) {
        for_each_vector([&](std::size_t i) {
            const auto contact = load(pressure_, i) > v(0.0);
            store(
                direction_, i,
                where(contact, kernels::multiply_add<double>(v(share), load(direction_, i), load(gap_, i))));
        });
    }
    /// The length of the step along the direction that minimises the gaps. Polonsky and Keer subtract the
    /// mean of the response if the level is free; since gaps and steps have zero mean, it has no influence.
    /// If the length is undetermined, as for a contact of one cell, returns that of a cell alone.
    double step_length() const {
        v fall(0.0), rise(0.0);
        for_each_vector([&](std::size_t i) { // steps outside of the contact are zero
            fall += load(gap_, i) * load(direction_, i);
            rise += load(response_, i) * load(direction_, i);
        });
        const double length = total(fall) / total(rise);
        return length > 0 && std::isfinite(length)
                   ? length
                   : 1 / (self_influence_ + softness_ * object_self_influence_);
    }

    struct moved {
        bool cells_changed; ///< some cell lost or gained contact
        bool grown;         ///< some cell gained contact
    };
    moved move(double length) {
        v lost(0.0), gained(0.0);
        for_each_vector([&](std::size_t i) {
            const v pressure = load(pressure_, i), gap = load(gap_, i);
            const v next = pressure - v(length) * load(direction_, i);
            const auto contact = pressure > v(0.0), stays = next > v(0.0), overlaps = gap < v(0.0);
            const v start = where(overlaps, v(0.0) - v(length) * gap);
            store(pressure_, i, kernels::choose<double>(contact, where(stays, next), start));
            lost += kernels::choose<double>(contact, kernels::choose<double>(stays, v(0.0), v(1.0)), v(0.0));
            gained += kernels::choose<double>(contact, v(0.0), where(overlaps, v(1.0)));
        });
        const bool grown = total(gained) > 0;
        return {grown || total(lost) > 0, grown};
    }
    /// Scales the pressures so that their sum is `pressure_sum`, and returns the factor. If all are zero,
    /// puts the sum on the lowest point and returns 0.
    double scale_to(double pressure_sum) {
        v sum(0.0);
        for_each_vector([&](std::size_t i) { sum += load(pressure_, i); });
        const double factor = pressure_sum / total(sum);
        if (!(factor > 0) || !std::isfinite(factor)) {
            std::fill(pressure_.begin(), pressure_.end(), 0.0);
            const auto lowest = std::min_element(heights_.begin(), heights_.end());
            pressure_[static_cast<std::size_t>(lowest - heights_.begin())] = pressure_sum;
            return 0;
        }
        for_each_vector([&](std::size_t i) { store(pressure_, i, load(pressure_, i) * v(factor)); });
        return factor;
    }

    convolution convolution_;
    typename convolution::spectrum surface_, object_, combined_;
    // The padding between rows has no object and no pressure.
    field heights_ = field(size, no_object), pressure_ = field(size, 0.0), deflection_ = field(size, 0.0),
          gap_ = field(size, 0.0), direction_ = field(size, 0.0), response_ = field(size, 0.0);
    double area_, self_influence_, object_self_influence_, nearby_ = 0, softness_ = 0;
    contact_accuracy accuracy_;
};

}}} // namespace tactnet::simulation

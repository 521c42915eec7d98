#pragma once

#include <tactnet/decision/saved_state.hpp>
#include <tactnet/kernels/rows/weighted_rows.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A linear map from the features of a network to few dimensions, in which classes lie far apart and the
/// touches of a class close together: see fit_discriminant. Large: keep it in static memory or on the heap.
template <std::size_t Features, std::size_t Dimensions>
struct discriminant {
    using point = std::array<float, Dimensions>;

    std::array<float, Features * Dimensions> directions{}; ///< [feature][dimension]
    point offset{};

    /// Projects features as deployed_view::read_features gives them.
    [[nodiscard]] point project(std::span<const float, Features> features) const noexcept {
        point sums = offset;
        kernels::add_weighted_rows<Features, Dimensions>(features.data(), directions.data(), sums.data());
        return sums;
    }
};

/// The class whose mean is nearest, and how far it is.
struct nearest_class {
    std::size_t index = 0;
    double squared_distance = 0;
    /// Squared distance in units of the class's spread (class_means::spread): what to compare with a limit.
    double relative_distance = 0;
};

/// Recognises touches by the nearest class mean (Mensink et al., 2013). Learns a new class from a few
/// touches, without changing the mean of any other, and forgets one; both take less than a microsecond. The
/// distance to the nearest mean shows objects that belong to no class.
template <std::size_t Dimensions, std::size_t MostClasses>
class class_means {
public:
    using point = std::array<float, Dimensions>;

    /// Adds a touch to a class. Returns false, and learns nothing, if there is no room for such a class or
    /// the point is not finite.
    bool learn(std::size_t index, const point& touch) noexcept {
        if (index >= MostClasses || !is_finite(touch))
            return false;
        const double count = static_cast<double>(++touches_[index]);
        for (std::size_t d = 0; d < Dimensions; ++d) {
            const double before = static_cast<double>(touch[d]) - means_[d][index];
            means_[d][index] += before / count;
            squares_[index] += before * (static_cast<double>(touch[d]) - means_[d][index]);
        }
        set_average_spread();
        return true;
    }
    /// Forgets all touches of a class.
    void forget(std::size_t index) noexcept {
        if (index >= MostClasses)
            return;
        touches_[index] = 0;
        squares_[index] = 0;
        for (auto& coordinates : means_)
            coordinates[index] = 0;
        set_average_spread();
    }
    /// How many touches of a class have been learnt.
    [[nodiscard]] std::size_t touches(std::size_t index) const noexcept {
        return index < MostClasses ? touches_[index] : 0;
    }
    /// The mean squared distance of the touches of a class from their mean, shrunk towards the average of all
    /// classes, which counts as much as eight touches. 1 while no class has two touches that differ.
    [[nodiscard]] double spread(std::size_t index) const noexcept {
        constexpr double prior = 8;
        if (!(average_spread_ > 0) || index >= MostClasses)
            return 1;
        return (squares_[index] + prior * average_spread_) / (static_cast<double>(touches_[index]) + prior);
    }

    /// Returns the class with the nearest mean, of equally near ones the first. std::nullopt without classes,
    /// and for a point that is not finite.
    [[nodiscard]] std::optional<nearest_class> nearest(const point& touch) const noexcept {
        std::optional<nearest_class> found;
        if (!is_finite(touch))
            return found;
        std::array<double, MostClasses> squared{};
        for (std::size_t d = 0; d < Dimensions; ++d)
            for (std::size_t c = 0; c < MostClasses; ++c) {
                const double difference = static_cast<double>(touch[d]) - means_[d][c];
                squared[c] += difference * difference;
            }
        for (std::size_t c = 0; c < MostClasses; ++c)
            if (touches_[c] > 0 && (!found || squared[c] < found->squared_distance))
                found = nearest_class{c, squared[c]};
        if (found)
            found->relative_distance = found->squared_distance / spread(found->index);
        return found;
    }

    /// The bytes of a saved state.
    static constexpr std::size_t state_bytes =
        detail::state_header_bytes + MostClasses * (12 + 8 * Dimensions) + detail::state_checksum_bytes;
    /// Returns all classes, for after a restart.
    [[nodiscard]] std::array<std::byte, state_bytes> save() const noexcept {
        detail::state_writer<state_bytes> to(state_header);
        for (const std::uint32_t touches : touches_)
            to.put(touches);
        for (const auto& coordinates : means_)
            for (const double coordinate : coordinates)
                to.put(coordinate);
        for (const double squares : squares_)
            to.put(squares);
        return to.finish();
    }
    /// Takes what `save` returned, in place of what was learnt.
    [[nodiscard]] restore_status restore(std::span<const std::byte> state) noexcept {
        detail::state_reader from;
        if (const restore_status opened = from.open(state, state_bytes, state_header);
            opened != restore_status::ok)
            return opened;
        class_means found;
        for (std::uint32_t& touches : found.touches_)
            from.take(touches);
        for (auto& coordinates : found.means_)
            for (double& coordinate : coordinates) {
                from.take(coordinate);
                if (!(std::abs(coordinate) <= std::numeric_limits<float>::max()))
                    return restore_status::damaged;
            }
        for (double& squares : found.squares_) {
            from.take(squares);
            if (!(squares >= 0 && squares <= std::numeric_limits<double>::max()))
                return restore_status::damaged;
        }
        found.set_average_spread();
        *this = found;
        return restore_status::ok;
    }

private:
    static constexpr detail::state_header state_header{.kind = {'m', 'e', 'a', 'n'},
                                                       .sizes = {Dimensions, MostClasses}};
    static bool is_finite(const point& touch) noexcept {
        return std::all_of(touch.begin(), touch.end(),
                           [](float value) { return std::abs(value) <= std::numeric_limits<float>::max(); });
    }

    /// A single touch of a class says nothing about its spread.
    void set_average_spread() noexcept {
        double sum = 0, classes = 0;
        for (std::size_t c = 0; c < MostClasses; ++c)
            if (touches_[c] > 1) {
                sum += squares_[c] / static_cast<double>(touches_[c]);
                ++classes;
            }
        average_spread_ = classes > 0 ? sum / classes : 0;
    }

    std::array<std::array<double, MostClasses>, Dimensions> means_{}; ///< [dimension][class]
    std::array<double, MostClasses> squares_{}; ///< sums of squared distances from the mean
    double average_spread_ = 0;
    std::array<std::uint32_t, MostClasses> touches_{};
};

}} // namespace tactnet

#pragma once

#include <tactnet/kernels/rows/packed.hpp>
#include <tactnet/runtime/saved_state.hpp>

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

    /// The bytes of a saved map.
    static constexpr std::size_t state_bytes = detail::state_header_bytes +
                                               (Features + 1) * Dimensions * sizeof(float) +
                                               detail::state_checksum_bytes;
    /// Writes the map, for other programs.
    void save(std::span<std::byte, state_bytes> state) const noexcept {
        detail::state_writer to(state, state_header);
        visit(*this, [&](float number) { to.put(number); });
        to.finish();
    }
    /// Takes what `save` wrote, in place of this map.
    [[nodiscard]] restore_status restore(std::span<const std::byte> state) noexcept {
        return detail::restore_numbers(state, state_bytes, state_header, [&](const auto& visit) {
            this->visit(*this,
                        [&](float& number) { visit(number, double{std::numeric_limits<float>::max()}); });
        });
    }

private:
    static constexpr detail::state_header state_header{.kind = {'d', 's', 'c', 'r'},
                                                       .sizes = {Features, Dimensions}};
    template <class Self, class Visit>
    static void visit(Self& self, const Visit& visit) noexcept {
        for (auto& number : self.directions)
            visit(number);
        for (auto& number : self.offset)
            visit(number);
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

    /// Adds a touch to a class. Returns false, and learns nothing, if there is no room for such a class, the
    /// class has 2³² − 1 touches, or the point is not finite.
    bool learn(std::size_t index, const point& touch) noexcept {
        if (index >= MostClasses || touches_[index] == std::numeric_limits<std::uint32_t>::max() ||
            !is_finite(touch))
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
        // By blocks of classes: the stack may have no room for all distances.
        constexpr std::size_t block = std::min<std::size_t>(MostClasses, 64);
        for (std::size_t first = 0; first < MostClasses; first += block) {
            const std::size_t count = std::min(block, MostClasses - first);
            std::array<double, block> squared{};
            for (std::size_t d = 0; d < Dimensions; ++d)
                for (std::size_t c = 0; c < count; ++c) {
                    const double difference = static_cast<double>(touch[d]) - means_[d][first + c];
                    squared[c] += difference * difference;
                }
            for (std::size_t c = 0; c < count; ++c)
                if (touches_[first + c] > 0 && (!found || squared[c] < found->squared_distance))
                    found = nearest_class{first + c, squared[c]};
        }
        if (found)
            found->relative_distance = found->squared_distance / spread(found->index);
        return found;
    }

    /// The bytes of a saved state.
    static constexpr std::size_t state_bytes =
        detail::state_header_bytes + MostClasses * (12 + 8 * Dimensions) + detail::state_checksum_bytes;
    /// Writes all classes, for after a restart.
    void save(std::span<std::byte, state_bytes> state) const noexcept {
        detail::state_writer to(state, state_header);
        visit(*this, [&](auto number) { to.put(number); });
        to.finish();
    }
    /// Returns them, if they are few enough for the stack.
    [[nodiscard]] std::array<std::byte, state_bytes> save() const noexcept
        requires(state_bytes <= 1U << 20U)
    {
        std::array<std::byte, state_bytes> state;
        save(state);
        return state;
    }
    /// Takes what `save` returned, in place of what was learnt.
    [[nodiscard]] restore_status restore(std::span<const std::byte> state) noexcept {
        detail::state_reader from;
        if (const restore_status opened = from.open(state, state_bytes, state_header);
            opened != restore_status::ok)
            return opened;
        // What is learnt is large, and stays unless all numbers are those of means: they are read twice.
        detail::state_reader ahead = from, touches = from;
        std::uint32_t count = 0;
        double number = 0;
        for (std::size_t c = 0; c < MostClasses; ++c)
            ahead.read(count);
        bool possible = true;
        for (std::size_t row = 0; row <= Dimensions; ++row) { // the last one holds the sums of squares
            touches = from;
            for (std::size_t c = 0; c < MostClasses; ++c) {
                ahead.read(number);
                touches.read(count);
                possible &=
                    row < Dimensions ? is_possible_mean(number, count) : are_possible_squares(number, count);
            }
        }
        if (!possible)
            return restore_status::damaged;
        visit(*this, [&](auto& each) { from.read(each); });
        set_average_spread();
        return restore_status::ok;
    }

private:
    static constexpr detail::state_header state_header{.kind = {'m', 'e', 'a', 'n'},
                                                       .sizes = {Dimensions, MostClasses}};
    static bool is_finite(const point& touch) noexcept {
        return std::all_of(touch.begin(), touch.end(), [](float value) { return std::isfinite(value); });
    }
    /// Calls visit(number) for each number, in the order of their bytes.
    template <class Self, class Visit>
    static void visit(Self& self, const Visit& visit) noexcept {
        for (auto& touches : self.touches_)
            visit(touches);
        for (auto& coordinates : self.means_)
            for (auto& coordinate : coordinates)
                visit(coordinate);
        for (auto& squares : self.squares_)
            visit(squares);
    }
    static bool is_possible_mean(double mean, std::uint32_t touches) noexcept {
        return std::abs(mean) <= (touches > 0 ? double{std::numeric_limits<float>::max()} : 0.0);
    }
    /// If touches differ, their smallest square is near 2⁻⁴⁰⁴, the largest that of half the range of
    /// float.
    static bool are_possible_squares(double squares, std::uint32_t touches) noexcept {
        constexpr double most = double{std::numeric_limits<float>::max()};
        return squares == 0 || (touches > 1 && squares >= 0x1p-500 &&
                                squares <= 2 * most * most * static_cast<double>(Dimensions) * touches);
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

#pragma once

#include <tactnet/decision/bordered_frame.hpp>
#include <tactnet/decision/saved_state.hpp>
#include <tactnet/decision/tactel_fault.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// The faulty tactels of an array, and what their counts are replaced by.
template <shape Array>
class fault_list {
    using grid = bordered_frame<Array>;

public:
    /// Tactels that can be faulty at the same time.
    static constexpr std::size_t most = Array.size() / 8;
    /// A count that a stuck tactel is not below, and a dead one not above.
    static constexpr std::uint8_t healthy_count = 10;

    [[nodiscard]] std::span<const tactel_fault> all() const noexcept {
        return std::span(faults_).first(count_);
    }
    /// Whether there was one more than can be replaced.
    [[nodiscard]] bool overflowed() const noexcept { return overflowed_; }
    [[nodiscard]] bool contains(std::size_t row, std::size_t column) const noexcept {
        return faulty_[row * grid::stride + column] != 0;
    }

    void add(const tactel_fault& fault) noexcept {
        if (count_ == most) {
            overflowed_ = true;
            return;
        }
        sound_frames_[count_] = 0;
        faults_[count_++] = fault;
        faulty_[fault.row * grid::stride + fault.column] = 1;
        plan_replacements();
    }

    /// Replaces the counts of faulty tactels by the mean of their sound neighbours. Removes those that have
    /// been seen to work in `enough` frames, and calls recovered(fault) for them.
    template <class Recovered>
    void replace(grid& counts, const fault_limits& limits, std::uint8_t enough,
                 const Recovered& recovered) noexcept {
        bool any = false;
        for (std::size_t f = 0; f < count_; ++f) {
            std::uint8_t& count = counts.counts[replacements_[f].place()];
            const std::uint8_t mean = replacements_[f].of(counts);
            const bool dead = faults_[f].kind == tactel_fault_kind::dead;
            const bool works = dead ? count > healthy_count : count < healthy_count;
            const bool fails = dead ? mean >= limits.pressed : count >= limits.spike && mean < count / 8;
            if (works)
                any = ++sound_frames_[f] >= enough || any;
            else if (fails)
                sound_frames_[f] = 0;
            count = mean;
        }
        if (any)
            remove_recovered(enough, recovered);
    }

    template <class Writer>
    void save(Writer& to) const noexcept {
        to.put(static_cast<std::uint8_t>(overflowed_));
        to.put(static_cast<std::uint32_t>(count_));
        for (const tactel_fault& fault : faults_) { // also those that are none, so that the size is constant
            to.put(fault.row), to.put(fault.column);
            to.put(static_cast<std::uint8_t>(fault.kind)), to.put(fault.since);
        }
    }
    static constexpr std::size_t state_bytes = 5 + 13 * most;
    /// Into an empty list. False for numbers that no list has.
    [[nodiscard]] bool restore(state_reader& from) noexcept {
        std::uint8_t overflowed = 0, kind = 0;
        std::uint32_t count = 0;
        from.take(overflowed), from.take(count);
        if (overflowed > 1 || count > most)
            return false;
        for (tactel_fault fault; count_ < count;) {
            from.take(fault.row), from.take(fault.column), from.take(kind), from.take(fault.since);
            if (fault.row >= Array.rows || fault.column >= Array.columns || kind > 1 ||
                contains(fault.row, fault.column))
                return false;
            fault.kind = static_cast<tactel_fault_kind>(kind);
            faulty_[fault.row * grid::stride + fault.column] = 1;
            faults_[count_++] = fault;
        }
        overflowed_ = overflowed != 0;
        plan_replacements();
        return true;
    }

private:
    template <class Recovered>
    void remove_recovered(std::uint8_t enough, const Recovered& recovered) noexcept {
        std::size_t kept = 0;
        for (std::size_t f = 0; f < count_; ++f) {
            const tactel_fault fault = faults_[f];
            if (sound_frames_[f] >= enough) {
                faulty_[fault.row * grid::stride + fault.column] = 0;
                recovered(fault);
                continue;
            }
            sound_frames_[kept] = sound_frames_[f];
            faults_[kept++] = fault;
        }
        count_ = kept;
        overflowed_ = false;
        plan_replacements();
    }
    void plan_replacements() noexcept {
        for (std::size_t f = 0; f < count_; ++f)
            replacements_[f] =
                neighbour_mean<Array>(faults_[f].row, faults_[f].column,
                                      [&](std::size_t y, std::size_t x) { return contains(y, x); });
    }

    std::size_t count_ = 0;
    bool overflowed_ = false;
    std::array<std::uint8_t, grid::span> faulty_{};
    std::array<tactel_fault, most> faults_{};
    std::array<std::uint8_t, most> sound_frames_{};
    std::array<neighbour_mean<Array>, most> replacements_{};
};

}}} // namespace tactnet::detail

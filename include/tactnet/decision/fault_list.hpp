#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/frame/suspects.hpp>
#include <tactnet/kernels/frame/tactels.hpp>
#include <tactnet/runtime/saved_state.hpp>
#include <tactnet/tensor/shape.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// A frame of counts, row after row, with zeros before and after it: kernels read around each tactel. Counts
/// are of 8 bits, or 1/256 of these in 16.
template <shape Array, class Count = std::uint8_t>
struct padded_frame {
    static_assert(Array.channels == 1, "padded_frame: an array of tactels has one channel");
    /// The tactels, in whole vectors.
    static constexpr std::size_t span = kernels::whole_count_vectors(Array.size());
    static constexpr std::size_t first = round_up(Array.columns + 1, vector_alignment);

    alignas(vector_alignment) std::array<Count, first + span + Array.columns + 1> counts{};

    [[nodiscard]] Count* tactels() noexcept { return counts.data() + first; }
    [[nodiscard]] const Count* tactels() const noexcept { return counts.data() + first; }
};

/// The mean of some neighbours of a tactel, in place of its own count.
template <shape Array, class Count = std::uint8_t>
class neighbour_mean {
    static constexpr Count all = static_cast<Count>(-1);

public:
    neighbour_mean() = default;
    /// Leaves out neighbours beyond the array and those with `left_out(place)`.
    template <class LeftOut>
    neighbour_mean(std::size_t place, const LeftOut& left_out) noexcept
        : place_(static_cast<std::uint16_t>(place)) {
        std::uint32_t count = 0;
        for (std::size_t n = 0; n < 8; ++n) {
            const std::size_t neighbour = kernels::neighbour_place<Array.rows, Array.columns>(place, n);
            if (neighbour >= Array.size() || left_out(neighbour))
                continue;
            mask_[n] = all;
            ++count;
        }
        reciprocal_ = static_cast<std::uint16_t>(count > 0 ? (0xFFFFU + count / 2) / count : 0);
    }

    [[nodiscard]] std::size_t place() const noexcept { return place_; }
    /// The rounded mean; 0 if there is no neighbour.
    [[nodiscard]] Count of(const padded_frame<Array, Count>& frame) const noexcept {
        const Count* const own = frame.tactels() + place_;
        std::conditional_t<sizeof(Count) == 1, std::uint32_t, std::uint64_t> sum = 0;
        for (std::size_t n = 0; n < 8; ++n)
            sum += static_cast<std::uint32_t>(own[kernels::neighbour_distances<Array.columns>[n]] & mask_[n]);
        return static_cast<Count>((sum * reciprocal_ + 0x8000U) >> 16U);
    }

private:
    static_assert(Array.size() <= 0x10000, "neighbour_mean: at most 65536 tactels");
    std::uint16_t place_ = 0, reciprocal_ = 0;
    std::array<Count, 8> mask_{}; ///< all bits for a neighbour that counts, else 0
};

}}} // namespace tactnet::detail

// How tactels are judged, the list of those that fail, and what their counts are replaced by.

namespace tactnet { inline namespace TACTNET_ARCH {

/// How a tactel fails: it shows pressure where there is none, or none where there is pressure, or the sensor
/// itself marks it as broken.
enum class tactel_fault_kind : std::uint8_t { stuck, dead, broken };
/// "stuck", "dead" or "broken".
[[nodiscard]] constexpr std::string_view name_of(tactel_fault_kind kind) noexcept {
    constexpr std::array<std::string_view, 3> names{"stuck", "dead", "broken"};
    return names[static_cast<std::size_t>(kind)];
}

/// A faulty tactel.
struct tactel_fault {
    std::uint16_t row = 0, column = 0;
    tactel_fault_kind kind{};
    std::uint64_t since = 0; ///< the frame in which it was found, counted from 0
};

/// When a frame shows that a tactel may be faulty. A spike is far above nearly all of its eight neighbours, a
/// hole has no pressure amid pressed neighbours. None of the 1100 images of Gandarias et al. (2019) has a
/// tactel within the default limits, since elastic skin and the layers above the tactels blur every edge. The
/// fewer tactels an array has, the sharper are edges from one to the next: what is empty follows from the
/// array, and is stricter below 1000 tactels.
struct fault_limits {
    std::uint8_t spike = 100;  ///< the smallest count of a spike
    std::uint8_t hole = 2;     ///< the largest count of a hole
    std::uint8_t pressed = 60; ///< the smallest count of a pressed neighbour of a hole
    /// How many neighbours are low or pressed. With 6, the default from 1000 tactels on, parts of rows and
    /// columns are found; with 7, the default of smaller arrays, pairs of tactels and whole rows and columns.
    std::optional<std::uint8_t> neighbours{};
    /// A tactel is a spike if it exceeds its low neighbours by this factor, at least 8. By default 8, or 16
    /// below 1000 tactels.
    std::optional<std::uint8_t> ratio{};
};

/// How sensor_health judges tactels.
struct health_settings {
    fault_limits limits{};
    /// Frames with a spike or a hole that make a tactel faulty, from 1 to 127. A frame between them in which
    /// the tactel is seen to work starts the count again.
    std::uint8_t frames_to_fault = 16;
    /// Frames in which a faulty tactel is seen to work, from 1 to 255, after which it is used again. A frame
    /// between them in which it fails starts the count again.
    std::uint8_t frames_to_recovery = 200;
    /// A tactel whose counts of air are larger is stuck.
    std::uint8_t largest_baseline = 64;
    /// By how much the baseline follows a frame of air, in 1/256 count. The default is 0.4 counts per second
    /// at 100 frames per second.
    std::uint8_t follow = 1;
    /// Counts above the baseline from which a tactel is pressed, and not followed: a touch too small to be
    /// felt must not become the baseline. 255 follows at any distance.
    std::uint8_t pressed = 8;
    /// A touch leaves at least one in so many tactels free, from 2: the offset of all tactels is followed by
    /// these. Empty: 4, or 8 below 1000 tactels.
    std::optional<std::uint8_t> one_free_in{};
};

namespace detail {

/// The faulty tactels of an array, and what their counts are replaced by.
template <shape Array, class Count = std::uint8_t>
class fault_list {
public:
    /// Tactels that can be faulty at the same time.
    static constexpr std::size_t most = Array.size() / 8;
    /// A count that a stuck tactel is not below, and a dead one not above.
    static constexpr Count healthy_count = sizeof(Count) == 1 ? 10 : 10 * 256;

    [[nodiscard]] std::span<const tactel_fault> all() const noexcept {
        return std::span(faults_).first(count_);
    }
    /// Whether there was one more than can be replaced.
    [[nodiscard]] bool overflowed() const noexcept { return overflowed_; }
    /// `place` counts tactels row by row.
    [[nodiscard]] bool contains(std::size_t place) const noexcept { return faulty_[place]; }
    [[nodiscard]] static std::size_t place_of(const tactel_fault& fault) noexcept {
        return fault.row * Array.columns + fault.column;
    }

    void add(const tactel_fault& fault) noexcept {
        if (count_ == most) {
            overflowed_ = true;
            return;
        }
        sound_frames_[count_] = 0;
        faults_[count_++] = fault;
        faulty_[place_of(fault)] = true;
        plan_replacements();
    }

    /// Replaces the counts of faulty tactels by the mean of their sound neighbours. Removes those that have
    /// been seen to work in `enough` frames, and calls recovered(fault) for them. A tactel with marked(place)
    /// does not work.
    template <class Marked, class Recovered>
    void replace(padded_frame<Array, Count>& frame, const kernels::basic_sign_limits<Count>& limits,
                 std::uint8_t enough, const Marked& marked, const Recovered& recovered) noexcept {
        bool any = false;
        for (std::size_t f = 0; f < count_; ++f) {
            Count& count = frame.tactels()[replacements_[f].place()];
            const Count mean = replacements_[f].of(frame);
            const tactel_fault_kind kind = faults_[f].kind;
            const bool dead = kind == tactel_fault_kind::dead, broken = marked(replacements_[f].place());
            const bool works = dead ? count > healthy_count : count < healthy_count;
            const bool fails = dead ? mean >= limits.pressed : count >= limits.spike && mean < count / 8;
            if (broken)
                sound_frames_[f] = 0;
            else if (works || kind == tactel_fault_kind::broken)
                any = ++sound_frames_[f] >= enough || any;
            else if (fails)
                sound_frames_[f] = 0;
            count = mean;
        }
        if (any)
            remove_recovered(enough, recovered);
    }

    void save(state_writer& to) const noexcept {
        to.put(static_cast<std::uint8_t>(overflowed_));
        to.put(static_cast<std::uint32_t>(count_));
        for (const tactel_fault& fault : faults_) { // also those that are none, so that the size is constant
            to.put(fault.row), to.put(fault.column);
            to.put(static_cast<std::uint8_t>(fault.kind)), to.put(fault.since);
        }
    }
    static constexpr std::size_t state_bytes = 5 + 13 * most;
    /// Into an empty list, after `frames` frames. False for numbers that no list has.
    [[nodiscard]] bool restore(state_reader& from, std::uint64_t frames) noexcept {
        // 8-bit counts have no mark of a broken tactel.
        constexpr std::uint8_t most_kind = sizeof(Count) == 1 ? 1 : 2;
        std::uint8_t overflowed = 0, kind = 0;
        std::uint32_t count = 0;
        from.read(overflowed), from.read(count);
        if (overflowed > 1 || count > most || (overflowed == 1 && count < most))
            return false;
        for (tactel_fault fault; count_ < count;) {
            from.read(fault.row), from.read(fault.column), from.read(kind), from.read(fault.since);
            if (fault.row >= Array.rows || fault.column >= Array.columns || kind > most_kind ||
                fault.since > frames || contains(place_of(fault)))
                return false;
            fault.kind = static_cast<tactel_fault_kind>(kind);
            faulty_[place_of(fault)] = true;
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
                faulty_[place_of(fault)] = false;
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
            replacements_[f] = neighbour_mean<Array, Count>(
                place_of(faults_[f]), [&](std::size_t neighbour) { return contains(neighbour); });
    }

    std::size_t count_ = 0;
    bool overflowed_ = false;
    std::array<bool, Array.size()> faulty_{};
    std::array<tactel_fault, most> faults_{};
    std::array<std::uint8_t, most> sound_frames_{};
    std::array<neighbour_mean<Array, Count>, most> replacements_{};
};

} // namespace detail

}} // namespace tactnet

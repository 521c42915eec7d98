#pragma once

#include <tactnet/decision/fault_list.hpp>
#include <tactnet/decision/gain_monitor.hpp>
#include <tactnet/kernels/frame/suspects.hpp>
#include <tactnet/kernels/frame/tactels.hpp>
#include <tactnet/runtime/saved_state.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>

// From the frames of a sensor that ages to frames like those that a network was trained on. Nothing here uses
// the heap or throws.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Learns the counts of air of each tactel, subtracts them, finds stuck and dead tactels, and replaces their
/// counts by the mean of their sound neighbours.
///
///     sensor_health<shape{28, 50}> health;
///     for (…) health.learn(frame_of_air);
///     const auto clean = health.clean(frame);      // for each frame, for the network
///     if (!contact) health.follow(frame);          // once it is known that nothing touches the array
///
/// `Count` is the element of clean frames. With std::uint8_t, frames are 8-bit counts and stay so. With
/// float, frames are counts of any depth (std::uint8_t, std::uint16_t, float), clean frames have the scale of
/// 8 bits with fractions, and counts that mark broken tactels are reported as faults at once and replaced:
///
///     sensor_health<shape{16, 16}, float> health({.full = 4095});
template <shape Array, class Count = std::uint8_t>
class sensor_health {
    static_assert(std::is_same_v<Count, std::uint8_t> || std::is_same_v<Count, float>,
                  "sensor_health: clean frames are of std::uint8_t, or of float for counts of any depth");
    static constexpr std::size_t size = Array.size();
    static constexpr bool deep = std::is_same_v<Count, float>;
    /// A count within: of 8 bits, or 1/256 of it, as baselines have.
    using level = std::conditional_t<deep, std::uint16_t, std::uint8_t>;
    static constexpr level unit = deep ? 256 : 1;
    static constexpr std::uint16_t levels_per_count = 256 / unit;
    using faults_of_array = detail::fault_list<Array, level>;
    /// A number for each tactel, in whole vectors.
    template <class T>
    using per_tactel = std::array<T, detail::padded_frame<Array>::span>;

public:
    /// What the sensor gives.
    using frame = std::conditional_t<deep, raw_counts<Array>, std::span<const std::uint8_t, size>>;
    using clean_frame = std::span<const Count, size>;
    /// Tactels that can be faulty at the same time; an array with more is worn out.
    static constexpr std::size_t max_faults = faults_of_array::most;

    explicit sensor_health(const health_settings& settings = {}) noexcept
        requires(!deep)
        : sensor_health(count_scale{}, settings, 0) {}
    explicit sensor_health(const count_scale& scale, const health_settings& settings = {}) noexcept
        requires(deep)
        : sensor_health(scale, settings, 0) {}

    /// Takes a frame of air into the baseline: the mean of all frames since the last call of `forget`. A
    /// tactel above largest_baseline is stuck.
    void learn(frame air) noexcept {
        const level* const counts = take(air);
        learnt_ = std::min(learnt_ + 1, most_learnt);
        for (std::size_t i = 0; i < size; ++i) {
            const auto target = static_cast<std::int32_t>(counts[i]) * levels_per_count;
            const auto mean = static_cast<std::int32_t>(level_[i]);
            const auto step = (target - mean) / static_cast<std::int32_t>(learnt_);
            level_[i] = static_cast<std::uint16_t>(mean + step);
        }
        for (std::size_t i = 0; i < size; ++i)
            if (level_[i] >= stuck_level() && !faults_.contains(i))
                add_fault(i, tactel_fault_kind::stuck);
        set_baseline();
    }
    /// Forgets baseline and faults.
    void forget() noexcept { *this = fresh(); }

    /// Moves the baseline towards a frame of air by `follow`, whatever the distance (a sigma-delta filter:
    /// Manzanera and Richefeu, "A new motion detection algorithm based on Σ-Δ background estimation", 2007),
    /// but leaves tactels as they are that are `pressed`.
    void follow(frame air) noexcept {
        const level* const counts = take(air);
        const auto pressed = static_cast<std::uint16_t>(
            settings_.pressed < 255 ? std::min(255, settings_.pressed + offset_) * 256 : 0xFFFF);
        kernels::follow_levels<size>(counts, settings_.follow, pressed, stuck_level(), level_.data(),
                                     baseline_.data());
    }

    /// Returns a frame as it would be without offsets and faults. The result is valid until the next call.
    clean_frame clean(frame raw) noexcept {
        subtract_baseline(take(raw));
        if (!faults().empty())
            replace_faulty();
        const bool any = find_suspects();
        if (any || watching_)
            count_signs();
        if (any)
            replace_suspects();
        frames_ += frames_ < std::numeric_limits<std::uint64_t>::max(); // or faults would be of the future
        if constexpr (deep) {
            for (std::size_t i = 0; i < size; ++i)
                deep_.clean[i] = static_cast<float>(clean_.tactels()[i]) / unit;
            return deep_.clean;
        } else {
            return clean_frame(clean_.tactels(), size);
        }
    }

    /// All faulty tactels, in the order in which they were found.
    [[nodiscard]] std::span<const tactel_fault> faults() const noexcept { return faults_.all(); }
    /// Whether at least `share` of the tactels of a row are faulty, as when its conductor is broken.
    [[nodiscard]] bool row_is_faulty(std::size_t row, double share = 0.5) const noexcept {
        const auto in_row = std::count_if(faults().begin(), faults().end(),
                                          [&](const tactel_fault& fault) { return fault.row == row; });
        return static_cast<double>(in_row) >= share * static_cast<double>(Array.columns);
    }
    [[nodiscard]] bool column_is_faulty(std::size_t column, double share = 0.5) const noexcept {
        const auto in_column =
            std::count_if(faults().begin(), faults().end(),
                          [&](const tactel_fault& fault) { return fault.column == column; });
        return static_cast<double>(in_column) >= share * static_cast<double>(Array.rows);
    }
    /// Whether more tactels are faulty than can be replaced.
    [[nodiscard]] bool worn_out() const noexcept { return faults_.overflowed(); }
    /// The mean baseline, in counts: the offset of the array.
    [[nodiscard]] double mean_baseline() const noexcept {
        std::uint64_t sum = 0;
        for (const std::uint16_t each : level_)
            sum += each;
        return offset_ + static_cast<double>(sum) / 256 / static_cast<double>(size);
    }
    /// How many frames `clean` has taken.
    [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }

    /// The bytes of a saved state.
    static constexpr std::size_t state_bytes = detail::state_header_bytes + 13 + 2 * size +
                                               faults_of_array::state_bytes + detail::state_checksum_bytes;
    /// Returns baseline, offset and faults, for after a restart; signs of the latest frames are left out.
    [[nodiscard]] std::array<std::byte, state_bytes> save() const noexcept {
        std::array<std::byte, state_bytes> state;
        detail::state_writer to(state, state_header);
        to.put(learnt_), to.put(frames_), to.put(offset_);
        for (const std::uint16_t each : level_)
            to.put(each);
        faults_.save(to);
        to.finish();
        return state;
    }
    /// Takes what `save` returned, in place of what was learnt. Settings stay.
    [[nodiscard]] restore_status restore(std::span<const std::byte> state) noexcept {
        detail::state_reader from;
        if (const restore_status opened = from.open(state, state_bytes, state_header);
            opened != restore_status::ok)
            return opened;
        sensor_health found = fresh();
        from.read(found.learnt_), from.read(found.frames_), from.read(found.offset_);
        bool possible = found.learnt_ <= most_learnt;
        for (std::uint16_t& each : found.level_) {
            from.read(each);
            possible &= each <= (deep ? 0xFFFF : 255 * 256);
        }
        if (!possible || !found.faults_.restore(from, found.frames_))
            return restore_status::damaged;
        found.set_baseline();
        *this = found;
        return restore_status::ok;
    }

private:
    struct deep_frames { ///< a raw frame in levels, and a clean one in counts
        count_scale scale;
        std::array<std::uint16_t, size> raw{};
        std::array<float, size> clean{};
    };
    struct no_frames {};

    sensor_health(const count_scale& scale, const health_settings& settings, int /*either*/) noexcept
        : settings_(settings),
          limits_{.spike = static_cast<level>(settings.limits.spike * unit),
                  .hole = static_cast<level>(settings.limits.hole * unit),
                  .pressed = static_cast<level>(settings.limits.pressed * unit),
                  .neighbours = settings.limits.neighbours.value_or(is_fine ? 6 : 7),
                  .ratio = std::max<std::uint8_t>(settings.limits.ratio.value_or(is_fine ? 8 : 16), 8)},
          one_free_in_(std::max<std::uint8_t>(settings.one_free_in.value_or(is_fine ? 4 : 8), 2)) {
        if constexpr (deep)
            deep_.scale = scale;
    }
    [[nodiscard]] sensor_health fresh() const noexcept {
        if constexpr (deep)
            return sensor_health(deep_.scale, settings_);
        else
            return sensor_health(settings_);
    }
    /// The levels of a frame. Those that are marked as broken are faulty, and are as in air.
    [[nodiscard]] const level* take(frame raw) noexcept {
        if constexpr (!deep) {
            return raw.data();
        } else {
            if (raw.quantise(deep_.scale, deep_.raw.data(), signs_.data()))
                kernels::visit_nonzero(signs_.data(), size, [&](std::size_t i) {
                    deep_.raw[i] = level_[i];
                    if (!faults_.contains(i))
                        add_fault(i, tactel_fault_kind::broken);
                });
            return deep_.raw.data();
        }
    }

    static constexpr detail::state_header state_header{.kind = {'h', 'l', 't', deep ? '2' : 'h'},
                                                       .sizes = {Array.rows, Array.columns}};
    /// The baseline of a stuck tactel, in 1/256 count.
    [[nodiscard]] std::uint16_t stuck_level() const noexcept {
        return static_cast<std::uint16_t>(settings_.largest_baseline * 256);
    }
    /// A stuck tactel keeps its counts, to be seen when it moves again.
    void set_baseline() noexcept {
        for (std::size_t i = 0; i < size; ++i) {
            constexpr auto half = static_cast<std::uint16_t>(levels_per_count / 2);
            const auto rounded =
                static_cast<level>(static_cast<std::uint16_t>(level_[i] + half) / levels_per_count);
            baseline_[i] = level_[i] >= stuck_level() ? level{0} : rounded;
        }
    }
    void add_fault(std::size_t place, tactel_fault_kind kind) noexcept {
        faults_.add({static_cast<std::uint16_t>(place / Array.columns),
                     static_cast<std::uint16_t>(place % Array.columns), kind, frames_});
    }

    /// Also follows an offset that all tactels have in common, by one count per frame: the lowest quarter, or
    /// other `one_free_in`, is at the baseline.
    void subtract_baseline(const level* raw) noexcept {
        const std::uint8_t offset = offset_;
        const auto [at_most, below] =
            kernels::subtract_levels<size>(raw, baseline_.data(), offset, clean_.tactels());
        if (one_free_in_ * at_most < size)
            offset_ = static_cast<std::uint8_t>(offset + (offset < settings_.largest_baseline));
        else if (one_free_in_ * below >= size)
            offset_ = static_cast<std::uint8_t>(offset - (offset > 0));
    }

    [[nodiscard]] bool find_suspects() noexcept {
        return kernels::find_suspects<Array.rows, Array.columns>(clean_.tactels(), limits_, signs_.data());
    }

    /// Counts the frames that speak against each tactel.
    void count_signs() noexcept {
        // A tactel that is low is not stuck, one that is pressed is not dead.
        watching_ = false;
        kernels::visit_nonzero(suspect_frames_.data(), size, [&](std::size_t i) {
            const level count = clean_.tactels()[i];
            const bool dead = suspect_frames_[i] & dead_bit;
            if (signs_[i] == 0 && (dead ? count > healthy_count : count < healthy_count))
                suspect_frames_[i] = 0;
            watching_ = watching_ || suspect_frames_[i] != 0;
        });
        kernels::visit_nonzero(signs_.data(), size, [&](std::size_t i) {
            const std::uint8_t kind = signs_[i] == kernels::hole_sign ? dead_bit : std::uint8_t{0};
            const auto frames = static_cast<std::uint8_t>((suspect_frames_[i] & ~dead_bit) + 1);
            suspect_frames_[i] = static_cast<std::uint8_t>(std::min(frames, frames_to_fault()) | kind);
            watching_ = true;
            if (frames >= frames_to_fault() && !faults_.contains(i))
                add_fault(i, kind != 0 ? tactel_fault_kind::dead : tactel_fault_kind::stuck);
        });
    }
    [[nodiscard]] std::uint8_t frames_to_fault() const noexcept {
        return std::clamp<std::uint8_t>(settings_.frames_to_fault, 1, 127);
    }

    void replace_faulty() noexcept {
        const auto enough = std::max<std::uint8_t>(settings_.frames_to_recovery, 1);
        const auto is_marked = [this](std::size_t place) { return deep && signs_[place] != 0; };
        faults_.replace(clean_, limits_, enough, is_marked, [this](const tactel_fault& fault) {
            const std::size_t place = faults_of_array::place_of(fault);
            suspect_frames_[place] = 0;
            if (fault.kind == tactel_fault_kind::stuck) // what was learnt was not its count of air
                level_[place] = baseline_[place] = 0;
        });
    }

    /// Replaces counts that this frame alone shows to be wrong.
    void replace_suspects() noexcept {
        // What is replaced is never read: the order does not matter.
        kernels::visit_nonzero(signs_.data(), size, [&](std::size_t i) {
            clean_.tactels()[i] = detail::neighbour_mean<Array, level>(i, [&](std::size_t neighbour) {
                                      return signs_[neighbour] != 0 || faults_.contains(neighbour);
                                  }).of(clean_);
        });
    }

    static constexpr bool is_fine = size >= 1000;           ///< a touch spreads over many tactels
    static constexpr std::uint32_t most_learnt = 1U << 16U; ///< frames that the mean of the baseline counts
    static constexpr std::uint8_t dead_bit = 0x80; ///< of `suspect_frames_`, whose other bits count frames
    static constexpr level healthy_count = faults_of_array::healthy_count;

    health_settings settings_;
    kernels::basic_sign_limits<level> limits_;
    std::size_t one_free_in_;
    std::uint32_t learnt_ = 0;
    std::uint64_t frames_ = 0;
    bool watching_ = false;
    std::array<std::uint16_t, size> level_{}; ///< the baseline in 1/256 count
    /// Baselines in levels; signs, before that marks of broken tactels.
    per_tactel<level> baseline_{}, signs_{};
    per_tactel<std::uint8_t> suspect_frames_{};
    detail::padded_frame<Array, level> clean_{};
    [[no_unique_address]] std::conditional_t<deep, deep_frames, no_frames> deep_;
    std::uint8_t offset_ = 0; ///< of all tactels
    faults_of_array faults_;
};

}} // namespace tactnet

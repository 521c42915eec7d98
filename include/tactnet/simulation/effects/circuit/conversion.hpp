#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/simd/normal_numbers.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/simulation/effect.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// Independent normal noise per tactel and frame, of the standard deviation √(additive² + (relative ·
/// pressure)²). Readings may be negative before threshold and converter.
///
/// The noise depends on (moment.seed, moment.frame), and is bit-identical with every instruction set: as in
/// kernels/simd/normal_numbers.hpp, nothing is added to a rounded product.
struct noise {
    static constexpr stage place = stage::circuit;
    static constexpr effect_purpose purpose{2};

    /// Pascals; half a count of the paper's converter. Chosen: its images are single frames, which do not
    /// show how much the same touch varies.
    double additive = 67;
    /// Fraction of the pressure: the repeatability that the maker states for single sensors of the same kind
    /// (Tekscan, FlexiForce A201, data sheet: ±2.5 %), taken as a standard deviation.
    double relative = 0.025;

    template <shape Shape>
    class bound {
    public:
        /// Negative and NaN deviations count as zero.
        bound(const noise& effect, const mounting&) {
            const double fixed = kept(effect.additive, most), share = kept(effect.relative, max_relative);
            none_ = fixed == 0 && share == 0;
            variance_ = static_cast<float>(fixed * fixed);
            // For a division, which no compiler fuses with a sum.
            inverse_ =
                share > 0 ? static_cast<float>(1 / (share * share)) : std::numeric_limits<float>::infinity();
        }
        void apply(signal<Shape> pressures, const moment& now) const noexcept {
            if (none_)
                return;
            constexpr std::size_t group = kernels::normal_numbers::chunk_size;
            const kernels::normal_numbers random(now.random(purpose));
            alignas(vector_alignment) std::array<float, group> numbers, values{};
            for (std::size_t first = 0; first < Shape.size(); first += group) {
                float* const from = pressures.data() + first;
                const std::size_t count = std::min(group, Shape.size() - first);
                random.chunk(static_cast<std::uint32_t>(first / group), numbers.data());
                std::copy_n(from, count, values.begin());
                for (std::size_t i = 0; i < group; i += kernels::lanes<float>)
                    kernels::store<float>(values.data() + i, noisy(kernels::load(values.data() + i),
                                                                   kernels::load(numbers.data() + i)));
                std::copy_n(values.begin(), count, from);
            }
        }

    private:
        // Limits of deviations and pressures, so that no square overflows.
        static constexpr double most = 1e15, max_relative = 1e3;

        static double kept(double deviation, double limit) {
            return deviation > 0 ? std::min(deviation, limit) : 0;
        }

        [[nodiscard]] kernels::vector<float> noisy(const kernels::vector<float>& value,
                                                   const kernels::vector<float>& number) const {
            using v = kernels::vector<float>;
            const v large(static_cast<float>(most)), small(-static_cast<float>(most));
            const v size = kernels::choose<float>(value < large,
                                                  kernels::choose<float>(value > small, value, small), large);
            const v variance = v(variance_) + kernels::quotient<v>(size * size, v(inverse_));
            return value + kernels::quotient<v>(
                               number, kernels::square_root<float>(kernels::quotient(v(1), variance)));
        }

        bool none_;
        float variance_, inverse_;
    };
};

/// Sets pressures below the threshold to zero, as the electronics of tactile arrays do to suppress noise: the
/// paper's images are exactly zero away from the object.
struct threshold {
    static constexpr stage place = stage::circuit;

    /// Pascals; 0 or less is none. Chosen: two counts of the paper's converter, four deviations of the noise.
    double level = 267;

    template <shape Shape>
    class bound {
    public:
        bound(const threshold& effect, const mounting&)
            : level_(effect.level > 0 ? static_cast<float>(effect.level)
                                      : -std::numeric_limits<float>::infinity()) {}
        void apply(signal<Shape> pressures, const moment&) const noexcept {
            for (std::size_t i = 0; i < Shape.size(); ++i)
                pressures.data()[i] = pressures.data()[i] < level_ ? 0 : pressures.data()[i];
        }

    private:
        float level_;
    };
};

/// Clamps pressures at the limit of the circuit, by default that of the paper's sensor.
struct saturation {
    static constexpr stage place = stage::circuit;

    double limit = tekscan_6077::saturation_pressure; ///< pascals; infinite for none

    template <shape Shape>
    class bound {
    public:
        bound(const saturation& effect, const mounting&) : limit_(static_cast<float>(effect.limit)) {}
        void apply(signal<Shape> pressures, const moment&) const noexcept {
            for (std::size_t i = 0; i < Shape.size(); ++i)
                pressures.data()[i] = std::min(pressures.data()[i], limit_);
        }

    private:
        float limit_;
    };
};

/// The converter: pressures are rounded to counts and clamped to 0 … Levels − 1.
template <std::size_t Levels>
struct quantisation_levels {
    static_assert(Levels >= 2 && Levels <= 65536,
                  "quantisation: there must be 2 to 65536 levels, 1 to 16 bits");
    static constexpr stage place = stage::converter;

    double full_scale = tekscan_6077::saturation_pressure; ///< pascals at the last count

    template <shape Shape>
    class bound {
    public:
        bound(const quantisation_levels& effect, const mounting&)
            : scale_(static_cast<float>((Levels - 1) / effect.full_scale)) {}
        void apply(signal<Shape> values, const moment&) const noexcept {
            constexpr auto last = static_cast<float>(Levels - 1);
            for (std::size_t i = 0; i < Shape.size(); ++i) {
                const float scaled = values.data()[i] * scale_;
                const float kept = std::min(last, std::max(0.0f, scaled)); // NaN is 0
                values.data()[i] = std::floor(kept + 0.5f);
            }
        }

    private:
        float scale_;
    };
};

/// A converter of 1 to 16 bits, as quantisation<8>.
template <std::size_t Bits>
using quantisation = quantisation_levels<(std::size_t{1} << std::min(Bits, std::size_t{17}))>;

}}} // namespace tactnet::simulation

#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/simd/normal_numbers.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/simulation/effect.hpp>

#include <algorithm>
#include <array>
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

}}} // namespace tactnet::simulation

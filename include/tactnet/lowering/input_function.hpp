#pragma once

#include <tactnet/detail/arithmetic.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

/// How counts are compressed before their mean is subtracted, so that light contact weighs more. Each rule
/// maps 0 … 255 into 0 … 255, never decreases, and takes a negative count for 0.
enum class count_rule : unsigned char {
    identity,          ///< counts as they are
    square_root,       ///< √(255 x)
    logarithm,         ///< in proportion to log(1 + x ÷ knee): linear far below the knee
    relative_logarithm ///< the same of x ÷ the mean of the frame, so that a gain changes nothing
};
/// The rules by name, in their order, as in files and in the options of the program.
inline constexpr std::array<std::string_view, 4> count_rule_names{"identity", "root", "log", "relative-log"};

/// The input function of a network: a part of its normalisation, of one frame at a time. Results are whole
/// multiples of 2⁻¹⁰, computed in double and rounded: bytes and floats of the same counts give the same bits
/// on every machine, in training and deployed.
struct input_function {
    count_rule rule = count_rule::identity;
    float knee = 1; ///< counts, or multiples of the frame's mean; above 0

    [[nodiscard]] constexpr bool identity() const noexcept { return rule == count_rule::identity; }
    /// Whether the knee is a number with which results are finite.
    [[nodiscard]] constexpr bool valid() const noexcept { return knee >= 1e-3F && knee <= 1e6F; }

    /// Compresses the counts of one frame, in place. NaN and infinity become NaN. A frame without contact
    /// stays zero.
    void apply(std::span<float> frame) const noexcept {
        if (!identity())
            run(frame.data(), frame, [](const curve& f, std::span<float> counts) {
                for (float& count : counts)
                    count = f(count) + (count - count);
            });
    }
    /// Writes the compressed counts of one frame.
    void apply(const float* counts, std::span<float> to) const noexcept {
        std::copy_n(counts, to.size(), to.data());
        apply(to);
    }
    /// Writes the compressed counts of a frame of bytes, which a table of 256 values gives.
    void apply(const std::uint8_t* counts, std::span<float> to) const noexcept {
        if (identity()) {
            std::copy_n(counts, to.size(), to.data());
            return;
        }
        run(counts, to, [&](const curve& f, std::span<float> out) {
            std::array<float, 256> table;
            for (std::size_t count = 0; count < table.size(); ++count)
                table[count] = f(static_cast<float>(count));
            for (std::size_t e = 0; e < out.size(); ++e)
                out[e] = table[counts[e]];
        });
    }
    friend constexpr bool operator==(const input_function&, const input_function&) = default;

private:
    static constexpr double most = 255, steps = 1024; ///< of a count

    struct curve {
        bool root;
        double slope, gain;

        float operator()(float count) const noexcept {
            const double x = count > 0 ? static_cast<double>(count) : 0;
            const double y = root ? root_of(most * x) : gain * log_of_one_plus(slope * x);
            const double within = y < most ? y : most;
            return static_cast<float>(static_cast<std::int32_t>(within * steps + 0.5)) /
                   static_cast<float>(steps);
        }
    };

    template <class Count, class Body>
    void run(const Count* counts, std::span<float> frame, const Body& body) const noexcept {
        double unit = static_cast<double>(knee);
        if (rule == count_rule::relative_logarithm) {
            double sum = 0;
            for (std::size_t e = 0; e < frame.size(); ++e)
                sum += counts[e] > 0 ? static_cast<double>(counts[e]) : 0;
            unit *= sum / static_cast<double>(frame.size());
        }
        body(curve{.root = rule == count_rule::square_root,
                   .slope = unit > 0 ? 1 / unit : 0,
                   .gain = most / log_of_one_plus(most / static_cast<double>(knee))},
             frame);
    }
    /// √x for x ≥ 0 by Newton's method for 1 ÷ √x, since frames call nothing of C: four steps from an
    /// estimate within 4 % leave an error near one rounding.
    static double root_of(double x) noexcept {
        auto r = detail::bits_as<double>(0x5fe6eb50c7b537a9 - detail::bits_as<std::uint64_t>(x) / 2);
        for (int step = 0; step < 4; ++step)
            r *= 1.5 - 0.5 * x * r * r;
        return x * r;
    }
    /// log(1 + t) for t ≥ 0 within 10⁻¹⁰, in plain arithmetic, which compilers vectorise: 1 + t is 2ⁿ · m
    /// with m in [√½, √2), and log m a series of 2 artanh((m − 1) ÷ (m + 1)).
    static double log_of_one_plus(double t) noexcept {
        constexpr auto root_half = detail::bits_as<std::uint64_t>(0x1.6a09e667f3bcdp-1);
        const auto bits = detail::bits_as<std::uint64_t>(t + 1);
        const auto power = static_cast<std::int32_t>((bits - root_half) >> 52);
        const auto m = detail::bits_as<double>(bits - (static_cast<std::uint64_t>(power) << 52));
        const double s = (m - 1) / (m + 1), square = s * s;
        double series = 1.0 / 13;
        for (const double share : {1.0 / 11, 1.0 / 9, 1.0 / 7, 1.0 / 5, 1.0 / 3, 1.0})
            series = series * square + share;
        return power * std::numbers::ln2 + 2 * s * series;
    }
};

}} // namespace tactnet

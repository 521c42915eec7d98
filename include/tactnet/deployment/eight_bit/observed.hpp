#pragma once

#include <tactnet/deployment/eight_bit/folded_check.hpp>
#include <tactnet/deployment/eight_bit/steps.hpp>
#include <tactnet/deployment/steps.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

// The same network in two number formats, step beside step: what the maps of single precision hold gives the
// ranges of the maps of bytes.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace detail {

/// The smallest and the largest number that a map held.
struct map_extremes {
    float lowest = 0, highest = 0;

    template <class Step>
    void see(const float* map) {
        for (std::size_t pixel = 0; pixel < Step::output.area(); ++pixel)
            for (std::size_t c = 0; c < Step::output.channels; ++c) {
                const float value = map[pixel * Step::output_stride + c];
                lowest = std::min(lowest, value), highest = std::max(highest, value);
            }
    }
};

/// A step in both formats. `maps`: maps inside and behind it that have a range of their own; `run` looks at
/// them, `set_ranges` writes the ranges to folded numbers and returns the output's.
template <class Floats, class Bytes>
struct observed_step {
    static constexpr bool has_parameters = requires { Bytes::ranges; };
    /// Pools and ReLUs by themselves leave bytes as they are.
    static constexpr std::size_t maps = [] {
        if constexpr (requires { Bytes::writes_bytes; })
            return std::size_t{Bytes::writes_bytes};
        else if constexpr (has_parameters)
            return std::size_t{Bytes::ranges > 1};
        else
            return std::size_t{0};
    }();

    static void run(const float* packed, const float* in, float* out, float* memory, map_extremes* seen) {
        Floats::run(packed, in, out, memory);
        if constexpr (maps > 0) {
            if constexpr (fills_map<Floats>)
                seen->template see<Floats>(out);
        }
    }
    static map_range set_ranges(float* folded, map_range input, map_range added, const map_range* of_maps) {
        const map_range output = maps > 0 ? *of_maps : input;
        if constexpr (has_parameters)
            Bytes::set_ranges(folded, {input, added, output});
        return output;
    }
};

template <class... Floats, class... Bytes>
struct observed_step<step_chain<Floats...>, step_chain<Bytes...>> {
    using floats = step_chain<Floats...>;
    static constexpr std::size_t maps = (observed_step<Floats, Bytes>::maps + ...);

    static void run(const float* packed, const float* in, float* out, float* memory, map_extremes* seen) {
        float* const inner = memory + floats::buffers * floats::buffer;
        std::size_t step = 0;
        const auto one = [&]<class F, class B>(std::type_identity<observed_step<F, B>>) {
            float* const to = step + 1 == sizeof...(Floats) ? out : memory + step % 2 * floats::buffer;
            observed_step<F, B>::run(packed, in, to, inner, seen);
            packed += F::packed, seen += observed_step<F, B>::maps, in = to, ++step;
        };
        (one(std::type_identity<observed_step<Floats, Bytes>>{}), ...);
    }
    static map_range set_ranges(float* folded, map_range input, map_range added, const map_range* of_maps) {
        const auto one = [&]<class F, class B>(std::type_identity<observed_step<F, B>>) {
            // What a residual block adds to is known to the last step of its main branch.
            input = observed_step<F, B>::set_ranges(folded, input, added, of_maps);
            folded += B::folded, of_maps += observed_step<F, B>::maps;
        };
        (one(std::type_identity<observed_step<Floats, Bytes>>{}), ...);
        return input;
    }
};

template <>
struct observed_step<no_step, no_step> {
    static constexpr std::size_t maps = 0;
    static map_range set_ranges(float*, map_range input, map_range, const map_range*) { return input; }
};

template <class FloatMain, class FloatSkip, class ByteMain, class ByteSkip, std::size_t S, std::size_t T>
struct observed_step<residual_step<FloatMain, FloatSkip, S>, residual_step<ByteMain, ByteSkip, T>> {
    using floats = residual_step<FloatMain, FloatSkip, S>;
    using main = observed_step<FloatMain, ByteMain>;
    using skip = observed_step<FloatSkip, ByteSkip>;
    static constexpr std::size_t maps = main::maps + skip::maps;

    static void run(const float* packed, const float* in, float* out, float* memory, map_extremes* seen) {
        if constexpr (std::is_same_v<FloatSkip, no_step>) {
            floats::leave_skip(packed, in, out, memory);
        } else {
            skip::run(packed + FloatMain::packed, in, floats::aside > 0 ? memory : out,
                      memory + floats::aside, seen + main::maps);
            floats::leave_skip(packed, in, out, memory);
        }
        main::run(packed, in, out, memory, seen);
    }
    static map_range set_ranges(float* folded, map_range input, map_range, const map_range* of_maps) {
        const map_range added = skip::set_ranges(folded + ByteMain::folded, input, {}, of_maps + main::maps);
        return main::set_ranges(folded, input, added, of_maps);
    }
};

/// Branches that write to their places in one map share its range.
template <class FloatFormat, class ByteFormat, shape Input, std::size_t S, std::size_t T, std::size_t Stride,
          class... FloatBranches, class... ByteBranches>
struct observed_step<concatenation_step<FloatFormat, Input, S, Stride, FloatBranches...>,
                     concatenation_step<ByteFormat, Input, T, Stride, ByteBranches...>> {
    using floats = concatenation_step<FloatFormat, Input, S, Stride, FloatBranches...>;
    template <class F, class B>
    struct branch_pair {};
    template <class F, class B>
    using branch = observed_step<typename F::step, typename B::step>;
    static_assert((!fills_map<typename ByteBranches::step> && ...),
                  "deploy: in 8 bits each branch of a concatenation must end in a convolution whose filters "
                  "fit their place in the common map");
    static constexpr std::size_t maps = (branch<FloatBranches, ByteBranches>::maps + ...);

    static void run(const float* packed, const float* in, float* out, float* memory, map_extremes* seen) {
        const auto one = [&]<class F, class B>(std::type_identity<branch_pair<F, B>>) {
            branch<F, B>::run(packed, in, out, memory, seen);
            packed += F::step::packed, seen += branch<F, B>::maps;
        };
        (one(std::type_identity<branch_pair<FloatBranches, ByteBranches>>{}), ...);
        floats::clear_rest(out);
        seen[-1].template see<floats>(out); // the last branch's last map stands for the common one
    }
    static map_range set_ranges(float* folded, map_range input, map_range, const map_range* of_maps) {
        const map_range common = of_maps[maps - 1];
        const auto one = [&]<class F, class B>(std::type_identity<branch_pair<F, B>>) {
            constexpr std::size_t count = branch<F, B>::maps;
            std::array<map_range, count> ranges;
            std::copy_n(of_maps, count, ranges.begin());
            ranges.back() = common;
            branch<F, B>::set_ranges(folded, input, {}, ranges.data());
            folded += B::step::folded, of_maps += count;
        };
        (one(std::type_identity<branch_pair<FloatBranches, ByteBranches>>{}), ...);
        return common;
    }
};

} // namespace detail
} // namespace TACTNET_ARCH
} // namespace tactnet

#pragma once

#include <tactnet/lowering/batch_executor.hpp>
#include <tactnet/lowering/step.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A branch whose channels begin at `Offset` of the common map. Its last step writes them there, or they are
/// copied if it cannot; a branch of no_step copies the input.
template <class Step, std::size_t Offset>
struct branch_step {
    using step = Step;
    static constexpr std::size_t offset = Offset;
};

/// Branches over the same input, with `InputStride` elements from one pixel to the next, side by side in one
/// map of `Stride` elements per pixel.
template <class Format, shape Input, std::size_t InputStride, std::size_t Stride, class... Branches>
struct concatenation_step : step_defaults {
    using format = typename Format::hidden_format;
    using activation = typename format::activation;
    using packed_number = typename format::packed_number;

private:
    template <class Branch>
    static constexpr bool passes_input_on = std::is_same_v<typename Branch::step, no_step>;
    /// The output of a branch.
    template <class Branch>
    static constexpr shape map = [] {
        if constexpr (passes_input_on<Branch>)
            return Input;
        else
            return Branch::step::output;
    }();
    /// Elements for a branch that is computed in the workspace and copied.
    template <class Branch>
    static constexpr std::size_t aside = [] {
        if constexpr (passes_input_on<Branch>)
            return std::size_t{0};
        else
            return Branch::step::fills_map
                       ? pad_to_cache_line<activation>(map<Branch>.area() * Branch::step::output_stride)
                       : 0;
    }();

public:
    static constexpr shape output = [] {
        shape all{0, 0, 0};
        ((all = {map<Branches>.rows, map<Branches>.columns, all.channels + map<Branches>.channels}), ...);
        return all;
    }();
    static constexpr std::size_t output_stride = Stride;
    static constexpr std::size_t folded_elements = (Branches::step::folded_elements + ...),
                                 packed_elements = (Branches::step::packed_elements + ...);
    static constexpr std::size_t workspace_elements =
        std::max({(aside<Branches> + Branches::step::workspace_elements)...});

    static constexpr void pack(const float* from, packed_number* to) {
        ((Branches::step::pack(from, to), from += Branches::step::folded_elements,
          to += Branches::step::packed_elements),
         ...);
    }
    static double output_bound(const float* from, double input) {
        double most = 0;
        ((most = std::max(most, Branches::step::output_bound(from, input)),
          from += Branches::step::folded_elements),
         ...);
        return most;
    }
    static void run(const packed_number* packed_values, const activation* in, activation* out,
                    activation* memory) noexcept {
        ((run_branch<Branches>(packed_values, in, out, memory),
          packed_values += Branches::step::packed_elements),
         ...);
        clear_rest(out);
    }
    static constexpr bool layerwise = (Branches::step::layerwise || ...);
    /// Only if all branches write their slices of the map.
    template <class Executor>
        requires((aside<Branches> == 0 && !passes_input_on<Branches>) && ...)
    static void run_batch(const packed_number* packed_values, const activation* in, std::size_t in_distance,
                          activation* out, activation* memory, const Executor& executor) {
        ((detail::run_batch<typename Branches::step>(packed_values, in, in_distance, out, memory, executor),
          packed_values += Branches::step::packed_elements),
         ...);
        executor.for_each_frame(
            [&](std::size_t frame) { clear_rest(out + frame * detail::map_distance<concatenation_step>); });
    }

    /// Clears the lanes after the last channel.
    static void clear_rest(activation* out) {
        if constexpr (output.channels < Stride)
            for (std::size_t pixel = 0; pixel < output.area(); ++pixel)
                std::fill(out + pixel * Stride + output.channels, out + (pixel + 1) * Stride, activation{});
    }

private:
    template <class Branch>
    static void run_branch(const packed_number* packed_values, const activation* in, activation* out,
                           activation* memory) noexcept {
        if constexpr (passes_input_on<Branch>) {
            copy<Branch, InputStride>(in, out);
        } else if constexpr (aside<Branch> == 0) {
            Branch::step::run(packed_values, in, out, memory);
        } else {
            Branch::step::run(packed_values, in, memory, memory + aside<Branch>);
            copy<Branch, Branch::step::output_stride>(memory, out);
        }
    }
    template <class Branch, std::size_t From>
    static void copy(const activation* from, activation* to) {
        for (std::size_t pixel = 0; pixel < output.area(); ++pixel)
            std::copy_n(from + pixel * From, map<Branch>.channels, to + pixel * Stride + Branch::offset);
    }
};
template <class Format, shape Input, std::size_t InputStride, std::size_t Stride, class... Branches>
struct step_description<concatenation_step<Format, Input, InputStride, Stride, Branches...>> {
    static constexpr const char* header = "tactnet/operators/concatenation/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::concatenation_step", "Branches side by side", std::type_identity<Format>{}, Input,
           input_stride_argument{}, Stride,
           inner_step<typename Branches::step, step_composition::concatenation>{"branch",
                                                                                Branches::offset}...);
    }
};

}} // namespace tactnet

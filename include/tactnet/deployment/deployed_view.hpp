#pragma once

#include <tactnet/deployment/frame_ref.hpp>
#include <tactnet/deployment/refused_call.hpp>
#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/frame/elementwise.hpp>
#include <tactnet/lowering/input_function.hpp>
#include <tactnet/lowering/step.hpp>
#include <tactnet/networks/recognition.hpp>
#include <tactnet/operators/sequence/step.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>

// The part of deployment that works without files, exceptions and run-time type information.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Reads a frame [channel][row][column] into the map of the first step, pixel by pixel without gaps, as
/// (count − mean) × scale. Its folded numbers, in every format: the mean frame, the scale, the largest
/// magnitude that the first step may see.
template <shape Input>
struct input_stage<single_precision, Input> {
    static constexpr std::size_t folded_elements = Input.size() + 2;
    static constexpr std::size_t packed_elements = pad_to_cache_line(Input.size()) + pad_to_cache_line(2);
    static constexpr std::size_t map =
        pad_to_cache_line(Input.size()); ///< elements of the first step's input

    static constexpr void pack(const float* from, float* to) {
        std::copy_n(from, Input.size(), to);
        std::copy_n(from + Input.size(), 2, to + pad_to_cache_line(Input.size()));
    }
    /// Whether all of the frame is finite and small enough. Pools and ReLUs would hide a NaN or an infinity
    /// from the outputs. Counts of 8 bits never exceed the limit.
    template <class Count>
    static bool read(const float* packed_values, const Count* counts, float* in) noexcept {
        const float* const mean = packed_values;
        const float scale = packed_values[map], limit = packed_values[map + 1];
        if constexpr (Input.channels == 1) {
            return kernels::normalise_counts<Input.size()>(counts, mean, scale, limit, in);
        } else {
            std::uint32_t out_of_range = 0;
            for (std::size_t channel = 0; channel < Input.channels; ++channel)
                for (std::size_t pixel = 0; pixel < Input.area(); ++pixel) {
                    const std::size_t at = channel * Input.area() + pixel;
                    const float number = (static_cast<float>(counts[at]) - mean[at]) * scale;
                    in[pixel * Input.channels + channel] = number;
                    if constexpr (std::is_floating_point_v<Count>)
                        out_of_range += !(number <= limit && number >= -limit);
                }
            return out_of_range == 0;
        }
    }
};

/// Writes the map of the last step, `Stride` elements from one pixel to the next, as outputs
/// [channel][row][column].
template <shape Output, std::size_t Stride>
struct output_stage<single_precision, Output, Stride> {
    /// Whether all outputs are finite.
    static bool write(const float* out, std::span<float, Output.size()> to) noexcept {
        std::uint32_t out_of_range = 0;
        for (std::size_t channel = 0; channel < Output.channels; ++channel)
            for (std::size_t pixel = 0; pixel < Output.area(); ++pixel)
                to[channel * Output.area() + pixel] = out[pixel * Stride + channel];
        for (const float value : to)
            out_of_range += !(std::abs(value) <= std::numeric_limits<float>::max());
        return out_of_range == 0;
    }
};

namespace detail {
template <class View>
struct batch_inference; // deployment/batch.hpp
} // namespace detail

template <std::size_t Needed, std::size_t AtMost>
concept fits_stack = (Needed <= AtMost);

/// A deployed network over packed weights that a `deployed` or a constant of the program keeps. Copies are
/// cheap. A call reads and writes nothing but its arguments, so any number of threads may call the same
/// object. It uses no heap, no exceptions and no branch on the instruction set.
///
/// `Steps` is a step_chain whose input lies pixel by pixel without gaps.
template <shape Input, class Steps>
class deployed_view : public detail::packed_steps<input_stage<typename Steps::format, Input>, Steps>,
                      detail::refused_calls<Input, Steps::output.size()> {
    static_assert(
        Steps::fills_map,
        "deployed_view: the last step writes only some channels of a wider map, which no step reads");
    using base = detail::packed_steps<input_stage<typename Steps::format, Input>, Steps>;
    using typename base::format, typename base::packed_number;
    using typename base::input;
    using output = output_stage<format, Steps::output, Steps::output_stride>;
    using base::packed_, base::classes_, base::temperature_, base::output_map;

public:
    using base::outputs, base::workspace_elements;
    using typename base::activation, typename base::packed_weights;
    static constexpr shape input_shape = Input, output_shape = Steps::output;

    /// Memory for one call. Nothing in it outlives the call.
    struct workspace {
        alignas(vector_alignment) std::array<activation, workspace_elements> elements;
    };
    static constexpr std::size_t workspace_bytes = sizeof(workspace);
    /// A call allocates no larger workspace on the stack: pass one from the heap.
    static constexpr std::size_t max_stack_bytes = std::size_t{1} << 20;
    /// Whether to prefer layer-wise batching, and all threads for one frame.
    static constexpr bool layerwise = Steps::layerwise;

    /// As the packed steps, for frames whose counts are compressed by a function, and with reflections that
    /// show a class. Partners must be below `outputs`, and outlive the view as weights do.
    constexpr explicit deployed_view(
        const packed_number* packed, std::size_t classes = outputs, double temperature = 1,
        const input_function& function = {},
        const reflection_rule_view& reflections = reflection_rule_view::all()) noexcept
        : base(packed, classes, temperature), function_(function), reflections_(reflections) {}
    constexpr explicit deployed_view(
        const packed_weights& weights, std::size_t classes = outputs, double temperature = 1,
        const input_function& function = {},
        const reflection_rule_view& reflections = reflection_rule_view::all()) noexcept
        : base(weights, classes, temperature), function_(function), reflections_(reflections) {}
    explicit deployed_view(const packed_weights&&, std::size_t = outputs, double = 1,
                           const input_function& = {}, const reflection_rule_view& = {}) = delete;

    /// Those over which reflection_average averages.
    [[nodiscard]] constexpr const reflection_rule_view& reflections() const noexcept { return reflections_; }

    using detail::refused_calls<Input, outputs>::infer;
    using detail::refused_calls<Input, outputs>::classify;

    /// Writes the outputs of the network for a frame: logits, or whatever its last layer computes.
    [[gnu::always_inline]] frame_status infer(frame_ref<Input> frame, std::span<float, outputs> to,
                                              workspace& memory) const noexcept {
        return function_.identity() ? infer_of<false>(frame, to, memory) : infer_of<true>(frame, to, memory);
    }
    /// As above, with a workspace on the stack.
    [[gnu::always_inline]] frame_status infer(frame_ref<Input> frame,
                                              std::span<float, outputs> to) const noexcept {
        check_stack();
        return function_.identity() ? infer_of<false>(frame, to) : infer_of<true>(frame, to);
    }
    /// Returns the class that a frame most likely shows, without its name, or std::nullopt if the frame or
    /// its outputs are not finite.
    [[nodiscard]] [[gnu::always_inline]] std::optional<recognition>
    classify(frame_ref<Input> frame, workspace& memory) const noexcept {
        return function_.identity() ? classify_of<false>(frame, memory) : classify_of<true>(frame, memory);
    }
    /// As above, with a workspace on the stack.
    [[nodiscard]] [[gnu::always_inline]] std::optional<recognition>
    classify(frame_ref<Input> frame) const noexcept {
        check_stack();
        return function_.identity() ? classify_of<false>(frame) : classify_of<true>(frame);
    }
    /// Returns the class that the outputs of a frame name.
    [[nodiscard]] std::optional<recognition>
    classify_outputs(std::span<const float, outputs> found) const noexcept {
        if constexpr (Steps::gives_probabilities)
            return classify_probabilities(found, classes_, temperature_);
        else
            return classify_logits(found, classes_, temperature_);
    }
    /// How many numbers the last layer reads: the features of a frame, if it is a dense layer. 0 for a
    /// network of a single step.
    static constexpr std::size_t features = Steps::size > 1 ? Steps::penultimate::output.size() : 0;
    /// Copies the features of the frame that `infer` or `classify` was last called for with this workspace,
    /// ordered [channel][row][column]. In 8 bits they are counts of the format's step from 0.
    void read_features(const workspace& memory, std::span<float, features> to) const noexcept {
        static_assert(features > 0, "read_features: the last layer of this network reads the frame");
        using before = typename Steps::penultimate;
        static_assert(before::number_elements == 1, "read_features: the last layer reads no single numbers");
        const activation* const map =
            memory.elements.data() + input::map + output_map + Steps::before_last_map;
        for (std::size_t channel = 0; channel < before::output.channels; ++channel)
            for (std::size_t pixel = 0; pixel < before::output.area(); ++pixel)
                to[channel * before::output.area() + pixel] =
                    static_cast<float>(map[pixel * before::output_stride + channel]);
    }

private:
    friend detail::batch_inference<deployed_view>;

    /// Runs the network layer by layer over executor.frames frames, of `frames` from `first` on
    /// (steps/batch_executor.hpp). `memory` holds workspace_elements for each of executor.copies(). `status`
    /// is null, or has one element per frame; those of broken frames become not_finite. The bits are those of
    /// each frame alone.
    template <class Executor>
    frame_status infer_batch(const frames_ref<Input>& frames, std::size_t first, float* to,
                             activation* memory, const Executor& executor, frame_status* status) const {
        activation* const in = memory;
        activation* const out = in + executor.copies() * input::map;
        std::atomic<bool> in_range = true;
        const auto check = [&](std::size_t i, bool finite) {
            if (finite)
                return;
            in_range = false;
            if (status != nullptr)
                status[i] = frame_status::not_finite;
        };
        executor.for_each_frame([&](std::size_t i) {
            activation* const at = in + i * input::map;
            check(i, function_.identity() ? read<false>(frames[first + i], at)
                                          : read<true>(frames[first + i], at));
        });
        Steps::run_batch(packed_ + input::packed_elements, in, input::map, out,
                         out + executor.copies() * output_map, executor);
        executor.for_each_frame([&](std::size_t i) {
            check(i,
                  output::write(out + i * output_map, std::span<float, outputs>(to + i * outputs, outputs)));
        });
        return in_range ? frame_status::ok : frame_status::not_finite;
    }

    // With and without an input function apart: the compiler sees that an exported header has none, and its
    // firmware holds no code for it.
    template <bool Compresses>
    frame_status infer_of(frame_ref<Input> frame, std::span<float, outputs> to,
                          workspace& memory) const noexcept {
        activation* const in = memory.elements.data();
        activation* const out = in + input::map;
        const bool in_range = read<Compresses>(frame, in);
        Steps::run(packed_ + input::packed_elements, in, out, out + output_map);
        return output::write(out, to) && in_range ? frame_status::ok : frame_status::not_finite;
    }
    template <bool Compresses>
    frame_status infer_of(frame_ref<Input> frame, std::span<float, outputs> to) const noexcept {
        workspace memory;
        return infer_of<Compresses>(frame, to, memory);
    }
    template <bool Compresses>
    std::optional<recognition> classify_of(frame_ref<Input> frame, workspace& memory) const noexcept {
        std::array<float, outputs> found;
        return infer_of<Compresses>(frame, found, memory) == frame_status::ok ? classify_outputs(found)
                                                                              : std::nullopt;
    }
    template <bool Compresses>
    std::optional<recognition> classify_of(frame_ref<Input> frame) const noexcept {
        workspace memory;
        return classify_of<Compresses>(frame, memory);
    }

    template <bool Compresses>
    bool read(frame_ref<Input> frame, activation* in) const noexcept {
        return frame.visit([&](auto frame_elements) {
            if constexpr (Compresses) {
                alignas(vector_alignment) std::array<float, Input.size()> compressed;
                function_.apply(frame_elements.data(), compressed);
                return input::read(packed_, compressed.data(), in);
            } else {
                return input::read(packed_, frame_elements.data(), in);
            }
        });
    }
    static constexpr void check_stack() {
        static_assert(fits_stack<workspace_bytes, max_stack_bytes>,
                      "deployed: this network needs more workspace than a stack should hold: give it some "
                      "from the heap; fits_stack shows bytes needed, bytes at most");
    }

    input_function function_;
    reflection_rule_view reflections_;
};

}} // namespace tactnet

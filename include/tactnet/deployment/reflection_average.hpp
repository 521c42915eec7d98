#pragma once

#include <tactnet/deployment/deployed_view.hpp>
#include <tactnet/networks/recognition.hpp>

#include <array>
#include <cstddef>
#include <optional>
#include <span>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The mean of the outputs of a deployed network for a frame and its reflections: more accurate if a touch
/// may come either way round, in up to four times the time. The mean is over the reflections that the network
/// was trained with, with the outputs of partners exchanged (deployed::reflections): all three by default.
///
///     reflection_average average(network.view());
///     const frame_status status = average.infer(counts, logits, workspace);
///
/// A frame and its reflections give the same bits. Like the view: const, no heap, no exceptions.
template <class View>
class reflection_average {
public:
    static constexpr shape input_shape = View::input_shape;
    static constexpr std::size_t outputs = View::outputs, features = View::features;

    /// Memory for one call. Nothing in it outlives the call.
    struct workspace {
        typename View::workspace network;            ///< memory of the network
        std::array<float, input_shape.size()> frame; ///< reflected
        /// The outputs and the features for each reflection.
        std::array<std::array<float, outputs>, all_reflections.size()> outputs_per_reflection;
        std::array<std::array<float, features>, all_reflections.size()> features_per_reflection;
    };

    /// The weights and the partners of the view must outlive it.
    constexpr explicit reflection_average(const View& network) noexcept : network_(network) {}

    /// As the view's call. `not_finite` if one of the images is.
    frame_status infer(frame_ref<input_shape> frame, std::span<float, outputs> to,
                       workspace& memory) const noexcept {
        return infer_each(frame, to, memory, [](std::size_t) {});
    }
    /// As above, and writes the mean of the features, in the order of read_features of the view: what
    /// class_means finds unknown objects by.
    frame_status infer(frame_ref<input_shape> frame, std::span<float, outputs> to,
                       std::span<float, features> to_features, workspace& memory) const noexcept {
        const frame_status status = infer_each(frame, to, memory, [&](std::size_t i) {
            network_.read_features(memory.network, memory.features_per_reflection[i]);
        });
        for (std::size_t f = 0; f < features; ++f)
            to_features[f] = mean_of_reflections(network_.reflections().axes(), [&](std::size_t i) {
                return memory.features_per_reflection[i][f];
            });
        return status;
    }

    /// The class that the mean names, as the view's call.
    [[nodiscard]] std::optional<recognition> classify(frame_ref<input_shape> frame,
                                                      workspace& memory) const noexcept {
        std::array<float, outputs> found;
        return infer(frame, found, memory) == frame_status::ok ? network_.classify_outputs(found)
                                                               : std::nullopt;
    }

private:
    /// Calls each(i) once the network has run on reflection i.
    template <class Each>
    frame_status infer_each(frame_ref<input_shape> frame, std::span<float, outputs> to, workspace& memory,
                            const Each& each) const noexcept {
        frame_status status = frame_status::ok;
        for (std::size_t i = 0; i < all_reflections.size(); ++i) {
            if (!all_reflections[i].within(network_.reflections().axes()))
                continue;
            frame.visit([&]<class Count>(tensor_view<const Count, input_shape> frame_elements) {
                // Bytes stay bytes, which the network may read faster.
                auto* const reflected = reinterpret_cast<Count*>(memory.frame.data());
                reflect_image(input_shape, all_reflections[i], frame_elements.data(), reflected);
                if (network_.infer(tensor_view<const Count, input_shape>(reflected),
                                   memory.outputs_per_reflection[i], memory.network) != frame_status::ok)
                    status = frame_status::not_finite;
            });
            each(i);
        }
        network_.reflections().average(
            [&](std::size_t i) -> const auto& { return memory.outputs_per_reflection[i]; }, to);
        return status;
    }

    View network_;
};

}} // namespace tactnet

#pragma once

#include <tactnet/deployment/deployed_view.hpp>
#include <tactnet/networks/recognition.hpp>

#include <array>
#include <cstddef>
#include <optional>
#include <span>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The mean of the outputs of a deployed network for a frame and its three reflections: more accurate if a
/// touch may come either way round, in four times the time. Train on reflected images, as by default.
///
///     reflection_average average(network.view());
///     const frame_status status = average.infer(counts, logits, workspace);
///
/// A frame and its reflections give the same bits. Like the view: const, no heap, no exceptions.
template <class View>
class reflection_average {
public:
    static constexpr shape input_shape = View::input_shape;
    static constexpr std::size_t outputs = View::outputs;

    /// Memory for one call. Nothing in it outlives the call.
    struct workspace {
        typename View::workspace network;            ///< memory of the network
        std::array<float, input_shape.size()> frame; ///< reflected
        /// The outputs for each reflection.
        std::array<std::array<float, outputs>, all_reflections.size()> outputs_per_reflection;
    };

    /// The weights of the view must outlive it.
    constexpr explicit reflection_average(const View& network) noexcept : network_(network) {}

    /// As the view's call. `not_finite` if one of the four is.
    frame_status infer(frame_ref<input_shape> frame, std::span<float, outputs> to,
                       workspace& memory) const noexcept {
        frame_status status = frame_status::ok;
        for (std::size_t i = 0; i < all_reflections.size(); ++i)
            frame.visit([&]<class Count>(tensor_view<const Count, input_shape> frame_elements) {
                // Bytes stay bytes, which the network may read faster.
                auto* const reflected = reinterpret_cast<Count*>(memory.frame.data());
                reflect_image(input_shape, all_reflections[i], frame_elements.data(), reflected);
                if (network_.infer(tensor_view<const Count, input_shape>(reflected),
                                   memory.outputs_per_reflection[i], memory.network) != frame_status::ok)
                    status = frame_status::not_finite;
            });
        const auto& [upright, rows, columns, both] = memory.outputs_per_reflection;
        for (std::size_t o = 0; o < outputs; ++o)
            to[o] = mean_of_reflections(upright[o], rows[o], columns[o], both[o]);
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
    View network_;
};

}} // namespace tactnet

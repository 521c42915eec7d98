#pragma once

#include <tactnet/deployment/deployed_view.hpp>
#include <tactnet/tensor/reflection.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The mean of what a deployed network gives for a frame and its three reflections: more accurate where a
/// touch may come either way round, for four times the time. Trained on reflected images, as by default.
///
///     reflection_average recognise(deployed.view());
///     const frame_status status = recognise(counts, logits, workspace);
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
        /// What the network gives for each reflection.
        std::array<std::array<float, outputs>, all_reflections.size()> of_each;
    };

    /// What the view views must outlive it.
    constexpr explicit reflection_average(const View& network) noexcept : network_(network) {}

    /// As the view's call. `not_finite` if any of the four is.
    frame_status operator()(tensor_view<const std::uint8_t, input_shape> counts, std::span<float, outputs> to,
                            workspace& memory) const noexcept {
        return recognise(counts.data(), to, memory);
    }
    frame_status operator()(tensor_view<const float, input_shape> counts, std::span<float, outputs> to,
                            workspace& memory) const noexcept {
        return recognise(counts.data(), to, memory);
    }

private:
    template <class Count>
    frame_status recognise(const Count* counts, std::span<float, outputs> to,
                           workspace& memory) const noexcept {
        frame_status status = frame_status::ok;
        for (std::size_t i = 0; i < all_reflections.size(); ++i) {
            // Bytes go as bytes, which the network may take faster.
            auto* const frame = reinterpret_cast<Count*>(memory.frame.data());
            reflect_image(input_shape, all_reflections[i], counts, frame);
            if (network_(tensor_view<const Count, input_shape>(frame), memory.of_each[i], memory.network) !=
                frame_status::ok)
                status = frame_status::not_finite;
        }
        const auto& [upright, rows, columns, both] = memory.of_each;
        for (std::size_t o = 0; o < outputs; ++o)
            to[o] = mean_of_reflections(upright[o], rows[o], columns[o], both[o]);
        return status;
    }

    View network_;
};

} // namespace TACTNET_ARCH
} // namespace tactnet

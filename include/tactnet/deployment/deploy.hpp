#pragma once

#include <tactnet/deployment/deployed_view.hpp>
#include <tactnet/deployment/plan.hpp>
#include <tactnet/kernels/thread_pool.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

namespace tactnet::inline TACTNET_ARCH {

/// A deployed network that keeps its weights, on the heap since they were packed: calls use none. May be
/// copied and moved. `deployed_view` tells of the calls.
template <class Network>
class deployed {
    using plan = deployment_plan<Network>;

public:
    using view_type = deployed_view<Network::input_shape, typename plan::step>;
    using scratch = typename view_type::scratch;
    static constexpr shape input_shape = Network::input_shape;
    static constexpr std::size_t outputs = view_type::outputs;
    static constexpr std::size_t weight_bytes = view_type::weight_bytes;
    static constexpr std::size_t scratch_bytes = view_type::scratch_bytes;
    static_assert(std::is_same_v<typename Network::value_type, float>,
                  "deploy: networks are deployed in single precision; this one has another number type");

    /// The input is (count − mean) × scale. Throws std::invalid_argument if a parameter is NaN or infinite,
    /// or a variance not above zero.
    deployed(const Network& network, std::span<const float, input_shape.size()> mean, float scale)
        : folded_(view_type::folded_elements), packed_(view_type::packed_elements) {
        std::copy(mean.begin(), mean.end(), folded_.begin());
        folded_[input_shape.size()] = scale;
        plan::fold({network.learnable_values().data(), network.running_statistics().data(), network.epsilon},
                   folded_.data() + input_shape.size() + 1);
        for (const float value : folded_)
            if (!std::isfinite(value))
                throw std::invalid_argument("deploy: expected finite parameters and variances above zero, "
                                            "found " +
                                            std::to_string(value) + " once batch norms are folded in");
        view_type::pack(folded_.data(), packed_.data());
    }

    [[nodiscard]] view_type view() const noexcept { return view_type(packed_.data()); }
    operator view_type() const noexcept { return view(); }
    /// The numbers before packing, for a file or a header.
    [[nodiscard]] std::span<const float, view_type::folded_elements> folded() const noexcept {
        return std::span<const float, view_type::folded_elements>(folded_.data(), folded_.size());
    }

    template <class Count>
    frame_status operator()(tensor_view<Count, input_shape> counts, std::span<float, outputs> to,
                            scratch& memory) const noexcept {
        return view()(counts, to, memory);
    }
    template <class Count>
    frame_status operator()(tensor_view<Count, input_shape> counts,
                            std::span<float, outputs> to) const noexcept {
        return view()(counts, to);
    }
    /// Frames one after the other, on all threads of a pool: each with the same bits as alone. Tells whether
    /// all were recognised. Throws std::invalid_argument unless there is a row of outputs for each frame.
    template <class Count>
    frame_status operator()(thread_pool& threads, std::span<const Count> frames, std::span<float> to) const {
        const std::size_t count = frames.size() / input_shape.size();
        if (count * input_shape.size() != frames.size() || count * outputs != to.size())
            throw std::invalid_argument("deployed: expected frames of " + std::to_string(input_shape.size()) +
                                        " counts and " + std::to_string(outputs) +
                                        " outputs for each, found " + std::to_string(frames.size()) +
                                        " counts and " + std::to_string(to.size()) + " outputs");
        std::atomic<frame_status> status = frame_status::recognised;
        threads.for_each(count, [&](std::size_t i) {
            const tensor_view<const Count, input_shape> frame(frames.data() + i * input_shape.size());
            if (view()(frame, to.subspan(i * outputs).template first<outputs>()) != frame_status::recognised)
                status = frame_status::not_finite;
        });
        return status;
    }

private:
    aligned_vector<float> folded_, packed_;
};

/// Turns a trained network into its fastest form, for inputs (count − mean) × scale.
template <class Network>
[[nodiscard]] deployed<Network>
deploy(const Network& network, std::span<const float, Network::input_shape.size()> mean, float scale = 1) {
    return deployed<Network>(network, mean, scale);
}
/// For inputs that are taken as they are.
template <class Network>
[[nodiscard]] deployed<Network> deploy(const Network& network) {
    const tensor<float, Network::input_shape> zero;
    return deployed<Network>(network, zero.view().elements(), 1);
}

} // namespace tactnet

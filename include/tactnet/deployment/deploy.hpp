#pragma once

#include <tactnet/deployment/deployed_view.hpp>
#include <tactnet/deployment/plan.hpp>
#include <tactnet/kernels/thread_pool.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
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
                   folded_.data() + view_type::steps_folded);
        for (const float value : folded_)
            if (!std::isfinite(value))
                throw std::invalid_argument("deploy: expected finite parameters and variances above zero, "
                                            "found " +
                                            std::to_string(value) + " once batch norms are folded in");
        set_limit();
        view_type::pack(folded_.data(), packed_.data());
    }

    [[nodiscard]] view_type view() const noexcept { return view_type(packed_.data()); }
    operator view_type() const noexcept { return view(); }
    /// The numbers before packing, for a file or a header.
    [[nodiscard]] std::span<const float, view_type::folded_elements> folded() const noexcept {
        return std::span<const float, view_type::folded_elements>(folded_.data(), folded_.size());
    }

    frame_status operator()(tensor_view<const std::uint8_t, input_shape> counts, std::span<float, outputs> to,
                            scratch& memory) const noexcept {
        return view()(counts, to, memory);
    }
    frame_status operator()(tensor_view<const float, input_shape> counts, std::span<float, outputs> to,
                            scratch& memory) const noexcept {
        return view()(counts, to, memory);
    }
    frame_status operator()(tensor_view<const std::uint8_t, input_shape> counts,
                            std::span<float, outputs> to) const noexcept {
        return view()(counts, to);
    }
    frame_status operator()(tensor_view<const float, input_shape> counts,
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
    /// The largest magnitude of the input, a power of ten, with which no sum can overflow. Tiles add and
    /// subtract up to 81 products of the same size on their way: hence the 128.
    void set_limit() {
        constexpr double most = static_cast<double>(std::numeric_limits<float>::max()) / 128;
        float& limit = folded_[input_shape.size() + 1];
        double largest = 1e36;
        while (largest > 1e-30 &&
               !(plan::step::reach(folded_.data() + view_type::steps_folded, largest) <= most))
            largest /= 10;
        limit = static_cast<float>(largest);
        for (std::size_t e = 0; e < input_shape.size(); ++e)
            for (const float count : {0.0f, 255.0f})
                if (!(std::abs((count - folded_[e]) * folded_[input_shape.size()]) <= limit))
                    throw std::invalid_argument(
                        "deploy: expected parameters with which counts of 8 bits stay in "
                        "the range of single precision, found some for inputs up to " +
                        std::to_string(limit));
    }

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
/// A network with what its inputs are normalised by, as `load_model` gives it.
template <class Model>
    requires requires(const Model& m) {
        m.network.epsilon;
        m.normalise.mean.view().elements();
    }
[[nodiscard]] auto deploy(const Model& model) {
    return deploy(model.network, model.normalise.mean.view().elements(), model.normalise.scale);
}

} // namespace tactnet

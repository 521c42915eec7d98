#pragma once

#include <tactnet/deployment/batch.hpp>
#include <tactnet/deployment/deployed_view.hpp>
#include <tactnet/deployment/lowering.hpp>
#include <tactnet/deployment/lowering/sequence.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/tensor/aligned.hpp>
#include <tactnet/tensor/tensor_view.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

/// `require<View>(folded)` throws std::invalid_argument for finite numbers that a format cannot have. That of
/// 8 bits stands in deployment/eight_bit/folded_check.hpp.
template <class Format>
struct folded_check;
template <>
struct folded_check<single_precision> {
    template <class View>
    static void require(std::span<const float>) {}
};

} // namespace detail

/// A deployed network that keeps its weights, on the heap since they were packed: calls use none. May be
/// copied and moved. `deployed_view` tells of the calls.
template <class Network, class Format = single_precision>
class deployed : protected detail::refused_calls<Network::input_shape, Network::outputs> {
    using plan = lowered_network<Network, Format>;

public:
    using view_type = deployed_view<Network::input_shape, typename plan::step>;

private:
    using batch = detail::frame_batch<view_type>;

public:
    using activation = typename Format::activation;
    using workspace = typename view_type::workspace;
    static constexpr shape input_shape = Network::input_shape;
    static constexpr std::size_t outputs = view_type::outputs;
    static constexpr std::size_t weight_bytes = view_type::weight_bytes;
    static constexpr std::size_t workspace_bytes = view_type::workspace_bytes;
    static_assert(std::is_same_v<typename Network::value_type, float>,
                  "deploy: networks are deployed in single precision; this one has another number type");

    /// The input is (count − mean) × scale. Throws std::invalid_argument if the mean, the scale or a
    /// parameter is NaN, infinite or beyond 1e30 once batch norms are folded in.
    deployed(const Network& network, std::span<const float, input_shape.size()> mean,
             float scale) requires std::is_same_v<Format, single_precision>
        : folded_(view_type::folded_elements), packed_(view_type::packed_elements) {
        std::copy(mean.begin(), mean.end(), folded_.begin());
        folded_[input_shape.size()] = scale;
        plan::fold({network.learnable_values().data(), network.running_statistics().data(), network.epsilon},
                   folded_.data() + view_type::steps_folded);
        for (std::size_t i = 0; i < folded_.size(); ++i)
            if (!(std::abs(folded_[i]) <= largest_parameter))
                throw std::invalid_argument(std::string("deploy: expected ") +
                                            (i <= input_shape.size()
                                                 ? "a mean and a scale"
                                                 : "parameters and variances + epsilon above zero") +
                                            " that give finite numbers up to 1e30, found " +
                                            std::to_string(folded_[i]) + " once batch norms are folded in");
        set_limit();
        view_type::pack(folded_.data(), packed_.data());
    }
    /// From the numbers before packing, as folded() gives them. Throws std::invalid_argument if one is NaN or
    /// infinite, or is none that the number format can have there.
    explicit deployed(std::span<const float, view_type::folded_elements> folded)
        : folded_(view_type::folded_elements), packed_(view_type::packed_elements) {
        for (std::size_t i = 0; i < folded.size(); ++i) {
            if (!(std::abs(folded[i]) <= std::numeric_limits<float>::max()))
                throw std::invalid_argument("deploy: expected finite numbers, found " +
                                            std::to_string(folded[i]) + " at place " + std::to_string(i));
            folded_[i] = folded[i];
        }
        detail::folded_check<Format>::template require<view_type>(folded);
        view_type::pack(folded_.data(), packed_.data());
    }

    /// A view of these weights, which must outlive it.
    [[nodiscard]] view_type view() const& noexcept { return view_type(packed_.data()); }
    view_type view() const&& = delete;
    operator view_type() const& noexcept { return view(); }
    operator view_type() const&& = delete;
    /// The numbers before packing, for a file or a header.
    [[nodiscard]] std::span<const float, view_type::folded_elements> folded() const noexcept {
        return std::span<const float, view_type::folded_elements>(folded_.data(), folded_.size());
    }

    using detail::refused_calls<input_shape, outputs>::operator();
    frame_status operator()(tensor_view<const std::uint8_t, input_shape> counts, std::span<float, outputs> to,
                            workspace& memory) const noexcept {
        return view()(counts, to, memory);
    }
    frame_status operator()(tensor_view<const float, input_shape> counts, std::span<float, outputs> to,
                            workspace& memory) const noexcept {
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
    /// Frames on all threads of a pool: each bit-exact with itself alone. A small network takes them one
    /// after the other on each thread, or a few together where its weights outgrow the second level of cache;
    /// of a large one, some frames pass together, so that weights are read once for all of them, and all
    /// threads share each layer, for a single frame too. Tells whether all were recognised. Throws
    /// std::invalid_argument unless there is a row of outputs for each frame, and std::bad_alloc: a large
    /// network uses the heap here, unless it is given memory that is kept.
    frame_status operator()(thread_pool& threads, std::span<const std::uint8_t> frames,
                            std::span<float> to) const {
        return batch::recognise(view(), threads, frames, to);
    }
    frame_status operator()(thread_pool& threads, std::span<const float> frames, std::span<float> to) const {
        return batch::recognise(view(), threads, frames, to);
    }
    /// Memory for such calls: it grows to what a call needs, and is kept for the next. It serves one call at
    /// a time.
    using batch_workspace = detail::workspace_buffer<activation>;
    frame_status operator()(thread_pool& threads, std::span<const std::uint8_t> frames, std::span<float> to,
                            batch_workspace& memory) const requires view_type::large {
        return batch::recognise(view(), threads, frames, to, memory);
    }
    frame_status operator()(thread_pool& threads, std::span<const float> frames, std::span<float> to,
                            batch_workspace& memory) const requires view_type::large {
        return batch::recognise(view(), threads, frames, to, memory);
    }

private:
    static constexpr float largest_parameter = 1e30f;

    /// The largest magnitude of the input, a power of ten, with which no sum can overflow, whatever the
    /// signs. The factors of a tile's lines add up to 13.8 for one weight, 189 in two directions: hence the
    /// 256. For a network so deep that this bound would refuse counts of 8 bits it says nothing: then
    /// only NaN and infinity are told.
    void set_limit() {
        constexpr double most = static_cast<double>(std::numeric_limits<float>::max()) / 256;
        double largest = 1e36, needed = 0;
        for (std::size_t e = 0; e < input_shape.size(); ++e)
            for (const double count : {0.0, 255.0})
                needed = std::max(needed, std::abs((count - static_cast<double>(folded_[e])) *
                                                   static_cast<double>(folded_[input_shape.size()])));
        while (largest >= needed &&
               !(plan::step::output_bound(folded_.data() + view_type::steps_folded, largest) <= most))
            largest /= 10;
        folded_[input_shape.size() + 1] =
            largest >= needed ? static_cast<float>(largest) : std::numeric_limits<float>::max();
    }

    aligned_vector<float> folded_;
    aligned_vector<typename Format::packed> packed_;
};

/// Turns a trained network into its fastest form, for inputs (count − mean) × scale. Any list of layers that
/// have a deployed form; the main branch of a residual block must end in a convolution, with or without batch
/// norm. Throws as the constructor of `deployed`. A `model` becomes a deployed_model, which names classes.
template <class Network>
[[nodiscard]] deployed<Network>
deploy(const Network& network, std::span<const float, Network::input_shape.size()> mean, float scale = 1) {
    return deployed<Network>(network, mean, scale);
}
/// For inputs that are taken as they are.
template <class Network>
[[nodiscard]] deployed<Network> deploy(const Network& network) {
    // Not on the stack: the photographs of large networks take more than half a megabyte.
    const std::vector<float> zero(Network::input_shape.size());
    return deployed<Network>(network, std::span(zero).template first<Network::input_shape.size()>(), 1);
}

} // namespace TACTNET_ARCH
} // namespace tactnet

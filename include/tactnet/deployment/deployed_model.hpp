#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/networks/model.hpp>
#include <tactnet/networks/recognition.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A deployed network that knows its classes. Beside the calls of `deployed`, which give all outputs, it
/// gives the class that a frame shows:
///
///     const auto recognise = deploy(model);
///     if (const auto found = recognise(frame)) // index, probability and name
///         show(found->name);
///
/// These calls too are `const` and `noexcept`, use no heap and may come from any number of threads.
template <class Network, class Format = single_precision>
class deployed_model : public deployed<Network, Format> {
    using base = deployed<Network, Format>;

public:
    using base::input_shape, base::outputs;
    using typename base::workspace;
    using counts_view = tensor_view<const std::uint8_t, input_shape>;
    using numbers_view = tensor_view<const float, input_shape>;

    /// Throws std::invalid_argument as the constructor of `deployed`, and unless the model names 1 to
    /// `outputs` classes.
    explicit deployed_model(const model<Network>& m) requires std::is_same_v<Format, single_precision>
        : deployed_model(base(m.network, m.normalise.mean.view().elements(), m.normalise.scale), m.classes) {}
    /// Of a network that is deployed already. Throws std::invalid_argument unless there are 1 to `outputs`
    /// classes.
    deployed_model(base network, std::vector<std::string> classes)
        : base(std::move(network)), classes_(std::move(classes)) {
        if (classes_.empty() || classes_.size() > outputs)
            throw std::invalid_argument("deploy: expected a model that names 1 to " +
                                        std::to_string(outputs) + " classes, found " +
                                        std::to_string(classes_.size()) + " names");
    }

    /// Names of the first outputs, in order. Outputs behind them stand for nothing.
    [[nodiscard]] std::span<const std::string> classes() const& noexcept { return classes_; }
    std::span<const std::string> classes() const&& = delete;

    using base::operator();
    /// The class that a frame of counts, or of numbers that are not whole, most likely shows. Nothing for a
    /// broken frame, one that is not `frame_status::ok`: it is never taken for a class. The name is
    /// a view of one of `classes()`.
    [[nodiscard]] std::optional<recognition> operator()(counts_view counts,
                                                        workspace& memory) const& noexcept {
        return recognise(counts, memory);
    }
    [[nodiscard]] std::optional<recognition> operator()(numbers_view counts,
                                                        workspace& memory) const& noexcept {
        return recognise(counts, memory);
    }
    /// With workspace on the stack: workspace_bytes of it.
    [[nodiscard]] std::optional<recognition> operator()(counts_view counts) const& noexcept {
        return recognise(counts);
    }
    [[nodiscard]] std::optional<recognition> operator()(numbers_view counts) const& noexcept {
        return recognise(counts);
    }
    /// Says why a frame of another size or type is none.
    template <class Frame>
    requires base::template refuses_frame<Frame> std::optional<recognition>
    operator()(Frame&&) const noexcept {
        detail::refuse_frame<Frame, input_shape>();
        return std::nullopt;
    }
    /// A frame of another size or type is refused by a sentence, not by a list of candidates.
    template <class Frame>
    requires base::template refuses_frame<Frame> std::optional<recognition>
    operator()(Frame&&, workspace&) const noexcept {
        detail::refuse_frame<Frame, input_shape>();
        return std::nullopt;
    }
    // The name would be gone with the classes.
    std::optional<recognition> operator()(counts_view, workspace&) const&& = delete;
    std::optional<recognition> operator()(numbers_view, workspace&) const&& = delete;
    std::optional<recognition> operator()(counts_view) const&& = delete;
    std::optional<recognition> operator()(numbers_view) const&& = delete;

private:
    template <class View, class... Memory>
    [[nodiscard]] std::optional<recognition> recognise(View counts, Memory&... memory) const noexcept {
        std::array<float, outputs> found;
        if (base::operator()(counts, std::span<float, outputs>(found), memory...) != frame_status::ok)
            return std::nullopt;
        if constexpr (Network::ends_in_softmax)
            return most_probable(found, classes_);
        else
            return likeliest(found, classes_);
    }

    std::vector<std::string> classes_;
};

/// A trained network with what its inputs are normalised by and the names of its classes, as `load_model`
/// gives it, in its fastest form. Throws as the constructor of `deployed_model`.
template <class Network>
[[nodiscard]] deployed_model<Network> deploy(const model<Network>& trained) {
    return deployed_model<Network>(trained);
}

} // namespace TACTNET_ARCH
} // namespace tactnet

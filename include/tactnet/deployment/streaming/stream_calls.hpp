#pragma once

#include <tactnet/deployment/frame_ref.hpp>
#include <tactnet/networks/recognition.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// The calls of a deployed stream that its `step` gives, in every number format.
template <class Stream, std::size_t Features, std::size_t Outputs>
class stream_calls {
public:
    static constexpr std::size_t features = Features; ///< numbers of a frame
    static constexpr std::size_t outputs = Outputs;   ///< numbers after each frame

    /// As `step`, and returns the class that the outputs name: the largest logit, and its probability by a
    /// softmax. std::nullopt for a broken frame, which leaves the state unchanged.
    template <class State>
    [[nodiscard]] std::optional<recognition> classify(std::span<const float, features> frame,
                                                      State& memory) const noexcept {
        std::array<float, outputs> found;
        return self().step(frame, memory, found) == frame_status::ok
                   ? classify_logits(found, self().class_count())
                   : std::nullopt;
    }
    /// Takes a recording, `features` numbers of one frame after the other, and writes `outputs` numbers for
    /// each frame: the bits of a `step` for each. Returns the number of frames that were taken: all that are
    /// whole in both spans, or those before the first broken one, where the state stays.
    template <class State>
    [[nodiscard]] std::size_t run(std::span<const float> recording, State& memory,
                                  std::span<float> to) const noexcept {
        const std::size_t frames = std::min(recording.size() / features, to.size() / outputs);
        for (std::size_t i = 0; i < frames; ++i)
            if (self().step(recording.subspan(i * features).template first<features>(), memory,
                            to.subspan(i * outputs).template first<outputs>()) != frame_status::ok)
                return i;
        return frames;
    }

private:
    [[nodiscard]] const Stream& self() const noexcept { return static_cast<const Stream&>(*this); }
};

}}} // namespace tactnet::detail

#pragma once

// What a frame says, and who says so, whatever the network behind it and its size.

#include <tactnet/decision.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/networks/recognition.hpp>
#include <tactnet/sensors/frame.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// What a frame says.
struct answer {
    enum class state {
        unreadable, ///< another size, or numbers that no network takes
        learning,   ///< air, which the baseline is learnt from
        air,        ///< nothing touches the array
        touch
    };
    state says = state::unreadable;
    std::uint64_t number = 0;
    std::optional<double> seconds{};                 ///< of the source
    std::optional<tactnet::recognition> found{};     ///< by all frames of the touch so far
    std::optional<tactnet::contact_state> contact{}; ///< where air was learnt
    std::span<const tactnet::tactel_fault> faults{}; ///< valid until the next frame
    std::span<const float> counts{};                 ///< without baseline and faults, likewise
    std::size_t columns = 0;                         ///< of the array
    double microseconds = 0;                         ///< that the answer took
};

/// Answers frame by frame.
class frame_reader {
public:
    virtual ~frame_reader() = default;
    virtual answer read(const tactnet::frame_view& frame) = 0;
    virtual std::vector<std::string> classes() const = 0;
};

/// A network that was compiled in, at a size.
struct compiled_reader {
    std::string_view network; ///< as in weight files: "tactnet6"
    tactnet::shape input;
    /// Without weights, touches are felt and not recognised. With a scale, frames have counts of any depth;
    /// otherwise 8-bit counts. Throws tactnet::file_error for a file of another network.
    std::unique_ptr<frame_reader> (*make)(const tactnet::safetensors* weights, std::size_t frames_of_air,
                                          const std::optional<tactnet::count_scale>& scale);
};
/// All of them: generated, see TACTNET_STREAM_NETWORKS.
std::vector<compiled_reader> compiled_readers();

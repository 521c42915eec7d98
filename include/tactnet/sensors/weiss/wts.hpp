#pragma once

#include <tactnet/sensors/weiss/packet.hpp>

// Weiss Robotics' WTS sensors: packets whose checksum covers all of them.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Decodes frames of a WTS sensor of a known size. See weiss_decoder for damage and memory.
class weiss_wts : public weiss_decoder {
public:
    /// Throws std::invalid_argument if rows × columns is not 1 to largest_frame_cells.
    explicit weiss_wts(const weiss_array& array)
        : weiss_decoder("Weiss WTS", array, weiss_coverage::whole_packet) {}
};

} // namespace TACTNET_ARCH
} // namespace tactnet

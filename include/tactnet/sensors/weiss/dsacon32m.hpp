#pragma once

#include <tactnet/sensors/weiss/packet.hpp>

// The DSACON32m controller, as in the Schunk SDH hand: packets whose checksum leaves the preamble out, frames
// usually in runs. One frame holds the cells of all its matrices, one after the other.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Decodes frames of a DSACON32m with a known number of cells. See weiss_decoder for damage and memory.
class dsacon32m : public weiss_decoder {
public:
    /// Throws std::invalid_argument if rows × columns is not 1 to largest_frame_cells.
    explicit dsacon32m(const weiss_array& array)
        : weiss_decoder("DSACON32m", array, weiss_coverage::without_preamble) {}
};

} // namespace TACTNET_ARCH
} // namespace tactnet

#pragma once

#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/tensor/shape.hpp>

#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace simulation {

/// An array of tactels. The default pitch is that of the paper's sensor.
template <std::size_t Rows, std::size_t Columns>
struct array {
    static constexpr shape extents{Rows, Columns};
    static_assert(Rows > 0 && Columns > 0, "array: there must be at least one row and one column of tactels");

    double pitch = tekscan_6077::pitch; ///< metres from tactel to tactel, along both axes

    [[nodiscard]] constexpr double tactel_area() const { return pitch * pitch; }
};

} // namespace simulation
} // namespace TACTNET_ARCH
} // namespace tactnet

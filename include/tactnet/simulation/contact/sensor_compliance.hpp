#pragma once

#include <tactnet/simulation/contact/bonded_layer.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace simulation {

// How far a sensor gives way to what presses on it. Sensors of one make differ more by what is behind the
// film than by the film: glued to a metal plate it is rigid; with foam between, semi-rigid; on a soft body
// without a frame it is flexible and bends round the object. The softer, the more tactels share a force and
// the less each of them bears: contact grows, and the range from faint to strong shrinks.
//
// All three are a bonded layer, whose surface follows the object; a film that bends without stretching is
// soft beside its backing. The figures are chosen, not measured: usual thicknesses, and moduli in the range
// of silicone of Shore 20 A (about 0.7 MPa), of foam rubber and of upholstery foam, which is squeezed without
// widening much. The order of the three is what is tested. It does not hold for an object that is flat to
// hundredths of a millimetre and pressed lightly: there all bear it evenly, but for its rim, which cuts the
// deeper into the softer.

/// A film under a thin rubber skin on a metal plate.
inline constexpr bonded_layer rigid_sensor{.young = 7e5, .poisson = 0.48, .thickness = 1e-3};
/// A film on a mat of foam rubber.
inline constexpr bonded_layer semi_rigid_sensor{.young = 1e5, .poisson = 0.3, .thickness = 3e-3};
/// A film on a thick soft body.
inline constexpr bonded_layer flexible_sensor{.young = 3e4, .poisson = 0.1, .thickness = 12e-3};

} // namespace simulation
} // namespace TACTNET_ARCH
} // namespace tactnet

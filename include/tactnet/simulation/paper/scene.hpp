#pragma once

#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/simulation/array.hpp>
#include <tactnet/simulation/contact/bonded_layer.hpp>
#include <tactnet/simulation/contact/winkler.hpp>
#include <tactnet/simulation/effects/circuit/quantisation.hpp>
#include <tactnet/simulation/effects/circuit/saturation.hpp>
#include <tactnet/simulation/effects/film/texture.hpp>
#include <tactnet/simulation/effects/mechanics/pad.hpp>
#include <tactnet/simulation/effects/storage/jpeg.hpp>
#include <tactnet/simulation/scene.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace simulation {

/// The array that the paper's images were taken with.
using paper_array = array<tekscan_6077::extents.rows, tekscan_6077::extents.columns>;

/// What the paper's images call for, and no more: the effects without which simulated images are told from
/// them at a glance. On the paper's array, as 8-bit counts that went through a JPEG file.
using paper_scene = scene<paper_array, contact<winkler>, elastic_pad, film_texture, saturation,
                          quantisation<8>, jpeg_storage>;

/// With the accurate model of contact, which lets neighbours sink with what presses beside them: for touches
/// of which the pressures themselves matter. Takes hundreds of times as long.
using layered_scene = scene<paper_array, contact<bonded_layer>, elastic_pad, film_texture, saturation,
                            quantisation<8>, jpeg_storage>;

/// On a sensor whose give is known: the layer is all that is soft, from the skin to what is behind the film.
/// rigid_sensor, semi_rigid_sensor and flexible_sensor (simulation/contact/bonded_layer.hpp) are such
/// layers: compliant_scene({}, {}, contact<bonded_layer>{flexible_sensor}).
using compliant_scene =
    scene<paper_array, contact<bonded_layer>, film_texture, saturation, quantisation<8>, jpeg_storage>;

/// The same touches as an ideal array would show them.
using ideal_scene = scene<paper_array, contact<winkler>, saturation, quantisation<8>>;

} // namespace simulation
} // namespace TACTNET_ARCH
} // namespace tactnet

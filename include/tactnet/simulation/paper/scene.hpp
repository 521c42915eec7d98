#pragma once

#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/simulation/contact/elastic.hpp>
#include <tactnet/simulation/contact/winkler.hpp>
#include <tactnet/simulation/effects/circuit/conversion.hpp>
#include <tactnet/simulation/effects/film/response.hpp>
#include <tactnet/simulation/effects/mechanics/pad.hpp>
#include <tactnet/simulation/effects/storage/jpeg.hpp>
#include <tactnet/simulation/scene.hpp>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// The array of the paper's images.
using paper_array = array<tekscan_6077::extents.rows, tekscan_6077::extents.columns>;

/// The effects that make simulated images resemble the paper's: on its array, as 8-bit counts from a JPEG
/// file. Without one of them, simulated images are easy to distinguish.
using paper_scene = scene<paper_array, contact<winkler>, elastic_pad, film_texture, saturation,
                          quantisation<8>, jpeg_storage>;

/// The effects of paper_scene with an accurate contact model, in which cells influence each other. Takes
/// hundreds of times as long.
using layered_scene = scene<paper_array, contact<bonded_layer>, elastic_pad, film_texture, saturation,
                            quantisation<8>, jpeg_storage>;

/// A sensor of known compliance: the layer includes all that is soft, from the skin to the backing of the
/// film. For example compliant_scene({}, {}, contact<bonded_layer>{flexible_sensor}).
using compliant_scene =
    scene<paper_array, contact<bonded_layer>, film_texture, saturation, quantisation<8>, jpeg_storage>;

/// An ideal array.
using ideal_scene = scene<paper_array, contact<winkler>, saturation, quantisation<8>>;

}}} // namespace tactnet::simulation

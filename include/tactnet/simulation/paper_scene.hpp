#pragma once

#include <tactnet/simulation/bonded_layer.hpp>
#include <tactnet/simulation/film_texture.hpp>
#include <tactnet/simulation/jpeg_storage.hpp>
#include <tactnet/simulation/pad.hpp>
#include <tactnet/simulation/quantisation.hpp>
#include <tactnet/simulation/saturation.hpp>
#include <tactnet/simulation/scene.hpp>
#include <tactnet/simulation/winkler.hpp>

namespace tactnet::inline TACTNET_ARCH {
namespace simulation {

/// What the paper's images call for, and no more: the effects without which simulated images are told from
/// them at a glance. On the 28 × 50 array of the paper, as 8-bit counts that went through a JPEG file.
using paper_scene = scene<array<28, 50>, contact<winkler>, elastic_pad, film_texture, saturation,
                          quantisation<8>, jpeg_storage>;

/// With the accurate model of contact, which lets neighbours sink with what presses beside them: for touches
/// of which the pressures themselves matter. Takes hundreds of times as long.
using layered_scene = scene<array<28, 50>, contact<bonded_layer>, elastic_pad, film_texture, saturation,
                            quantisation<8>, jpeg_storage>;

/// The same touches as an ideal array would show them.
using ideal_scene = scene<array<28, 50>, contact<winkler>, saturation, quantisation<8>>;

} // namespace simulation
} // namespace tactnet

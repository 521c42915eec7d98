#pragma once

#include <tactnet/runtime/random.hpp>
#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/simulation/contact/contact.hpp>
#include <tactnet/simulation/contact/elastic.hpp>
#include <tactnet/simulation/effects/circuit/conversion.hpp>
#include <tactnet/simulation/effects/film/response.hpp>
#include <tactnet/simulation/effects/mechanics.hpp>
#include <tactnet/simulation/effects/storage.hpp>
#include <tactnet/simulation/objects/object.hpp>
#include <tactnet/simulation/paper/bars.hpp>
#include <tactnet/simulation/paper/solids.hpp>
#include <tactnet/simulation/paper/tools.hpp>
#include <tactnet/simulation/scene.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

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

/// The 22 classes of the paper, in the order of their names.
inline constexpr std::array<object_family, 22> paper_objects{{
    {"adhesive", objects::adhesive},
    {"allen_key", objects::allen_key},
    {"arm", objects::arm},
    {"ball", objects::ball},
    {"bottle", objects::bottle},
    {"box", objects::box},
    {"branch", objects::branch},
    {"cable", objects::cable},
    {"cable_pipe", objects::cable_pipe},
    {"caliper", objects::caliper},
    {"can", objects::can},
    {"finger", objects::finger},
    {"hand", objects::hand},
    {"highlighter", objects::highlighter},
    {"key", objects::key},
    {"pen", objects::pen},
    {"pliers", objects::pliers},
    {"rock", objects::rock},
    {"rubber", objects::rubber},
    {"scissors", objects::scissors},
    {"sticky_tape", objects::sticky_tape},
    {"tube", objects::tube},
}};

/// Draws touch `number` of a class, an index of paper_objects. Bit-identical wherever it runs.
[[nodiscard]] inline touch draw_touch(std::size_t label, std::uint64_t seed, std::uint32_t number) {
    enum what : std::uint32_t { shape = 4, pose = 5, force = 6 }; // of 64 per class
    const auto stream = [&](what drawn) {
        return random_stream(seed, random_purposes::touch, number,
                             static_cast<std::uint32_t>(label) * 64 + drawn);
    };
    drawing draw(stream(shape), stream(pose), stream(force));
    return paper_objects.at(label).draw(draw);
}

/// Simulates touch `number` of a class, each on a sensor of its own, so that a network does not learn the
/// flaws of one sensor. Bit-identical wherever it runs.
template <class Scene>
void simulate_paper_touch(Scene& scene, std::size_t label, std::uint64_t seed, std::uint32_t number,
                          typename Scene::frames& result) {
    const auto mixed =
        philox({number, static_cast<std::uint32_t>(label), 0, random_purposes::sensor.number()},
               {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)});
    const std::uint64_t own = std::uint64_t{mixed[0]} << 32 | mixed[1];
    scene.use(sensor_unit{own});
    simulate(scene, draw_touch(label, seed, number), {.seed = own, .frame = number}, result);
}

}}} // namespace tactnet::simulation

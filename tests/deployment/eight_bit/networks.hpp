#pragma once

// Networks in 8 bits for these tests: filled with numbers and calibrated on a few frames.

#include "../deployed_network.hpp"

#include <tactnet/io/eight_bit_file.hpp>
#include <tactnet/quantisation/calibration.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <support/layers/whole_reference.hpp>
#include <support/same_bits.hpp>
#include <utility>
#include <vector>

namespace support {

template <class Network>
using byte_network = tactnet::deployed<Network, tactnet::eight_bit>;

constexpr float input_scale = 1.0f / 64;

/// A mean frame that is no whole number of steps.
template <class Network>
std::vector<float> mean_for(std::uint64_t seed) {
    std::vector<float> mean(Network::input_shape.size());
    numbers draw(seed + 7);
    for (float& m : mean)
        m = draw.next(0, 60);
    return mean;
}
template <class Network>
std::vector<float> frames_for(std::size_t count, std::uint64_t seed) {
    std::vector<float> frames;
    for (std::size_t i = 0; i < count; ++i) {
        const std::vector<std::uint8_t> frame = make_frame(Network::input_shape.size(), seed * 100 + i);
        frames.insert(frames.end(), frame.begin(), frame.end());
    }
    return frames;
}
template <class Network>
tactnet::eight_bit_calibration<Network> calibrated(const Network& net, std::uint64_t seed,
                                                   std::size_t images) {
    const std::vector<float> mean = mean_for<Network>(seed), frames = frames_for<Network>(images, seed + 50);
    return {net, std::span(mean).template first<Network::input_shape.size()>(), input_scale,
            std::span<const float>(frames)};
}

/// The mean square of numbers, or of their differences from others.
inline double mean_square(std::span<const float> a, std::span<const float> b = {}) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += std::pow(static_cast<double>(a[i]) - (b.empty() ? 0.0 : static_cast<double>(b[i])), 2);
    return sum / static_cast<double>(a.size());
}

/// Whether a step in 8 bits has a reference in whole numbers.
template <class Step>
concept has_whole_reference = requires { &reference_step<Step>::run; };
template <class Steps>
inline constexpr bool all_have_whole_references = [] {
    return []<std::size_t... I>(std::index_sequence<I...>) {
        return (has_whole_reference<typename Steps::template at<I>> && ...);
    }(std::make_index_sequence<Steps::size>{});
}();

/// Without one, a byte of a step may be half a step from what its reference for calibration says of the
/// values of the input, and 1/256 for at most 256 roundings of numbers up to 255 steps. Returns how many are
/// further, and sets the map to what was found.
template <class Step>
std::size_t bytes_outside(const float* folded, const std::uint8_t* found, whole_map& map) {
    const auto [input, added, output] = Step::arrays.read_ranges(folded);
    std::vector<float> in, exact(Step::output.size());
    for (const std::int64_t byte : map.whole)
        in.push_back((static_cast<float>(byte) - input.zero_point) * input.scale);
    Step::reference(folded, in.data(), exact.data());
    map = whole_map(Step::output);
    std::size_t outside = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        map.whole[i] = found[i / map.channels * Step::output_stride + i % map.channels];
        const double wanted = std::clamp(static_cast<double>(exact[i]) / static_cast<double>(output.scale) +
                                             static_cast<double>(output.zero_point),
                                         0.0, 255.0);
        outside += !(std::abs(static_cast<double>(map.whole[i]) - wanted) <= 0.5 + 1.0 / 256);
    }
    return outside;
}

/// The steps of a plan that write other bytes than the reference, each given the reference's input.
/// Memory holds garbage before, and so do lanes after the last channel of the input.
template <class Network>
std::size_t steps_that_differ(std::span<const float> all_folded, std::span<const std::uint8_t> counts) {
    using view = typename byte_network<Network>::view_type;
    using steps = typename view::steps;
    using input = tactnet::input_stage<tactnet::eight_bit, Network::input_shape>;
    const float* folded = all_folded.data() + view::steps_folded;
    whole_map map = reference_entrance<Network::input_shape>(all_folded.data(), counts);
    std::size_t stride = map.channels, element = sizeof(std::int16_t), different = 0;

    tactnet::aligned_vector<std::int8_t> first(input::packed_elements);
    input::pack(all_folded.data(), first.data());
    tactnet::aligned_vector<std::uint8_t> words(input::map, std::uint8_t{0xa5});
    different += !input::read(first.data(), counts.data(), words.data());
    for (std::size_t i = 0; i < map.whole.size(); ++i) {
        std::int16_t word;
        std::memcpy(&word, words.data() + i * sizeof(word), sizeof(word));
        different += word != map.whole[i];
    }

    const auto one = [&]<class Step>(std::type_identity<Step>) {
        tactnet::aligned_vector<std::uint8_t> in(
            tactnet::pad_to_cache_line<std::uint8_t>(map.rows * map.columns * stride * element),
            std::uint8_t{0xa5});
        for (std::size_t i = 0; i < map.whole.size(); ++i) {
            const auto word = static_cast<std::int16_t>(map.whole[i]);
            std::memcpy(in.data() + (i / map.channels * stride + i % map.channels) * element, &word, element);
        }
        tactnet::aligned_vector<std::int8_t> packed(Step::packed_elements);
        Step::pack(folded, packed.data());
        const std::size_t elements = Step::output.area() * Step::output_stride;
        tactnet::aligned_vector<std::uint8_t> out(elements * sizeof(float), std::uint8_t{0x5a}),
            memory(Step::workspace_elements, std::uint8_t{0xff});
        Step::run(packed.data(), in.data(), out.data(), memory.data());
        if constexpr (!has_whole_reference<Step>) {
            different += bytes_outside<Step>(folded, out.data(), map) > 0;
        } else {
            map = reference_step<Step>::run(folded, map, whole_map{});
            const bool floats = std::is_same_v<Step, typename steps::template at<steps::size - 1>>;
            bool same = map.rows == Step::output.rows && map.columns == Step::output.columns &&
                        map.channels == Step::output.channels;
            for (std::size_t i = 0; same && i < map.whole.size(); ++i) {
                const std::size_t at = i / map.channels * Step::output_stride + i % map.channels;
                same = floats
                           ? std::memcmp(out.data() + at * sizeof(float), &map.floats[i], sizeof(float)) == 0
                           : out[at] == map.whole[i];
            }
            different += !same;
        }
        folded += Step::folded_elements, stride = Step::output_stride, element = 1;
    };
    [&]<std::size_t... I>(std::index_sequence<I...>) {
        (one(std::type_identity<typename steps::template at<I>>{}), ...);
    }(std::make_index_sequence<steps::size>{});
    return different;
}

/// The content of its weight file, with that many classes and images to test itself with.
template <class Network>
std::vector<std::byte> file_of(const byte_network<Network>& network, std::size_t classes,
                               std::span<const std::uint8_t> images = {}) {
    std::vector<std::string> names;
    for (std::size_t c = 0; c < classes; ++c)
        names.push_back("class " + std::to_string(c));
    tactnet::safetensors_writer writer;
    tactnet::add_deployed(writer, tactnet::folded_layout_of<typename byte_network<Network>::view_type>(),
                          network.folded(), names, images, [&](std::span<const std::uint8_t> some) {
                              return tactnet::detail::logits_of(network, some, classes);
                          });
    return writer.to_bytes();
}
template <class Network>
tactnet::deployed<Network, tactnet::eight_bit> from_file(std::vector<std::byte> bytes) {
    return tactnet::load_deployed<Network, tactnet::eight_bit>(
        tactnet::safetensors::parse(std::move(bytes), "net.safetensors"));
}

/// How many of some frames give other bits than the reference says, as outputs, in a step or from a file; of
/// steps without one in whole numbers, bytes too far from their own.
template <class Network>
std::size_t frames_that_differ(std::uint64_t seed, std::size_t frames, std::size_t images = 3) {
    const auto net = std::make_unique<Network>();
    fill(*net, seed);
    const tactnet::eight_bit_calibration<Network> calibration = calibrated(*net, seed, images);
    const byte_network<Network> network(calibration.folded());
    const auto memory = std::make_unique<typename byte_network<Network>::workspace>();
    std::memset(static_cast<void*>(memory.get()), 0xff, sizeof(*memory));
    // A file keeps every bit.
    const auto loaded = from_file<Network>(file_of<Network>(network, Network::outputs));
    std::size_t different = !same_bits(loaded.folded(), network.folded());
    for (std::size_t i = 0; i < frames; ++i) {
        const std::vector<std::uint8_t> counts = make_frame(Network::input_shape.size(), seed * 100 + i);
        const std::span<const std::uint8_t> frame(counts);
        std::vector<float> out(Network::outputs, NAN);
        const auto status =
            network.infer(tactnet::tensor_view<const std::uint8_t, Network::input_shape>(counts.data()),
                          std::span<float, Network::outputs>(out), *memory);
        const auto of_loaded = tactnet::detail::logits_of(loaded, frame, Network::outputs);
        std::vector<float> expected = out;
        if constexpr (all_have_whole_references<typename byte_network<Network>::view_type::steps>)
            expected =
                reference_outputs<typename byte_network<Network>::view_type>(calibration.folded(), frame);
        different += status != tactnet::frame_status::ok || !same_bits(out, expected) ||
                     !same_bits(of_loaded, expected) ||
                     (i < 2 && steps_that_differ<Network>(calibration.folded(), frame) > 0);
    }
    return different;
}

} // namespace support

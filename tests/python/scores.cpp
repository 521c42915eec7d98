// What the C++ library makes of a weight file and frames, to the bit: scores FILE FRAMES [FILE_IN_8_BITS]
// prints all outputs as hexadecimal numbers; then clean frames and areas of contacts, after ten frames of
// air; what a scene measures of the last frame, with heights of 10 µm for each count below 255; and a
// probability by the last outputs, in two grasps; features, their points of a discriminant, the nearest
// means of the last ten, and a gain. At last the nanoseconds per call. means.state has what was learnt.

#include <tactnet/decision.hpp>
#include <tactnet/io.hpp>
#include <tactnet/quantisation.hpp>
#include <tactnet/simulation/effects/circuit/conversion.hpp>
#include <tactnet/simulation/effects/circuit/wiring.hpp>
#include <tactnet/simulation/scene.hpp>
#include <tactnet/tactnet.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <span>
#include <vector>

using net = tactnet::tactnet4<tactnet::shape{14, 25}, 5>;

template <class Deployed>
std::array<float, net::outputs> print(const Deployed& network, const std::vector<std::byte>& frames) {
    std::array<float, net::outputs> outputs{};
    std::array<std::uint8_t, 14 * 25> frame{};
    for (std::size_t i = 0; i < frames.size(); i += frame.size()) {
        std::transform(&frames[i], &frames[i] + frame.size(), frame.begin(),
                       [](std::byte count) { return std::to_integer<std::uint8_t>(count); });
        if (network.infer(frame, outputs) != tactnet::frame_status::ok)
            std::puts("broken");
        for (const float output : outputs)
            std::printf("%a\n", static_cast<double>(output));
    }
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < 20000; ++i)
        static_cast<void>(network.infer(frame, outputs));
    const std::chrono::duration<double, std::nano> taken = std::chrono::steady_clock::now() - begin;
    std::fprintf(stderr, "%.0f\n", taken.count() / 20000);
    return outputs;
}

void print(std::span<const float> numbers) {
    for (const float number : numbers)
        std::printf("%a\n", static_cast<double>(number));
}

void print_touches(const std::vector<std::byte>& frames, std::span<const float, net::outputs> logits) {
    constexpr tactnet::shape array{14, 25};
    tactnet::sensor_health<array, float> health({.full = 200});
    tactnet::contact_detector<array, float> detector;
    std::array<std::uint8_t, array.size()> frame{};
    for (std::size_t i = 0; i < frames.size() / frame.size(); ++i) {
        std::memcpy(frame.data(), &frames[i * frame.size()], frame.size());
        if (i < 10)
            health.learn(frame);
        const auto clean = health.clean(frame);
        if (i < 10) {
            detector.learn(clean);
            continue;
        }
        print(clean);
        const tactnet::contact_state& now = detector.update(clean);
        const auto area = static_cast<float>(now.area);
        print({&area, 1});
        if (!now.touching)
            health.follow(frame);
    }
    using namespace tactnet::simulation;
    using scene_type = scene<tactnet::simulation::array<14, 25>, contact<winkler>, noise, quantisation<8>>;
    scene_type scene({}, {7}, noise{.additive = 300});
    tactnet::tensor<float, array> heights;
    std::transform(frame.begin(), frame.end(), heights.begin(),
                   [](std::uint8_t count) { return static_cast<float>(255 - count) * 1e-5F; });
    scene_type::frames found;
    scene.touch(heights.view(), pressing::to_force(5), {.seed = 3, .frame = 2}, found);
    print({found.measured.data(), found.measured.size()});
    tactnet::touch_evidence<net::outputs> evidence(net::outputs, tactnet::temperature_scaling{2});
    evidence.add_frame(logits);
    evidence.end_grasp();
    evidence.add_frame(logits);
    std::printf("%a\n", evidence.most_likely()->probability);
}

void print_objects(const tactnet::deployed<net>& network, const std::vector<std::byte>& frames) {
    using network_type = tactnet::deployed<net>;
    constexpr std::size_t features = network_type::view_type::features, size = 14 * 25;
    std::vector<std::uint8_t> counts(frames.size());
    std::memcpy(counts.data(), frames.data(), frames.size());
    const std::size_t count = counts.size() / size;
    const auto memory = std::make_unique<network_type::workspace>();
    std::vector<float> rows(count * features);
    std::vector<std::size_t> labels(count);
    for (std::size_t i = 0; i < count; ++i) {
        std::array<float, net::outputs> logits;
        (void)network.infer(std::span(counts).subspan(i * size).first<size>(), logits, *memory);
        network.view().read_features(*memory, std::span(rows).subspan(i * features).first<features>());
        labels[i] = i % 5;
    }
    print(rows);
    const auto map = tactnet::fit_discriminant<features, 4>(rows, labels, 5);
    tactnet::class_means<4, 8> means;
    for (std::size_t i = 0; i < count; ++i) {
        const auto point = map->project(std::span(rows).subspan(i * features).first<features>());
        print(point);
        if (i < count - 10) {
            means.learn(labels[i], point);
            continue;
        }
        const auto found = means.nearest(point);
        std::printf("%zu\n%a\n%a\n", found->index, found->squared_distance, found->relative_distance);
    }
    const auto state = means.save();
    std::ofstream("means.state", std::ios::binary)
        .write(reinterpret_cast<const char*>(state.data()), static_cast<std::streamsize>(state.size()));
    tactnet::gain_monitor monitor(tactnet::force_statistics::of(counts, size, 8), 20);
    for (int touch = 0; touch < 30; ++touch)
        monitor.add_touch(3000 + 500 * touch);
    std::printf("%a\n%a\n", monitor.gain(), monitor.uncertainty());
}

int main(int, char** arguments) {
    const std::vector<std::byte> frames = tactnet::read_file(arguments[2]);
    const auto network = tactnet::load_deployed<net>(arguments[1]);
    print(network, frames);
    const auto logits = print(tactnet::load_deployed<net, tactnet::eight_bit>(arguments[3]), frames);
    print_touches(frames, logits);
    print_objects(network, frames);
}

// Resize and augmentation of tactile images, compared with OpenCV if it was found, on one core. Rounds of all
// are interleaved, so that a change of the machine's speed meets them alike; what is timed is checked first.
// Run it pinned to an idle core.

#include "../peers/image_peer.hpp"
#include "../support/measure.hpp"

#include <tactnet/image.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <vector>

namespace {

using tactnet::shape;

constexpr shape frame{28, 50};
constexpr std::size_t rounds = 101;

const tactnet::tensor<float, frame>& image() {
    static const auto pixels = [] {
        tactnet::tensor<float, frame> drawn;
        tactnet::random_stream random(1, tactnet::random_purposes::order);
        for (float& value : drawn)
            value = static_cast<float>(random.uniform(0, 255));
        return drawn;
    }();
    return pixels;
}

/// What is timed, and what it is compared with.
struct task {
    const char* name;
    std::size_t calls; ///< in one round
    std::function<void()> ours{}, peer{};
    double goal;           ///< how many times as fast
    double difference = 0; ///< of both results, largest
    double allowed = 0;    ///< by both definitions
    double ours_seconds = 1e9, peer_seconds = 1e9;
};

template <shape To>
tactnet::tensor<float, To> ours_resized;
template <shape To>
tactnet::tensor<float, To> peers_resized;

template <shape To, class Kernel>
task resize_task(const char* name, std::size_t calls, double goal) {
    task t{.name = name, .calls = calls, .goal = goal};
    t.ours = [] { tactnet::resize<frame, To, Kernel>(image().view(), ours_resized<To>.view()); };
#ifdef TACTNET_BENCHMARK_OPENCV
    t.peer = [] {
        benchmark::opencv_resize(image().data(), {frame.rows, frame.columns}, peers_resized<To>.data(),
                                 {To.rows, To.columns});
    };
    // Compared with OpenCV's own kernel, whichever is timed.
    tactnet::resize<frame, To, tactnet::opencv_cubic>(image().view(), ours_resized<To>.view());
    t.peer();
    for (std::size_t e = 0; e < To.size(); ++e)
        t.difference =
            std::max(t.difference,
                     static_cast<double>(std::abs(ours_resized<To>.data()[e] - peers_resized<To>.data()[e])));
    t.allowed = 255e-5;
#endif
    return t;
}

/// In and out of a pixel's neighbourhood within OpenCV's 1/32 of a pixel: positions are rounded to that.
task affine_task() {
    static tactnet::tensor<float, frame> ours;
    static std::uint32_t sample = 0;
    static const tactnet::augmentation_ranges ranges{.reflect_rows = 0.5,
                                                     .reflect_columns = 0.5,
                                                     .translation = 3,
                                                     .rotation = 10,
                                                     .scale = 0.1,
                                                     .pressure = 0.3};
    static const auto draw = [](std::uint32_t number) {
        tactnet::random_stream random(1, tactnet::random_purposes::augmentation, 0, number);
        return tactnet::image_transform::draw(ranges, random);
    };
    task t{.name = "28x50 random affine, bilinear, drawn", .calls = 500, .goal = 3};
    t.ours = [] { tactnet::transform_image<frame>(draw(sample++), image().view(), ours.view()); };
#ifdef TACTNET_BENCHMARK_OPENCV
    static tactnet::tensor<float, frame> peers;
    static const auto warp = [](const tactnet::image_transform& m) {
        const double x = (frame.columns - 1) / 2.0, y = (frame.rows - 1) / 2.0;
        const double map[6]{m.column_by_column,
                            m.column_by_row,
                            m.column_shift + x - m.column_by_column * x - m.column_by_row * y,
                            m.row_by_column,
                            m.row_by_row,
                            m.row_shift + y - m.row_by_column * x - m.row_by_row * y};
        benchmark::opencv_affine(image().data(), peers.data(), {frame.rows, frame.columns}, map);
    };
    t.peer = [] { warp(draw(0)); };
    tactnet::image_transform same = draw(0);
    same.gain = 1; // which OpenCV leaves out
    tactnet::transform_image<frame>(same, image().view(), ours.view());
    warp(same);
    for (std::size_t e = 0; e < frame.size(); ++e)
        t.difference =
            std::max(t.difference, static_cast<double>(std::abs(ours.data()[e] - peers.data()[e])));
    t.allowed = 2 * 255 / 32.0;
#endif
    return t;
}

} // namespace

int main() {
    std::vector<task> tasks{
        resize_task<shape{227, 227}, tactnet::opencv_cubic>("28x50 to 227x227, a = -3/4", 50, 4),
        resize_task<shape{227, 227}, tactnet::lagrange_cubic>("28x50 to 227x227, Lagrange", 50, 4),
        resize_task<shape{14, 25}, tactnet::keys_cubic<>>("28x50 to 14x25, antialiased", 2000, 4),
        resize_task<shape{14, 25}, tactnet::opencv_cubic>("28x50 to 14x25, a = -3/4", 2000, 4),
        resize_task<shape{20, 35}, tactnet::keys_cubic<>>("28x50 to 20x35, antialiased", 2000, 0),
        affine_task(),
    };
#ifdef TACTNET_BENCHMARK_OPENCV
    benchmark::opencv_on_one_thread();
#endif
    for (std::size_t r = 0; r < rounds; ++r)
        for (task& t : tasks) {
            t.ours_seconds = std::min(t.ours_seconds, benchmark::seconds_of(t.ours, t.calls));
            if (t.peer)
                t.peer_seconds = std::min(t.peer_seconds, benchmark::seconds_of(t.peer, t.calls));
        }
    std::printf(
        "one core, %zu lanes, microseconds in the fastest of %zu interleaved rounds\n%-38s %9s %9s %7s "
        "%6s %12s\n",
        tactnet::kernels::lanes<float>, rounds, "", "tactnet", "OpenCV", "ratio", "goal", "difference");
    bool good = true;
    for (const task& t : tasks) {
        std::printf("%-38s %9.3f", t.name, 1e6 * t.ours_seconds);
        if (t.peer)
            std::printf(" %9.3f %7.2f %6.1f %12.2g%s", 1e6 * t.peer_seconds, t.peer_seconds / t.ours_seconds,
                        t.goal, t.difference, t.difference <= t.allowed ? "" : " DIFFERENT");
        std::printf("\n");
        good = good && t.difference <= t.allowed;
    }
#ifdef TACTNET_BENCHMARK_OPENCV
    std::printf("OpenCV %s, INTER_CUBIC without antialiasing and warpAffine with INTER_LINEAR\n",
                benchmark::opencv_version());
#endif
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}

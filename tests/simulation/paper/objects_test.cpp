#include "../witness.hpp"

#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/simulation/paper/objects.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace {

using namespace tactnet::simulation;

std::vector<float> images_of(std::size_t count, std::size_t threads) {
    std::vector<float> all(count * paper_scene::output.size());
    tactnet::thread_pool pool(threads);
    pool.on_each_thread([&](auto share) {
        paper_scene scene;
        paper_scene::frames frames;
        for (std::size_t index = share.begin(count); index < share.end(count); ++index) {
            simulate_paper_touch(scene, index % paper_objects.size(), 3,
                                 static_cast<std::uint32_t>(index / paper_objects.size()), frames);
            std::copy(frames.measured.begin(), frames.measured.end(),
                      all.begin() + static_cast<std::ptrdiff_t>(index * paper_scene::output.size()));
        }
    });
    return all;
}

TEST_CASE("objects: the classes are those of the paper, in the order of a folder") {
    CHECK(paper_objects.size() == 22);
    CHECK(std::ranges::is_sorted(paper_objects, {}, &object_family::name));
}

TEST_CASE("objects: every draw of every class touches the array, with whole counts and a force that is met") {
    paper_scene scene;
    paper_scene::frames frames;
    for (std::size_t label = 0; label < paper_objects.size(); ++label) {
        CAPTURE(paper_objects[label].name);
        for (std::uint32_t number = 0; number < 100; ++number) {
            CAPTURE(number);
            const touch drawn = draw_touch(label, 5, number);
            simulate_paper_touch(scene, label, 5, number, frames);
            CHECK(frames.contact.converged);
            CHECK(frames.contact.force == doctest::Approx(drawn.press.amount).epsilon(1e-3));
            const auto touched =
                std::ranges::count_if(frames.measured, [](float count) { return count > 15; });
            CHECK(touched >= 5);
            CHECK(std::ranges::all_of(frames.measured, [](float count) {
                return count >= 0 && count <= 255 && count == std::floor(count);
            }));
        }
    }
}

TEST_CASE("objects: an image is the same wherever it is made, and unlike every other") {
    const auto alone = images_of(110, 1);
    CHECK(alone == images_of(110, 2));
    CHECK(alone == images_of(110, 3));
    const std::size_t size = paper_scene::output.size();
    std::set<std::vector<float>> different;
    for (std::size_t image = 0; image < 110; ++image)
        different.emplace(alone.begin() + static_cast<std::ptrdiff_t>(image * size),
                          alone.begin() + static_cast<std::ptrdiff_t>((image + 1) * size));
    CHECK(different.size() == 110);
}

TEST_CASE("objects: classes are drawn apart, though all from one seed") {
    const auto drawn = [](std::string_view name) {
        const auto found = std::ranges::find(paper_objects, name, &object_family::name);
        return draw_touch(static_cast<std::size_t>(found - paper_objects.begin()), 1, 0).at.position;
    };
    // These three lie anywhere in the same range.
    CHECK(drawn("can").x != drawn("pen").x);
    CHECK(drawn("pen").x != drawn("tube").x);
    CHECK_THROWS_AS(static_cast<void>(draw_touch(paper_objects.size(), 1, 0)), std::out_of_range);
}

TEST_CASE("objects: soft bodies are broad and faint, tools sharp") {
    const auto over = [](std::string_view name) {
        const auto found = std::ranges::find(paper_objects, name, &object_family::name);
        const auto label = static_cast<std::size_t>(found - paper_objects.begin());
        std::vector<double> highest, touched;
        ideal_scene scene;
        ideal_scene::frames frames;
        for (std::uint32_t number = 0; number < 40; ++number) {
            simulate_paper_touch(scene, label, 9, number, frames);
            highest.push_back(static_cast<double>(std::ranges::max(frames.measured)));
            touched.push_back(
                static_cast<double>(std::ranges::count_if(frames.measured, [](float c) { return c > 0; })));
        }
        const auto median = [](std::vector<double> values) {
            std::ranges::sort(values);
            return values[values.size() / 2];
        };
        return std::pair{median(highest), median(touched)};
    };
    for (const auto* soft : {"arm", "hand"})
        for (const auto* sharp : {"allen_key", "branch", "rock"}) {
            CHECK(over(soft).first < 0.5 * over(sharp).first);
            CHECK(over(soft).second > 2 * over(sharp).second);
        }
}

} // namespace

namespace {

using namespace support;

TEST_CASE("simulate: each touch of the paper's classes has a sensor and random numbers of its own, to the "
          "seed's last bit") {
    watched scene;
    watched::frames result;
    std::set<std::uint64_t> sensors;
    std::size_t touches = 0;
    for (const std::uint64_t seed : {0ull, 1ull, 1ull << 32, ~0ull})
        for (const std::size_t label : {0u, 1u, 21u})
            for (const std::uint32_t number : {0u, 1u, 7u}) {
                simulate_paper_touch(scene, label, seed, number, result);
                CHECK(said(result, 1) == said(result, 0));
                CHECK(said(result, 2) == number);
                sensors.insert(said(result, 0));
                ++touches;
            }
    CHECK(sensors.size() == touches);
}

} // namespace

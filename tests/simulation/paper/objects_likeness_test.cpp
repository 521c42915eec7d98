// Simulated images compared with the real ones, class by class: how much of the array shows anything, and how
// much. Needs the paper's images.

#include <tactnet/io/images/folder.hpp>
#include <tactnet/simulation/paper/objects.hpp>

#include <doctest/doctest.h>

#include <decode_image.hpp>
#include <string>
#include <support/files/data_folder.hpp>
#include <vector>

namespace {

using namespace tactnet::simulation;

class likeness {
public:
    template <class Counts>
    void add(const Counts& counts) {
        double sum = 0, touched = 0, all = 0;
        for (const auto count : counts)
            sum += static_cast<double>(count), touched += count > 0, ++all;
        contact_ += touched / all;
        mean_ += touched > 0 ? sum / touched : 0;
        ++images_;
    }
    double contact() const { return contact_ / images_; }
    double mean() const { return mean_ / images_; }

private:
    double contact_ = 0, mean_ = 0, images_ = 0;
};

TEST_CASE(
    "paper_scene: contact and pressure of simulated images are within a factor of 1.5 of the real ones" *
    doctest::test_suite("data")) {
    const auto folder = support::find_data("tactile_images");
    if (!folder)
        return;
    const tactnet::image_folder list = tactnet::list_image_folder(*folder);
    REQUIRE(list.classes.size() == paper_objects.size());
    std::vector<likeness> real(list.classes.size());
    for (const auto& file : list.files)
        real[file.label].add(decode_image(file.path).pixels);

    const auto alike = [](double a, double b) { return a < 1.5 * b && b < 1.5 * a; };
    paper_scene scene;
    paper_scene::frames frames;
    std::size_t good = 0;
    for (std::size_t label = 0; label < paper_objects.size(); ++label) {
        REQUIRE(list.classes[label] == paper_objects[label].name);
        likeness simulated;
        for (std::uint32_t number = 0; number < 50; ++number) {
            simulate_paper_touch(scene, label, 1, number, frames);
            simulated.add(frames.measured);
        }
        const bool both =
            alike(simulated.contact(), real[label].contact()) && alike(simulated.mean(), real[label].mean());
        good += both;
        if (!both)
            MESSAGE(list.classes[label], ": contact ", simulated.contact(), " and ", real[label].contact(),
                    ", mean ", simulated.mean(), " and ", real[label].mean());
    }
    CHECK(good >= 18);
}

} // namespace

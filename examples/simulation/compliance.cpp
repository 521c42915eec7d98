// How much the sensor gives way, and what of it reaches the images: simulated touches of the paper's 22
// classes on a rigid, a semi-rigid and a flexible sensor, the same objects pressed alike. Writes CSV to
// standard output, a line per image, with the two numbers of the paper's histograms, which
// docs/pictures/source/compliance.gnuplot draws.
//
//     tactnet_compliance [IMAGES_PER_CLASS] > compliance.csv

#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/simulation/contact/elastic.hpp>
#include <tactnet/simulation/paper/objects.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace {

using namespace tactnet::simulation;

/// Contact area: tactels that show anything. Mean tactel: of those, in counts. To standard error their means,
/// and which share of all pressures lay beyond full scale, where the converter cuts them off.
void write(const char* sensor, const bonded_layer& layer, std::uint32_t per_class) {
    compliant_scene scene({}, {}, contact<bonded_layer>{layer});
    compliant_scene::frames frames;
    double contact_sum = 0, mean_sum = 0, pressures = 0, beyond = 0;
    for (std::size_t label = 0; label < paper_objects.size(); ++label)
        for (std::uint32_t number = 0; number < per_class; ++number) {
            simulate_paper_touch(scene, label, 1, number, frames);
            double sum = 0;
            std::size_t touched = 0;
            for (const float count : frames.measured)
                sum += static_cast<double>(count), touched += count > 0;
            const double mean = touched > 0 ? sum / static_cast<double>(touched) : 0;
            std::printf("%s,%.*s,%u,%zu,%.3f\n", sensor, static_cast<int>(paper_objects[label].name.size()),
                        paper_objects[label].name.data(), number, touched, mean);
            contact_sum += static_cast<double>(touched), mean_sum += mean;
            for (const float pressure : frames.clean) {
                const double pascals = static_cast<double>(pressure);
                pressures += pascals,
                    beyond += std::max(pascals - tactnet::tekscan_6077::saturation_pressure, 0.0);
            }
        }
    const double images = static_cast<double>(paper_objects.size()) * per_class;
    std::fprintf(
        stderr, "%s: contact %.0f tactels, mean tactel %.0f counts, %.0f %% of the force beyond full scale\n",
        sensor, contact_sum / images, mean_sum / images, 100 * beyond / pressures);
}

} // namespace

int main(int count, char** arguments) {
    const long per_class = count > 1 ? std::strtol(arguments[1], nullptr, 10) : 50;
    if (per_class < 1 || per_class > 100000) {
        std::fputs("tactnet_compliance: expected 1 to 100000 images of each class\n", stderr);
        return 2;
    }
    std::puts("sensor,class,image,contact,mean");
    write("rigid", rigid_sensor, static_cast<std::uint32_t>(per_class));
    write("semi-rigid", semi_rigid_sensor, static_cast<std::uint32_t>(per_class));
    write("flexible", flexible_sensor, static_cast<std::uint32_t>(per_class));
    return std::fflush(stdout) == 0 ? 0 : 2;
}

// Draws one picture per class of the paper: four simulated touches, and four real ones to their left if a
// folder with one subfolder of images per class is given. Prints how alike simulated and real touches are.

#include <tactnet/image/resize.hpp>
#include <tactnet/io/images/folder.hpp>
#include <tactnet/io/images/set.hpp>
#include <tactnet/simulation/paper/objects.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <decode_image.hpp>
#include <exception>
#include <filesystem>
#include <sheet.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace {

using namespace tactnet::simulation;

using frame = tactnet::tensor<float, paper_scene::output>;
constexpr std::size_t shown = 4;

struct likeness {
    double contact = 0; ///< share of tactels that show anything
    double mean = 0;    ///< of those, in counts

    static likeness of(const std::vector<frame>& images) {
        likeness all;
        for (const frame& image : images) {
            double sum = 0, touched = 0;
            for (const float count : image)
                sum += static_cast<double>(count), touched += count > 0;
            all.contact += touched / static_cast<double>(frame::size() * images.size());
            all.mean += touched > 0 ? sum / touched / static_cast<double>(images.size()) : 0;
        }
        return all;
    }
};

std::vector<frame> simulated(std::size_t label, std::size_t count) {
    paper_scene scene;
    paper_scene::frames frames;
    std::vector<frame> images;
    for (std::uint32_t number = 0; number < count; ++number) {
        simulate_paper_touch(scene, label, 1, number, frames);
        images.push_back(frames.measured);
    }
    return images;
}

std::vector<frame> real(const tactnet::image_folder& folder, std::string_view name) {
    std::vector<frame> images;
    for (const auto& file : folder.files)
        if (folder.classes[file.label] == name) {
            const tactnet::grey_image image = decode_image(file.path);
            const auto pixels = tactnet::resize_bicubic(image.pixels, image.rows, image.columns,
                                                        frame::extents.rows, frame::extents.columns);
            std::copy(pixels.begin(), pixels.end(), images.emplace_back().begin());
        }
    return images;
}

/// Spread over all of them.
void show(sheet& strip, std::size_t column, const std::vector<frame>& images) {
    for (std::size_t i = 0; i < shown && !images.empty(); ++i)
        strip.show(0, column + i, images[i * images.size() / shown]);
}

void draw(const std::filesystem::path& out, const tactnet::image_folder* folder) {
    std::filesystem::create_directories(out);
    std::printf("class,simulated contact,simulated mean%s\n", folder ? ",real contact,real mean" : "");
    for (std::size_t label = 0; label < paper_objects.size(); ++label) {
        const auto name = paper_objects[label].name;
        const auto made = simulated(label, 50);
        const auto said = likeness::of(made);
        std::printf("%s,%.3f,%.1f", std::string(name).c_str(), said.contact, said.mean);
        sheet strip(1, folder ? 2 * shown : shown, 2);
        if (folder) {
            const auto seen = real(*folder, name);
            const auto truth = likeness::of(seen);
            std::printf(",%.3f,%.1f", truth.contact, truth.mean);
            show(strip, 0, seen);
        }
        std::printf("\n");
        show(strip, folder ? shown : 0, made);
        write_png(out / (std::string(name) + ".png"), strip.height(), strip.width(), strip.pixels());
    }
}

} // namespace

int main(int count, char** arguments) {
    if (count != 2 && count != 3) {
        std::fprintf(stderr,
                     "touches: expected the folder to draw into, then perhaps a folder of real images\n");
        return 2;
    }
    try {
        if (count == 3) {
            const auto folder = tactnet::list_image_folder(arguments[2]);
            draw(arguments[1], &folder);
        } else {
            draw(arguments[1], nullptr);
        }
    } catch (const std::exception& error) {
        std::fprintf(stderr, "touches: %s\n", error.what());
        return 2;
    }
    return 0;
}

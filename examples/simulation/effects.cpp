// Draws two touches without effects, and with each effect of the simulation alone; prints what each effect
// costs per frame. Strengths are chosen so that the effect is visible, unless the default already is.

#include <tactnet/simulation.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <decode_image.hpp>
#include <exception>
#include <filesystem>
#include <sheet.hpp>
#include <string>
#include <vector>

namespace {

using namespace tactnet::simulation;

using plain = scene<paper_array, contact<winkler>, quantisation<8>>;

/// The mean of both touches, fastest of many rounds.
template <class Scene>
double microseconds(Scene& scene, const std::array<touch, 2>& touches) {
    std::array<tactnet::tensor<float, Scene::surface>, 2> heights;
    for (std::size_t i = 0; i < 2; ++i)
        compute_heights<Scene::surface>(touches[i].shape, touches[i].at, scene.cell(), heights[i].view());
    typename Scene::frames frames;
    double fastest = 1e9;
    for (std::uint32_t round = 0; round < 200; ++round) {
        const auto start = std::chrono::steady_clock::now();
        for (std::size_t i = 0; i < 2; ++i)
            scene.touch(heights[i].view(), touches[i].press, {.frame = round}, frames);
        const std::chrono::duration<double, std::micro> taken = std::chrono::steady_clock::now() - start;
        fastest = std::min(fastest, taken.count() / 2);
    }
    return fastest;
}

/// A frame after 1000 s at 42 °C, when the object was pressed twice as hard a moment before.
template <class Scene>
auto frame_of(Scene& scene, touch some) {
    typename Scene::frames frames;
    scene.reset();
    const moment now{.seconds = 1000, .celsius = 42};
    some.press.amount *= 2;
    simulate(scene, some, now, frames);
    some.press.amount /= 2;
    simulate(scene, some, now, frames);
    return frames.measured;
}

/// So that stronger readings differ from full scale.
touch lightly(touch some) {
    some.press.amount *= 0.6;
    return some;
}

class gallery {
public:
    explicit gallery(std::filesystem::path folder) : folder_(std::move(folder)) {
        std::filesystem::create_directories(folder_);
        plain scene;
        base_ = microseconds(scene, touches_);
        std::printf("effect,microseconds\ncontact and converter alone,%.1f\n", base_);
    }
    /// `Scene` is `plain` with one effect more, or another; `brightness` multiplies its counts in the
    /// picture.
    template <class Scene>
    void show(const char* name, Scene scene, float brightness = 1) {
        std::printf("%s,%.1f\n", name, microseconds(scene, touches_) - base_);
        sheet strip(1, 4, 3);
        plain without;
        for (std::size_t i = 0; i < 2; ++i) {
            strip.show(0, 2 * i, frame_of(without, touches_[i]));
            auto with = frame_of(scene, touches_[i]);
            for (float& count : with)
                count *= brightness;
            strip.show(0, 2 * i + 1, with);
        }
        write_png(folder_ / (std::string(name) + ".png"), strip.height(), strip.width(), strip.pixels());
    }
    /// An effect between contact and converter.
    template <class Effect>
    void show_analogue(const char* name, const Effect& effect) {
        show(name, scene<paper_array, contact<winkler>, Effect, quantisation<8>>({}, {}, effect));
    }
    /// An effect on counts.
    template <class Effect>
    void show_digital(const char* name, const Effect& effect) {
        show(name, scene<paper_array, contact<winkler>, quantisation<8>, Effect>({}, {}, effect));
    }

private:
    static constexpr std::size_t pliers = 16, rubber = 18;
    std::filesystem::path folder_;
    std::array<touch, 2> touches_{lightly(draw_touch(pliers, 1, 3)), lightly(draw_touch(rubber, 1, 0))};
    double base_ = 0;
};

void draw(const std::filesystem::path& folder) {
    gallery pictures(folder);
    pictures.show("bonded_layer", scene<paper_array, contact<bonded_layer>, quantisation<8>>());
    pictures.show_analogue("elastic_pad", elastic_pad{});
    pictures.show_analogue("tactel_average", tactel_average<3>{});
    pictures.show_analogue("gain_map", gain_map{});
    pictures.show_analogue("film_texture", film_texture{});
    pictures.show_analogue("linearity", linearity{.error = 0.2});
    pictures.show_analogue("hysteresis",
                           hysteresis{.plays = {{{2e3, 0.2}, {4e3, 0.2}, {8e3, 0.2}, {12e3, 0.2}}}});
    pictures.show_analogue("creep", creep{.rate = 0.1});
    pictures.show_analogue("drift", drift{.deviation = 3e-4});
    pictures.show_analogue("temperature", temperature{.sensitivity = 0.02});
    pictures.show_analogue("crosstalk", crosstalk{.along_row = 0.1, .along_column = 0.1});
    pictures.show_analogue("resistive_network", resistive_network{.grounding = 0});
    pictures.show_analogue("dead_tactels", dead_tactels{.single = 0.02, .row = 0.04, .column = 0.04});
    pictures.show_analogue("noise", noise{.additive = 1000});
    pictures.show_analogue("threshold", threshold{.level = 8e3});
    pictures.show_analogue("saturation", saturation{.limit = 12e3});
    pictures.show("quantisation", scene<paper_array, contact<winkler>, quantisation_levels<15>>(),
                  255.0f / 14);
    pictures.show_digital("resolution", resolution<14, 25>{});
    pictures.show_digital("jpeg_storage", jpeg_storage{.quality = 30});
}

} // namespace

int main(int count, char** arguments) {
    if (count != 2) {
        std::fprintf(stderr, "effects: expected the folder to draw into\n");
        return 2;
    }
    try {
        draw(arguments[1]);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "effects: %s\n", error.what());
        return 2;
    }
    return 0;
}

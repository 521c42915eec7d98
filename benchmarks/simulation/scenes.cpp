// Microseconds a frame of whole scenes on 28 × 50 tactels and one core: the mean over one touch of each of
// the paper's 22 classes. All in turns, the fastest and the median of many rounds. Run it pinned to an idle
// core.

#include <tactnet/simulation/effects/circuit/conversion.hpp>
#include <tactnet/simulation/paper/objects.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

namespace {

using namespace tactnet::simulation;

constexpr std::size_t rounds = 60;

template <class... Effects>
using tactile = scene<array<28, 50>, Effects...>;

/// A scene before the same touches.
class entry {
public:
    explicit entry(std::string name) : name_(std::move(name)) {}
    virtual ~entry() = default;

    /// All touches once; microseconds a frame.
    void time() {
        const auto start = std::chrono::steady_clock::now();
        run();
        const std::chrono::duration<double, std::micro> taken = std::chrono::steady_clock::now() - start;
        microseconds_.push_back(taken.count() / static_cast<double>(paper_objects.size()));
    }
    /// Prints its line; whether its results were right.
    bool report() {
        std::sort(microseconds_.begin(), microseconds_.end());
        std::printf("%-60s %9.1f %9.1f\n", name_.c_str(), microseconds_.front(), microseconds_[rounds / 2]);
        if (!right_)
            std::printf("WRONG result of %s\n", name_.c_str());
        return right_;
    }

protected:
    virtual void run() = 0;
    bool right_ = true;

private:
    std::string name_;
    std::vector<double> microseconds_;
};

template <class Scene>
class scene_entry final : public entry {
public:
    explicit scene_entry(std::string name) : entry(std::move(name)) {
        for (std::size_t label = 0; label < paper_objects.size(); ++label) {
            touches_.push_back(draw_touch(label, 1, 0));
            compute_heights<Scene::surface>(touches_[label].shape, touches_[label].at, scene_.cell(),
                                            heights_.emplace_back().view());
        }
    }

private:
    void run() override {
        for (std::size_t label = 0; label < touches_.size(); ++label) {
            const pressing& press = touches_[label].press;
            scene_.touch(heights_[label].view(), press, {.frame = static_cast<std::uint32_t>(label)},
                         frames_);
            right_ =
                right_ && frames_.contact.converged &&
                std::abs(frames_.contact.force - press.amount) < 1e-3 * press.amount &&
                std::ranges::all_of(frames_.measured, [](float count) { return count >= 0 && count <= 255; });
        }
    }

    Scene scene_;
    std::vector<touch> touches_;
    std::vector<tactnet::tensor<float, Scene::surface>> heights_;
    typename Scene::frames frames_;
};

/// What it takes to draw a touch and to lay it on the array.
class drawing_entry final : public entry {
public:
    using entry::entry;

private:
    void run() override {
        for (std::size_t label = 0; label < paper_objects.size(); ++label) {
            const touch drawn = draw_touch(label, 1, 0);
            compute_heights<paper_scene::surface>(drawn.shape, drawn.at, array<28, 50>{}.pitch,
                                                  heights_.view());
            right_ =
                right_ && std::ranges::any_of(heights_, [](float height) { return std::isfinite(height); });
        }
    }
    tactnet::tensor<float, paper_scene::surface> heights_;
};

} // namespace

int main() {
    std::vector<std::unique_ptr<entry>> entries;
    const auto add = [&]<class Scene>(std::string name) {
        entries.push_back(std::make_unique<scene_entry<Scene>>(std::move(name)));
    };
    add.operator()<tactile<contact<winkler>, quantisation<8>>>("springs, 8 bits");
    add.operator()<tactile<contact<winkler>, elastic_pad, quantisation<8>>>("springs, pad, 8 bits");
    add.operator()<tactile<contact<winkler>, elastic_pad, noise, quantisation<8>>>(
        "springs, pad, noise, 8 bits");
    add.operator()<paper_scene>("springs, pad, film, saturation, 8 bits, file");
    add.operator()<tactile<contact<bonded_layer>, quantisation<8>>>("layer, 8 bits");
    add.operator()<layered_scene>("layer, pad, film, saturation, 8 bits, file");
    entries.push_back(std::make_unique<drawing_entry>("to draw a touch and lay it on the array"));

    for (std::size_t round = 0; round < rounds; ++round)
        for (const auto& each : entries)
            each->time();
    std::printf("28x50, microseconds a frame\n%-60s %9s %9s\n", "", "fastest", "median");
    bool right = true;
    for (const auto& each : entries)
        right = each->report() && right;
    return right ? EXIT_SUCCESS : EXIT_FAILURE;
}

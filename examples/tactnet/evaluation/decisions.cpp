#include "evaluation/decisions.hpp"

#include <tactnet/decision/fitting.hpp>
#include <tactnet/decision/sensor_health.hpp>
#include <tactnet/runtime/random.hpp>

#include <cmath>

namespace {

constexpr auto faulty_tactels = tactnet::random_purpose::named("tactnet/faulty_tactels");

/// Corrects images with stuck tactels in place: each is five frames of air and five of the touch, of which
/// the last is kept. The faults begin after frames of air without them.
using corrector = void (*)(std::vector<std::uint8_t>& pixels, std::span<const std::size_t> images,
                           const std::vector<bool>& stuck);
template <tactnet::shape Array>
void correct(std::vector<std::uint8_t>& pixels, std::span<const std::size_t> images,
             const std::vector<bool>& stuck) {
    const auto health = std::make_unique<tactnet::sensor_health<Array>>();
    std::array<std::uint8_t, Array.size()> air{};
    for (int i = 0; i < 50; ++i)
        health->learn(air);
    std::ranges::transform(stuck, air.begin(), [](bool is_stuck) { return is_stuck ? 255 : 0; });
    for (const std::size_t image : images) {
        const auto touch = std::span(pixels).subspan(image * air.size()).template first<Array.size()>();
        for (int i = 0; i < 5; ++i) {
            (void)health->clean(air);
            health->follow(air);
        }
        for (int i = 0; i < 4; ++i)
            (void)health->clean(touch);
        std::ranges::copy(health->clean(touch), touch.begin());
    }
}
template <tactnet::shape... Arrays>
corrector corrector_of(std::size_t rows, std::size_t columns) {
    corrector found = nullptr;
    ((Arrays.rows == rows && Arrays.columns == columns ? void(found = correct<Arrays>) : void()), ...);
    return found;
}

} // namespace

decision_means sets_of_classes(const tactnet::temperature_scaling& scaling,
                               const tactnet::evaluation& validation, const tactnet::evaluation& test,
                               const image_data& data, const tactnet::data_split& split) {
    const std::size_t classes = data.images.classes.size();
    std::vector<std::size_t> labels;
    for (const std::size_t image : split.validation)
        labels.push_back(data.images.labels[image]);
    const auto set = tactnet::fit_prediction_set(scaling, 0.95, validation.logits, classes, labels, classes);
    double held = 0, size = 0;
    const auto count = static_cast<double>(split.test.size());
    const auto members = std::make_unique<bool[]>(classes);
    for (std::size_t i = 0; i < split.test.size(); ++i) {
        size += static_cast<double>(
            set.predict(std::span(test.logits).subspan(i * classes, classes), {members.get(), classes}));
        held += members[data.images.labels[split.test[i]]];
    }
    return {{"set_coverage", {held, count}}, {"set_size", {size, count}}};
}

decision_means faults_of_sensor(const trained_method& trained, const image_data& data,
                                std::span<const std::size_t> images, std::uint64_t seed,
                                tactnet::thread_pool& threads) {
    const std::size_t rows = data.images.rows, columns = data.images.columns, size = rows * columns;
    using tactnet::shape;
    const corrector corrected =
        corrector_of<shape{28, 50}, shape{20, 35}, shape{14, 25}, shape{10, 18}, shape{7, 13}>(rows, columns);
    if (corrected == nullptr)
        return {};
    std::vector<bool> row(size), tactels(size);
    tactnet::random_stream random(seed, faulty_tactels);
    const std::size_t broken = random.below(static_cast<std::uint32_t>(rows));
    for (std::size_t i = 0; i < size; ++i) {
        row[i] = i / columns == broken;
        tactels[i] = random.uniform() < 0.05;
    }
    decision_means means;
    for (const auto& [name, stuck] : {std::pair{"stuck_row", &row}, std::pair{"stuck_tactels", &tactels}}) {
        std::vector<std::uint8_t> pixels = data.images.pixels;
        const auto measure = [&, to = std::string(name)](const char* what) {
            const auto found =
                trained.evaluate({pixels, data.images.labels, data.images.classes.size()}, images, threads)
                    .confusion;
            means[to + what] = {static_cast<double>(found.correct()), static_cast<double>(found.total())};
        };
        for (const std::size_t image : images)
            for (std::size_t i = 0; i < size; ++i)
                if ((*stuck)[i])
                    pixels[image * size + i] = 255;
        measure("_accuracy");
        corrected(pixels, images, *stuck);
        measure("_corrected_accuracy");
    }
    return means;
}

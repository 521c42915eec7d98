#include "evaluation/calibration.hpp"

#include <tactnet/decision/fitting.hpp>

#include <cmath>
#include <vector>

std::optional<tactnet::temperature_scaling> fit_temperature(const tactnet::evaluation& held_out,
                                                            std::span<const std::size_t> images,
                                                            const image_data& data) {
    if (held_out.logits.empty() || !std::isfinite(held_out.loss))
        return std::nullopt;
    std::vector<std::size_t> labels;
    for (const std::size_t image : images)
        labels.push_back(data.images.labels[image]);
    const std::size_t classes = data.images.classes.size();
    return tactnet::fit_temperature(held_out.logits, classes, labels, classes);
}

calibration calibration_of(const tactnet::evaluation& result, std::span<const std::size_t> images,
                           const image_data& data, const tactnet::temperature_scaling& scaling) {
    calibration found{scaling};
    const std::size_t classes = data.images.classes.size();
    for (std::size_t i = 0; i * classes < result.logits.size(); ++i) {
        const auto logits = std::span(result.logits).subspan(i * classes, classes);
        const auto add = [&](const tactnet::temperature_scaling& by, tactnet::reliability_diagram& to) {
            if (const auto recognised = by.classify(logits, classes))
                to.add(recognised->probability, recognised->index == data.images.labels[images[i]]);
        };
        add({}, found.before);
        add(scaling, found.after);
    }
    return found;
}

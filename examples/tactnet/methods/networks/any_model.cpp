#include "methods/networks/any_model.hpp"

#include <tactnet/networks/recognition.hpp>
#include <tactnet/training/initialise.hpp>

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <utility>

std::vector<std::span<float>> arrays_of(tactnet::trainable& network) {
    std::vector<std::span<float>> arrays;
    for (const tactnet::parameter& p : network.describe())
        arrays.push_back(network.values_of(p));
    return arrays;
}

tactnet::model_parts parts_of(const any_model& model, tactnet::shape image, tactnet::stored_arrays arrays) {
    tactnet::model_parts parts{.input = image,
                               .arrays = std::move(arrays),
                               .values = {},
                               .epsilon = model.network->epsilon(),
                               .mean = model.mean,
                               .scale = model.scale,
                               .classes = model.classes};
    for (const std::span<float> values : arrays_of(*model.network))
        parts.values.push_back(values);
    return parts;
}

void take(any_model& model, tactnet::stored_model stored) {
    model.network->epsilon() = stored.epsilon;
    const auto arrays = arrays_of(*model.network);
    for (std::size_t i = 0; i < arrays.size(); ++i) {
        std::ranges::fill(arrays[i], 0.0f);
        std::ranges::copy(stored.arrays[i], arrays[i].begin());
    }
    model.mean = std::move(stored.mean);
    model.mean.resize(model.network->input_shape().size());
    model.scale = stored.scale;
    model.classes = std::move(stored.classes);
}

void draw_arrays(tactnet::trainable& network) {
    const auto parameters = network.describe();
    const auto arrays = arrays_of(network);
    std::uint32_t index = 0;
    for (std::size_t i = 0; i < arrays.size(); ++i)
        tactnet::detail::initialise(parameters[i], arrays[i], tactnet::he_normal{}, 0, index);
}

std::vector<float> logits_of(const any_model& model, std::size_t count,
                             const std::function<void(std::size_t, std::span<float>)>& make) {
    const std::size_t size = model.mean.size();
    tactnet::thread_pool alone;
    tactnet::sample_batch in(size, count), out(model.network->outputs(), count);
    std::vector<float> sample(size), result;
    for (std::size_t i = 0; i < count; ++i) {
        make(i, sample);
        for (std::size_t e = 0; e < size; ++e)
            sample[e] = (sample[e] - model.mean[e]) * model.scale;
        in.set(i, sample);
    }
    const auto space = model.network->make_workspace();
    model.network->prepare(alone, *space);
    model.network->logits(in, out, alone, *space);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < model.classes.size(); ++c)
            result.push_back(out(i, c));
    return result;
}

void refuse_logits() {
    throw std::runtime_error("expected finite logits, found some that are not: the weights are broken");
}

std::vector<scored_class> classes_of_rows(std::span<const float> rows, std::size_t outputs,
                                          std::size_t classes, bool are_probabilities) {
    std::vector<scored_class> result;
    for (std::size_t first = 0; first < rows.size(); first += outputs) {
        const auto row = rows.subspan(first, outputs);
        const auto found = are_probabilities ? tactnet::classify_probabilities(row, classes)
                                             : tactnet::classify_logits(row, classes);
        if (!found)
            refuse_logits();
        result.push_back({found->index, found->probability});
    }
    return result;
}

method_costs costs_for(const method_costs& all, const method_costs& one, std::size_t outputs,
                       std::size_t classes) {
    const auto cost = [&](std::size_t method_costs::*of) {
        return outputs == 1 ? all.*of : one.*of + (all.*of - one.*of) / (outputs - 1) * (classes - 1);
    };
    return {cost(&method_costs::parameters), cost(&method_costs::multiply_adds),
            cost(&method_costs::multiply_adds_on_pixels), cost(&method_costs::parameter_bytes),
            all.activation_bytes - (outputs - classes) * sizeof(float)};
}

#include "methods/networks/compiled.hpp"

#include <tactnet/io/checkpoint.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/training/initialise.hpp>

#include <cmath>
#include <functional>
#include <limits>
#include <utility>

void refuse_logits() {
    throw std::runtime_error("expected finite logits, found some that are not: the weights are broken");
}

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
                               .classes = model.classes,
                               .temperature = model.temperature,
                               .function = model.function,
                               .reflections = model.reflections};
    for (const std::span<float> values : arrays_of(*model.network))
        parts.values.push_back(values);
    return parts;
}

any_model load_model(const compiled_network& code, const tactnet::safetensors& file, tactnet::shape image,
                     std::optional<double> epsilon) {
    tactnet::stored_model stored = tactnet::read_model(file, image, code.arrays(), epsilon);
    any_model model{code.make(),
                    std::move(stored.mean),
                    stored.scale,
                    std::move(stored.classes),
                    stored.temperature,
                    stored.function,
                    std::move(stored.reflections)};
    model.network->epsilon() = stored.epsilon;
    model.mean.resize(code.pixels());
    const auto arrays = arrays_of(*model.network);
    for (std::size_t i = 0; i < arrays.size(); ++i) {
        std::ranges::fill(arrays[i], 0.0f);
        std::ranges::copy(stored.arrays[i], arrays[i].begin());
    }
    return model;
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
        model.function.apply(sample);
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

std::vector<float> outputs_of(const any_deployed& network, const compiled_network& code,
                              std::span<const std::uint8_t> frames, tactnet::thread_pool& threads) {
    std::vector<float> rows(frames.size() / code.pixels() * code.outputs);
    if (!network.infer(threads, frames, rows))
        refuse_logits();
    return rows;
}

std::vector<float> logits_of(const any_deployed& network, const compiled_network& code,
                             std::span<const std::uint8_t> frames, tactnet::thread_pool& threads) {
    std::vector<float> rows = outputs_of(network, code, frames, threads);
    if (network.gives_probabilities())
        for (float& value : rows)
            value = std::log(std::max(value, std::numeric_limits<float>::min()));
    return rows;
}

std::vector<std::uint8_t> made_up_touches(std::size_t count, tactnet::extent2d image) {
    std::vector<std::uint8_t> pixels;
    for (std::uint32_t i = 0; i < count; ++i) {
        tactnet::random_stream random(1, tactnet::random_purposes::order, i);
        const double row = random.uniform(0, static_cast<double>(image.rows)),
                     column = random.uniform(0, static_cast<double>(image.columns)), size = 2 + i % 22;
        for (std::size_t y = 0; y < image.rows; ++y)
            for (std::size_t x = 0; x < image.columns; ++x) {
                const double dy = static_cast<double>(y) - row, dx = static_cast<double>(x) - column;
                const double pressure = std::max(0.0, 1 - (dy * dy + dx * dx) / (size * size));
                pixels.push_back(static_cast<std::uint8_t>(200 * pressure + random.uniform(0, 8)));
            }
    }
    return pixels;
}

method_costs compiled_network::costs_for(std::size_t classes) const {
    const auto cost = [&](std::size_t method_costs::*of) {
        return outputs == 1
                   ? costs.*of
                   : costs_of_one.*of + (costs.*of - costs_of_one.*of) / (outputs - 1) * (classes - 1);
    };
    return {cost(&method_costs::parameters), cost(&method_costs::multiply_adds),
            cost(&method_costs::multiply_adds_on_pixels), cost(&method_costs::parameter_bytes),
            costs.activation_bytes - (outputs - classes) * sizeof(float)};
}

void epoch_training::advance() {
    loop_.run_epoch();
}
void epoch_training::start_from(const trained_method& other) {
    tactnet::trainable& from = *other.model()->network;
    loop_.start_from(from.learnable_values(), from.running_statistics());
}
void epoch_training::save_checkpoint(const std::filesystem::path& path,
                                     const tactnet::file_metadata& settings) {
    tactnet::save_checkpoint(path, loop_, settings);
}
tactnet::checksum_state epoch_training::load_checkpoint(const std::filesystem::path& path,
                                                        const tactnet::file_metadata& settings) {
    return tactnet::load_checkpoint(path, loop_, settings);
}
std::unique_ptr<trained_method> epoch_training::best(const std::vector<std::string>& classes) const {
    return finish_({loop_.best().copy(),
                    {loop_.mean().begin(), loop_.mean().end()},
                    loop_.scale(),
                    classes,
                    1,
                    loop_.function(),
                    loop_.reflections()});
}

#pragma once

// Puts a network type behind the interface of method.hpp. Included only by the generated units.

#include "method.hpp"
#include "settings.hpp"
#include "stopwatch.hpp"

#include <tactnet/deployment.hpp>
#include <tactnet/deployment/export/deployed_header.hpp>
#include <tactnet/io/checkpoint.hpp>
#include <tactnet/training/trainer.hpp>

#include <cstdint>
#include <stdexcept>
#include <utility>

template <class Network>
class registered_network final : public trained_network {
public:
    explicit registered_network(tactnet::model<Network> model) : model_(std::move(model)) {}

    const tactnet::model<Network>& model() const { return model_; }
    const std::vector<std::string>& classes() const override { return model_.classes; }
    tactnet::evaluation evaluate(const tactnet::labelled_images& images, std::span<const std::size_t> chosen,
                                 tactnet::thread_pool& threads) const override {
        return tactnet::evaluate(model_.network, model_.normalise, images, chosen, threads);
    }
    std::vector<recognition> recognise(std::span<const std::uint8_t> images,
                                       tactnet::thread_pool& threads) const override {
        const auto deployed = tactnet::deploy(model_);
        const std::size_t count = images.size() / Network::input_shape.size();
        std::vector<float> logits(count * Network::outputs);
        if (deployed(threads, images, std::span(logits)) != tactnet::frame_status::recognised)
            throw std::runtime_error(
                "expected finite logits, found some that are not: the weights are broken");
        std::vector<recognition> result;
        for (std::size_t i = 0; i < count; ++i) {
            const auto found = tactnet::likeliest(std::span(logits).subspan(i * Network::outputs), classes());
            result.push_back({found.value().index, found.value().probability});
        }
        return result;
    }
    void save(const std::filesystem::path& path, const tactnet::file_metadata& metadata,
              std::span<const std::uint8_t> selftest) const override {
        tactnet::save_model(path, model_, metadata, selftest);
    }
    std::string header(const tactnet::header_description& says,
                       std::span<const std::uint8_t> frame) const override {
        return tactnet::deployed_header(tactnet::deploy(model_), says,
                                        frame.first<Network::input_shape.size()>());
    }

private:
    tactnet::model<Network> model_;
};

template <class Network>
class registered_training final : public network_training {
public:
    template <class... Arguments>
    explicit registered_training(Arguments&&... arguments)
        : trainer_(std::forward<Arguments>(arguments)...) {}

    bool finished() const override { return trainer_.finished(); }
    void advance() override { trainer_.run_epoch(); }
    const std::vector<tactnet::epoch_report>& history() const override { return trainer_.history(); }
    std::size_t images_per_epoch() const override { return trainer_.images_per_epoch(); }
    void start_from(const trained_method& other) override {
        trainer_.start_from(dynamic_cast<const registered_network<Network>&>(other).model().network);
    }
    const tactnet::data_split& split() const override { return trainer_.split(); }
    void save_checkpoint(const std::filesystem::path& path, const tactnet::file_metadata& settings) override {
        tactnet::save_checkpoint(path, trainer_, settings);
    }
    void load_checkpoint(const std::filesystem::path& path, const tactnet::file_metadata& settings) override {
        tactnet::load_checkpoint(path, trainer_, settings);
    }
    std::unique_ptr<trained_method> best(const std::vector<std::string>& classes) const override {
        return std::make_unique<registered_network<Network>>(
            tactnet::model<Network>{trainer_.best(), trainer_.input_normalisation(), classes});
    }

private:
    tactnet::trainer<Network> trainer_;
};

template <class Network>
class registration final : public method {
    static constexpr tactnet::shape input = Network::input_shape;

public:
    explicit registration(std::string_view network_name)
        : method(network_name, input.rows, input.columns, Network::outputs) {}

    tactnet::file_metadata describe(const tactnet::recipe& recipe) const override {
        return describe_recipe(recipe);
    }

    network_costs costs(std::size_t classes) const override {
        // Outputs that stand for no class are no part of the network.
        const std::size_t spare = Network::outputs - classes, inputs = last_inputs();
        return {Network::parameters - spare * (inputs + 1), Network::multiply_adds - spare * inputs,
                Network::multiply_adds_on_pixels - spare * inputs,
                Network::parameter_bytes - spare * (inputs + 1) * sizeof(float),
                Network::activation_bytes - spare * sizeof(float)};
    }

    frame_times time_frames() const override {
        Network network;
        tactnet::initialise(network, tactnet::he_normal{}, 0);
        return {time(network, 1), time(network, 64)};
    }

    std::unique_ptr<training_run> train(const tactnet::recipe& recipe, const tactnet::labelled_images& images,
                                        tactnet::data_split split, std::uint64_t seed,
                                        tactnet::thread_pool& threads) const override {
        return std::make_unique<registered_training<Network>>(recipe, images, std::move(split), seed,
                                                              threads);
    }

    std::unique_ptr<trained_method> load(const tactnet::safetensors& file,
                                         std::optional<double> epsilon) const override {
        return std::make_unique<registered_network<Network>>(tactnet::load_model<Network>(file, epsilon));
    }

private:
    /// Of the dense layer that gives the logits: its weights stand before its biases, the last array of all.
    static std::size_t last_inputs() {
        const auto arrays = Network::describe();
        return arrays[arrays.size() - 2].fan_in;
    }

    static double time(const Network& network, std::size_t batch) {
        tactnet::thread_pool alone;
        const auto deployed = tactnet::deploy(network);
        std::vector<std::uint8_t> frames(batch * input.size());
        std::vector<float> logits(batch * Network::outputs);
        for (std::size_t e = 0; e < frames.size(); ++e)
            frames[e] = static_cast<std::uint8_t>(e * 37 % 64);
        bool good = true;
        const double microseconds = median_microseconds([&] {
            good = deployed(alone, std::span<const std::uint8_t>(frames), std::span(logits)) ==
                       tactnet::frame_status::recognised &&
                   good;
        });
        if (!good)
            throw std::runtime_error("expected finite logits of the frames that are timed");
        return microseconds / static_cast<double>(batch);
    }
};

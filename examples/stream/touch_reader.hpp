#pragma once

// From a frame of the sensor to what a robot acts on: is anything touching, what is it, how sure is that, and
// which tactels can no longer be trusted.

#include "answer.hpp"

#include <tactnet/io/deployed_file.hpp>
#include <tactnet/networks.hpp>
#include <tactnet/tactnet.hpp>

#include <array>
#include <chrono>
#include <type_traits>
#include <utility>

/// `Count` is std::uint8_t for a sensor of 8-bit counts, float for counts of any depth and marks of broken
/// tactels.
template <class Network, class Count>
class touch_reader final : public frame_reader {
    static constexpr tactnet::shape array = Network::input_shape;
    static constexpr bool deep = std::is_same_v<Count, float>;

public:
    /// The first `frames_of_air` frames teach what the array counts when nothing touches it. Without any,
    /// each frame is recognised by itself, and no tactel is looked after.
    touch_reader(std::optional<tactnet::deployed<Network>> network, std::size_t frames_of_air,
                 const tactnet::count_scale& scale)
        : deployed_(std::move(network)),
          frames_of_air_(frames_of_air),
          scale_(scale),
          health_(health_on(scale)) {
        if (deployed_)
            evidence_.emplace(deployed_->class_count(),
                              tactnet::temperature_scaling{deployed_->temperature()});
    }

    std::vector<std::string> classes() const override {
        if (!deployed_)
            return {};
        return {deployed_->classes().begin(), deployed_->classes().end()};
    }
    answer read(const tactnet::frame_view& frame) override {
        answer result{.number = frame.number, .seconds = frame.seconds, .columns = array.columns};
        const auto start = std::chrono::steady_clock::now();
        if (const auto cells = frame.as<array>()) {
            if (frames_of_air_ == 0)
                recognise_alone(cells->elements(), result);
            else if constexpr (deep)
                recognise_touch(cells->elements(), result);
            else if (const auto counts = frame.counts<array>())
                recognise_touch(counts->view().elements(), result);
        }
        const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - start;
        result.microseconds = time.count();
        result.counts = shown_;
        return result;
    }

private:
    static auto health_on(const tactnet::count_scale& scale) {
        if constexpr (deep)
            return tactnet::sensor_health<array, float>(scale);
        else
            return tactnet::sensor_health<array>();
    }

    void recognise_alone(std::span<const float, array.size()> cells, answer& result) {
        for (std::size_t i = 0; i < array.size(); ++i)
            shown_[i] = deep ? scale_.of(cells[i]) : cells[i];
        std::array<float, Network::outputs> logits;
        if (!deployed_ || deployed_->infer(shown_, logits) != tactnet::frame_status::ok)
            return;
        evidence_->clear();
        evidence_->add_frame(logits);
        result.says = answer::state::touch;
        result.found = evidence_->most_likely();
    }

    void recognise_touch(std::span<const Count, array.size()> raw, answer& result) {
        if (learnt_ < frames_of_air_) {
            ++learnt_;
            health_.learn(raw);
            detector_.learn(health_.clean(raw));
            result.says = answer::state::learning;
            return;
        }
        const auto clean = health_.clean(raw);
        const tactnet::contact_state& contact = detector_.update(clean);
        result.contact = contact;
        result.faults = health_.faults();
        result.says = contact.touching ? answer::state::touch : answer::state::air;
        std::copy(clean.begin(), clean.end(), shown_.begin());
        if (!contact.touching) {
            health_.follow(raw);
            if (evidence_)
                evidence_->clear(); // what comes next may be another object
            return;
        }
        if (!deployed_)
            return;
        std::array<float, Network::outputs> logits;
        if (contact.firm && deployed_->infer(clean, logits) == tactnet::frame_status::ok)
            evidence_->add_frame(logits);
        result.found = evidence_->most_likely();
    }

    std::optional<tactnet::deployed<Network>> deployed_;
    std::size_t frames_of_air_, learnt_ = 0;
    tactnet::count_scale scale_;
    tactnet::sensor_health<array, Count> health_;
    tactnet::contact_detector<array, Count> detector_;
    std::optional<tactnet::touch_evidence<Network::outputs>> evidence_;
    std::array<float, array.size()> shown_{};
};

/// See compiled_reader::make.
template <class Network>
std::unique_ptr<frame_reader> make_touch_reader(const tactnet::safetensors* weights,
                                                std::size_t frames_of_air,
                                                const std::optional<tactnet::count_scale>& scale) {
    std::optional<tactnet::deployed<Network>> network;
    if (weights != nullptr)
        network = tactnet::load_deployed<Network>(*weights);
    if (scale)
        return std::make_unique<touch_reader<Network, float>>(std::move(network), frames_of_air, *scale);
    return std::make_unique<touch_reader<Network, std::uint8_t>>(std::move(network), frames_of_air,
                                                                 tactnet::count_scale{});
}

#pragma once

#include "sensing.hpp"

#include <tactnet/decision/sensor_health.hpp>

#include <algorithm>

namespace tactnet {

/// A size, as the name of what is compiled for it.
template <shape Array>
struct sensor_array {
    static constexpr shape extents = Array;
};

} // namespace tactnet

namespace tactnet_python {

template <tactnet::shape Array>
class sensor final : public any_sensor {
    using health_type = tactnet::sensor_health<Array, float>;

public:
    explicit sensor(const sensor_settings& settings)
        : health_(settings.scale, settings.health), contact_(settings.contact) {}
    void learn(const raw_frames& air) override {
        visit(air, [&](const auto& frame, std::size_t) {
            health_.learn(frame);
            contact_.learn(health_.clean(frame));
        });
    }
    void update(const raw_frames& raw, float* clean, tactnet::contact_state* contacts) override {
        visit(raw, [&](const auto& frame, std::size_t i) {
            const auto found = health_.clean(frame);
            std::ranges::copy(found, clean + i * Array.size());
            contacts[i] = contact_.update(found);
            if (!contacts[i].touching)
                health_.follow(frame);
        });
    }
    std::span<const tactnet::tactel_fault> faults() const override { return health_.faults(); }
    bool worn_out() const override { return health_.worn_out(); }
    std::uint8_t pressed() const override { return contact_.pressed(); }
    std::vector<std::byte> state() const override {
        const auto saved = health_.save();
        return {saved.begin(), saved.end()};
    }
    tactnet::restore_status restore(std::span<const std::byte> state) override {
        return health_.restore(state);
    }

private:
    template <class Body>
    static void visit(const raw_frames& frames, const Body& body) {
        std::visit(
            [&](const auto& all) {
                for (std::size_t i = 0; i < all.size() / Array.size(); ++i)
                    body(all.subspan(i * Array.size()).template first<Array.size()>(), i);
            },
            frames);
    }
    health_type health_;
    tactnet::contact_detector<Array, float> contact_;
};

template <class Array>
network_code code_of_sensor() {
    network_code code;
    code.sensor = [](const sensor_settings& settings) -> std::unique_ptr<any_sensor> {
        return std::make_unique<sensor<Array::extents>>(settings);
    };
    return code;
}

} // namespace tactnet_python

#pragma once

#include <tactnet/simulation/contact/contact.hpp>
#include <tactnet/simulation/scene.hpp>

#include <cstddef>
#include <cstdint>

namespace support {

using namespace tactnet::simulation;

/// Writes what an effect is given instead of what it does with it.
struct witness {
    static constexpr stage place = stage::film;

    template <tactnet::shape Shape>
    class bound {
    public:
        bound(const witness&, const mounting& where) : unit_(where.unit) {}
        void apply(tactnet::simulation::signal<Shape> values, const moment& now) noexcept {
            float* out = values.data();
            for (std::uint64_t number : {unit_.number, now.seed, std::uint64_t{now.frame}})
                for (int part = 0; part < 4; ++part, number >>= 16) // a float holds 24 bits
                    *out++ = static_cast<float>(number & 0xFFFF);
        }

    private:
        sensor_unit unit_;
    };
};

using watched = scene<array<28, 50>, contact<winkler>, witness>;

inline std::uint64_t said(const watched::frames& frames, std::size_t which) {
    std::uint64_t number = 0;
    for (std::size_t part = 4; part-- > 0;)
        number = number << 16 | static_cast<std::uint64_t>(frames.measured.data()[4 * which + part]);
    return number;
}

} // namespace support

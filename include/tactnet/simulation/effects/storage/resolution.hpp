#pragma once

#include <tactnet/image/resize.hpp>
#include <tactnet/simulation/effect.hpp>

#include <cmath>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// Resizes counts as the paper makes its smaller images: bicubic, then rounded. The same size changes
/// nothing.
template <std::size_t Rows, std::size_t Columns, class Kernel = keys_cubic<>>
struct resolution {
    static_assert(Rows > 0 && Columns > 0, "resolution: there must be at least one row and one column");
    static constexpr stage place = stage::storage;
    template <shape In>
    static constexpr shape output{Rows, Columns, In.channels};

    double last = 255; ///< the largest count

    template <shape Shape>
    class bound {
    public:
        static constexpr shape resized = output<Shape>;

        bound(const resolution& effect, const mounting&)
            : last_(static_cast<float>(effect.last > 0 ? effect.last : 0)) {}
        void apply(tensor_view<const float, Shape> from, signal<resized> to, const moment&) const noexcept {
            resize<Shape, resized, Kernel>(from, to);
            for (float& count : to.elements()) {
                const float kept = count > 0 ? (count < last_ ? count : last_) : 0;
                count = std::floor(kept + 0.5f);
            }
        }
        void apply(signal<Shape>, const moment&) const noexcept
            requires(Shape == resized)
        {}

    private:
        float last_;
    };
};

}}} // namespace tactnet::simulation

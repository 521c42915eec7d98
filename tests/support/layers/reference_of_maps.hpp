#pragma once

// The references of layers that give a map another size. reference_of.hpp includes it.

#include <tactnet/layers.hpp>

#include <support/layers/reference.hpp>

namespace support {

template <class Spec>
struct reference_of;

template <tactnet::extent2d Factor, tactnet::interpolation Mode>
struct reference_of<tactnet::upsample<Factor, Mode>> {
    static reference_pointer on(extents3 in) {
        return reference_upsampling(in, in.rows * Factor.rows, in.columns * Factor.columns,
                                    Mode == tactnet::interpolation::bilinear);
    }
};
template <tactnet::extent2d Size, tactnet::interpolation Mode>
struct reference_of<tactnet::upsample_to<Size, Mode>> {
    static reference_pointer on(extents3 in) {
        return reference_upsampling(in, Size.rows, Size.columns, Mode == tactnet::interpolation::bilinear);
    }
};

} // namespace support

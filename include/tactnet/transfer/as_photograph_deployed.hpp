#pragma once

#include <tactnet/deployment/export/step_text.hpp>
#include <tactnet/deployment/lowering/lowering.hpp>
#include <tactnet/transfer/as_photograph.hpp>
#include <tactnet/transfer/as_photograph_step.hpp>

#include <cmath>
#include <cstddef>
#include <string>

// Lowers as_photograph to its deployed step, and spells that step in an exported header.

namespace tactnet {
inline namespace TACTNET_ARCH {

template <extent2d Size>
struct lowering<as_photograph<Size>> {
    template <class Place>
    struct at {
        using step = as_photograph_step<typename Place::format,
                                        extent2d{Place::layer::input.rows, Place::layer::input.columns},
                                        Place::input_stride, Size>;
        static void fold(const parameter_source& list, float* to) {
            const float* const statistics = Place::parameters(list).statistics;
            for (std::size_t channel = 0; channel < 3; ++channel) {
                to[channel] = statistics[channel];
                to[3 + channel] =
                    static_cast<float>(1 / std::sqrt(static_cast<double>(statistics[3 + channel])));
            }
        }
    };
};

template <extent2d From, std::size_t InputStride, extent2d To>
struct step_spelling<as_photograph_step<single_precision, From, InputStride, To>> {
    static spelled_step of(step_text& text, const shape&, const std::string& stride) {
        text.include("tactnet/transfer/as_photograph_step.hpp");
        return {"Photograph", "tactnet::as_photograph_step<tactnet::single_precision, tactnet::extent2d" +
                                  text_of(From) + ", " + stride + ", tactnet::extent2d" + text_of(To) + ">"};
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet

#pragma once

#include <tactnet/layers.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/networks/published_training.hpp>

#include <algorithm>
#include <cstddef>
#include <optional>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The pools of the compact network, by the size of its images.
struct tactnet_compact_form {
    std::size_t first_pool = 2, second_pool = 2, third_pool = 2; ///< 1 is none
    extent last_window{2, 4}, last_stride{2, 3};

    /// A pool halves the map while at least three rows and three columns remain; the last one leaves 2 × 2,
    /// of bins as equal as can be.
    [[nodiscard]] static constexpr tactnet_compact_form at(shape image) {
        extent map{image.rows, image.columns};
        const auto halve = [&] {
            const extent half{(map.rows + 1) / 2, (map.columns + 1) / 2};
            if (std::min(half.rows, half.columns) < 3)
                return std::size_t{1};
            map = half;
            return std::size_t{2};
        };
        const std::size_t first = halve(), second = halve(), third = halve();
        return {first,
                second,
                third,
                {map.rows - map.rows / 2, map.columns - map.columns / 2},
                {std::max<std::size_t>(map.rows / 2, 1), std::max<std::size_t>(map.columns / 2, 1)}};
    }
};

/// The compact network: of the roots of counts, three convolutions, a residual block (He et al., 2016), a
/// convolution and a dense layer; all kernels are 3 × 3. More accurate than the paper's networks on its
/// images (docs/results.md). Trains on scaled counts, input_rule::scale.
template <shape Input, std::size_t Classes, tactnet_compact_form Form = tactnet_compact_form::at(Input)>
using tactnet_compact =
    network<Input,                                                                                //
            square_root<>,                                                                        //
            conv2d<16, 3>, batch_norm, relu, max_pool<Form.first_pool>,                           //
            conv2d<32, 3>, batch_norm, relu, max_pool<Form.second_pool>,                          //
            conv2d<48, 3>, batch_norm, relu, max_pool<Form.third_pool>,                           //
            residual<sequence<conv2d<48, 3>, batch_norm, relu, conv2d<48, 3>, batch_norm>>, relu, //
            conv2d<96, 3>, batch_norm, relu, max_pool<Form.last_window, Form.last_stride, valid>, //
            dense<Classes>>;

/// No training of it is published.
inline constexpr std::optional<published_training> tactnet_compact_training{};

} // namespace TACTNET_ARCH
} // namespace tactnet

#include <tactnet/operators/convolution/layer.hpp>

#include <support/layers/conformance.hpp>

using namespace tactnet;
using support::check_layer;

// Sizes at which convolution, the gradient of its input and, where channels fill vectors, that of its weights
// are computed by Winograd's tiles.

namespace {

template <std::size_t Filters, extent2d Kernel, shape Input, padding Padding = padding::same,
          std::size_t Groups = 1>
void check_by_tiles() {
    constexpr auto window =
        sliding_window::over({Input.rows, Input.columns, Input.channels / Groups}, Kernel, 1, Padding);
    constexpr std::size_t filters = Filters / Groups, channels = Input.channels / Groups;
    static_assert(best_tile(kernels::batch_convolution::forward(window, filters)) != extent2d(0) &&
                  best_tile(kernels::batch_convolution::backward(window, filters)) != extent2d(0));
    constexpr std::size_t width = kernels::lanes<float>;
    constexpr bool fill = width > 1 && (channels % width == 0 || filters % width == 0);
    constexpr bool by_tiles =
        kernels::best_gradient_tile<kernels::batch_convolution::forward(window, filters), float>() !=
        extent2d(0);
    static_assert(by_tiles == fill || (width <= 4 && !by_tiles)); // of four lanes, tiles do not always pay
    check_layer<conv2d<Filters, Kernel, 1, Padding, in_groups(Groups)>, Input>();
}

} // namespace

TEST_CASE("conv2d: what must hold of every layer, by tiles") {
    check_by_tiles<16, 3, shape{4, 8, 16}>(); // tiles cover the map
    check_by_tiles<13, 3, shape{5, 7, 16}>(); // tiles reach beyond the map
    check_by_tiles<18, 2, shape{6, 7, 16}>();
    check_by_tiles<9, 3, shape{8, 9, 12}, padding::valid>();
    // Filters fill vectors where channels do not.
    check_by_tiles<16, 3, shape{5, 8, 8}>();
    check_by_tiles<24, 3, shape{4, 8, 32}, padding::same, 2>();
}

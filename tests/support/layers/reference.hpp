#pragma once

// What every layer computes, by plain loops in double over [channel][row][column] vectors: knows nothing of
// the library's kernels, of lanes or of threads. Each number comes with the bound of the error that a
// computation in a given precision may make, carried along through lists of layers (running error analysis;
// Higham, "Accuracy and stability of numerical algorithms", 2nd edition, chapter 3). The same layers give
// what a batch computes, as it is trained, and what a deployed network computes for one frame, where batch
// norms are folded into convolutions and the sum of a residual block is taken in its last one
// (deployed_reference.hpp).

#include <cstddef>
#include <memory>
#include <span>
#include <stdexcept>
#include <support/tolerance.hpp>
#include <vector>

namespace support {

/// What one rounding loses below the smallest normal number, at most: half of the smallest number of all.
inline constexpr double lost = 0x1p-150;

/// Sizes of one sample, when running.
struct extents3 {
    std::size_t channels = 1, rows = 1, columns = 1;
    [[nodiscard]] std::size_t area() const { return rows * columns; }
    [[nodiscard]] std::size_t size() const { return channels * rows * columns; }
    friend bool operator==(const extents3&, const extents3&) = default;
};

using sample = std::vector<bounded>;
using samples = std::vector<sample>;

/// Outputs of one of Winograd's tiles; none where a convolution is computed by taps.
struct tile_size {
    std::size_t rows = 0, columns = 0;
};

/// What the reference must know of a call.
struct reference_call {
    std::span<const double> values;  ///< learnable parameters
    std::span<const double> running; ///< running statistics
    bool training = false;           ///< moments of the batch instead of the running ones
    double epsilon = 1e-5;
    double roundoff = 0; ///< of the precision that the bounds are for
    /// As a deployed network computes frames, in single precision.
    bool deployed = false;
    bool folded = true; ///< deployed: batch norms in convolutions, sums in the last of a block
    std::span<const tile_size> tiles{}; ///< deployed: how each convolution is computed; none by taps
};

/// Gradients, and bounds of their errors, for exact inputs and gradients of the output.
struct reference_gradients {
    samples input;
    sample values;
};

class reference_layer {
public:
    virtual ~reference_layer() = default;

    extents3 input, output;
    std::size_t parameters = 0, statistics = 0;
    std::size_t multiply_adds = 0, multiply_adds_on_pixels = 0;
    std::size_t convolutions = 0; ///< that a deployed network may compute by tiles

    [[nodiscard]] virtual samples forward(const reference_call& call, const samples& in) const = 0;
    /// Single layers only: lists are compared with the chain of their layers instead.
    [[nodiscard]] virtual bool has_backward() const { return false; }
    /// Of a single layer without a backward: gradients in single precision are compared with those in double.
    [[nodiscard]] virtual bool compares_precisions() const { return false; }
    [[nodiscard]] virtual reference_gradients backward(const reference_call&, const samples&,
                                                       const samples&) const {
        return {};
    }
};

using reference_pointer = std::unique_ptr<reference_layer>;

/// A window that slides over an image with `top` … `right` pixels around it.
struct reference_window {
    extents3 input;
    std::size_t kernel_rows, kernel_columns, stride_rows, stride_columns;
    std::size_t top, bottom, left, right;

    /// 'same': as many outputs as strides begin in the image; what is missing is halved, odd rests bottom and
    /// right.
    static reference_window same(extents3 input, std::size_t kernel_rows, std::size_t kernel_columns,
                                 std::size_t stride_rows, std::size_t stride_columns);
    /// PyTorch's ceil_mode, by its rule: as many windows as it takes to reach the end, but each begins in the
    /// image or in the padding before it.
    [[nodiscard]] reference_window completed() const;
    [[nodiscard]] std::size_t output_rows() const {
        return (input.rows + top + bottom - kernel_rows) / stride_rows + 1;
    }
    [[nodiscard]] std::size_t output_columns() const {
        return (input.columns + left + right - kernel_columns) / stride_columns + 1;
    }
    /// body(output pixel, input pixel, tap) for all that lie on the image.
    template <class Body>
    void for_each_tap(Body&& body) const {
        for (std::size_t y = 0; y < output_rows(); ++y)
            for (std::size_t x = 0; x < output_columns(); ++x)
                for (std::size_t i = 0; i < kernel_rows; ++i)
                    for (std::size_t j = 0; j < kernel_columns; ++j) {
                        const std::size_t row = y * stride_rows + i, column = x * stride_columns + j;
                        if (row >= top && row < top + input.rows && column >= left &&
                            column < left + input.columns)
                            body(y * output_columns() + x, (row - top) * input.columns + column - left,
                                 i * kernel_columns + j);
                    }
    }
};

/// By which of Winograd's tiles the library computes a convolution and the gradient of its input, and whether
/// it may compute that of the weights by some: errors may then be larger (tile_magnitudes.hpp).
struct reference_tiles {
    tile_size ahead, back;
    bool of_weights = false;
};
reference_pointer reference_convolution(const reference_window& window, std::size_t filters,
                                        std::size_t groups = 1, bool bias = true,
                                        const reference_tiles& tiles = {});
/// The geometry of a transposed convolution: `crop_top` and `crop_left` rows and columns of an output of
/// (size − 1) × stride + kernel are left out, and what remains is cut or filled up to rows × columns.
struct reference_enlargement {
    extents3 input;
    std::size_t filters, rows, columns;
    std::size_t kernel_rows, kernel_columns, stride_rows, stride_columns;
    std::size_t crop_top, crop_left;
};
reference_pointer reference_transposed_convolution(const reference_enlargement& geometry, bool bias,
                                                   const reference_tiles& tiles = {});
/// The geometry of a dilated convolution: the window has the size of the kernel without dilation and the
/// padding of the dilated one.
struct reference_dilation {
    reference_window window;
    std::size_t dilation_rows, dilation_columns, output_rows, output_columns;
    /// `phases` slides over the map of the phases; the outputs are at `sums` among its outputs.
    struct layout {
        reference_window phases;
        std::vector<std::size_t> sums;
    };
    layout trained, deployed;
};
reference_pointer reference_dilated_convolution(const reference_dilation& geometry, std::size_t filters,
                                                std::size_t groups = 1, bool bias = true,
                                                const reference_tiles& tiles = {});
reference_pointer reference_dense(extents3 input, std::size_t outputs);
reference_pointer reference_batch_norm(extents3 input);
/// Each channel times a number.
reference_pointer reference_channel_scale(extents3 input);
/// Normalises the channels of each of some groups of each sample.
reference_pointer reference_group_norm(extents3 input, std::size_t groups);
/// Normalises each sample as a whole, with a weight for each element, or the channels of each of its pixels.
reference_pointer reference_layer_norm(extents3 input, bool over_channels);
reference_pointer reference_relu(extents3 input);
reference_pointer reference_max_pool(const reference_window& window);
/// The mean of each window over its pixels, or over its pixels and the padding as it was `given` at the
/// bottom and on the right.
reference_pointer reference_average_pool(const reference_window& window, bool counts_padding,
                                         std::size_t given_bottom, std::size_t given_right);
/// PyTorch's adaptive average pool.
reference_pointer reference_adaptive_average(extents3 input, std::size_t rows, std::size_t columns);
/// PyTorch's adaptive max pool.
reference_pointer reference_adaptive_max(extents3 input, std::size_t rows, std::size_t columns);
/// PyTorch's nn.Upsample with mode 'nearest' or 'bilinear' and align_corners=False.
reference_pointer reference_upsampling(extents3 input, std::size_t rows, std::size_t columns, bool linear);
reference_pointer reference_local_response_norm(extents3 input, std::size_t size, double alpha, double beta,
                                                double k);
reference_pointer reference_softmax(extents3 input);
/// √(x + offset) − √offset, 0 for x below 0.
reference_pointer reference_square_root(extents3 input, double offset);
/// An elementwise function in double, its derivative, and how far results may lie from them, in units
/// roundoff.
struct reference_function {
    double (*value)(double);
    double (*derivative)(double);
    double value_roundings = 0, derivative_roundings = 0;
    double largest_slope = 1;
};
reference_pointer reference_activation(extents3 input, const reference_function& function);
/// x above 0, otherwise x times the slope of its channel.
reference_pointer reference_parametric_relu(extents3 input);
/// Dropout of nothing, and any dropout after training.
reference_pointer reference_identity(extents3 input);
reference_pointer reference_sequence(extents3 input, std::vector<reference_pointer> layers);
reference_pointer reference_residual(reference_pointer main, reference_pointer skip);
/// The input times the factor of each channel that the branch gives.
reference_pointer reference_gate(reference_pointer branch);
reference_pointer reference_concatenation(std::vector<reference_pointer> branches);

/// PyTorch's nn.GRU and nn.LSTM of one layer. The gradients of layers that run through time are compared with
/// finite differences alone.
reference_pointer reference_gru(extents3 input, std::size_t hidden);
reference_pointer reference_lstm(extents3 input, std::size_t hidden);
/// PyTorch's nn.Conv1d after a padding with zeros before the first frame.
reference_pointer reference_causal_conv1d(extents3 input, std::size_t filters, std::size_t taps,
                                          std::size_t dilation);
reference_pointer reference_last_frame(extents3 input);

} // namespace support

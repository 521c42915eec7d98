"""A model for each operator and each of its forms, as exporters write them, at odd sizes. MODELS: name to (bytes, options)."""

import math

import numpy

from builder import Builder
from onnx import numpy_helper

MODELS = {}


def model(**options):
    def add(function):
        MODELS[function.__name__] = function(), options
        return function
    return add


def finished(b, x, inputs, outputs=5, **options):
    return b.model(b.classifier(x, inputs, outputs), **options)


@model()
def conv_same_upper():
    b = Builder(1, 1, 9, 14, opset=11)
    x = b.conv("x", 1, 6, 4, 3, auto_pad="SAME_UPPER", strides=[2, 1])
    return finished(b, b("Relu", x), 6 * 5 * 14)


@model(scale=1 / 255)
def conv_same_lower():
    b = Builder(1, 1, 9, 14, opset=8)
    x = b.conv("x", 1, 6, 4, 2, auto_pad="SAME_LOWER")
    return finished(b, b("LeakyRelu", x, alpha=0.2), 6 * 9 * 14)


@model()
def conv_asymmetric():
    b = Builder(1, 1, 11, 7, opset=13)
    x = b("Sub", "x", [[[[100.0]]]])
    x = b.conv(x, 1, 5, 3, 2, pads=[0, 1, 2, 0], strides=[2, 1], bias=False)
    return finished(b, b("Tanh", b("Mul", x, [0.01])), 5 * 6 * 7, batch="batch")


@model(scale=1 / 255)
def conv_groups_without_bias():
    b = Builder(1, 1, 9, 10, opset=12)
    x = b("Relu", b.conv("x", 1, 6, 3, 3, pads=[1, 1, 1, 1]))
    x = b.norm(b.conv(x, 6, 4, 3, 3, groups=2, bias=False), 4, epsilon=1e-3)
    return finished(b, b("Relu", b.norm(x, 4)), 4 * 7 * 8)


@model(scale=1 / 255)
def conv_depthwise():
    b = Builder(1, 1, 9, 11)
    x = b("Clip", b.conv("x", 1, 8, 3, 3, pads=[1] * 4), b.constant(0.0), b.constant(6.0))
    return finished(b, b("Relu", b.conv(x, 8, 8, 3, 3, groups=8, pads=[1] * 4, strides=[2, 2])), 8 * 5 * 6)


@model(scale=1 / 255)
def conv_dilated():
    b = Builder(1, 1, 13, 12)
    x = b("Relu", b.conv("x", 1, 4, 3, 3, dilations=[2, 2], pads=[2] * 4))
    return finished(b, b("Relu", b.conv(x, 4, 4, 3, 2, dilations=[1, 3], pads=[0, 1, 1, 2])), 4 * 12 * 12)


@model(scale=1 / 255)
def conv_of_sequence():
    b = Builder(1, 3, 15)
    x = b("Relu", b.conv("x", 3, 6, 3, pads=[1, 1], strides=[2]))
    return finished(b, x, 6 * 8)


@model(scale=1 / 255)
def conv_causal():
    b = Builder(1, 3, 12, opset=10)
    x = b("Relu", b.conv(b("Pad", "x", pads=[0, 0, 2, 0, 0, 0]), 3, 6, 3))
    x = b("Relu", b.conv(b("Pad", x, pads=[0, 0, 4, 0, 0, 0]), 6, 4, 3, dilations=[2], bias=False))
    return b.model(b.gemm(b("Squeeze", b("Slice", x, [-1], [2 ** 62], [2]), axes=[2]), 4, 3))


@model(scale=1 / 255)
def conv_transposed():
    b = Builder(1, 1, 5, 7)
    x = b("Relu", b.conv("x", 1, 6, 3, 3, pads=[1] * 4))
    x = b("ConvTranspose", x, b.draw(6, 4, 3, 3), b.draw(4), strides=[2, 2], pads=[1, 1, 1, 1], output_padding=[1, 1])
    x = b("ConvTranspose", b("Relu", x), b.draw(4, 3, 2, 3), strides=[1, 2])
    return finished(b, b("Relu", x), 3 * 11 * 29)


@model(scale=1 / 255)
def conv_transposed_same():
    b = Builder(1, 1, 5, 4, opset=11)
    x = b("ConvTranspose", "x", b.draw(1, 4, 4, 3), b.draw(4), strides=[2, 2], auto_pad="SAME_UPPER")
    return finished(b, b("Relu", x), 4 * 10 * 8)


@model(scale=1 / 255)
def pool_max_ceil():
    b = Builder(1, 1, 9, 12, opset=10)
    x = b("MaxPool", b.conv("x", 1, 4, 3, 3), kernel_shape=[2, 3], strides=[2, 2], ceil_mode=1)
    return finished(b, b("MaxPool", b("Relu", x), kernel_shape=[3, 3], strides=[2, 1], pads=[1, 1, 1, 0]), 4 * 2 * 4)


@model(scale=1 / 255)
def pool_max_same():
    b = Builder(1, 1, 9, 12, opset=8)
    x = b("MaxPool", b("Relu", b.conv("x", 1, 4, 3, 3)), kernel_shape=[2, 2], strides=[2, 2], auto_pad="SAME_UPPER")
    return finished(b, x, 4 * 4 * 5)


@model(scale=1 / 255)
def pool_average_padded():
    b = Builder(1, 1, 9, 12)
    x = b("AveragePool", b.conv("x", 1, 4, 3, 3), kernel_shape=[3, 2], strides=[2, 1], pads=[1, 0, 1, 1], count_include_pad=1)
    return finished(b, b("Relu", x), 4 * 4 * 10)


@model(scale=1 / 255)
def pool_average_of_pixels():
    b = Builder(1, 1, 9, 12)
    x = b("AveragePool", b.conv("x", 1, 4, 3, 3), kernel_shape=[3, 3], strides=[2, 2], pads=[1, 1, 1, 1], ceil_mode=0)
    return finished(b, b("Relu", x), 4 * 4 * 5)


@model(scale=1 / 255)
def pool_after_pad():
    b = Builder(1, 1, 9, 12)
    x = b("AveragePool", b("Pad", b.conv("x", 1, 4, 3, 3), [0, 0, 1, 0, 0, 0, 0, 1]), kernel_shape=[2, 2], strides=[2, 2])
    x = b("MaxPool", b("Pad", b("Relu", x), [0, 0, 0, 1, 0, 0, 1, 0]), kernel_shape=[2, 2], strides=[1, 1])
    return finished(b, x, 4 * 4 * 5)


@model(scale=1 / 255)
def pool_global():
    b = Builder(1, 1, 9, 7)
    x = b("Relu", b.conv("x", 1, 6, 3, 3))
    mean = b("Squeeze", b("GlobalAveragePool", x), [2, 3])
    return b.model(b.gemm(b("Concat", mean, b("ReduceMax", x, axes=[2, 3], keepdims=0), axis=1), 12, 4))


@model(scale=1 / 255)
def norm_batch_kept():
    b = Builder(1, 1, 9, 7, opset=9)
    x = b("PRelu", b.norm(b("MaxPool", b.conv("x", 1, 6, 3, 3), kernel_shape=[2, 2]), 6), b.draw(6, 1, 1, low=-0.3, high=0.4))
    return finished(b, x, 6 * 6 * 4)


@model(scale=1 / 255, fold=True)
def norm_batch_folded():
    b = Builder(1, 1, 9, 7, opset=15)
    x = b("Relu", b.norm(b.conv("x", 1, 6, 3, 3, bias=False), 6))
    return b.model(b.norm(b.classifier(b.norm(x, 6), 6 * 7 * 5), 5))


@model(scale=1 / 255)
def norm_of_elements():
    b = Builder(1, 1, 5, 7)
    return b.model(b.gemm(b.norm(b("Flatten", b("Relu", b.conv("x", 1, 3, 3, 3))), 45), 45, 4))


@model(scale=1 / 255)
def norm_instance():
    b = Builder(1, 1, 9, 7)
    x = b("InstanceNormalization", b.conv("x", 1, 6, 3, 3), b.draw(6, low=0.5, high=1.5), b.draw(6))
    return finished(b, b("Relu", x), 6 * 7 * 5)


@model(scale=1 / 255)
def norm_group():
    b = Builder(1, 1, 9, 7, opset=11)
    x = b("Reshape", b.conv("x", 1, 6, 3, 3), [0, 3, -1])
    x = b("Reshape", b("InstanceNormalization", x, numpy.ones(3), numpy.zeros(3), epsilon=1e-4), [1, 6, 7, 5])
    x = b("Add", b("Mul", x, b.draw(6, 1, 1, low=0.5, high=1.5)), b.draw(6, 1, 1))
    return finished(b, b("Relu", x), 6 * 7 * 5)


@model(scale=1 / 255)
def norm_layer_of_frame():
    b = Builder(1, 1, 9, 7, opset=17)
    x = b("LayerNormalization", b.conv("x", 1, 4, 3, 3), b.draw(4, 7, 5, low=0.5, high=1.5), b.draw(4, 7, 5), axis=1)
    return finished(b, b("Relu", x), 4 * 7 * 5)


@model(scale=1 / 255)
def norm_layer_of_channels():
    b = Builder(1, 1, 9, 7, opset=11)
    x = b("Transpose", b.conv("x", 1, 6, 3, 3), perm=[0, 2, 3, 1])
    rest = b("Sub", x, b("ReduceMean", x, axes=[-1]))
    root = b("Sqrt", b("Add", b("ReduceMean", b("Pow", rest, b.constant(2.0)), axes=[-1]), b.constant(1e-6)))
    x = b("Add", b("Mul", b("Div", rest, root), b.draw(6, low=0.5, high=1.5)), b.draw(6))
    x = b("Add", b("MatMul", x, b.draw(6, 4)), b.draw(4))
    return finished(b, b("Relu", b("Transpose", x, perm=[0, 3, 1, 2])), 4 * 7 * 5)


@model(scale=1 / 255)
def norm_local_response():
    b = Builder(1, 1, 9, 7)
    return finished(b, b("LRN", b("Relu", b.conv("x", 1, 8, 3, 3)), size=5, alpha=0.05, beta=0.75, bias=2.0), 8 * 7 * 5)


@model(scale=1 / 255)
def functions_smooth():
    b = Builder(1, 1, 9, 9)
    x = b("Softplus", b.conv("x", 1, 4, 3, 3))
    x = b("Sigmoid", b.conv(x, 4, 4, 2, 2))
    x = b.conv(x, 4, 4, 2, 2)
    x = b("Mul", x, b("Sigmoid", x))
    x = b("Elu", b.conv(x, 4, 4, 2, 2), alpha=0.5)
    x = b.conv(x, 4, 4, 1, 1)
    x = b("Mul", b("Mul", x, b("Add", b("Erf", b("Div", x, b.constant(math.sqrt(2)))), b.constant(1.0))), b.constant(0.5))
    return finished(b, x, 4 * 4 * 4)


@model(scale=1 / 255)
def functions_piecewise():
    b = Builder(1, 1, 9, 9, opset=14)
    x = b("HardSwish", b.conv("x", 1, 4, 3, 3))
    x = b("HardSigmoid", b.conv(x, 4, 4, 2, 2), alpha=1 / 6, beta=0.5)
    x = b.conv(x, 4, 4, 2, 2)
    x = b("Div", b("Mul", x, b("Clip", b("Add", x, b.constant(3.0)), b.constant(0.0), b.constant(6.0))), b.constant(6.0))
    x = b("PRelu", b.conv(x, 4, 4, 2, 2), b.constant(numpy.full((1, 1, 1), 0.21719)))
    return finished(b, b("Max", b.conv(x, 4, 4, 1, 1), b.constant(0.0)), 4 * 4 * 4)


@model(scale=1 / 255)
def functions_clip():
    b = Builder(1, 1, 9, 9, opset=7)
    x = b("Clip", b.conv("x", 1, 4, 3, 3), min=0.0, max=6.0)
    return finished(b, b("Clip", b.conv(x, 4, 4, 2, 2), min=0.0), 4 * 6 * 6)


@model(scale=1 / 255)
def functions_square_root():
    b = Builder(1, 1, 9, 9)
    x = b("Sub", b("Sqrt", b("Add", b("Relu", "x"), b.constant(0.25))), b.constant(0.5))
    return finished(b, b("Relu", b.conv(x, 1, 4, 3, 3)), 4 * 7 * 7)


def resize(opset, arguments, scale_or_size, size, **attributes):
    b = Builder(1, 1, 5, 7, opset=opset)
    x = b("Resize" if opset > 9 else "Upsample", b("Relu", b.conv("x", 1, 3, 2, 2)), *arguments(b), scale_or_size, **attributes)
    return finished(b, b("Relu", b.conv(x, 3, 2, 3, 3)), 2 * (size[0] - 2) * (size[1] - 2))


@model(scale=1 / 255)
def resize_nearest():
    return resize(13, lambda b: [""], [1.0, 1.0, 2.0, 3.0], (8, 18), mode="nearest", nearest_mode="floor",
                  coordinate_transformation_mode="asymmetric")


@model(scale=1 / 255)
def resize_nearest_old():
    return resize(10, lambda b: [], [1.0, 1.0, 2.0, 2.0], (8, 12), mode="nearest")


@model(scale=1 / 255)
def resize_upsample():
    return resize(9, lambda b: [], [1.0, 1.0, 3.0, 2.0], (12, 12), mode="nearest")


@model(scale=1 / 255)
def resize_bilinear_to_size():
    return resize(11, lambda b: [b.constant(numpy.zeros(0)), b.constant(numpy.zeros(0))], [1, 3, 7, 11], (7, 11), mode="linear",
                  coordinate_transformation_mode="pytorch_half_pixel")


@model(scale=1 / 255)
def join_residual():
    b = Builder(1, 1, 9, 7)
    x = b("Relu", b.conv("x", 1, 4, 3, 3, pads=[1] * 4))
    x = b("Relu", b("Add", x, b.norm(b.conv(b("Relu", b.conv(x, 4, 6, 3, 3, pads=[1] * 4)), 6, 4, 3, 3, pads=[1] * 4), 4)))
    main = b.conv(b("Relu", b.conv(x, 4, 6, 3, 3, pads=[1] * 4, strides=[2, 2])), 6, 6, 1, 1)
    x = b("Relu", b("Add", main, b.conv(x, 4, 6, 1, 1, strides=[2, 2], bias=False)))
    return finished(b, x, 6 * 5 * 4)


@model(scale=1 / 255)
def join_sum_of_three():
    b = Builder(1, 1, 9, 7)
    x = b("Relu", b.conv("x", 1, 4, 3, 3))
    x = b("Sum", x, b.conv(x, 4, 4, 1, 1), b.conv(x, 4, 4, 3, 3, pads=[1] * 4))
    return finished(b, b("Relu", x), 4 * 7 * 5)


@model(scale=1 / 255)
def join_shared():
    """Branches that share a convolution, which both then compute."""
    b = Builder(1, 1, 9, 7)
    x = b("Relu", b.conv("x", 1, 4, 3, 3, pads=[1] * 4))
    left = b("Relu", b.conv(x, 4, 4, 1, 1))
    right = b("Relu", b.conv(b("Add", left, x), 4, 4, 1, 1))
    return finished(b, b("Relu", b("Add", b("Add", right, left), b.conv(left, 4, 4, 1, 1))), 4 * 9 * 7)


@model(scale=1 / 255)
def join_concat_nested():
    b = Builder(1, 1, 9, 7)
    x = b("Relu", b.conv("x", 1, 4, 3, 3))
    left = b("Relu", b.conv(x, 4, 3, 1, 1))
    left = b("Concat", b.conv(left, 3, 2, 1, 3, pads=[0, 1, 0, 1]), b.conv(left, 3, 2, 3, 1, pads=[1, 0, 1, 0]), axis=1)
    x = b("Concat", x, left, b("MaxPool", x, kernel_shape=[3, 3], pads=[1] * 4), axis=-3)
    return finished(b, b("Relu", x), 12 * 7 * 5)


@model(scale=1 / 255)
def join_gates():
    b = Builder(1, 1, 9, 7)
    x = b("Relu", b.conv("x", 1, 8, 3, 3))
    factors = b("Relu", b.conv(b("GlobalAveragePool", x), 8, 3, 1, 1))
    x = b("Mul", x, b("Sigmoid", b.conv(factors, 3, 8, 1, 1)))
    factors = b("Relu", b.gemm(b("ReduceMean", x, axes=[2, 3], keepdims=0), 8, 2))
    factors = b("Reshape", b("HardSigmoid", b.gemm(factors, 2, 8), alpha=1 / 6, beta=0.5), [1, 8, 1, 1])
    return finished(b, b("Mul", factors, x), 8 * 7 * 5)


@model(scale=1 / 255)
def recurrent_gru():
    b = Builder(1, 11, 3)
    x = b("Transpose", "x", perm=[1, 0, 2])
    every, last = b("GRU", x, b.draw(1, 15, 3), b.draw(1, 15, 5), b.draw(1, 30), outputs=2, hidden_size=5, linear_before_reset=1)
    gemm = [b.draw(3, 5), b.draw(3)]
    # The states of two layers, of which one is read, as PyTorch writes it.
    _, other = b("LSTM", b("Squeeze", every, [1]), b.draw(1, 20, 5), b.draw(1, 20, 5), outputs=2, hidden_size=5)
    return b.model(b("Gemm", b("Gather", b("Concat", last, other, axis=0), b.constant(0), axis=0), *gemm, transB=1))


@model(scale=1 / 255)
def recurrent_lstm():
    b = Builder(11, 1, 3, opset=12)
    every = b("LSTM", "x", b.draw(1, 20, 3), b.draw(1, 20, 5), b.draw(1, 40), "", b.constant(numpy.zeros((1, 1, 5))),
              b.constant(numpy.zeros((1, 1, 5))), outputs=3, hidden_size=5)[0]
    _, last = b("GRU", b("Squeeze", every, axes=[1]), b.draw(1, 12, 5), b.draw(1, 12, 4), outputs=2, hidden_size=4, linear_before_reset=1)
    return b.model(b.gemm(b("Squeeze", last, axes=[0]), 4, 3))


@model(scale=1 / 255)
def places_of_output():
    """A map as the output, with channels last."""
    b = Builder(1, 1, 6, 5)
    return b.model(b("Transpose", b.conv(b("Relu", b.conv("x", 1, 4, 3, 3)), 4, 3, 2, 2), perm=[0, 2, 3, 1]))


@model(scale=1 / 255)
def places_of_shapes():
    """A reshape whose sizes are computed from shapes, as PyTorch writes for open batches."""
    b = Builder(1, 1, 9, 7)
    x = b("Identity", b("Relu", b.conv("x", 1, 4, 3, 3)))
    batch = b("Unsqueeze", b("Gather", b("Shape", x), b.constant(0), axis=0), [0])
    x = b("Reshape", b("Dropout", x), b("Concat", batch, b.constant([-1]), axis=0))
    return b.model(b.gemm(x, 4 * 7 * 5, 4), batch="n")


@model(scale=1 / 255)
def places_channels_last():
    """What tf2onnx makes of Keras: channels last, bias apart, a flatten in that order."""
    b = Builder(1, 9, 7, 1)
    x = b("Transpose", "x", perm=[0, 3, 1, 2])
    x = b("Relu", b("Add", b.conv(x, 1, 6, 3, 3, bias=False, auto_pad="SAME_UPPER", strides=[2, 2]), b.draw(1, 6, 1, 1)))
    x = b("Transpose", b("MaxPool", x, kernel_shape=[2, 2], strides=[2, 2]), perm=[0, 2, 3, 1])
    x = b("Add", b("MatMul", b("Reshape", x, [-1, 24]), b.draw(24, 4)), b.draw(4))
    return b.model(b("Softmax", x))


@model()
def input_normalised():
    """MATLAB's input layer: minus a mean image, divided by a deviation for each channel."""
    b = Builder(1, 3, 9, 7, opset=9)
    x = b("Div", b("Sub", "x", b.draw(1, 3, 1, 1, low=90, high=140)), b.draw(1, 3, 1, 1, low=40, high=70))
    return finished(b, b("Relu", b.conv(x, 3, 4, 3, 3, pads=[1, 1, 1, 1])), 4 * 9 * 7)


@model()
def input_minus_image():
    b = Builder(1, 1, 9, 7, opset=9)
    x = b("Mul", b("Sub", "x", b.draw(1, 1, 9, 7, low=0, high=60)), b.constant(numpy.full((1, 1, 1, 1), 1 / 255)))
    return finished(b, b("Relu", b.conv(x, 1, 4, 3, 3, pads=[1, 1, 1, 1])), 4 * 9 * 7)


@model()
def linear_softmax():
    """skl2onnx: a scaler and a multinomial logistic regression."""
    b = Builder(1, 12, ai_onnx_ml=1)
    x = b("Scaler", "x", domain="ai.onnx.ml", offset=list(b.draw(12, low=0, high=255)), scale=[1 / 80] * 12)
    scores = b("LinearClassifier", x, domain="ai.onnx.ml", outputs=2, coefficients=list(b.draw(48)), intercepts=list(b.draw(4)),
               classlabels_strings=["ball", "bar", "hand", "mug"], multi_class=1, post_transform="SOFTMAX")[1]
    return b.model(b("Normalizer", scores, domain="ai.onnx.ml", norm="L1"))


@model(scale=1 / 255)
def linear_logistic():
    b = Builder(1, 12, ai_onnx_ml=1)
    w = b.draw(12)
    scores = b("LinearClassifier", "x", domain="ai.onnx.ml", outputs=2, coefficients=[*-w, *w], intercepts=[-0.25, 0.25],
               classlabels_ints=[0, 1], multi_class=1, post_transform="LOGISTIC")[1]
    return b.model(b("Normalizer", scores, domain="ai.onnx.ml", norm="L1"))


@model(scale=1 / 255)
def linear_regressor():
    b = Builder(1, 12, ai_onnx_ml=1)
    return b.model(b("LinearRegressor", "x", domain="ai.onnx.ml", coefficients=list(b.draw(24)), intercepts=list(b.draw(2)), targets=2))


def quantised():
    """A model of 8 bits as onnxruntime's quantiser writes it (QDQ), without the ReLU that a zero point stands for. Also the scales of its
    maps: of the input, and after each layer."""
    b, scales = Builder(1, 1, 6, 5), [1.0, 2.0, 16.0]
    byte = lambda value, kind: numpy_helper.from_array(numpy.asarray(value, kind), f"q{len(b.constants)}")  # noqa: E731

    def stored(value, kind):
        b.constants.append(byte(value, kind))
        return b.constants[-1].name

    def rounded(x, scale, zero):
        args = [b.constant(scale), stored(zero, numpy.uint8)]
        return b("DequantizeLinear", b("QuantizeLinear", x, *args), *args)

    def weights(*shape):
        scale = b.constant(b.draw(shape[0], low=0.001, high=0.004))
        return b("DequantizeLinear", stored(b.random.integers(-127, 128, shape), numpy.int8), scale, stored(numpy.zeros(shape[0]), numpy.int8), axis=0)

    x = rounded(b("Conv", rounded("x", scales[0], 0), weights(4, 1, 3, 3), b.draw(4)), scales[1], 0)
    x = rounded(b("Gemm", b("Flatten", x), weights(3, 48), b.draw(3), transB=1), scales[2], 128)
    return b.model(x), scales


# Kernel machines, whose label is compared.
MACHINES = {}


def machine(kernel, scaled, classes=3, features=7):
    b = Builder(1, features, ai_onnx_ml=1)
    counts = list(range(4, 4 + classes))
    total, pairs = sum(counts), classes * (classes - 1) // 2
    x = b("Scaler", "x", domain="ai.onnx.ml", offset=list(b.draw(features, low=90, high=160)), scale=[1 / 64] * features) if scaled else "x"
    size = 1.0 if scaled else 255.0
    b("SVMClassifier", x, domain="ai.onnx.ml", outputs=2, kernel_type=kernel, kernel_params=[0.15 if scaled else 2.0 / size ** 2, 0.0, 3.0],
      support_vectors=list(b.draw(total * features, low=-size if scaled else 0, high=size)), vectors_per_class=counts,
      coefficients=list(b.draw((classes - 1) * total)), rho=list(b.draw(pairs, low=-0.05, high=0.05)), classlabels_ints=list(range(classes)))
    b.nodes[-1].output[0] = "label"
    return b.model("label")


MACHINES["machine_rbf"] = machine("RBF", True)
MACHINES["machine_rbf_plain"] = machine("RBF", False, classes=5)
MACHINES["machine_linear"] = machine("LINEAR", True, classes=2)

"""A model for each operator and each of its forms, as exporters write them, at odd sizes. MODELS: name to (bytes, options)."""

import math

import numpy

from builder import Builder
from onnx import numpy_helper

MODELS = {}


def model(name, shape, make, scale=1 / 255, fold=None, batch=None, **opsets):
    """`make(builder)` returns the output, or a map and its size, which a dense layer of five outputs then reads."""
    b = Builder(*shape, **opsets)
    end = make(b)
    options = {key: value for key, value in (("scale", scale), ("fold", fold)) if value is not None}
    MODELS[name] = b.model(end if isinstance(end, str) else b.classifier(*end), batch=batch), options


def small(b, filters=4, kernel=3, **attributes):
    """A convolution of the input."""
    return b.conv("x", 1, filters, kernel, kernel, **attributes)


def relu(b, filters=4, kernel=3, **attributes):
    return b("Relu", small(b, filters, kernel, **attributes))


AROUND, IMAGE, WIDE, SQUARE = {"pads": [1] * 4}, (1, 1, 9, 7), (1, 1, 9, 12), (1, 1, 9, 9)

model("conv_same_upper", (1, 1, 9, 14), lambda b: (b("Relu", b.conv("x", 1, 6, 4, 3, auto_pad="SAME_UPPER", strides=[2, 1])), 6 * 5 * 14), None, opset=11)
model("conv_same_lower", (1, 1, 9, 14), lambda b: (b("LeakyRelu", b.conv("x", 1, 6, 4, 2, auto_pad="SAME_LOWER"), alpha=0.2), 6 * 9 * 14), opset=8)
model("conv_asymmetric", (1, 1, 11, 7), lambda b: (
    b("Tanh", b("Mul", b.conv(b("Sub", "x", [[[[100.0]]]]), 1, 5, 3, 2, pads=[0, 1, 2, 0], strides=[2, 1], bias=False), [0.01])), 5 * 6 * 7),
    None, batch="batch", opset=13)
model("conv_groups_without_bias", (1, 1, 9, 10), lambda b: (
    b("Relu", b.norm(b.norm(b.conv(relu(b, 6, **AROUND), 6, 4, 3, 3, groups=2, bias=False), 4, epsilon=1e-3), 4)), 4 * 7 * 8), opset=12)
model("conv_depthwise", (1, 1, 9, 11), lambda b: (b("Relu", b.conv(
    b("Clip", small(b, 8, **AROUND), b.constant(0.0), b.constant(6.0)), 8, 8, 3, 3, groups=8, strides=[2, 2], **AROUND)), 8 * 5 * 6))
model("conv_dilated", (1, 1, 13, 12), lambda b: (
    b("Relu", b.conv(relu(b, dilations=[2, 2], pads=[2] * 4), 4, 4, 3, 2, dilations=[1, 3], pads=[0, 1, 1, 2])), 4 * 12 * 12))
model("conv_of_sequence", (1, 3, 15), lambda b: (b("Relu", b.conv("x", 3, 6, 3, pads=[1, 1], strides=[2])), 6 * 8))


def conv_causal(b):
    x = b("Relu", b.conv(b("Pad", "x", pads=[0, 0, 2, 0, 0, 0]), 3, 6, 3))
    x = b("Relu", b.conv(b("Pad", x, pads=[0, 0, 4, 0, 0, 0]), 6, 4, 3, dilations=[2], bias=False))
    return b.gemm(b("Squeeze", b("Slice", x, [-1], [2 ** 62], [2]), axes=[2]), 4, 3)


def conv_transposed(b):
    x = b("ConvTranspose", relu(b, 6, **AROUND), b.draw(6, 4, 3, 3), b.draw(4), strides=[2, 2], output_padding=[1, 1], **AROUND)
    return b("Relu", b("ConvTranspose", b("Relu", x), b.draw(4, 3, 2, 3), strides=[1, 2])), 3 * 11 * 29


model("conv_causal", (1, 3, 12), conv_causal, opset=10)
model("conv_transposed", (1, 1, 5, 7), conv_transposed)
model("conv_transposed_same", (1, 1, 5, 4), lambda b: (
    b("Relu", b("ConvTranspose", "x", b.draw(1, 4, 4, 3), b.draw(4), strides=[2, 2], auto_pad="SAME_UPPER")), 4 * 10 * 8), opset=11)
model("pool_max_ceil", WIDE, lambda b: (b("MaxPool", b("Relu", b("MaxPool", small(b), kernel_shape=[2, 3], strides=[2, 2], ceil_mode=1)),
                                          kernel_shape=[3, 3], strides=[2, 1], pads=[1, 1, 1, 0]), 4 * 2 * 4), opset=10)
model("pool_max_same", WIDE, lambda b: (
    b("MaxPool", relu(b), kernel_shape=[2, 2], strides=[2, 2], auto_pad="SAME_UPPER"), 4 * 4 * 5), opset=8)
model("pool_average_padded", WIDE, lambda b: (
    b("Relu", b("AveragePool", small(b), kernel_shape=[3, 2], strides=[2, 1], pads=[1, 0, 1, 1], count_include_pad=1)), 4 * 4 * 10))
model("pool_average_of_pixels", WIDE, lambda b: (
    b("Relu", b("AveragePool", small(b), kernel_shape=[3, 3], strides=[2, 2], pads=[1, 1, 1, 1], ceil_mode=0)), 4 * 4 * 5))
model("pool_after_pad", WIDE, lambda b: (b("MaxPool", b("Pad", b("Relu", b(
    "AveragePool", b("Pad", small(b), [0, 0, 1, 0, 0, 0, 0, 1]), kernel_shape=[2, 2], strides=[2, 2])), [0, 0, 0, 1, 0, 0, 1, 0]),
    kernel_shape=[2, 2], strides=[1, 1]), 4 * 4 * 5))
model("pool_global", IMAGE, lambda b: b.gemm(b("Concat", b("Squeeze", b("GlobalAveragePool", (x := relu(b, 6))), [2, 3]),
                                               b("ReduceMax", x, axes=[2, 3], keepdims=0), axis=1), 12, 4))
model("norm_batch_kept", IMAGE, lambda b: (b("PRelu", b.norm(b("MaxPool", small(b, 6), kernel_shape=[2, 2]), 6), b.draw(
    6, 1, 1, low=-0.3, high=0.4)), 6 * 6 * 4), opset=9)
model("norm_batch_folded", IMAGE, lambda b: b.norm(
    b.classifier(b.norm(b("Relu", b.norm(small(b, 6, bias=False), 6)), 6), 6 * 7 * 5), 5), fold=True, opset=15)
model("norm_of_elements", (1, 1, 5, 7), lambda b: b.gemm(b.norm(b("Flatten", relu(b, 3)), 45), 45, 4))
model("norm_instance", IMAGE, lambda b: (
    b("Relu", b("InstanceNormalization", small(b, 6), b.draw(6, low=0.5, high=1.5), b.draw(6))), 6 * 7 * 5))


def norm_group(b):
    x = b("Reshape", small(b, 6), [0, 3, -1])
    x = b("Reshape", b("InstanceNormalization", x, numpy.ones(3), numpy.zeros(3), epsilon=1e-4), [1, 6, 7, 5])
    return b("Relu", b("Add", b("Mul", x, b.draw(6, 1, 1, low=0.5, high=1.5)), b.draw(6, 1, 1))), 6 * 7 * 5


def norm_layer_of_channels(b):
    x = b("Transpose", small(b, 6), perm=[0, 2, 3, 1])
    rest = b("Sub", x, b("ReduceMean", x, axes=[-1]))
    root = b("Sqrt", b("Add", b("ReduceMean", b("Pow", rest, b.constant(2.0)), axes=[-1]), b.constant(1e-6)))
    x = b("Add", b("Mul", b("Div", rest, root), b.draw(6, low=0.5, high=1.5)), b.draw(6))
    return b("Relu", b("Transpose", b("Add", b("MatMul", x, b.draw(6, 4)), b.draw(4)), perm=[0, 3, 1, 2])), 4 * 7 * 5


model("norm_group", IMAGE, norm_group, opset=11)
model("norm_layer_of_frame", IMAGE, lambda b: (
    b("Relu", b("LayerNormalization", small(b), b.draw(4, 7, 5, low=0.5, high=1.5), b.draw(4, 7, 5), axis=1)), 4 * 7 * 5), opset=17)
model("norm_layer_of_channels", IMAGE, norm_layer_of_channels, opset=11)
model("norm_local_response", IMAGE, lambda b: (b("LRN", relu(b, 8), size=5, alpha=0.05, beta=0.75, bias=2.0), 8 * 7 * 5))


def functions_smooth(b):
    x = b.conv(b("Sigmoid", b.conv(b("Softplus", small(b)), 4, 4, 2, 2)), 4, 4, 2, 2)
    x = b.conv(b("Elu", b.conv(b("Mul", x, b("Sigmoid", x)), 4, 4, 2, 2), alpha=0.5), 4, 4, 1, 1)
    erf = b("Erf", b("Div", x, b.constant(math.sqrt(2))))
    return b("Mul", b("Mul", x, b("Add", erf, b.constant(1.0))), b.constant(0.5)), 4 * 4 * 4


def functions_piecewise(b):
    x = b("HardSigmoid", b.conv(b("HardSwish", small(b)), 4, 4, 2, 2), alpha=1 / 6, beta=0.5)
    x = b.conv(x, 4, 4, 2, 2)
    x = b("Div", b("Mul", x, b("Clip", b("Add", x, b.constant(3.0)), b.constant(0.0), b.constant(6.0))), b.constant(6.0))
    x = b("PRelu", b.conv(x, 4, 4, 2, 2), b.constant(numpy.full((1, 1, 1), 0.21719)))
    return b("Max", b.conv(x, 4, 4, 1, 1), b.constant(0.0)), 4 * 4 * 4


model("functions_smooth", SQUARE, functions_smooth)
model("functions_piecewise", SQUARE, functions_piecewise, opset=14)
model("functions_clip", SQUARE, lambda b: (b("Clip", b.conv(b("Clip", small(b), min=0.0, max=6.0), 4, 4, 2, 2), min=0.0), 4 * 6 * 6), opset=7)
model("functions_square_root", SQUARE, lambda b: (
    b("Relu", b.conv(b("Sub", b("Sqrt", b("Add", b("Relu", "x"), b.constant(0.25))), b.constant(0.5)), 1, 4, 3, 3)), 4 * 7 * 7))

for name, opset, before, scale_or_size, (rows, columns), attributes in (
        ("nearest", 13, [""], [1.0, 1.0, 2.0, 3.0], (8, 18), {"nearest_mode": "floor", "coordinate_transformation_mode": "asymmetric"}),
        ("nearest_old", 10, [], [1.0, 1.0, 2.0, 2.0], (8, 12), {}), ("upsample", 9, [], [1.0, 1.0, 3.0, 2.0], (12, 12), {}),
        ("bilinear_to_size", 11, [numpy.zeros(0)] * 2, [1, 3, 7, 11], (7, 11), {"mode": "linear", "coordinate_transformation_mode": "pytorch_half_pixel"})):
    model(f"resize_{name}", (1, 1, 5, 7), lambda b: (b("Relu", b.conv(
        b("Resize" if opset > 9 else "Upsample", relu(b, 3, 2), *before, scale_or_size, **{"mode": "nearest", **attributes}), 3, 2, 3, 3)),
        2 * (rows - 2) * (columns - 2)), opset=opset)


def join_residual(b):
    x = relu(b, **AROUND)
    x = b("Relu", b("Add", x, b.norm(b.conv(b("Relu", b.conv(x, 4, 6, 3, 3, **AROUND)), 6, 4, 3, 3, **AROUND), 4)))
    main = b.conv(b("Relu", b.conv(x, 4, 6, 3, 3, strides=[2, 2], **AROUND)), 6, 6, 1, 1)
    return b("Relu", b("Add", main, b.conv(x, 4, 6, 1, 1, strides=[2, 2], bias=False))), 6 * 5 * 4


def join_shared(b):
    """Branches that share a convolution, which both then compute."""
    x = relu(b, **AROUND)
    left = b("Relu", b.conv(x, 4, 4, 1, 1))
    right = b("Relu", b.conv(b("Add", left, x), 4, 4, 1, 1))
    return b("Relu", b("Add", b("Add", right, left), b.conv(left, 4, 4, 1, 1))), 4 * 9 * 7


def join_concat_nested(b):
    x = relu(b)
    left = b("Relu", b.conv(x, 4, 3, 1, 1))
    left = b("Concat", b.conv(left, 3, 2, 1, 3, pads=[0, 1, 0, 1]), b.conv(left, 3, 2, 3, 1, pads=[1, 0, 1, 0]), axis=1)
    return b("Relu", b("Concat", x, left, b("MaxPool", x, kernel_shape=[3, 3], **AROUND), axis=-3)), 12 * 7 * 5


def join_gates(b):
    x = relu(b, 8)
    factors = b("Relu", b.conv(b("GlobalAveragePool", x), 8, 3, 1, 1))
    x = b("Mul", x, b("Sigmoid", b.conv(factors, 3, 8, 1, 1)))
    factors = b("Relu", b.gemm(b("ReduceMean", x, axes=[2, 3], keepdims=0), 8, 2))
    return b("Mul", b("Reshape", b("HardSigmoid", b.gemm(factors, 2, 8), alpha=1 / 6, beta=0.5), [1, 8, 1, 1]), x), 8 * 7 * 5


def recurrent_gru(b):
    every, last = b("GRU", b("Transpose", "x", perm=[1, 0, 2]), b.draw(1, 15, 3), b.draw(1, 15, 5), b.draw(1, 30), outputs=2, hidden_size=5,
                    linear_before_reset=1)
    gemm = [b.draw(3, 5), b.draw(3)]
    # The states of two layers, of which one is read, as PyTorch writes it.
    _, other = b("LSTM", b("Squeeze", every, [1]), b.draw(1, 20, 5), b.draw(1, 20, 5), outputs=2, hidden_size=5)
    return b("Gemm", b("Gather", b("Concat", last, other, axis=0), b.constant(0), axis=0), *gemm, transB=1)


def recurrent_lstm(b):
    every = b("LSTM", "x", b.draw(1, 20, 3), b.draw(1, 20, 5), b.draw(1, 40), "", *(b.constant(numpy.zeros((1, 1, 5))) for _ in range(2)),
              outputs=3, hidden_size=5)[0]
    _, last = b("GRU", b("Squeeze", every, axes=[1]), b.draw(1, 12, 5), b.draw(1, 12, 4), outputs=2, hidden_size=4, linear_before_reset=1)
    return b.gemm(b("Squeeze", last, axes=[0]), 4, 3)


def places_of_shapes(b):
    """A reshape whose sizes are computed from shapes, as PyTorch writes for open batches."""
    x = b("Identity", relu(b))
    batch = b("Unsqueeze", b("Gather", b("Shape", x), b.constant(0), axis=0), [0])
    return b.gemm(b("Reshape", b("Dropout", x), b("Concat", batch, b.constant([-1]), axis=0)), 4 * 7 * 5, 4)


def places_channels_last(b):
    """What tf2onnx makes of Keras: channels last, bias apart, a flatten in that order."""
    x = b("Transpose", "x", perm=[0, 3, 1, 2])
    x = b("Relu", b("Add", b.conv(x, 1, 6, 3, 3, bias=False, auto_pad="SAME_UPPER", strides=[2, 2]), b.draw(1, 6, 1, 1)))
    x = b("Transpose", b("MaxPool", x, kernel_shape=[2, 2], strides=[2, 2]), perm=[0, 2, 3, 1])
    return b("Softmax", b("Add", b("MatMul", b("Reshape", x, [-1, 24]), b.draw(24, 4)), b.draw(4)))


model("join_residual", IMAGE, join_residual)
model("join_sum_of_three", IMAGE, lambda b: (
    b("Relu", b("Sum", (x := relu(b)), b.conv(x, 4, 4, 1, 1), b.conv(x, 4, 4, 3, 3, **AROUND))), 4 * 7 * 5))
model("join_shared", IMAGE, join_shared)
model("join_concat_nested", IMAGE, join_concat_nested)
model("join_gates", IMAGE, join_gates)
model("recurrent_gru", (1, 11, 3), recurrent_gru)
model("recurrent_lstm", (11, 1, 3), recurrent_lstm, opset=12)
# A map as the output, with channels last.
model("places_of_output", (1, 1, 6, 5), lambda b: b("Transpose", b.conv(relu(b), 4, 3, 2, 2), perm=[0, 2, 3, 1]))
model("places_of_shapes", IMAGE, places_of_shapes, batch="n")
model("places_channels_last", (1, 9, 7, 1), places_channels_last)
# MATLAB's input layer: minus a mean image, divided by a deviation for each channel.
model("input_normalised", (1, 3, 9, 7), lambda b: (b("Relu", b.conv(b("Div", b("Sub", "x", b.draw(1, 3, 1, 1, low=90, high=140)), b.draw(
    1, 3, 1, 1, low=40, high=70)), 3, 4, 3, 3, **AROUND)), 4 * 9 * 7), None, opset=9)
model("input_minus_image", IMAGE, lambda b: (b("Relu", b.conv(b("Mul", b("Sub", "x", b.draw(1, 1, 9, 7, low=0, high=60)), numpy.full(
    (1, 1, 1, 1), 1 / 255)), 1, 4, 3, 3, **AROUND)), 4 * 9 * 7), None, opset=9)


def linear(b, x, coefficients, intercepts, transform, **labels):
    """skl2onnx: scores and their sum."""
    scores = b("LinearClassifier", x, domain="ai.onnx.ml", outputs=2, coefficients=coefficients, intercepts=intercepts, multi_class=1,
               post_transform=transform, **labels)[1]
    return b("Normalizer", scores, domain="ai.onnx.ml", norm="L1")


# A scaler and a multinomial logistic regression; one of two classes; a regression.
model("linear_softmax", (1, 12), lambda b: linear(
    b, b("Scaler", "x", domain="ai.onnx.ml", offset=list(b.draw(12, low=0, high=255)), scale=[1 / 80] * 12), list(b.draw(48)), list(b.draw(4)),
    "SOFTMAX", classlabels_strings=["ball", "bar", "hand", "mug"]), None, ai_onnx_ml=1)
model("linear_logistic", (1, 12), lambda b: linear(
    b, "x", [*-(w := b.draw(12)), *w], [-0.25, 0.25], "LOGISTIC", classlabels_ints=[0, 1]), ai_onnx_ml=1)
model("linear_regressor", (1, 12), lambda b: b(
    "LinearRegressor", "x", domain="ai.onnx.ml", coefficients=list(b.draw(24)), intercepts=list(b.draw(2)), targets=2), ai_onnx_ml=1)


def quantised(of_input=1.0):
    """A model of 8 bits as onnxruntime's quantiser writes it (QDQ), without the ReLU that a zero point stands for. Also the scales of its
    maps: of the input, and after each layer."""
    b, scales = Builder(1, 1, 6, 5), [of_input, 2.0, 16.0]
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

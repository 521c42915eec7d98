"""Layers of networks, as docs/train/networks.md describes them. Sizes are a number for a square, or (rows, columns); padding is
"same", "valid", a number of pixels, or (top, bottom, left, right); a branch is a layer or a list of them.

>>> Conv2d(16, (2, 3), padding="valid")
conv2d<16, extent2d{2, 3}, 1, padding::valid>
>>> Residual([Conv2d(16, 3), BatchNorm()])
residual<sequence<conv2d<16, 3>, batch_norm>>
"""

import inspect
from dataclasses import dataclass
from fractions import Fraction
from typing import Callable

from .spelling import call, extent


@dataclass(frozen=True)
class Layer:
    """A layer of a list: `text` is its type in C++."""
    text: str

    def __repr__(self) -> str:
        return self.text


Cpp = Layer  # any other layer, by its type: Cpp("local_response_norm<>")


def whole(value, least=1) -> int:
    if isinstance(value, bool) or int(value) != value or value < least:
        raise ValueError(f"expected a whole number of at least {least}, found {value!r}")
    return int(value)


def number(value) -> str:
    return str(whole(value))


def size(value) -> str:
    return extent(*(whole(n) for n in (value if isinstance(value, (tuple, list)) else (value, value))))


def padding(value) -> str:
    if value in ("same", "valid"):
        return f"padding::{value}"
    sides = value if isinstance(value, (tuple, list)) else (value,)
    if isinstance(value, str) or len(sides) not in (1, 4):
        raise ValueError(f"expected padding 'same', 'valid', a number, or (top, bottom, left, right), found {value!r}")
    return f"pad({', '.join(str(whole(side, 0)) for side in sides)})"


def branch(value) -> str:
    texts = [layer.text for layer in ([value] if isinstance(value, Layer) else value)]
    return "identity_layer" if not texts else texts[0] if len(texts) == 1 else f"sequence<{', '.join(texts)}>"


def thousandths(value) -> str:
    if abs(value - round(1000 * value) / 1000) > 1e-9:
        raise ValueError(f"expected a number of whole thousandths, found {value!r}")
    return number(round(1000 * value))


def word(*words):
    def spell(value):
        if value not in words:
            raise ValueError(f"expected one of {', '.join(words)}, found {value!r}")
        return value
    return spell


def ratio(value) -> str:
    share = Fraction(value).limit_denominator(10 ** 6)
    return f"std::ratio<{share.numerator}, {share.denominator}>"


def _layer(text: str, what: str, **parameters) -> Callable[..., Layer]:
    """A function that spells a layer. Parameters are how they are spelled, or that and their default; None is the window or the kernel."""
    spellings = {name: each if isinstance(each, tuple) else (each,) for name, each in parameters.items()}
    signature = inspect.Signature([inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD, default=each[1] if each[1:] else inspect.Parameter.empty)
                                   for name, each in spellings.items()])

    def make(*positional, **named):
        given = signature.bind(*positional, **named)
        given.apply_defaults()
        window = given.arguments.get("window", given.arguments.get("kernel"))
        texts = [[spell(window if value is None else value) for value in (given.arguments[name], *default)] for name, (spell, *default) in spellings.items()]
        spelled = call(text.rstrip("<>"), *((own, default[0] if default else "") for own, *default in texts))
        return Layer(spelled + "<>" if text.endswith("<>") and "<" not in spelled else spelled)

    vars(make)["__signature__"], make.__doc__ = signature, what
    return make


def _list(text: str, what: str) -> Callable[..., Layer]:
    def make(*layers):
        return Layer(f"{text}<{', '.join(map(branch, layers))}>")
    make.__doc__ = what
    return make


_windows = {"window": size, "stride": (size, None), "padding": (padding, "same")}
Conv2d = _layer("conv2d", "Convolution; as many groups as channels make it depthwise.", filters=number, kernel=size, stride=(size, 1),
                padding=(padding, "same"), groups=(lambda n: f"in_groups({whole(n)})", 1))
DilatedConv2d = _layer("dilated_conv2d", "Convolution whose taps are `dilation` pixels apart.", filters=number, kernel=size, dilation=(size, 2),
                       stride=(size, 1), padding=(padding, "same"))
TransposedConv2d = _layer("transposed_conv2d", "Transposed convolution: the map grows by `stride`.", filters=number, kernel=size, stride=(size, None),
                          padding=(padding, "same"))
MaxPool = _layer("max_pool", "The largest value of each window.", **_windows)
AveragePool = _layer("average_pool", "The mean of each window.", **_windows, over=(
    lambda value: f"average_over::{word('pixels', 'pixels_and_padding')(value)}", "pixels"))
AdaptiveMaxPool = _layer("adaptive_max_pool", "The largest values of bins of almost equal size.", outputs=size)
AdaptiveAveragePool = _layer("adaptive_average_pool", "The means of bins of almost equal size.", outputs=size)
Upsample = _layer("upsample", "Rows and columns times `factor`.", factor=size, mode=(
    lambda value: f"interpolation::{word('nearest', 'bilinear')(value)}", "nearest"))
Dense = _layer("dense", "Every output is a weighted sum of all inputs, with bias.", outputs=number)
Dropout = _layer("dropout", "Zeroes each element with that probability, 1 to 99 %, in training.", percent=number)
GroupNorm = _layer("group_norm", "Each group of channels of each frame gets mean 0 and variance 1.", groups=number)
LayerNorm = _layer("layer_norm", "Over the whole 'frame', or over the 'channels' of each pixel.", over=lambda value: f"norm_over::{word('frame', 'channels')(value)}")
LeakyReLU = _layer("leaky_relu<>", "x, or `slope` times x below 0.", slope=(thousandths, 0.01))
ELU = _layer("elu<>", "x, or alpha (exp(x) - 1) below 0.", alpha=(thousandths, 1))
SquareRoot = _layer("square_root<>", "sqrt(x + offset) - sqrt(offset): at the start of a network, the noise of counts becomes uniform.",
                    offset=(ratio, Fraction(3, 8 * 255)))
Residual = _layer("residual", "main(x) + skip(x); an empty branch passes x on.", main=branch, skip=(branch, ()))
SqueezeExcitation = _layer("squeeze_excitation", "A gate of means of all channels.", channels=number, squeezed=number,
                           scale=(word("sigmoid", "hard_sigmoid"), "sigmoid"))
GRU = _layer("gru", "Reads a sequence of frames (frames, 1, features), and makes the sequence of its states.", hidden=number)
LSTM = _layer("lstm", "As GRU.", hidden=number)
CausalConv1d = _layer("causal_conv1d", "Convolution over a frame and those before it.", filters=number, taps=number, dilation=(number, 1))
Concatenation = _list("concatenation", "The channels of all branches, each a layer or a list.")
Gate = _list("gate", "Multiplies each channel by a factor, which the layers compute.")
Sequence = _list("sequence", "A list as one layer.")
BatchNorm = _layer("batch_norm", "Each channel gets mean 0 and variance 1, then a learned scale and shift.")
InstanceNorm = _layer("instance_norm", "Each channel of each frame gets mean 0 and variance 1.")
RMSNorm = _layer("rms_norm", "The channels of each pixel, divided by their root mean square.")
ChannelScale = _layer("channel_scale", "A learned factor for each channel.")
ReLU = _layer("relu", "max(x, 0)")
ReLU6 = _layer("relu6", "max(x, 0), at most 6")
PReLU = _layer("parametric_relu", "x, or below 0 x times a learned slope of its channel")
Sigmoid = _layer("sigmoid", "1 / (1 + exp(-x))")
Tanh = _layer("hyperbolic_tangent", "tanh(x)")
Softplus = _layer("softplus", "log(1 + exp(x))")
SiLU = _layer("silu", "x sigmoid(x)")
GELU = _layer("gelu", "x times the normal distribution function of x")
HardSigmoid = _layer("hard_sigmoid", "(x + 3) / 6, clamped to 0 ... 1")
HardSwish = _layer("hard_swish", "x hard_sigmoid(x)")
GlobalMaxPool = _layer("global_max_pool", "The largest value of each channel.")
GlobalAveragePool = _layer("global_average_pool", "The mean of each channel.")
LastFrame = _layer("last_frame", "The last frame of a sequence.")
Softmax = _layer("softmax", "Probabilities of logits, at the end of a list.")

__all__ = [name for name in globals() if name[0].isupper() and name != "Fraction"]

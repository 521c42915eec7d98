"""What evaluation of ONNX's operators and the library's layers have in common, in double precision. Maps are
[channels, rows, columns]."""

import math

import numpy
from numpy.lib.stride_tricks import sliding_window_view


def windows(x, kernel, strides, pads, dilations=(1, 1), fill=0.0):
    """[channels, output rows, output columns, kernel rows, kernel columns]; pads are top, left, bottom, right."""
    if max(pads) > 1 << 12 or max(*kernel, *strides, *dilations) > 1 << 14 or min(*kernel, *strides, *dilations) < 1:
        raise ValueError("impossible kernel, stride, dilation or padding")
    padded = numpy.pad(x, ((0, 0), (pads[0], pads[2]), (pads[1], pads[3])), constant_values=fill)
    reach = [(k - 1) * d + 1 for k, d in zip(kernel, dilations)]
    if padded.shape[1] < reach[0] or padded.shape[2] < reach[1]:
        raise ValueError("the kernel is larger than the padded input")
    seen = sliding_window_view(padded, reach, axis=(1, 2))
    return seen[:, :: strides[0], :: strides[1], :: dilations[0], :: dilations[1]]


def convolution(x, weight, bias, strides, pads, dilations=(1, 1), groups=1):
    if groups < 1 or weight.shape[0] % groups or x.shape[0] != weight.shape[1] * groups:
        raise ValueError(f"weights {list(weight.shape)} in {groups} groups and {x.shape[0]} channels do not fit")
    seen = windows(x, weight.shape[2:], strides, pads, dilations)
    filters, channels = weight.shape[0] // groups, weight.shape[1]
    found = numpy.concatenate([
        numpy.tensordot(weight[g * filters:(g + 1) * filters], seen[g * channels:(g + 1) * channels], ([1, 2, 3], [0, 3, 4]))
        for g in range(groups)])
    return found if bias is None else found + bias[:, None, None]


def transposed_convolution(x, weight, bias, strides, pads, size=None, groups=1, dilations=(1, 1)):
    """Weights are [channels, filters of a group, rows, columns]. `size` of the output follows from the pads unless given."""
    channels = weight.shape[0] // groups
    if x.shape[0] != weight.shape[0] or weight.shape[0] % groups:
        raise ValueError("weights and channels do not fit")
    reach = [(k - 1) * d + 1 for k, d in zip(weight.shape[2:], dilations)]
    whole = [(n - 1) * s + k for n, s, k in zip(x.shape[1:], strides, reach)]
    if math.prod(whole) > 1 << 24 or max(*strides, *dilations, *pads) > 1 << 12:
        raise ValueError("impossible stride or padding")
    filters = weight.shape[1]
    size = size or [w - pads[i] - pads[i + 2] for i, w in enumerate(whole)]
    if min(size) < 1:
        raise ValueError("the padding leaves nothing")
    room = [max(w, s + p) for w, s, p in zip(whole, size, pads)]
    found = numpy.zeros((filters * groups, *room))
    for r in range(weight.shape[2]):
        for c in range(weight.shape[3]):
            rows = slice(r * dilations[0], r * dilations[0] + (x.shape[1] - 1) * strides[0] + 1, strides[0])
            columns = slice(c * dilations[1], c * dilations[1] + (x.shape[2] - 1) * strides[1] + 1, strides[1])
            for g in range(groups):
                part = slice(g * channels, (g + 1) * channels)
                found[g * filters:(g + 1) * filters, rows, columns] += numpy.tensordot(weight[part, :, r, c], x[part], (0, 0))
    found = found[:, pads[0]:pads[0] + size[0], pads[1]:pads[1] + size[1]]
    return found if bias is None else found + bias[:, None, None]


def pool(x, kernel, strides, pads, dilations=(1, 1), average=False, counts=None):
    """The largest or the mean of each window; `counts` divides sums, otherwise the pixels in each window do."""
    if not average:
        return windows(x, kernel, strides, pads, dilations, -numpy.inf).max((3, 4))
    sums = windows(x, kernel, strides, pads, dilations).sum((3, 4))
    return sums / (windows(numpy.ones_like(x[:1]), kernel, strides, pads, dilations).sum((3, 4)) if counts is None else counts)


def normalise(x, axes, epsilon):
    mean = x.mean(axes, keepdims=True)
    return (x - mean) / numpy.sqrt(((x - mean) ** 2).mean(axes, keepdims=True) + epsilon)


def softmax(x, axis):
    powers = numpy.exp(x - x.max(axis, keepdims=True))
    return powers / powers.sum(axis, keepdims=True)


def sigmoid(x):
    return 0.5 * (1 + numpy.tanh(0.5 * x))


def softplus(x):
    return numpy.maximum(x, 0) + numpy.log1p(numpy.exp(-abs(x)))


def error_function(x):
    return numpy.vectorize(math.erf, otypes=[float])(x)


def local_responses(x, size, alpha, beta, k, before):
    squares = numpy.pad(x ** 2, [(before, size - 1 - before)] + [(0, 0)] * (x.ndim - 1))
    return x * (k + alpha / size * sum(squares[i:i + x.shape[0]] for i in range(size))) ** -beta


def gru(x, w, r, wb, rb, linear_before_reset=True):
    """Frames [frames, features]; gates in PyTorch's order: reset, update, new."""
    hidden, h, states = r.shape[1], numpy.zeros(r.shape[1]), []
    for frame in x @ w.T + wb:
        own = r @ h + rb
        reset = sigmoid(frame[:hidden] + own[:hidden])
        update = sigmoid(frame[hidden:2 * hidden] + own[hidden:2 * hidden])
        rest = reset * own[2 * hidden:] if linear_before_reset else r[2 * hidden:] @ (reset * h) + rb[2 * hidden:]
        h = (1 - update) * numpy.tanh(frame[2 * hidden:] + rest) + update * h
        states.append(h)
    return numpy.array(states)


def lstm(x, w, r, wb, rb):
    """Gates in PyTorch's order: input, forget, cell, output."""
    hidden = r.shape[1]
    h, c, states = numpy.zeros(hidden), numpy.zeros(hidden), []
    for frame in x @ w.T + wb:
        i, f, g, o = (frame + r @ h + rb).reshape(4, hidden)
        c = sigmoid(f) * c + sigmoid(i) * numpy.tanh(g)
        h = sigmoid(o) * numpy.tanh(c)
        states.append(h)
    return numpy.array(states)

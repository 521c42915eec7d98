"""Pools, means and maxima over axes, and resizing."""

import numpy

from .. import arithmetic
from ..layers import Layer, Map, call, extent
from . import REFUSED, evaluates, imports
from .convolution import as_tensor, image, outputs_of, pad_text, padding_text, window_of
from .shapes import axes_of


def pool_window(node, extents):
    """As window_of; in ceil mode with what the last window needs after the end. The third of the pads is as stated."""
    kernel, strides, pads, dilations = window_of(node, extents, node.get("kernel_shape"))
    stated, extents = list(pads), list(extents) + [1] * (2 - len(extents))
    if node.get("ceil_mode", 0):
        for i, (n, k, s, d) in enumerate(zip(extents, kernel, strides, dilations)):
            reach, whole = (k - 1) * d + 1, n + pads[i] + pads[i + 2]
            outputs = -(-(whole - reach) // s) + 1
            if (outputs - 1) * s >= n + pads[i]:  # a window begins in the image or before it
                outputs -= 1
            pads[i + 2] = max(0, (outputs - 1) * s + reach - n - pads[i])
    return kernel, strides, pads, dilations, stated


def counts_of(x, kernel, strides, pads, stated):
    """The elements of each window, with the stated padding but without what ceil mode adds."""
    ones = numpy.pad(numpy.ones_like(x[:1]), ((0, 0), (stated[0], stated[2]), (stated[1], stated[3])))
    ones[:] = 1
    return arithmetic.windows(ones, kernel, strides, [0, 0, max(0, pads[2] - stated[2]), max(0, pads[3] - stated[3])]).sum((3, 4))


@evaluates("MaxPool", "AveragePool")
def evaluate_pool(node, x):
    kernel, strides, pads, dilations, stated = pool_window(node, x.shape[2:])
    x, like = image(x), x
    counts = counts_of(x, kernel, strides, pads, stated) if node.get("count_include_pad", 0) else None
    return as_tensor(arithmetic.pool(x, kernel, strides, pads, dilations, node.op == "AveragePool", counts), like)


@evaluates("GlobalAveragePool", "GlobalMaxPool")
def evaluate_global(node, x):
    axes = tuple(range(2, x.ndim))
    return x.mean(axes, keepdims=True) if node.op == "GlobalAveragePool" else x.max(axes, keepdims=True)


@evaluates("ReduceMean", "ReduceMax", "ReduceSum", "ReduceMin", "ReduceProd")
def evaluate_reduce(node, x, axes=None):
    if axes is not None and axes.size == 0 or node.get("noop_with_empty_axes") and axes is None:
        axes = None
    function = {"ReduceMean": numpy.mean, "ReduceMax": numpy.max, "ReduceSum": numpy.sum, "ReduceMin": numpy.min, "ReduceProd": numpy.prod}[node.op]
    return function(x, axis=axes_of(node, axes, x.ndim), keepdims=bool(node.get("keepdims", 1)))


@imports("MaxPool", "AveragePool")
def import_pool(walk, node, here, _):
    node.require(here.is_image(), "its input is no map [1, channels, rows, columns] in order", "a pool of such a map")
    kernel, strides, pads, dilations, stated = pool_window(node, here.places.shape[2:])
    node.require(dilations == [1, 1], "a dilated pool", "dilations of 1")
    average, over = node.op == "AveragePool", "average_over::pixels"
    around = walk.pads.get(node.inputs[0])
    counted = bool(node.get("count_include_pad", 0)) and any(pads)
    if around:
        node.require(not average or not any(pads) or counted, "it counts one padding and not the other", "count_include_pad of 1")
        pads, stated = ([p + a for p, a in zip(given, around)] for given in (pads, stated))
        counted = average and any(pads)
    rows, columns, channels = here.shape
    node.require(max(pads[0], pads[2]) < kernel[0] and max(pads[1], pads[3]) < kernel[1], "a window holds nothing but padding",
                 "padding below the window")
    output = outputs_of(here.shape, kernel, strides, pads)
    # A window that the image does not fill on its own may be larger than it.
    text = padding_text(here.shape, kernel, strides, pads)
    counts = None
    if average and counted:
        over = "average_over::pixels_and_padding"
        if pads != stated:
            text = f"ceil_mode({pad_text(stated) if any(stated) else ''})"
        counts = counts_of(numpy.zeros((1, rows, columns)), kernel, strides, pads, stated)
        text = text if pads != stated or text != "padding::same" else pad_text(pads)
    name = "average_pool" if average else "max_pool"
    layer = Layer("pool", call(name, (extent(*kernel), ""), (extent(*strides), extent(*kernel)), (text, "padding::same"),
                               (over, "average_over::pixels")), output + (channels,),
                  lambda x, _: arithmetic.pool(x, kernel, strides, pads, average=average, counts=counts))
    if output == (1, 1) and tuple(kernel) == (rows, columns) and not any(pads):
        layer.text = "global_average_pool" if average else "global_max_pool"
    return [layer], Map.plain(layer.output, (1, channels, *output)[:here.places.ndim])


@imports("GlobalAveragePool", "GlobalMaxPool", "ReduceMean", "ReduceMax")
def import_global(walk, node, here, _):
    """Whatever axes it reduces: the places must be all those of each channel."""
    channels = here.places // here.area
    axes, keep = tuple(range(2, channels.ndim)), True
    if not node.op.startswith("Global"):
        axes, keep = axes_of(node, walk.constant(node, 1), channels.ndim), bool(node.get("keepdims", 1))
    low, high = (find(channels, axis=axes, keepdims=keep) for find in (numpy.min, numpy.max))
    count = here.size // max(1, low.size)
    node.require(here.places.size == here.size and numpy.array_equal(low, high) and count == here.area and low.size == here.shape[2],
                 "it reduces something else than all pixels of each channel", "GlobalAveragePool, global_average_pool")
    name, function = ("global_max_pool", numpy.max) if "Max" in node.op else ("global_average_pool", numpy.mean)
    shape = (1, 1, here.shape[2])
    return [Layer("pool", name, shape, lambda x, _: function(x, axis=(1, 2), keepdims=True))], Map(shape, low)


for operator in ("ReduceSum", "ReduceMin", "ReduceProd"):
    REFUSED[operator] = ("there is no such layer", "ReduceMean, global_average_pool")


def sources(inputs, outputs, scale, mode, position, nearest):
    """[outputs, inputs]: the weights of each input along one axis. `scale` is outputs per input."""
    o = numpy.arange(outputs, dtype=numpy.float32)
    scale = numpy.float32(scale)
    if position == "asymmetric":
        x = o / scale
    elif position == "align_corners":
        x = o * numpy.float32((inputs - 1) / (outputs - 1)) if outputs > 1 else o * 0
    elif position == "pytorch_half_pixel" and outputs == 1:
        x = o * 0
    elif position == "tf_half_pixel_for_nn":
        x = (o + 0.5) / scale
    elif position in ("half_pixel", "pytorch_half_pixel", "half_pixel_symmetric"):
        x = (o + numpy.float32(0.5)) / scale - numpy.float32(0.5)
    else:
        raise ValueError(f"coordinate_transformation_mode {position}")
    if mode == "nearest":
        x = {"floor": numpy.floor, "ceil": numpy.ceil, "round_prefer_floor": lambda v: numpy.ceil(v - 0.5),
             "round_prefer_ceil": lambda v: numpy.floor(v + 0.5)}[nearest](x)
    elif mode != "linear":
        raise ValueError(f"mode {mode}")
    return weights_at(x, inputs, mode == "linear")


def weights_at(x, inputs, linear):
    """[positions, inputs]: the weights of each input at positions between them."""
    x = numpy.clip(x.astype(numpy.float64), 0, inputs - 1)
    every, first = numpy.arange(len(x)), numpy.floor(x).astype(int)
    weights = numpy.zeros((len(x), inputs))
    if linear:
        first = numpy.minimum(first, max(0, inputs - 2))
        weights[every, first] += 1 - (x - first)
        weights[every, numpy.minimum(first + 1, inputs - 1)] += x - first
    else:
        weights[every, first] = 1
    return weights


def resizing(node, x, scales, sizes):
    """The weights along each axis of a map, and its new extents."""
    extents = x.shape
    if sizes is not None and numpy.size(sizes):
        sizes = [int(s) for s in sizes]
        scales = [s / n for s, n in zip(sizes, extents)]
    else:
        scales = [float(s) for s in numpy.ravel(node.get("scales") if scales is None else scales)]
        if not all(0 < s < 4096 for s in scales):
            raise ValueError(f"scales {scales}")
        if scales[:2] != [1, 1]:
            raise ValueError("it resizes batch or channels")
        sizes = [int(numpy.floor(n * s)) for n, s in zip(extents, scales)]
    if len(sizes) != len(extents) or sizes[:2] != list(extents[:2]) or min(sizes) < 1 or numpy.prod(sizes, dtype=float) > 1 << 26:
        raise ValueError(f"it resizes {list(extents)} to {sizes}")
    old = node.op == "Upsample" or node.opset < 11
    return [sources(n, s, scale, {"bilinear": "linear"}.get(node.get("mode", "nearest"), node.get("mode", "nearest")),
                    "asymmetric" if old else node.get("coordinate_transformation_mode", "half_pixel"),
                    "floor" if old else node.get("nearest_mode", "round_prefer_floor"))
            for n, s, scale in zip(extents[2:], sizes[2:], scales[2:])], sizes


def resize_inputs(node, arguments):
    """(scales, sizes) of the versions of Resize and Upsample."""
    arguments = list(arguments) + [None] * 3
    return (arguments[0], None) if node.op == "Upsample" or node.opset < 11 else (arguments[1], arguments[2])


def resampled(x, down, along):
    return numpy.einsum("or,crk,pk->cop", down, x, along)


@evaluates("Resize", "Upsample")
def evaluate_resize(node, x, *arguments):
    axes, _ = resizing(node, x, *resize_inputs(node, arguments))
    return as_tensor(resampled(image(x), axes[0], axes[1] if len(axes) > 1 else numpy.ones((1, 1))), x)


def own_sources(inputs, outputs, bilinear):
    """The weights of the library: PyTorch's positions."""
    if bilinear:
        return weights_at((numpy.arange(outputs) + 0.5) * inputs / outputs - 0.5, inputs, True)
    return weights_at(numpy.arange(outputs, dtype=numpy.float32) * (numpy.float32(inputs) / numpy.float32(outputs)), inputs, False)


@imports("Resize", "Upsample")
def import_resize(walk, node, here, _):
    node.require(here.is_image(), "its input is no map [1, channels, rows, columns] in order", "Resize of such a map")
    axes, sizes = resizing(node, here.places, *resize_inputs(node, [walk.constant(node, i) for i in range(1, len(node.inputs))]))
    size = (sizes[2], sizes[3] if len(sizes) > 3 else 1)
    axes = axes + [numpy.ones((1, 1))] * (2 - len(axes))
    for bilinear in (False, True):
        own = [own_sources(n, s, bilinear) for n, s in zip(here.shape, size)]
        if all(numpy.allclose(a, b, rtol=0, atol=1e-5) for a, b in zip(own, axes)):
            break
    else:
        node.fail("its positions are not those of the library", "nearest asymmetric floor, or linear half_pixel: upsample, upsample_to")
    factors = [s // n if s % n == 0 else 0 for s, n in zip(size, here.shape)]
    mode = ("interpolation::bilinear" if bilinear else "interpolation::nearest", "interpolation::nearest")
    text = call("upsample", (extent(*factors), ""), mode) if all(factors) else call("upsample_to", (extent(*size), ""), mode)
    layer = Layer("upsample", text, size + (here.shape[2],), lambda x, _: resampled(x, *own))
    return [layer], Map.plain(layer.output, sizes)

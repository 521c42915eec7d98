"""Convolutions: plain, grouped, dilated, transposed, along one axis."""

import numpy

from .. import arithmetic
from ..layers import Layer, Map, call, extent
from . import evaluates, imports
from .quantised import with_scales


def same_pads(size, kernel, stride):
    """Padding before and after so that ceil(size ÷ stride) outputs remain; an odd zero goes to the end."""
    whole = max(0, ((size + stride - 1) // stride - 1) * stride + kernel - size)
    return whole // 2, whole - whole // 2


def window_of(node, extents, kernel):
    """Kernel, strides, pads (top, left, bottom, right) and dilations of a window over [rows, columns]; a single axis has
    one column."""
    count = len(kernel)
    node.require(count in (1, 2), f"a window of {count} axes", "one of one or two axes")
    strides, dilations = node.get("strides", [1] * count), node.get("dilations", [1] * count)
    pads, auto = node.get("pads", [0] * 2 * count), node.get("auto_pad", "NOTSET")
    if len(strides) != count or len(dilations) != count or len(pads) != 2 * count or min([*kernel, *strides, *dilations]) < 1:
        raise ValueError("its kernel, strides, dilations and pads do not fit")
    reach = [(k - 1) * d + 1 for k, d in zip(kernel, dilations)]
    if auto == "VALID":
        pads = [0] * 2 * count
    elif auto in ("SAME_UPPER", "SAME_LOWER"):
        both = [same_pads(n, k, s) for n, k, s in zip(extents, reach, strides)]
        both = both if auto == "SAME_UPPER" else [(after, before) for before, after in both]
        pads = [before for before, _ in both] + [after for _, after in both]
    node.require(min(pads) >= 0, "its padding is negative", "Slice before it does not exist either; pads of 0 or more")
    if count == 1:
        return [kernel[0], 1], [strides[0], 1], [pads[0], 0, pads[1], 0], [dilations[0], 1]
    return list(kernel), list(strides), list(pads), list(dilations)


def outputs_of(shape, reach, strides, pads):
    return tuple((n + pads[i] + pads[i + 2] - k) // s + 1 for i, (n, k, s) in enumerate(zip(shape, reach, strides)))


def padding_text(shape, reach, strides, pads):
    """The shortest text of a padding whose windows see the same pixels."""
    before, after = zip(*[same_pads(n, k, s) for n, k, s in zip(shape, reach, strides)])
    if list(before) == pads[:2] and outputs_of(shape, reach, strides, pads) == tuple(-(-n // s) for n, s in zip(shape, strides)):
        return "padding::same"
    if not any(pads):
        return "padding::valid"
    return pad_text(pads)


def pad_text(pads):
    top, left, bottom, right = pads
    return f"pad({top})" if len(set(pads)) == 1 else f"pad({top}, {bottom}, {left}, {right})"


def image(x):
    """[channels, rows, columns] of a tensor with a batch of one."""
    if x.ndim not in (3, 4) or x.shape[0] != 1:
        raise ValueError(f"a map of the extents {list(x.shape)}")
    return x[0] if x.ndim == 4 else x[0][:, :, None]


def as_tensor(found, like):
    return found[None] if like.ndim == 4 else found[None, :, :, 0]


def four(weight):
    return weight if weight.ndim == 4 else weight[..., None]


@evaluates("Conv")
def evaluate_conv(node, x, weight, bias=None):
    _, strides, pads, dilations = window_of(node, x.shape[2:], weight.shape[2:])
    return as_tensor(arithmetic.convolution(image(x), four(weight), bias, strides, pads, dilations, node.get("group", 1)), x)


def transposed_window(node, extents, kernel):
    """Strides, pads and dilations of a transposed convolution, and the size of its output."""
    count = len(kernel)
    kernel, strides, pads, dilations = window_of(node, extents, kernel)
    extents = list(extents) + [1] * (2 - count)
    more = (node.get("output_padding", [0] * count) + [0])[:2] if count == 1 else node.get("output_padding", [0, 0])
    reach = [(k - 1) * d + 1 for k, d in zip(kernel, dilations)]
    whole = [(n - 1) * s + k + m for n, s, k, m in zip(extents, strides, reach, more)]
    size, auto = node.get("output_shape"), node.get("auto_pad", "NOTSET")
    if size is not None or auto.startswith("SAME"):
        size = ((list(size) + [1])[:2] if count == 1 else list(size)[-2:]) if size is not None else [n * s for n, s in zip(extents, strides)]
        less = [max(0, w - s) for w, s in zip(whole, size)]
        small = [n // 2 if auto != "SAME_LOWER" else n - n // 2 for n in less]
        pads = [*small, *(n - s for n, s in zip(less, small))]
    return strides, pads, dilations, size or [w - pads[i] - pads[i + 2] for i, w in enumerate(whole)]


@evaluates("ConvTranspose")
def evaluate_transposed(node, x, weight, bias=None):
    strides, pads, dilations, size = transposed_window(node, x.shape[2:], weight.shape[2:])
    return as_tensor(arithmetic.transposed_convolution(image(x), four(weight), bias, strides, pads, size, node.get("group", 1), dilations), x)


def weights_of(walk, node):
    weight, bias = walk.constant(node, 1), walk.constant(node, 2)
    node.require(numpy.isfinite(weight).all() and (bias is None or numpy.isfinite(bias).all()), "a weight is not finite", "finite numbers")
    return four(weight), bias


def with_bias(weight, bias):
    return {"weight": weight} if bias is None else {"weight": weight, "bias": bias}


def convolution(here, weight, bias, strides, pads, dilations=(1, 1), groups=1):
    """conv2d, dilated_conv2d, or causal_conv1d of a window that looks back only."""
    filters, channels, *kernel = weight.shape
    reach = [(k - 1) * d + 1 for k, d in zip(kernel, dilations)]
    output = outputs_of(here.shape, reach, strides, pads)
    rows, columns = here.shape[:2]
    dilations = [d if k > 1 else 1 for k, d in zip(kernel, dilations)]

    def run(x, a):
        return arithmetic.convolution(x, a["weight"].reshape(filters, channels, *kernel), a.get("bias"), strides, pads, dilations, groups)

    def write(layer):
        has_bias = "bias" in layer.arrays
        options = {(1, True): "", (1, False): "without_bias"}.get((groups, has_bias), f"in_groups({groups})" if has_bias else
                                                                  f"conv2d_options{{.groups = {groups}, .bias = false}}")
        around = padding_text(here.shape, reach, strides, pads)
        middle = [(extent(*dilations), "2")] if dilations != [1, 1] else []
        return call("dilated_conv2d" if middle else "conv2d", (str(filters), ""), (extent(*kernel), ""), *middle,
                    (extent(*strides), "1"), (around, "padding::same"), (options, ""))
    layer = Layer("conv", "", output + (filters,), run, with_bias(weight, bias), output[0] * output[1] * weight.size,
                  write=write, filter_axis=0)
    # One that looks back only, along frames. Its bias is not optional.
    if columns == 1 and rows > 1 and groups == 1 and kernel[1] == 1 and list(strides) == [1, 1] and pads == [reach[0] - 1, 0, 0, 0] \
            and (kernel[0] > 1 or rows > 1):
        layer.arrays = {"weight": weight[..., 0], "bias": numpy.zeros(filters) if bias is None else bias}
        layer.write = lambda _: call("causal_conv1d", (str(filters), ""), (str(kernel[0]), ""), (str(dilations[0]), "1"))
    return layer


@imports("Conv")
def import_conv(walk, node, here, _):
    node.require(here.is_image(), f"its input is no map [1, channels, rows, columns] in order, but {list(here.places.shape)}",
                 "Conv of the input, or of a map that transposes leave in the order of ONNX")
    weight, bias = weights_of(walk, node)
    _, strides, pads, dilations = window_of(node, here.places.shape[2:], weight.shape[2:] if here.places.ndim == 4 else weight.shape[2:3])
    before = walk.pads.get(node.inputs[0])
    if before:
        pads = [p + b for p, b in zip(pads, before)]
    layer = convolution(here, weight, bias, strides, pads, dilations, node.get("group", 1))
    rows, columns, filters = layer.output
    return [with_scales(walk, node, layer)], Map.plain(layer.output, (1, filters, rows, columns)[:here.places.ndim])


@imports("ConvTranspose")
def import_transposed(walk, node, here, _):
    node.require(here.is_image(), "its input is no map [1, channels, rows, columns] in order", "ConvTranspose of such a map")
    node.require(node.get("group", 1) == 1, "a transposed convolution in groups", "one group, transposed_conv2d")
    weight, bias = weights_of(walk, node)
    channels, filters, *kernel = weight.shape
    strides, pads, dilations, size = transposed_window(node, here.places.shape[2:], kernel[:here.places.ndim - 2])
    node.require(list(dilations) == [1, 1], "a dilated transposed convolution", "dilations of 1, transposed_conv2d")
    whole = [(n - 1) * s + k for n, s, k in zip(here.shape, strides, kernel)]
    pads = [pads[0], pads[1], whole[0] - size[0] - pads[0], whole[1] - size[1] - pads[1]]
    node.require(min(pads) >= 0 and max(pads[0], pads[2]) < kernel[0] and max(pads[1], pads[3]) < kernel[1],
                 "its output is larger than the taps reach, or cropped by more than the kernel",
                 "pads below the kernel, and output_padding up to the padding")
    rest = [max(0, k - s) for k, s in zip(kernel, strides)]  # what padding::same crops
    same = size == [n * s for n, s in zip(here.shape, strides)] and pads[:2] == [r // 2 for r in rest]
    around = "padding::same" if same else "padding::valid" if not any(pads) else pad_text(pads)

    def write(layer):
        return call("transposed_conv2d", (str(filters), ""), (extent(*kernel), ""), (extent(*strides), extent(*kernel)),
                    (around, "padding::same"), ("true" if "bias" in layer.arrays else "false", "true"))
    layer = Layer("conv", "", (*size, filters), lambda x, a: arithmetic.transposed_convolution(
        x, a["weight"], a.get("bias"), strides, pads, size), with_bias(weight, bias), here.area * weight.size,
        write=write, filter_axis=1)
    return [layer], Map.plain(layer.output, (1, filters, *size)[:here.places.ndim])

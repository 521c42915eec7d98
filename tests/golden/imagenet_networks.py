#!/usr/bin/env python3
"""Writes imagenet_networks.safetensors: what torchvision's networks make of numbers that both sides can draw.

Weights are not stored: each array is drawn by Philox (include/tactnet/runtime/random.hpp) from its name, and so is the
input. The networks run in double precision. Of each stage the file keeps a few elements evenly spread over its output
(rows: values; how far single precision may be off), and of each network at its full size a hash of all names and
extents.

The second row is the deviation of the error that single precision makes when roundings are independent (Higham and
Mary, "A new approach to probabilistic rounding error analysis", 2019), carried through the layers as in
tests/support/layers/deployed_reference.hpp: a sum of n products passes n + 3 roundings, a batch norm 3, a mean of n
numbers n + 1, local responses size + 3 in their base, 5 in the power and one product. What lies ten deviations below zero is
exactly zero behind a ReLU.

Made with PyTorch 1.13.0 and torchvision 0.14.1. On Debian 12: apt install python3-torchvision, then
/usr/bin/python3 imagenet_networks.py. With a name of a network as argument it prints that network's arrays instead;
with the folder of the data it writes squeezenet_imagenet.safetensors: what the real weights make of tactile images.
"""

import math
import pathlib
import sys

import numpy
import torch
import torchvision
import weight_files
from torch import nn

FOLDER = pathlib.Path(__file__).parent
SAMPLES = 16
ROUNDOFF = 2.0**-24 * (1 + 2.0**-20)


def hash_of(text):
    """FNV-1a."""
    value = 0x811C9DC5
    for letter in text.encode():
        value = (value ^ letter) * 0x01000193 & 0xFFFFFFFF
    return value


def philox(count, stream):
    """The first numbers of random_stream(2012, random_purposes::order, stream)."""
    blocks = (count + 3) // 4
    counter = [
        numpy.arange(blocks, dtype=numpy.uint64),
        numpy.full(blocks, 1, numpy.uint64),
        numpy.full(blocks, stream, numpy.uint64),
        numpy.zeros(blocks, numpy.uint64),
    ]
    key = [2012, 0]
    low, shift = numpy.uint64(0xFFFFFFFF), numpy.uint64(32)
    for _ in range(10):
        a, b = numpy.uint64(0xD2511F53) * counter[0], numpy.uint64(0xCD9E8D57) * counter[2]
        counter = [
            (b >> shift) ^ counter[1] ^ numpy.uint64(key[0]),
            b & low,
            (a >> shift) ^ counter[3] ^ numpy.uint64(key[1]),
            a & low,
        ]
        key = [(key[0] + 0x9E3779B9) & 0xFFFFFFFF, (key[1] + 0xBB67AE85) & 0xFFFFFFFF]
    return numpy.stack(counter, 1).reshape(-1)[:count]


def drawn(name, extents):
    """Whole multiples of 2^-23 in [-1, 1), in single precision."""
    bits = philox(math.prod(extents), hash_of(name))
    return ((bits >> numpy.uint64(8)).astype(numpy.float32) * numpy.float32(2.0**-23) - numpy.float32(1)).reshape(extents)


def fill(model):
    norms = {name for name, module in model.named_modules() if isinstance(module, nn.BatchNorm2d)}
    state = {}
    for name, values in model.state_dict().items():
        owner, kind = name.rsplit(".", 1)
        if kind == "num_batches_tracked":
            continue
        numbers = drawn(name, tuple(values.shape))
        if kind == "running_var" or (owner in norms and kind == "weight"):
            numbers = numpy.float32(1) + numpy.float32(0.5) * numbers
        elif kind == "weight":
            numbers = numbers * numpy.float32(math.sqrt(6 / math.prod(values.shape[1:])))
        else:
            numbers = numpy.float32(0.125) * numbers
        state[name] = torch.from_numpy(numbers)
    model.load_state_dict(state, strict=False)
    return model.double().eval()


class Rounded:
    """Numbers, and the squares of the deviations of their errors."""

    def __init__(self, value, squares):
        self.value, self.squares = value, squares


def relu(x):
    sure = x.value < -10 * x.squares.sqrt()
    return Rounded(x.value.clamp(min=0), x.squares.masked_fill(sure, 0))


def through(module, x):
    """What a layer makes of numbers with errors."""
    f = nn.functional
    if isinstance(module, (nn.Conv2d, nn.Linear)):
        w, b = module.weight, module.bias
        if isinstance(module, nn.Linear):
            apply = lambda v, w, b=None: f.linear(v, w, b)
        else:
            apply = lambda v, w, b=None: f.conv2d(v, w, b, module.stride, module.padding, 1, module.groups)
        count = math.prod(w.shape[1:]) + 3
        size = apply(x.value.abs(), w.abs(), None if b is None else b.abs())
        return Rounded(apply(x.value, w, b), apply(x.squares, w**2) + count * (ROUNDOFF * size) ** 2)
    if isinstance(module, nn.BatchNorm2d):
        factor = module.weight / (module.running_var + module.eps).sqrt()
        offset = module.bias - module.running_mean * factor
        factor, offset = factor[None, :, None, None], offset[None, :, None, None]
        size = (x.value * factor).abs() + offset.abs()
        return Rounded(x.value * factor + offset, x.squares * factor**2 + 3 * (ROUNDOFF * size) ** 2)
    if isinstance(module, nn.LocalResponseNorm):
        n = module.size
        window = lambda v: f.avg_pool3d(f.pad(v[:, None], (0, 0, 0, 0, n // 2, (n - 1) // 2)), (n, 1, 1), 1)[:, 0] * n
        base = module.k + module.alpha / n * window(x.value**2)
        power = base**-module.beta
        base_squares = (2 * module.alpha / n) ** 2 * window(x.value**2 * x.squares) + (n + 3) * (ROUNDOFF * base) ** 2
        return Rounded(
            module(x.value),
            x.squares * power**2
            + (x.value * module.beta * power / base) ** 2 * base_squares
            + 6 * (ROUNDOFF * x.value * power) ** 2,
        )
    if isinstance(module, nn.ReLU):
        return relu(x)
    if isinstance(module, nn.MaxPool2d):
        return Rounded(module(x.value), module(x.squares))
    if isinstance(module, nn.AdaptiveAvgPool2d):
        # In a bin of n numbers, the mean of the squares is n times that of the mean.
        side = (x.value.shape[2], x.value.shape[3])
        bins = [
            torch.tensor([float(-(-(i + 1) * s // o) - i * s // o) for i in range(o)], dtype=torch.float64)
            for s, o in zip(side, (module.output_size,) * 2 if isinstance(module.output_size, int) else module.output_size)
        ]
        n = bins[0][:, None] * bins[1][None, :]
        size = module(x.value.abs())
        return Rounded(module(x.value), module(x.squares) / n + (n + 1) * (ROUNDOFF * size) ** 2)
    if isinstance(module, (nn.Dropout, nn.Identity)):
        return x
    if isinstance(module, nn.Flatten):
        return Rounded(x.value.flatten(1), x.squares.flatten(1))
    if isinstance(module, torchvision.models.squeezenet.Fire):
        x = relu(through(module.squeeze, x))
        branches = [relu(through(branch, x)) for branch in (module.expand1x1, module.expand3x3)]
        return Rounded(torch.cat([b.value for b in branches], 1), torch.cat([b.squares for b in branches], 1))
    if isinstance(module, (torchvision.models.resnet.BasicBlock, torchvision.models.resnet.Bottleneck)):
        y, skip = x, x
        last = 3 if hasattr(module, "conv3") else 2
        for i in range(1, last + 1):
            y = through(getattr(module, f"bn{i}"), through(getattr(module, f"conv{i}"), y))
            if i < last:
                y = relu(y)
        if module.downsample is not None:
            skip = through(module.downsample, x)
        size = y.value.abs() + skip.value.abs()
        return relu(Rounded(y.value + skip.value, y.squares + skip.squares + (ROUNDOFF * size) ** 2))
    if isinstance(module, nn.Sequential):
        for inner in module:
            x = through(inner, x)
        return x
    raise TypeError(type(module))


def alexnet_original(hidden):
    """As in Caffe and MATLAB; torchvision has none."""
    return nn.Sequential(
        *[nn.Conv2d(3, 96, 11, 4), nn.ReLU(), nn.LocalResponseNorm(5, 1e-4, 0.75, 1.0), nn.MaxPool2d(3, 2)],
        *[nn.Conv2d(96, 256, 5, 1, 2, groups=2), nn.ReLU(), nn.LocalResponseNorm(5, 1e-4, 0.75, 1.0), nn.MaxPool2d(3, 2)],
        *[nn.Conv2d(256, 384, 3, 1, 1), nn.ReLU(), nn.Conv2d(384, 384, 3, 1, 1, groups=2), nn.ReLU()],
        *[nn.Conv2d(384, 256, 3, 1, 1, groups=2), nn.ReLU(), nn.MaxPool2d(3, 2), nn.Flatten()],
        *[nn.Linear(256, hidden), nn.ReLU(), nn.Dropout(), nn.Linear(hidden, hidden), nn.ReLU(), nn.Dropout()],
        nn.Linear(hidden, 10),
    )


class Named(nn.Module):
    """Layers by the names of another list."""

    def __init__(self, layers, names):
        super().__init__()
        self.order = []
        for layer in layers:
            name = names.pop(0) if list(layer.parameters()) else f"step{len(self.order)}"
            self.add_module(name, layer)
            self.order.append(name)


def narrowed(model, hidden):
    """The same with narrow dense layers, so that a test draws them quickly."""
    before = None
    for i, layer in enumerate(model.classifier):
        if isinstance(layer, nn.Linear):
            last = not any(isinstance(l, nn.Linear) for l in model.classifier[i + 1 :])
            model.classifier[i] = nn.Linear(layer.in_features if before is None else hidden, 10 if last else hidden)
            before = layer
    return model


def stages_of(name, model):
    """(name, module) in the order of computation."""
    if isinstance(model, Named):
        yield from ((n, getattr(model, n)) for n in model.order)
    elif name.startswith("resnet"):
        yield from ((n, getattr(model, n)) for n in ("conv1", "bn1", "relu", "maxpool"))
        for stage in ("layer1", "layer2", "layer3", "layer4"):
            yield from ((f"{stage}.{i}", block) for i, block in enumerate(getattr(model, stage)))
        yield "avgpool", model.avgpool
        yield "flatten", nn.Flatten()
        yield "fc", model.fc
    else:
        yield from ((f"features.{i}", layer) for i, layer in enumerate(model.features))
        if hasattr(model, "avgpool"):
            yield "avgpool", model.avgpool
            yield "flatten", nn.Flatten()
        yield from ((f"classifier.{i}", layer) for i, layer in enumerate(model.classifier))


def summary_of(x):
    size = x.value.numel()
    places = [(2 * k + 1) * size // (2 * SAMPLES) for k in range(SAMPLES)]
    return torch.stack([x.value.flatten()[places], x.squares.flatten()[places].sqrt()]).numpy()


def real_weights(folder):
    """SqueezeNet 1.1 with the weights of ImageNet on a few of the tactile images beside them, each tactel repeated to
    227 x 227: then both sides see the same numbers."""
    weights = weight_files.read(folder / "squeezenet1_1_imagenet_features.safetensors")
    images = weight_files.read(folder / "published_tactnet4_14x25_golden.safetensors")["inputs"].reshape(110, 14, 25)
    mean = torch.from_numpy(weights.pop("input_mean").copy())
    model = torchvision.models.squeezenet1_1(weights=None).features
    model.load_state_dict({k.removeprefix("features."): torch.from_numpy(v.copy()) for k, v in weights.items()})
    model.double().eval()
    place = numpy.arange(227)
    tensors = {}
    with torch.no_grad():
        for number in (0, 37, 109):
            image = images[number][place * 14 // 227][:, place * 25 // 227].astype(numpy.float32)
            counts = torch.from_numpy(image)[None, None] - mean[None, :, None, None]
            x = Rounded(counts.double(), torch.zeros_like(counts.double()))
            for layer in model:
                x = through(layer, x)
            # Most features are zero: elements spread over the others, from the largest down, and where they are.
            order = torch.argsort(x.value.flatten(), descending=True)[: int((x.value > 0).sum())]
            places = order[torch.arange(4 * SAMPLES) * len(order) // (4 * SAMPLES)]
            tensors[f"{number}/features.12"] = torch.stack(
                [x.value.flatten()[places], x.squares.flatten()[places].sqrt()]
            ).numpy()
            tensors[f"{number}/features.12.at"] = places.double().numpy()
            error = (model(counts.double()) - x.value).abs().max() / x.value.abs().max()
            assert error < 1e-12, error
            print(number, float(x.value.abs().max()))
    weight_files.write(FOLDER / "squeezenet_imagenet.safetensors", tensors)


models = torchvision.models
full = {name: getattr(models, name)(weights=None) for name in
        ("squeezenet1_0", "squeezenet1_1", "alexnet", "resnet18", "resnet34", "resnet50", "vgg16")}
lists = {
    name: sorted(
        f"{n}:{'x'.join(map(str, v.shape))}\n"
        for n, v in model.state_dict().items()
        if not n.endswith("num_batches_tracked")
    )
    for name, model in full.items()
}
if len(sys.argv) > 1 and sys.argv[1] in lists:
    print("".join(lists[sys.argv[1]]), end="")
    sys.exit()
if len(sys.argv) > 1:
    real_weights(pathlib.Path(sys.argv[1]))
    sys.exit()

tensors = {}
for name, lines in lists.items():
    tensors[name + "/names"] = numpy.array([float(hash_of("".join(lines)))])

cases = {
    "squeezenet1_0": (models.squeezenet1_0(weights=None, num_classes=10), 67),
    "squeezenet1_1": (models.squeezenet1_1(weights=None, num_classes=10), 67),
    "alexnet": (narrowed(full["alexnet"], 48), 67),
    "alexnet_original": (
        Named(alexnet_original(48), ["conv1", "conv2", "conv3", "conv4", "conv5", "fc6", "fc7", "fc8"]), 67),
    "resnet18": (models.resnet18(weights=None, num_classes=10), 64),
    "resnet50": (models.resnet50(weights=None, num_classes=10), 64),
    "vgg16": (narrowed(full["vgg16"], 48), 32),
}
with torch.no_grad():
    for name, (model, side) in cases.items():
        fill(model)
        exact = torch.from_numpy(drawn("input", (1, 3, side, side))).double()
        x = Rounded(exact, torch.zeros_like(exact))
        for stage, module in stages_of(name, model):
            x = through(module, x)
            tensors[f"{name}/{stage}"] = summary_of(x)
        if not isinstance(model, Named):
            # What is above must be what torchvision computes.
            error = (model(exact).flatten() - x.value.flatten()).abs().max() / x.value.abs().max()
            assert error < 1e-12, (name, error)
        print(name, float(x.value.abs().max()), float((x.squares.sqrt() / x.value.abs()).median()))

weight_files.write(FOLDER / "imagenet_networks.safetensors", tensors)

"""Whole networks: by PyTorch's exporter at all its operator sets, and as Keras (tf2onnx) and MATLAB write theirs. MODELS: name to
(bytes, options); those of PyTorch are left out without it."""

import io
import warnings

from builder import Builder

MODELS = {}


def keras_tactnet():
    """tf2onnx: channels last outside, biases apart, batch norms as products and sums."""
    b = Builder(1, 13, 21, 1, opset=15)
    x = b("Transpose", b("Mul", "x", b.constant(1 / 255)), perm=[0, 3, 1, 2])
    for channels, filters in ((1, 6), (6, 8), (8, 12)):
        x = b("Add", b.conv(x, channels, filters, 3, 3, bias=False, auto_pad="SAME_UPPER"), b.draw(1, filters, 1, 1))
        x = b("Relu", b("Add", b("Mul", x, b.draw(1, filters, 1, 1, low=0.5, high=1.5)), b.draw(1, filters, 1, 1)))
        x = b("MaxPool", x, kernel_shape=[2, 2], strides=[2, 2], auto_pad="SAME_UPPER")
    x = b("Reshape", b("Transpose", x, perm=[0, 2, 3, 1]), [-1, 72])
    x = b("Add", b("MatMul", x, b.draw(72, 22)), b.draw(22))
    return b.model(b("Softmax", x, axis=-1))


def keras_mobile():
    """tf2onnx: depthwise convolutions, swish, a gate whose means keep channels last."""
    b = Builder(1, 15, 11, 1, opset=12)
    x = b("Transpose", b("Sub", b("Mul", "x", b.constant(2 / 255)), b.constant(1.0)), perm=[0, 3, 1, 2])
    x = b.norm(b.conv(x, 1, 8, 3, 3, bias=False, auto_pad="SAME_UPPER", strides=[2, 2]), 8, epsilon=1e-3)
    x = b("Mul", x, b("Sigmoid", x))
    x = b.norm(b.conv(x, 8, 8, 3, 3, groups=8, bias=False, auto_pad="SAME_UPPER"), 8, epsilon=1e-3)
    x = b("Mul", b("Sigmoid", x), x)
    last = b("Transpose", x, perm=[0, 2, 3, 1])
    factors = b("ReduceMean", last, axes=[1, 2], keepdims=1)
    factors = b("Transpose", factors, perm=[0, 3, 1, 2])
    factors = b.conv(factors, 8, 4, 1, 1)
    factors = b("Sigmoid", b.conv(b("Mul", factors, b("Sigmoid", factors)), 4, 8, 1, 1))
    x = b.norm(b.conv(b("Mul", factors, x), 8, 8, 1, 1, bias=False), 8, epsilon=1e-3)
    x = b("Clip", b("Add", x, b("Clip", b.conv(x, 8, 8, 1, 1), b.constant(0.0), b.constant(6.0))), b.constant(0.0))
    x = b("Squeeze", b("GlobalAveragePool", x), axes=[2, 3])
    return b.model(b("Add", b("MatMul", x, b.draw(8, 7)), b.draw(7)))


def matlab_tactnet():
    """exportONNXNetwork: minus the mean image, explicit pads, batch norms kept, the dense layer as a convolution or Gemm, softmax."""
    b = Builder(1, 1, 14, 25, opset=9)
    x = b("Sub", "x", b.draw(1, 1, 14, 25, low=0, high=50))
    for channels, filters, kernel, pads in ((1, 8, 3, [1, 1, 1, 1]), (8, 16, 2, [0, 0, 1, 1]), (16, 32, 2, [0, 0, 1, 1])):
        x = b.conv(x, channels, filters, kernel, kernel, pads=pads, strides=[1, 1])
        x = b("Relu", b.norm(x, filters, variance=4000 if channels == 1 else 1, epsilon=1e-5))
        x = b("MaxPool", x, kernel_shape=[2, 2], strides=[2, 2], pads=[0, 0, *{1: [0, 1], 8: [1, 1], 16: [0, 1]}[channels]])
    x = b.conv(x, 32, 22, 2, 4)
    return b.model(b("Softmax", b("Flatten", x), axis=1))


def matlab_dense_first():
    """A fullyConnectedLayer of a feature input, rescaled to 0 … 1."""
    b = Builder(1, 35, opset=8)
    x = b("Mul", b("Sub", "x", b.constant(0.0)), b.constant(1 / 255))
    x = b("Relu", b("Add", b("MatMul", x, b.draw(35, 9)), b.draw(9)))
    return b.model(b("Softmax", b.gemm(x, 9, 4), axis=1))


for function, options in ((keras_tactnet, {}), (keras_mobile, {}), (matlab_tactnet, {}), (matlab_dense_first, {})):
    MODELS[function.__name__] = function(), options

try:
    import torch
    from torch import nn
except ImportError:
    torch = None


def exported(net, *shape, opset=13, dynamic=False, seed=3):
    """What PyTorch's exporter writes; parameters and statistics are drawn, so that none hides a mistake."""
    torch.manual_seed(seed)
    with torch.no_grad():
        for name, value in net.state_dict().items():
            if name.endswith(("running_mean", "bias")):
                value.uniform_(-0.3, 0.3)
            elif name.endswith("running_var"):
                value.uniform_(0.5, 2)
            elif value.ndim == 1 and value.dtype.is_floating_point:
                value.uniform_(0.5, 1.5)
    data = io.BytesIO()
    axes = {"x": {0: "batch"}, "y": {0: "batch"}} if dynamic else None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        torch.onnx.export(net.eval(), torch.rand(shape), data, opset_version=opset, input_names=["x"], output_names=["y"], dynamic_axes=axes)
    return data.getvalue()


def torch_models():
    def block(i, o, k, pool=2, stride=2):
        return [nn.Conv2d(i, o, k, padding=k // 2), nn.BatchNorm2d(o), nn.ReLU(), nn.MaxPool2d(pool, stride, ceil_mode=True)]

    def norm(i, o, k, act, **more):
        return nn.Sequential(nn.Conv2d(i, o, k, padding=k // 2, bias=False, **more), nn.BatchNorm2d(o), *([act()] if act else []))

    class Residual(nn.Module):
        def __init__(self, main, skip=None, after=None):
            super().__init__()
            self.main, self.skip, self.after = main, skip or nn.Identity(), after or nn.Identity()

        def forward(self, x):
            return self.after(self.main(x) + self.skip(x))

    class Joined(nn.Module):
        def __init__(self, *branches):
            super().__init__()
            self.branches = nn.ModuleList(branches)

        def forward(self, x):
            return torch.cat([branch(x) for branch in self.branches], 1)

    class Gate(nn.Module):
        def __init__(self, channels, squeezed, linear=False):
            super().__init__()
            self.a = nn.Linear(channels, squeezed) if linear else nn.Conv2d(channels, squeezed, 1)
            self.b = nn.Linear(squeezed, channels) if linear else nn.Conv2d(squeezed, channels, 1)
            self.linear = linear

        def forward(self, x):
            means = x.mean((2, 3)) if self.linear else nn.functional.adaptive_avg_pool2d(x, 1)
            factors = nn.functional.hardsigmoid(self.b(self.a(means).relu()))
            return x * (factors[:, :, None, None] if self.linear else factors)

    class ConvNext(nn.Module):
        def __init__(self, channels):
            super().__init__()
            self.dw, self.norm = nn.Conv2d(channels, channels, 5, padding=2, groups=channels), nn.LayerNorm(channels, eps=1e-6)
            self.a, self.b = nn.Linear(channels, 2 * channels), nn.Linear(2 * channels, channels)
            self.gamma = nn.Parameter(torch.ones(channels))

        def forward(self, x):
            y = self.norm(self.dw(x).permute(0, 2, 3, 1))
            return x + (self.gamma * self.b(nn.functional.gelu(self.a(y)))).permute(0, 3, 1, 2)

    class Recurrent(nn.Module):
        def __init__(self, kind, features, hidden, layers):
            super().__init__()
            self.cells, self.fc = kind(features, hidden, layers, batch_first=True), nn.Linear(hidden, 5)

        def forward(self, x):
            return self.fc(self.cells(x / 100)[0][:, -1])

    class Temporal(nn.Module):
        def __init__(self):
            super().__init__()
            self.a, self.b, self.fc = nn.Conv1d(4, 8, 3), nn.Conv1d(8, 8, 3, dilation=2), nn.Linear(8, 3)

        def forward(self, x):
            pad = nn.functional.pad
            return self.fc(self.b(pad(self.a(pad(x, (2, 0))).relu(), (4, 0))).relu()[:, :, -1])

    class UNet(nn.Module):
        def __init__(self):
            super().__init__()
            self.down, self.inner = nn.Conv2d(1, 4, 3, padding=1), nn.Conv2d(4, 8, 3, padding=1)
            self.up, self.out, self.fc = nn.ConvTranspose2d(8, 4, 2, 2), nn.Conv2d(8, 2, 3, padding=1), nn.Linear(2 * 12 * 10, 6)

        def forward(self, x):
            a = self.down(x / 255).relu()
            b = self.inner(nn.functional.max_pool2d(a, 2)).relu()
            c = torch.cat([a, self.up(b).relu()], 1)
            c = self.out(nn.functional.interpolate(c, scale_factor=2, mode="bilinear", align_corners=False))
            return self.fc(nn.functional.adaptive_avg_pool2d(c, (12, 10)).flatten(1))

    class Scaled(nn.Module):
        """(counts − mean) ÷ deviation, inside the network."""

        def __init__(self, *layers, mean=20.0, deviation=64.0):
            super().__init__()
            self.layers, self.mean, self.deviation = nn.Sequential(*layers), mean, deviation

        def forward(self, x):
            return self.layers((x - self.mean) / self.deviation)

    swish, pool = nn.Hardswish, nn.AdaptiveAvgPool2d(1)
    return {
        "tactnet4": (Scaled(*block(1, 8, 3), *block(8, 16, 3), *block(16, 32, 3), nn.Flatten(), nn.Linear(32 * 2 * 4, 22)), (1, 1, 15, 27), 11),
        "tactnet6": (Scaled(*block(1, 8, 5), *block(8, 16, 3), *block(16, 32, 3), *block(32, 48, 3), nn.Flatten(), nn.Dropout(),
                            nn.Linear(48 * 2 * 3, 22)), (1, 1, 21, 35), 17),
        "tactresnet": (Scaled(norm(1, 8, 5, nn.ReLU), nn.MaxPool2d(2), Residual(nn.Sequential(norm(8, 8, 3, nn.ReLU), norm(8, 8, 3, None)), after=nn.ReLU()),
                              Residual(nn.Sequential(norm(8, 12, 3, nn.ReLU, stride=2), norm(12, 12, 3, None)), norm(8, 12, 1, None, stride=2), nn.ReLU()),
                              pool, nn.Flatten(), nn.Linear(12, 22)), (1, 1, 19, 27), 14),
        "mobile": (Scaled(norm(1, 8, 3, swish, stride=2), norm(8, 8, 3, swish, groups=8), Gate(8, 4), norm(8, 16, 1, None), norm(16, 16, 3, nn.ReLU6, groups=16),
                          Gate(16, 4, linear=True), pool, nn.Flatten(), nn.Linear(16, 9)), (1, 1, 17, 23), 14),
        "squeeze": (Scaled(nn.Conv2d(1, 8, 3, 2), nn.ReLU(), nn.Conv2d(8, 4, 1), nn.ReLU(), Joined(nn.Sequential(nn.Conv2d(4, 6, 1), nn.ReLU()), nn.Sequential(
            nn.Conv2d(4, 6, 3, padding=1), nn.ReLU())), nn.MaxPool2d(3, 2, ceil_mode=True), nn.Conv2d(12, 7, 1), nn.ReLU(), pool, nn.Flatten()), (1, 1, 17, 22), 12),
        "convnext": (Scaled(nn.Conv2d(1, 8, 2, 2), ConvNext(8), ConvNext(8), pool, nn.Flatten(), nn.Linear(8, 6)), (1, 1, 18, 14), 13),
        "convnext_17": (Scaled(nn.Conv2d(1, 8, 2, 2), ConvNext(8), pool, nn.Flatten(), nn.Linear(8, 6)), (1, 1, 18, 14), 17),
        "group_norms": (Scaled(nn.Conv2d(1, 8, 3), nn.GroupNorm(2, 8), nn.SiLU(), nn.Conv2d(8, 8, 3), nn.InstanceNorm2d(8, affine=True), nn.ELU(0.7),
                               nn.Conv2d(8, 6, 3), nn.GroupNorm(1, 6), nn.PReLU(6), nn.Flatten(), nn.Linear(6 * 5 * 7, 4)), (1, 1, 11, 13), 16),
        "dense_blocks": (Scaled(nn.Conv2d(1, 6, 3), Joined(nn.Identity(), norm(6, 4, 3, nn.ReLU)), Joined(nn.Identity(), norm(10, 4, 3, nn.LeakyReLU)),
                                nn.AvgPool2d(3, 2, 1), nn.Flatten(), nn.Linear(14 * 5 * 6, 5)), (1, 1, 11, 13), 15),
        "unet": (UNet(), (1, 1, 12, 10), 11),
        "gru_of_two": (Recurrent(nn.GRU, 3, 6, 2), (1, 13, 3), 14),
        "lstm": (Recurrent(nn.LSTM, 3, 6, 1), (1, 13, 3), 11),
        "temporal": (Scaled(Temporal()), (1, 4, 15), 13),
        "vgg": (Scaled(nn.Conv2d(1, 6, 3, padding=1), nn.ReLU(), nn.Conv2d(6, 6, 3, padding=1), nn.ReLU(), nn.MaxPool2d(2, 2), nn.Conv2d(6, 8, 3, padding=1, dilation=1),
                       nn.Softplus(), nn.AdaptiveMaxPool2d((3, 2)), nn.Flatten(), nn.Linear(48, 12), nn.ReLU(), nn.Dropout(), nn.Linear(12, 5), nn.Softmax(1)),
                (1, 1, 12, 16), 12),
    }


if torch is not None:
    torch.manual_seed(1)
    for number, (name, (net, shape, opset)) in enumerate(torch_models().items()):
        dynamic = name in ("tactnet4", "tactnet6", "mobile", "squeeze", "tactresnet", "temporal")
        MODELS[f"torch_{name}"] = exported(net, *shape, opset=opset, dynamic=dynamic, seed=number), {}

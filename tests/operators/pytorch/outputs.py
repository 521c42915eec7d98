#!/usr/bin/env python3
"""Writes what PyTorch's layers compute, for compare.cpp: python3 outputs.py FOLDER

FOLDER/NAME.safetensors holds a layer's arrays under PyTorch's names, inputs, outputs, a gradient of the outputs, and the
gradients of inputs and arrays that follow from it. The names and sizes of the table stand in compare.cpp too.
"""

import pathlib
import sys

import torch
from torch import nn

sys.path.append(str(pathlib.Path(__file__).parents[2] / "golden"))
import weight_files

# name: (layer, its name in the network, size of the input: channels, rows, columns)
LAYERS = {
    "adaptive_average_pool": (nn.AdaptiveAvgPool2d((3, 4)), "pool1", (2, 7, 11)),
    "adaptive_max_pool": (nn.AdaptiveMaxPool2d((3, 4)), "pool1", (2, 7, 11)),
    "adaptive_max_pool_larger": (nn.AdaptiveMaxPool2d((9, 2)), "pool1", (3, 5, 7)),
    "conv2d": (nn.Conv2d(6, 9, (3, 2), (2, 1), 1, groups=3), "conv1", (6, 7, 5)),
    "dilated_conv2d": (nn.Conv2d(3, 5, 3, padding="same", dilation=2), "conv1", (3, 7, 11)),
    "dilated_conv2d_valid": (nn.Conv2d(4, 3, (3, 2), dilation=(2, 3)), "conv1", (4, 7, 5)),
    "dilated_conv2d_strides": (nn.Conv2d(2, 7, 3, 2, 2, dilation=2), "conv1", (2, 9, 5)),
    "dilated_conv2d_depthwise": (nn.Conv2d(5, 5, 3, padding="same", dilation=3, groups=5), "conv1", (5, 9, 7)),
    "elu": (nn.ELU(), "elu1", (5, 7, 3)),
    "elu_small": (nn.ELU(0.3), "elu1", (3, 5, 7)),
    "parametric_relu": (nn.PReLU(5), "prelu1", (5, 7, 3)),
    "transposed_conv2d": (nn.ConvTranspose2d(3, 5, (3, 4), (2, 3)), "conv1", (3, 5, 7)),
    "transposed_conv2d_cropped": (nn.ConvTranspose2d(4, 7, 3, 2, 1, output_padding=1), "conv1", (4, 5, 3)),
    "transposed_conv2d_gaps": (nn.ConvTranspose2d(2, 3, 2, 3, bias=False), "conv1", (2, 3, 5)),
    "transposed_conv2d_pixel": (nn.ConvTranspose2d(3, 5, 1), "conv1", (3, 1, 1)),
    "upsample_nearest": (nn.Upsample(scale_factor=3, mode="nearest"), "upsample1", (2, 5, 7)),
    "upsample_nearest_to": (nn.Upsample((13, 5), mode="nearest"), "upsample1", (3, 5, 7)),
    "upsample_bilinear": (nn.Upsample(scale_factor=(2, 3), mode="bilinear"), "upsample1", (2, 5, 7)),
    "upsample_bilinear_to": (nn.Upsample((11, 17), mode="bilinear"), "upsample1", (3, 7, 13)),
    "upsample_bilinear_smaller": (nn.Upsample((3, 5), mode="bilinear"), "upsample1", (2, 7, 13)),
}
SAMPLES = 3


folder = pathlib.Path(sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)
torch.manual_seed(1)
for name, (layer, own_name, size) in LAYERS.items():
    for parameter in layer.parameters():
        nn.init.uniform_(parameter, -1, 1)
    x = (4 * torch.rand(SAMPLES, *size) - 2).requires_grad_()
    y = layer(x)
    gradient = 2 * torch.rand(y.shape) - 1
    y.backward(gradient)
    arrays = {f"{own_name}.{p}": value for p, value in layer.state_dict().items()}
    arrays |= {
        "selftest.input": x,
        "selftest.output": y,
        "selftest.output_gradient": gradient,
        "selftest.input_gradient": x.grad,
    }
    arrays |= {f"selftest.gradient.{own_name}.{p}": value.grad for p, value in layer.named_parameters()}
    arrays = {key: value.detach().numpy() for key, value in arrays.items()}
    weight_files.write(folder / f"{name}.safetensors", arrays)
print(f"{len(LAYERS)} layers of PyTorch {torch.__version__}")

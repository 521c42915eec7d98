#!/usr/bin/env python3
"""Inference of the three networks at their published sizes in PyTorch, on one core: images per second in batches of 64
(or of the size given), the fastest and the median of several rounds of the better memory layout. Batch norms are folded
and the graph is frozen and optimised first. benchmark_inference times the same. Needs PyTorch (Debian: python3-torch)."""

import statistics
import sys
import time

import torch
from torch import nn

BATCH = int(sys.argv[1]) if len(sys.argv) > 1 else 64
ROUNDS = 9


class same(nn.Module):
    """Pads as 'same' does: what is left over goes to the bottom and the right."""

    def __init__(self, kernel, stride=1, value=0.0):
        super().__init__()
        self.kernel, self.stride, self.value = kernel, stride, value

    def forward(self, x):
        add = [max((-(-size // self.stride) - 1) * self.stride + self.kernel - size, 0) for size in x.shape[2:]]
        return nn.functional.pad(
            x, (add[1] // 2, add[1] - add[1] // 2, add[0] // 2, add[0] - add[0] // 2), value=self.value)


def convolution(inputs, filters, kernel):
    if kernel % 2 == 1:
        return [nn.Conv2d(inputs, filters, kernel, padding=kernel // 2)]
    return [same(kernel), nn.Conv2d(inputs, filters, kernel)]


def pool(stride):
    return [nn.MaxPool2d(2, 2, ceil_mode=True)] if stride == 2 else [same(2, 1, -1e30), nn.MaxPool2d(2, 1)]


def block(inputs, filters, kernel, stride):
    return [*convolution(inputs, filters, kernel), nn.BatchNorm2d(filters), nn.ReLU(), *pool(stride)]


def with_classes(layers, rows, columns):
    with torch.no_grad():
        size = nn.Sequential(*layers).eval()(torch.zeros(1, 1, rows, columns)).numel()
    return nn.Sequential(*layers, nn.Flatten(), nn.Linear(size, 22))


class residual(nn.Module):
    def __init__(self, inputs, filters):
        super().__init__()
        self.main = nn.Sequential(nn.Conv2d(inputs, filters, 3, padding=1), nn.BatchNorm2d(filters), nn.ReLU(),
                                  nn.Conv2d(filters, filters, 3, padding=1), nn.BatchNorm2d(filters))
        self.skip = nn.Identity() if inputs == filters else nn.Sequential(
            nn.Conv2d(inputs, filters, 3, padding=1), nn.BatchNorm2d(filters))

    def forward(self, x):
        return torch.relu(self.main(x) + self.skip(x))


def tactnet4(rows, columns):
    k1, k2, k3 = (3, 2, 2) if (rows, columns) == (14, 25) else (5, 3, 3)
    return with_classes([*block(1, 8, k1, 2), *block(8, 16, k2, 2), *block(16, 32, k3, 2)], rows, columns)


def tactnet6(rows, columns):
    k5 = 3 if rows == 28 else 2
    first, others = {28: (2, 2), 20: (1, 2), 14: (1, 2)}.get(rows, (1, 1))
    return with_classes([*block(1, 8, 5, first), *block(8, 16, 3, others), *block(16, 32, 3, others),
                         *block(32, 64, 3, others), *block(64, 128, k5, others)], rows, columns)


def tactresnet(rows, columns):
    return with_classes([nn.Conv2d(1, 64, 5, 2, 2), nn.BatchNorm2d(64), nn.ReLU(), nn.MaxPool2d(3, 2), residual(64, 64),
                         residual(64, 64), residual(64, 128), residual(128, 128), nn.MaxPool2d(5, 1)], rows, columns)


def images_per_second(network, images):
    with torch.no_grad():
        deployed = torch.jit.optimize_for_inference(torch.jit.freeze(torch.jit.trace(network, images)))
        expected, times = network(images), []
        for _ in range(ROUNDS + 3):
            start = time.perf_counter()
            found = deployed(images)
            times.append(time.perf_counter() - start)
        assert torch.allclose(found, expected, atol=1e-3, rtol=1e-3)
    times = times[3:]
    return BATCH / min(times), BATCH / statistics.median(times)


torch.set_num_threads(1)
torch.set_flush_denormal(True)
torch.manual_seed(1)
print(f"PyTorch {torch.__version__}, one thread, batch {BATCH}; images per second")
print(f"{'network':10s} {'size':6s} {'fastest':>9s} {'median':>9s}")
SIZES = [(28, 50), (20, 35), (14, 25), (10, 18), (7, 13)]
for make, sizes in [(tactnet4, SIZES), (tactnet6, SIZES), (tactresnet, SIZES[:1])]:
    for rows, columns in sizes:
        best = (0, 0)
        for layout in [torch.contiguous_format, torch.channels_last]:
            network = make(rows, columns).eval().to(memory_format=layout)
            images = (torch.rand(BATCH, 1, rows, columns) * 120 - 20).contiguous(memory_format=layout)
            best = max(best, images_per_second(network, images))
        print(f"{make.__name__:10s} {rows}x{columns:<3d} {best[0]:9.0f} {best[1]:9.0f}", flush=True)

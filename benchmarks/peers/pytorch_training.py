#!/usr/bin/env python3
"""Training speed in PyTorch, on one core: images per second of whole steps (forward, backward, stochastic gradient
descent with momentum), the fastest and the median of several rounds, for both memory layouts.

    pytorch_training.py [BATCH [NETWORK]]

NETWORK is TactNet-6 at 28 x 50, whose step benchmark_training_speed times too, or one of torchvision's, such as
squeezenet1_1 for benchmark_fine_tuning_speed: then for images of 227 x 227, resizing apart. Needs PyTorch (Debian:
python3-torch, python3-torchvision)."""

import statistics
import sys
import time

import torch
from torch import nn

BATCH = int(sys.argv[1]) if len(sys.argv) > 1 else 704
NETWORK = sys.argv[2] if len(sys.argv) > 2 else "tactnet6"
ROUNDS = 15 if NETWORK == "tactnet6" else 5


def block(inputs, outputs, kernel):
    return [
        nn.Conv2d(inputs, outputs, kernel, padding=kernel // 2),
        nn.BatchNorm2d(outputs),
        nn.ReLU(inplace=True),
        nn.MaxPool2d(2, ceil_mode=True),
    ]


def network():
    return nn.Sequential(
        *block(1, 8, 5), *block(8, 16, 3), *block(16, 32, 3), *block(32, 64, 3), *block(64, 128, 3),
        nn.Flatten(), nn.Linear(256, 22))


torch.set_num_threads(1)
torch.set_flush_denormal(True)
torch.manual_seed(1)
print(f"PyTorch {torch.__version__}, one thread, {NETWORK}, batch {BATCH}")
for name, layout in [("contiguous", torch.contiguous_format), ("channels last", torch.channels_last)]:
    if NETWORK == "tactnet6":
        model, shape = network(), (1, 28, 50)
    else:
        import torchvision

        model, shape = getattr(torchvision.models, NETWORK)(num_classes=22), (3, 227, 227)
    model = model.to(memory_format=layout)
    optimiser = torch.optim.SGD(model.parameters(), lr=1e-3, momentum=0.8, weight_decay=1e-4)
    images = (torch.rand(BATCH, *shape) * 120 - 20).contiguous(memory_format=layout)
    labels = torch.arange(BATCH) % 22
    loss_of = nn.CrossEntropyLoss(label_smoothing=0.1)
    times = []
    for _ in range(ROUNDS + 2):
        start = time.perf_counter()
        optimiser.zero_grad(set_to_none=True)
        loss = loss_of(model(images), labels)
        loss.backward()
        optimiser.step()
        times.append(time.perf_counter() - start)
    assert torch.isfinite(loss)
    times = times[2:]
    print(f"{name:14s} fastest {BATCH / min(times):8.0f} images/s, median {BATCH / statistics.median(times):8.0f}")

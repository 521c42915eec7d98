#!/usr/bin/env python3
"""Times scikit-learn's dense SVC on raw pixels: what benchmark_svm measures of LIBSVM, by hand.

scikit_learn_svm.py FOLDER, with one subfolder a class. Needs python3-sklearn and python3-pil. Run it pinned to the
core that benchmark_svm ran on, with OPENBLAS_NUM_THREADS=1.
"""

import pathlib
import sys
import time

import numpy
from PIL import Image
from sklearn.model_selection import StratifiedShuffleSplit
from sklearn.svm import SVC


def fastest(rounds, body):
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        body()
        times.append(time.perf_counter() - start)
    return min(times)


def load(folder):
    rows, labels = [], []
    for label, subfolder in enumerate(sorted(p for p in pathlib.Path(folder).iterdir() if p.is_dir())):
        for path in sorted(subfolder.iterdir()):
            rows.append(numpy.asarray(Image.open(path).convert("L"), dtype=float).ravel() / 255)
            labels.append(label)
    return numpy.array(rows), numpy.array(labels)


def main():
    rows, labels = load(sys.argv[1])
    accuracies = []
    for training, test in StratifiedShuffleSplit(10, train_size=704, random_state=0).split(rows, labels):
        machine = SVC(C=10).fit(rows[training], labels[training])
        accuracies.append(100 * machine.score(rows[test], labels[test]))
    print(f"accuracy over 10 splits: {numpy.mean(accuracies):.2f} ± {numpy.std(accuracies, ddof=1):.2f} %")
    train = fastest(5, lambda: SVC(C=10).fit(rows[training], labels[training]))
    one = fastest(200, lambda: machine.predict(rows[test][:1]))
    batch = fastest(5, lambda: machine.predict(rows[test])) / len(test)
    print(f"train {1e3 * train:.1f} ms, predict one row {1e6 * one:.0f} us, a row of a batch {1e6 * batch:.0f} us")


main()

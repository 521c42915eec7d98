"""Puts measured figures into the documentation; none is typed. Results of `tactnet study` become docs/verify/study and the tables between
the comments `<!-- study NAME -->` and `<!-- study NAME ends -->` of pages; times of benchmark_inference and benchmark_cold those between `<!-- speed NAME -->`
comments. Tables that are not in study.md are rows and columns of its table of all methods. README.md quotes some figures: they are compared.

    python3 docs/verify/study/tables.py                       writes the tables into the pages again
    python3 docs/verify/study/tables.py --check [ROOT]        fails if they differ
    python3 docs/verify/study/tables.py RESULTS ARCHIVE       takes over a folder of results; all rows, trainings and timings go into the
                                     archive, such as benchmarks/results/zen5/2026-11-24/study.tar.xz
"""

import csv
import pathlib
import re
import shutil
import subprocess
import sys
import tarfile

CHECK = sys.argv[1:2] == ["--check"]
ROOT = pathlib.Path(sys.argv[2]) if CHECK and len(sys.argv) > 2 else pathlib.Path(__file__).resolve().parents[3]
KEPT = ROOT / "docs/verify/study"


def take_over(results, archive):
    results = pathlib.Path(results)
    shutil.copy(results / "study.csv", KEPT)
    page = (results / "study.md").read_text()
    (KEPT / "study.md").write_text(re.sub(r"\n!\[.*\n\n.*\n", "", page))  # docs/pictures has pictures in the pages' style
    with tarfile.open(archive, "w:xz", format=tarfile.GNU_FORMAT) as file:
        for name in ("evaluation.jsonl", "timings.jsonl", "study.jsonl"):
            file.add(results / name, name)
    subprocess.run([ROOT / "scripts/pictures", "accuracy_and_time"], check=True)


def between(page, mark):
    """The text between two comments of a page."""
    found = re.search(rf"<!-- {mark} -->\n(.*?)<!-- {mark} ends -->", (ROOT / page).read_text(), re.S)
    if not found:
        sys.exit(f"tables.py: {page}: expected '<!-- {mark} -->' and after it '<!-- {mark} ends -->', found only one of them, or none.")
    return found[1]


def put(page, mark, table):
    old = between(page, mark)
    if old == table:
        return
    if CHECK:
        sys.exit(f"tables.py: {page}: the table '{mark}' differs from the results; run docs/verify/study/tables.py.")
    text = (ROOT / page).read_text()
    (ROOT / page).write_text(text.replace(f"<!-- {mark} -->\n{old}", f"<!-- {mark} -->\n{table}"))
    print(f"{page}: table '{mark}'")


def table_of(head, rows):
    if not rows:
        sys.exit(f"tables.py: expected rows of '{head}', found none.")
    return "\n".join([head, re.sub(r"[^|]+", " --- ", head), *rows]) + "\n"


def study(name):
    """A table by its name. Columns of the table of all methods, from 1: method, tactels, recipe, random splits, the same with reflections
    averaged, blocked splits, paper, µs, p99, ms of the paper, parameters, multiply-adds, training."""
    methods = [line.split("|") for line in re.findall("^[|] (?!method )[a-z].*", between("docs/verify/study/study.md", "study methods"), re.M)]

    def rows(chosen, columns):
        return ["|" + "|".join(row[column] for column in columns) + "|" for row in chosen]

    if name == "best":
        wanted = ("tactnet4 in 8 bits | 7 × 13 | default", "tactnet6-economical | 14 × 25 | default", "tactnet6 | 28 × 50 | default",
                  "tactnet6 | 28 × 50 | thorough", "squeezenet-pooled-svm | 28 × 50 | default")
        chosen = [row for key in wanted for row in methods if row[1:4] == f" {key} ".split("|")]
        head = "| method | tactels | recipe | random splits, % | blocked splits, % | µs per frame | parameters |"
        return table_of(head, rows(chosen, (1, 2, 3, 4, 6, 8, 11)))
    if name == "compared":
        chosen = [row for row in methods if row[4] != " " and row[7] != " " and row[3] != " default "]
        return table_of("| method | tactels | recipe | paper, % | tactnet, % |", rows(chosen, (1, 2, 3, 7, 4)))
    return between("docs/verify/study/study.md", f"study {name}")


def paper_methods():
    """The twelve methods of the paper, with the default recipe. Those without pretrained weights have the time of the network alone."""
    with open(KEPT / "study.csv", encoding="utf-8") as file:
        rows = {row["method"]: row for row in csv.DictReader(file)
                if (row["rows"], row["recipe"]) == ("28", "default") and row["bits"] in ("", "32")}
    with open(ROOT / "benchmarks/results/zen5/2026-11-24/large_networks.csv", encoding="utf-8") as file:
        alone = {row["network"]: float(row["tactnet_ms"]) for row in csv.DictReader(file) if row["batch"] == "1"}

    def percent(row, name):
        mean, deviation = row[f"{name}_accuracy"], row[f"{name}_deviation"]
        return f"{100 * float(mean):.2f} ± {100 * float(deviation):.2f}" if mean else "–"

    lines = []
    networks = {"squeezenet": "SqueezeNet", "alexnet": "AlexNet", "resnet50": "ResNet-50", "vgg16": "VGG16"}
    titles = {"surf-svm": "SURF-SVM", **{f"{name}-{end}": f"{title}-{end.upper()}" for end in ("svm", "nn") for name, title in networks.items()},
              "tactnet4": "TactNet-4", "tactnet6": "TactNet-6", "tactresnet": "TactResNet"}
    for method, title in titles.items():
        row = rows[method]
        time = f"{float(row['microseconds']) / 1000:.3g}" if row["microseconds"] else f"{alone[method.split('-')[0]]:.3g} ¹"
        lines.append(f"| {title} | {percent(row, 'published')} | {float(row['published_microseconds']) / 1000:g} | "
                     f"{percent(row, 'random')} | {percent(row, 'blocked')} | {time} |")
    return table_of("| method | paper, % | paper, ms | tactnet, random splits, % | blocked splits, % | tactnet, ms |", lines)


def speed(name):
    """What benchmark_inference measured at batch 1, from the newest results on each processor."""
    measured = {}
    for processor in ("zen4", "zen5"):
        with open(ROOT / f"benchmarks/results/{processor}/2026-11-24/inference.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        network, batch = list(rows[0])[:2]
        measured[processor] = {row[network]: row for row in rows if row[batch] == "1" and re.fullmatch("[a-z0-9]+/[0-9]+x[0-9]+", row[network])}
    if name == "libraries":
        libraries = {"tactnet": "tactnet_us", "oneDNN 2.6.3, primitives called directly": "onednn_us",
                     "ONNX Runtime 1.30.0, all graph optimisations": "onnxruntime_us", "OpenCV 4.6.0": "opencv_dnn_us",
                     "PyTorch 1.13.0, its C++ functions": "libtorch_us"}
        row = measured["zen4"]["tactnet6/28x50"]
        return "| TactNet-6 at 28 × 50 | µs per frame |\n|---|---|\n" + "".join(f"| {name} | {row[key]} |\n" for name, key in libraries.items())
    def title(network):
        return re.sub("tact(net|resnet)([0-9]?)/(.*)x(.*)", lambda m: f"Tact{'Net-' + m[2] if m[1] == 'net' else 'ResNet'} {m[3]} × {m[4]}", network)

    if name.startswith("cold"):
        with open(ROOT / "benchmarks/results/zen5/2026-11-28/cold.csv", encoding="utf-8") as file:
            rows = {(row["network"], row["library"]): row for row in csv.DictReader(file) if row["format"] == name[5:]}
        table = ("| one frame | packed, kB | tactnet, µs: warm | cold | oneDNN, µs: warm | cold | oneDNN ÷ tactnet: warm | cold |\n"
                 "|---|---|---|---|---|---|---|---|\n")
        for (network, library), ours in rows.items():
            if library == "tactnet":
                theirs = rows[network, "onednn"]
                times = [float(row[when]) for row in (ours, theirs) for when in ("warm_us", "cold_us")]
                cells = [f"{int(ours['packed_bytes']) / 1000:.0f}", *(f"{t:.3g}" for t in times), f"{times[2] / times[0]:.2f}",
                         f"{times[3] / times[1]:.2f}"]
                table += f"| {title(network)} | {' | '.join(cells)} |\n"
        return table
    table = ("| batch 1 | Zen 4: tactnet, µs | oneDNN, µs | ONNX Runtime, µs | oneDNN ÷ tactnet | Zen 5: tactnet, µs | oneDNN ÷ tactnet |\n"
             "|---|---|---|---|---|---|---|\n")
    for network, four in measured["zen4"].items():
        five = measured["zen5"][network]
        cells = [four["tactnet_us"], four["onednn_us"], four["onnxruntime_us"], four["ratio"], five["tactnet_us"], five["ratio"]]
        table += f"| {title(network)} | {' | '.join(cells)} |\n"
    return table


def expect_in_readme(page, pattern, *quotes):
    """Each of the quotes, in which `{n}` is the n-th group of the pattern, must be in README.md."""
    found = re.search(pattern, (ROOT / page).read_text())
    if not found:
        sys.exit(f"tables.py: {page}: expected a row '{pattern}' for README.md, found none.")
    for quote in quotes:
        quote = quote.format(found[0], *found.groups())
        if quote not in (ROOT / "README.md").read_text():
            sys.exit(f"tables.py: README.md: expected '{quote}', as the tables have it, found none.")


if not CHECK and len(sys.argv) == 3:
    take_over(*sys.argv[1:])
put("docs/choosing.md", "study front", study("front"))
for table in ("best", "compared", "memory"):
    put("docs/verify/results.md", f"study {table}", study(table))
put("docs/verify/results.md", "paper methods", paper_methods())
put("docs/recognise/speed.md", "speed networks", speed("networks"))
for numbers in ("float", "8 bits"):
    put("docs/recognise/speed.md", f"speed cold {numbers}", speed(f"cold {numbers}"))
put("docs/choosing.md", "speed libraries", speed("libraries"))
# The first and the last row of the front, and the microcontroller.
expect_in_readme(
    "docs/verify/study/study.md",
    r"\n[|] tactnet6, thorough recipe [|] 28 × 50 [|] ([0-9.]+) [|] ([0-9.]+) ± ([0-9.]+) [(]20[)] [|] ([0-9.]+) ± ([0-9.]+) ",
    "TactNet-6 takes {1} µs per frame", "TactNet-6 recognises {4} %", "and {2} % if they are not", "{2} ± {3} %", "{4} ± {5} %",
)
expect_in_readme("docs/verify/study/study.md", r"\n[|] tactnet4 in 8 bits [|] 7 × 13 [|] ([0-9.]+) ", "the smallest network {1} µs")
expect_in_readme(
    "docs/recognise/deployment.md",
    r"Cortex-M7 [|] ([0-9.]+) [|] ([0-9.]+) [|]",
    "{1} kB of flash and {2} kB of RAM on an emulated Cortex-M7",
)

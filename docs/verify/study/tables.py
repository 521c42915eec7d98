"""Puts measured figures into the documentation; none is typed. Results of `tactnet study` become docs/verify/study and the tables between
the comments `<!-- study NAME -->` and `<!-- study NAME ends -->` of pages; times of benchmark_inference and benchmark_cold those between `<!-- speed NAME -->`
comments. Most are rows and columns of study.csv. Sentences of pages quote figures: they are compared, and written again where one place fits.
Of results of a kind, the newest of a processor counts.

    python3 docs/verify/study/tables.py                       writes tables and figures into the pages again
    python3 docs/verify/study/tables.py --check [ROOT]        fails if they differ
    python3 docs/verify/study/tables.py RESULTS ARCHIVE       takes over a folder of results; all rows, trainings and timings go into the
                                     archive, such as benchmarks/results/zen5/2026-11-24/study.tar.xz
"""

import csv
import json
import math
import pathlib
import re
import statistics
import string
import subprocess
import sys
import tarfile

CHECK = sys.argv[1:2] == ["--check"]
ROOT = pathlib.Path(sys.argv[2]) if CHECK and len(sys.argv) > 2 else pathlib.Path(__file__).resolve().parents[3]
KEPT = ROOT / "docs/verify/study"
PAGE = "docs/verify/study/study.md"


def take_over(results, archive):
    results = pathlib.Path(results)
    kept, taken = read("study.csv", KEPT), read("study.csv", results)
    with open(KEPT / "study.csv", "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, [*dict.fromkeys([*taken[0], *kept[0]])], lineterminator="\n")
        writer.writeheader()
        # A method that the program was built without keeps its row, but for times, which are not of this program.
        writer.writerows(taken + [{key: "" if key.startswith(("microseconds", "jitter")) else value for key, value in row.items()}
                                  for row in kept if row["method"] not in {row["method"] for row in taken}])
    page = (results / "study.md").read_text()
    put(PAGE, "study front", re.sub(r"[^|]+[|]\n", "\n", section(page, "study front", results)))  # without the types in C++
    put(PAGE, "study memory", section(page, "study memory", results))
    quote_figures(PAGE, re.search("tactnet ([0-9.]+); ([0-9-]+)", page).groups(), "version {0}, {1} |")
    print(f"{PAGE}: its words on images, machine, compiler, version and date are to be those of:", page.split("\n\n")[1], sep="\n")
    with tarfile.open(archive, "w:xz", format=tarfile.GNU_FORMAT) as file:
        for name in ("evaluation.jsonl", "timings.jsonl", "study.jsonl"):
            file.add(results / name, name)
    subprocess.run([ROOT / "scripts/pictures", "accuracy_and_time"], check=True)


def section(text, mark, page):
    """The text between two comments of a page."""
    found = re.search(rf"<!-- {mark} -->\n(.*?)<!-- {mark} ends -->", text, re.S)
    if not found:
        sys.exit(f"tables.py: {page}: expected '<!-- {mark} -->' and after it '<!-- {mark} ends -->', found only one of them, or none.")
    return found[1]


def put(page, mark, table):
    old = section((ROOT / page).read_text(), mark, page)
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


def study_rows():
    """The rows of study.csv as cells, from 1: method, tactels, recipe, random splits, the same with reflections averaged, blocked splits,
    paper, µs, p99, ms of the paper, parameters, multiply-adds, training."""
    with open(KEPT / "study.csv", encoding="utf-8") as file:
        found = list(csv.DictReader(file))

    def percent(row, name, splits=""):
        mean, deviation, count = (row.get(f"{name}_{what}", "") for what in ("accuracy", "deviation", "splits"))
        return f" {100 * float(mean):.2f} ± {100 * float(deviation):.2f}{f' ({count})' if splits else ''} " if mean else " "

    def number(text, digits=None, scale=1.0):
        return f" {float(text) / scale:.{digits}f} " if text and digits is not None else f" {int(text):,} ".replace(",", " ") if text else " "

    return [["", f" {row['method']}{' in 8 bits' if row['bits'] == '8' else ''} ", f" {row['rows']} × {row['columns']} ", f" {row['recipe']} ",
             percent(row, "random", "with"), percent(row, "random_reflected", "with"), percent(row, "blocked", "with"), percent(row, "published"),
             number(row["microseconds"], 1), number(row["microseconds_p99"], 1), number(row["published_microseconds"], 0, 1000.0),
             number(row["parameters"]), number(row["multiply_adds"]), number(row["training_seconds"], 1), "\n"] for row in found]


def study(name):
    """A table by its name: rows and columns of the table of all methods."""
    methods = study_rows()

    def rows(chosen, columns):
        return ["|" + "|".join(row[column] for column in columns) + "|" for row in chosen]

    def with_titles(chosen):
        return [["", f"{row[1]}at {row[2].strip()}{'' if row[3] == ' default ' else f',{row[3]}recipe'.replace('  ', ' ')} ", *row[2:]] for row in chosen]

    if name == "best":
        wanted = ("tactnet4 in 8 bits | 7 × 13 | default", "tactnet6-economical | 14 × 25 | default", "tactnet6 | 28 × 50 | default",
                  "tactnet6 | 28 × 50 | thorough", "squeezenet-pooled-svm | 28 × 50 | default")
        chosen = [row for key in wanted for row in methods if row[1:4] == f" {key} ".split("|")]
        return table_of("| method | random splits, % | blocked splits, % | µs per frame |", rows(with_titles(chosen), (1, 4, 6, 8)))
    if name == "methods":
        chosen = with_titles(row for row in methods if row[4] != " ")
        return table_of("| method | random splits, % | the same, reflections averaged, % | blocked splits, % |", rows(chosen, (1, 4, 5, 6)))
    if name == "costs":
        chosen = with_titles(row for row in methods if row[8] != " ")
        return table_of("| method | µs per frame | p99 | parameters | multiply-adds | training, s |", rows(chosen, (1, 8, 9, 11, 12, 13)))
    if name == "compared":
        chosen = [row for row in methods if row[4] != " " and row[7] != " " and row[3] != " default "]
        return table_of("| method | tactels | recipe | paper, % | tactnet, % |", rows(chosen, (1, 2, 3, 7, 4)))
    return section((ROOT / PAGE).read_text(), f"study {name}", PAGE)


def paper_methods():
    """The twelve methods of the paper, with the default recipe. Those without pretrained weights have the time of the network alone."""
    with open(KEPT / "study.csv", encoding="utf-8") as file:
        rows = {row["method"]: row for row in csv.DictReader(file)
                if (row["rows"], row["recipe"]) == ("28", "default") and row["bits"] in ("", "32")}
    alone = {row["network"]: float(row["tactnet_ms"]) for row in read(newest("zen5", "large_networks.csv")) if row["batch"] == "1"}

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


def read(path, folder="benchmarks/results"):
    with open(ROOT / folder / path, encoding="utf-8") as file:
        return list(csv.DictReader(file))


def title(network):
    return re.sub("tact(net|resnet)([0-9]?)/(.*)x(.*)", lambda m: f"Tact{'Net-' + m[2] if m[1] == 'net' else 'ResNet'} {m[3]} × {m[4]}", network)


def newest(processor, name, holds=""):
    """The newest of the results of a processor, in benchmarks/results, that has such a name and holds such a text."""
    found = [path for path in sorted((ROOT / "benchmarks/results" / processor).glob(f"*/{name}")) if holds in path.read_text()]
    if not found:
        sys.exit(f"tables.py: benchmarks/results/{processor}: expected a file '{name}' with '{holds}', found none.")
    return found[-1].relative_to(ROOT / "benchmarks/results").as_posix()


PROCESSORS = {"Zen 4": "zen4", "Zen 5": "zen5", "Xeon with AMX": "xeon"}


def inference(processor, batch="1", kind=""):
    """What benchmark_inference measured last on a processor: its rows by network."""
    names = (f"inference{kind}.csv", "eight_bit_networks.csv" if kind else "")
    for path in sorted((ROOT / "benchmarks/results" / PROCESSORS[processor]).glob("*/*.csv"), reverse=True):
        rows = read(path.relative_to(ROOT / "benchmarks/results")) if path.name in names else [{}]
        network, of = (*rows[0], "", "")[:2]
        if found := {row[network]: row for row in rows if row.get(of) == batch and re.fullmatch("[a-z0-9]+/[0-9]+x[0-9]+", row[network])}:
            return found
    sys.exit(f"tables.py: benchmarks/results: expected a file of {names} with batch {batch} for {processor}, found none.")


def speed(name):
    """What benchmark_inference and benchmark_cold measured, from the newest results on each processor."""
    if name == "libraries":
        libraries = {"tactnet": "tactnet_us", "oneDNN 2.6.3, primitives called directly": "onednn_us",
                     "ONNX Runtime 1.30.0, all graph optimisations": "onnxruntime_us", "OpenCV 4.6.0": "opencv_dnn_us",
                     "PyTorch 1.13.0, its C++ functions": "libtorch_us"}
        row = inference("Zen 4")["tactnet6/28x50"]
        return "| TactNet-6 at 28 × 50 | µs per frame |\n|---|---|\n" + "".join(f"| {name} | {row[key]} |\n" for name, key in libraries.items())
    if name == "rivals":
        best = {}  # of a library's back ends, the fastest
        for row in read(newest("zen5", "rivals.csv")):
            best.setdefault((row["library"].split(" with ")[0], row["what"]), []).append(row)
        rows = [min(each, key=lambda row: float(row["library_us"])) for each in best.values()]
        return table_of("| network | library | its µs per frame | library ÷ tactnet (quartiles) |", [
            f"| {row['what']} | {row['library']} | {float(row['library_us']):.3g} | "
            f"{float(row['ratio']):.3g} ({float(row['lower']):.3g}–{float(row['upper']):.3g}) |" for row in rows])
    if name == "boards":
        rows = re.findall("\n([|] TactNet[^|]+)[|] Cortex-M7 ([|].*)", (ROOT / "docs/recognise/deployment.md").read_text())
        return table_of("| Cortex-M7, thousand instructions per frame | tactnet | CMSIS-NN | CMSIS-NN ÷ tactnet |", list(map("".join, rows)))
    if name == "ratios":
        lines = []
        for label, batch, kind in (("one frame", "1", ""), ("batches of 64", "64", ""), ("8 bits, one frame", "1", "_8bit"),
                                   ("8 bits, batches of 64", "64", "_8bit")):
            for processor in PROCESSORS:
                ratios = {network: float(row["ratio"]) for network, row in inference(processor, batch, kind).items()}
                least = min(ratios, key=ratios.get)
                lines.append(f"| {label} | {processor} | {statistics.geometric_mean(ratios.values()):.2f} | {ratios[least]:.2f} | {title(least)} |")
        return table_of("| oneDNN ÷ tactnet | processor | mean | least | for |", lines)
    if name.startswith("cold"):
        rows = {(row["network"], row["library"]): row for row in read(newest("zen5", "cold.csv")) if row["format"] == name[5:]}
        lines = []
        for (network, library), ours in rows.items():
            if library == "tactnet":
                warm, cold, their_warm, their_cold = (float(row[when]) for row in (ours, rows[network, "onednn"]) for when in ("warm_us", "cold_us"))
                lines.append(f"| {title(network)} | {int(ours['packed_bytes']) / 1000:.0f} | {cold:.3g} | {cold / warm:.1f} | "
                             f"{their_warm / warm:.2f} | {their_cold / cold:.2f} |")
        return table_of("| one frame | packed, kB | cold, µs | cold ÷ warm | oneDNN ÷ tactnet: warm | cold |", lines)
    times, ratios = [], []
    for network, row in inference("Zen 4").items():
        times.append(" | ".join([f"| {title(network)}", *(row[f"{library}_us"] for library in ("tactnet", "onednn", "onnxruntime"))]) + " |")
        ratios.append(" | ".join([f"| {title(network)}", *(f"{float(inference(each)[network]['ratio']):.2f}" for each in PROCESSORS)]) + " |")
    return (table_of("| µs per frame, Zen 4 | tactnet | oneDNN | ONNX Runtime |", times) + "\n" +
            table_of(f"| oneDNN ÷ tactnet | {' | '.join(PROCESSORS)} |", ratios))


def choice():
    """Networks with the best accuracy for their time: rows of the results on Zen 4, and the study's accuracy of the largest."""
    page = (ROOT / "benchmarks/results/zen4/2026-11-26/smaller_networks.md").read_text()
    measured = [[cell.strip() for cell in line.split("|")] for line in re.findall("^[|] tactnet.*", page, re.M)]
    rows = {f"{cells[1]} at {cells[2]}": cells for cells in measured}
    lines = []
    for key, type_name in (("tactnet4-3x3 in 8 bits at 8 × 16", "tactnet4_3x3"), ("tactnet4-strided in 8 bits at 12 × 22", "tactnet4_strided"),
                           ("tactnet6-economical in 8 bits at 10 × 18", "tactnet6_economical"),
                           ("tactnet6-symmetric in 8 bits at 14 × 25", "tactnet6_symmetric"),
                           ("tactnet6-economical in 8 bits, thorough recipe at 18 × 32", "tactnet6_economical"),
                           ("tactnet6 in 8 bits, thorough recipe at 28 × 50", "tactnet6")):
        cells = rows[key]
        recipe = ", thorough recipe" if "thorough" in key else ""
        lines.append(f"| `{type_name}` in 8 bits{recipe} | {cells[2]} | {cells[6]} | {cells[3]} | {cells[5]} | {cells[7]} |")
    best = next(cells for cells in study_rows() if cells[1:4] == [" tactnet6 ", " 28 × 50 ", " thorough "])
    time = float(inference("Zen 4")["tactnet6/28x50"]["tactnet_us"])
    lines.append(f"| `tactnet6`, thorough recipe | 28 × 50 | {time:.1f} | {best[4].strip()[:-5]} | {best[6].strip()[:-5]} | {best[11].strip()} |")
    return table_of("| network | tactels | µs per frame | random splits, % | blocked splits, % | parameters |", lines)


def sizes():
    """Accuracy and time of three networks at twenty sizes; time as a share of the largest network's."""
    rows = {(row["method"], row["rows"], row["columns"]): row for row in read(newest("zen4", "sweep.csv")) if row["bits"] == "32"}
    largest = float(rows["tactnet6-economical", "28", "50"]["microseconds"])
    networks = ("tactnet4", "tactnet6-economical", "tactnet4-strided")

    def table(head, title, cell):
        return table_of(f"| {head} | TactNet-4 | TactNet-6 economical | TactNet-4 strided |", [
            " | ".join([f"| {title(int(height), int(width))}", *(cell(rows[name, height, width]) for name in networks)]) + " |"
            for method, height, width in rows if method == networks[0]])

    accuracy = table("accuracy, %", lambda height, width: f"{height} × {width} = {height * width}",
                     lambda row: f"{100 * float(row['random_accuracy']):.1f}, {100 * float(row['blocked_accuracy']):.1f}")
    return accuracy + "\n" + table("time, share", "{} × {}".format, lambda row: f"{float(row['microseconds']) / largest:.2f}")


def mat():
    runs = {}
    for row in read(newest("zen5", "pressure_mat.csv")):
        runs.setdefault(row["run"], []).append(100 * float(row["accuracy"]))
    plain = runs["the same kinds, no reflections, 17 postures"]
    lines = []
    for run, found in runs.items():
        gains = [a - b for a, b in zip(found, plain)]
        gain = f"{statistics.mean(gains):+.2f} ± {statistics.stdev(gains) / math.sqrt(len(gains)):.2f}" if "17" in run and found is not plain else "–"
        lines.append(f"| {run} | {statistics.mean(found):.2f} ± {statistics.stdev(found):.2f} | {min(found):.1f} | {gain} |")
    return table_of("| kinds of augmentation, task | accuracy, % | worst person | gain over no reflections, ± standard error |", lines)


class figure(str):
    """A figure as a file has it, or with a format such as `.1f` rounded to it."""

    def __format__(self, wanted):
        return format(float(self), wanted) if wanted else str(self)


def quote_figures(page, figures, *quotes):
    """Each of the quotes, in which `{n}` is the n-th figure, must be on the page. Unless pages are only checked, their figures are written
    anew, where one place of the page fits."""
    figures = [figure(value) for value in figures]
    for text in quotes:
        expected, page_text = text.format(*figures), (ROOT / page).read_text()
        if expected in " ".join(page_text.split()):
            continue
        pattern = "".join(r"\s+".join(map(re.escape, re.split(" ", words))) + (r"([^\s|()\[\]#]+)" if name is not None else "")
                          for words, name, _, _ in string.Formatter().parse(text))
        places = list(re.finditer(pattern, page_text))
        if CHECK or len(places) != 1:
            sys.exit(f"tables.py: {page}: expected '{expected}', as the results have it, found {len(places)} places like it with other figures.")
        names = [(name, wanted) for _, name, wanted, _ in string.Formatter().parse(text) if name is not None]
        for group in reversed(range(len(names))):
            name, wanted = names[group]
            begin, end = places[0].span(group + 1)
            page_text = page_text[:begin] + format(figures[int(name)], wanted) + page_text[end:]
        (ROOT / page).write_text(page_text)
        print(f"{page}: '{expected}'")


def expect(source, pattern, page, *quotes):
    """Each of the quotes, in which `{n}` is the n-th group of the pattern in the source, must be on the page."""
    found = re.search(pattern, (ROOT / source).read_text())
    if not found:
        sys.exit(f"tables.py: {source}: expected a row '{pattern}' for {page}, found none.")
    quote_figures(page, (found[0], *found.groups()), *quotes)


def check_confusion():
    """What results.md says of the confusion matrix of TactNet-6."""
    with tarfile.open(ROOT / "benchmarks/results/zen5/2026-11-24/study.tar.xz") as archive:
        found = [row for row in map(json.loads, archive.extractfile("evaluation.jsonl").read().splitlines())
                 if [row["settings"].get(key, "32") for key in ("network", "recipe", "rows", "bits")] == ["tactnet6", "default", "28", "32"]]
    counts, classes = [sum(cells) for cells in zip(*(row["confusion"] for row in found))], found[0]["classes"]
    pen, tube = 15, 21
    tubes, pens, errors = counts[tube * classes + pen], counts[pen * classes + tube], sum(counts) - sum(counts[::classes + 1])
    words = " ".join((ROOT / "docs/verify/results.md").read_text().split())
    sentence = f"{tubes} are taken for a pen, and {pens} of 400 pens for a tube. These are {tubes + pens} of all {errors} errors."
    if sentence not in words:
        sys.exit(f"tables.py: docs/verify/results.md: expected '{sentence}', found none.")


def check_times(time):
    """Where the words of a page say what TactNet-6 at 28 × 50 takes, they say the time of the study; each section names what it was timed on."""
    for page in (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))):
        text = re.sub("^```.*?^```", "", page.read_text(), flags=re.M | re.S)
        for section in re.split("\n(?=#)", text):
            found = re.search(r"[0-9] (µs|ms)\b.*", section)
            if found and not re.search("Zen|Xeon|EPYC|Cortex", section):
                sys.exit(f"tables.py: {page.relative_to(ROOT)}: expected the processor of '{found[0]}' in its section, found none.")
        for paragraph in text.split("\n\n"):
            words = " ".join(paragraph.split())
            for one, other in re.findall(r"TactNet-6(?! economical)[^;|]{0,90}?\b([0-9]+[.][0-9]+) µs|([0-9]+[.][0-9]+) µs (?:per frame )?for TactNet-6", words):
                if (one or other) != time:
                    sys.exit(f"tables.py: {page.relative_to(ROOT)}: expected {time} µs for TactNet-6, as in the study, found {one or other} µs.")


if not CHECK and len(sys.argv) == 3:
    take_over(*sys.argv[1:])
put("docs/choosing.md", "choice", choice())
put("docs/verify/study/tactels.md", "sizes", sizes())
for table in ("methods", "costs"):
    put(PAGE, f"study {table}", study(table))
for table in ("best", "compared", "memory"):
    put("docs/verify/results.md", f"study {table}", study(table))
put("docs/verify/results.md", "paper methods", paper_methods())
for table in ("networks", "ratios"):
    put("docs/recognise/speed.md", f"speed {table}", speed(table))
for numbers in ("float", "8 bits"):
    put("docs/recognise/speed.md", f"speed cold {numbers}", speed(f"cold {numbers}"))
put("docs/verify/results.md", "mat", mat())
for table in ("libraries", "rivals", "boards"):
    put("docs/choosing.md", f"speed {table}", speed(table))
# Figures in words.
large = (r"\n[|] tactnet6, thorough recipe [|] 28 × 50 [|] ([0-9.]+) [|] ([0-9.]+) ± ([0-9.]+) [(]20[)] [|] ([0-9.]+) ± ([0-9.]+) ")
large_bytes, small, small_bytes = (rf"\n[|] {key} [|] ([0-9.]+) " for key in (
    "tactnet6 in 8 bits [|] 28 × 50", "tactnet4 [|] 7 × 13", "tactnet4 in 8 bits [|] 7 × 13"))
expect(PAGE, large, "README.md", "TactNet-6 takes {1} µs per frame", "TactNet-6 recognises {4} %", "and {2} % if images are split at random",
       "| {4} ± {5} % | {2} ± {3} % |")
expect(PAGE, large, "docs/verify/results.md", "{4} % of test images on blocked splits and {2} % on random ones")
expect(PAGE, small_bytes, "README.md", "the smallest network takes {1} µs")
expect("docs/recognise/deployment.md", r"Cortex-M7 [|] ([0-9.]+) [|] ([0-9.]+) [|]", "README.md",
       "{1} kB of flash and {2} kB of RAM on an emulated Cortex-M7")
for board, core in (("Teensy 4", "Cortex-M7"), ("ESP32-C3", "RISC-V, RV32IMC")):
    expect("docs/recognise/deployment.md", rf"\n[|] {core} [|] ([0-9.]+) [|] ([0-9.]+) [|] ([0-9 ]+) [|]", "docs/faq.md",
           f"| {board} | {core} | {{1}} | {{2}} | {{3}} |")
for page, words in (("docs/faq.md", "TactNet-6 takes [{1} µs]"), ("docs/recognise/deployment.md", "TactNet-6 takes {1} µs"),
                    ("docs/recognise/speed.md", "{1} µs for TactNet-6 at 28 × 50"), ("docs/train/transfer.md", "It takes {1} µs per frame"),
                    ("docs/recognise/eight_bit.md", "| Zen 5, AVX-512 with VNNI, µs per frame | {1} |"),
                    ("docs/recognise/speed.md", "TactNet-6 at 28 × 50 takes {1:.0f} to")):
    expect(PAGE, large, page, words)
expect(PAGE, large_bytes, "docs/faq.md", "and {1} µs in 8 bits")
expect(PAGE, large_bytes, "docs/recognise/eight_bit.md", "| {1} | [study]")
expect(PAGE, small, "docs/recognise/deployment.md", "TactNet-4 takes {1} µs at 7 × 13")
expect(PAGE, small, "docs/recognise/speed.md", "TactNet-4 takes {1} to")
forms = {" ".join(cell.strip() for cell in row[1:3]): row for row in study_rows() if row[3] == " default "}
for network, size in (("6", "28 × 50"), ("4", "28 × 50"), ("4", "14 × 25"), ("4", "7 × 13")):
    shares = [forms[f"tactnet{network}{form} {size}"][column].split()[0] for form in ("", " in 8 bits") for column in (4, 6)]
    quote_figures("docs/recognise/eight_bit.md", shares, f"| TactNet-{network}, {size} | {{0}} | {{2}} | {{1}} | {{3}} |")
quote_figures("docs/recognise/speed.md", [forms[f"tactnet6-economical {size}"][8].strip() for size in ("10 × 18", "7 × 13")],
              "takes {0} µs and {1} µs on Zen 5")
zen4 = {batch: inference("Zen 4", batch) for batch in ("1", "64")}
quote_figures("docs/recognise/speed.md", [zen4["1"]["tactnet4/28x50"]["tactnet_us"], zen4["1"]["tactnet6/28x50"]["tactnet_us"]],
              "to {0:.0f} µs per frame, depending on its size and the processor", "to {1:.0f} µs. - oneDNN")
means = [statistics.geometric_mean(float(row["ratio"]) for row in inference(processor).values()) for processor in PROCESSORS]
quote_figures("docs/recognise/speed.md", [min(means), max(means)], "takes {0:.1f} to {1:.1f} times as long on average")
calls = [float(row["cold_us"]) / float(row["warm_us"]) for row in read(newest("zen5", "cold.csv")) if row["library"] == "tactnet"]
quote_figures("docs/recognise/speed.md", [min(calls), max(calls)], "takes {0:.0f} to 9 times as long for most networks, and up to {1:.0f} times for the smallest")
quote_figures("docs/choosing.md", [zen4["64"]["tactnet6/28x50"][library] for library in ("libtorch_us", "tactnet_us")],
              "it takes {0:.0f} µs per frame, and tactnet {1:.1f} µs")
alone = newest("zen5", "large_networks.csv")
quote_figures("docs/choosing.md", [next(row["ratio"] for row in read(alone) if (row["network"], row["batch"]) == ("alexnet", "1"))],
              "oneDNN takes {0:.2f} times as long as tactnet")
smaller = "benchmarks/results/zen4/2026-11-26/smaller_networks.md"
expect(smaller, r"tactnet6 in 8 bits, thorough recipe [|] 28 × 50 [|][^|]*[|][^|]*[|][^|]*[|] ([0-9.]+) ", "docs/recognise/eight_bit.md",
       "| {1} | [benchmark](../../" + smaller)
quote_figures("docs/recognise/eight_bit.md", [zen4["1"]["tactnet6/28x50"]["tactnet_us"]], "| Zen 4, AVX-512 with VNNI, µs per frame | {0:.1f} |")
expect("benchmarks/results/zen4/2026-11-23/results.md", "28 × 50 with SSE4.1: ([0-9.]+) and ([0-9.]+) µs", "docs/recognise/eight_bit.md",
       "SSE4.1, µs per frame | {1} | {2} |")
ratios = [float(row["ratio"]) for row in read(newest("zen4", "eight_bit_networks.csv")) if row["batch"] == "1"]
quote_figures("docs/recognise/eight_bit.md", [min(ratios), max(ratios)], "[{0:.1f} to {1:.0f} times]")
quote_figures("docs/verify/results.md", [newest("zen5", "networks.md")], "on the same machine ([benchmark](../../benchmarks/results/{0}))")
quote_figures("docs/recognise/speed.md", [newest("zen5", "inference.csv")], "and [Zen 5](../../benchmarks/results/{0}).")
# What decisions cost, and what they gain.
costs = newest("zen5", "decision*.md", "| single precision |")
alone, whole, more = re.search("[|] single precision [|] ([0-9.]+) [|] ([0-9.]+) [|] ([0-9.]+) [|]", (ROOT / "benchmarks/results" / costs).read_text()).groups()
for page, words in (("docs/recognise/decision.md", "[{0:.1f} µs per frame of a touch](../../benchmarks/results/{1}#cost-per-frame), {2:.0f} % of the time"),
                    ("docs/faq.md", "[{0:.1f} µs](../benchmarks/results/{1}#cost-per-frame)")):
    quote_figures(page, [f"{float(whole) - float(alone):.6f}", costs, more], words)
faults = "benchmarks/results/" + newest("zen5", "decision*.md", "| one row stuck at 255 |")
for pattern, *words in ((r"[|] none [|] ([0-9.]+) [|][^|]*[|][^|]*[|] ([0-9.]+) ", "the {1:.1f} % without a fault", "`sensor_health::clean` takes {2} µs"),
                        (r"[|] one row stuck at 255 [|] ([0-9.]+) [|] ([0-9.]+) [|][^|]*[|] ([0-9.]+) ", "TactNet-6 recognises {1:.1f} % of the paper's",
                         "it recognises {2:.1f} %", "and {3} to"),
                        (r"[|] one row dead [|][^|]*[|][^|]*[|][^|]*[|] ([0-9.]+) ", "to {1} µs if a row is faulty"),
                        (r"of the softmax [|] ([0-9.]+) (?:.*\n.*)[|] ([0-9.]+) [|]", "[{1:.1f} and"),
                        (r"[|] 95 [|] ([0-9.]+) [|] ([0-9.]+) ", "contain {2:.2f} classes on average", "[{1:.1f} % of test images]")):
    expect(faults, pattern, "docs/recognise/decision.md", *words)
expect("benchmarks/results/zen3/2026-11-26/decision.md", "error fell from ([0-9.]+) to ([0-9.]+) %", "docs/recognise/decision.md", "[{1:.1f} to {2:.1f} %]")
# The accuracies of the fresh seeds are those of the results.
fresh = "reaches ([0-9.]+) ± ([0-9.]+) % [(]random, 10[)] and ([0-9.]+) ± ([0-9.]+) % [(]blocked"
for page, words in (("README.md", "it recognises {3} % and {1} %"), ("README.md", "| {3} ± {4} % | {1} ± {2} % |"),
                    ("docs/choosing.md", "reaches {1} ± {2} % on random and {3} ± {4} % on blocked"),
                    ("docs/train/training.md", "reaches {1} ± {2} % on random splits and {3} ± {4} % on blocked ones")):
    expect("docs/verify/results.md", fresh, page, words)
expect("docs/verify/results.md", r"[|] auto, 3 postures [|] ([0-9.]+) .*\n[|] auto, 17 postures [|] ([0-9.]+) ± ([0-9.]+) ", "README.md",
       "in {2} ± {3} % of the frames of a person", "in {1} % of the frames")
for row in ("random images", "blocked: consecutive images", "a person left out"):
    expect("docs/verify/honest_tests.md", rf"[|] {row} [|] ([0-9.]+) ", "docs/verify/results.md", f"| {row} | {{1}} |")
six = {row["class"] + row["image"]: row for row in read("unrecognised.csv", "docs/pictures/source")}
quote_figures("docs/verify/results.md", [six[image][key] for image, key in (("pen22", "length"), ("pen24", "class_length"), ("tube21", "class_length"))],
              "cuts them to {0:.0f} tactels", "longer than {1:.0f}, and half of all tubes longer than {2:.0f}")
check_confusion()
check_times(re.search(large, (ROOT / PAGE).read_text())[1])

#!/usr/bin/env python3
"""Measures the tests: changes one thing in a header, and sees whether a test fails.

    tests/mutation/mutate.py --count 60                        60 mutants, from all rooms in turn
    tests/mutation/mutate.py --rooms svm,io --count 20         from two rooms
    tests/mutation/mutate.py --at svm/multiclass.hpp:79        all mutants of a line

--seed alone decides which mutants are made. Each result is a line of output/mutants.jsonl, or of the file that --results
names, as soon as it is known; a run that was stopped resumes there. A mutant is compiled with the smallest tests that include
its header, up to --units of them, until one fails: the test of the header itself first. The source tree stays unchanged.
Needs Python 3, a compiler, and what the tests need.
"""

import argparse
import json
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
HEADERS = ROOT / "include" / "tactnet"
TESTS = ROOT / "tests"
# Checks of all operators: units of the examples of the folder that a header is in.
OF_ALL = [TESTS / "operators" / "of_all" / f"{check}.hpp" for check in ("batches", "frames", "streams")]
LIMIT = 120  # seconds that an unchanged test may take

# The changes. clang-format puts spaces around an operator, and none around the brackets of a template.
SWAPS = [
    (r" < ", " <= "), (r" <= ", " < "), (r" > ", " >= "), (r" >= ", " > "),
    (r" == ", " != "), (r" != ", " == "), (r" && ", " || "), (r" \|\| ", " && "),
    (r" \+ ", " - "), (r" - ", " + "), (r" \* ", " / "), (r" / ", " * "), (r" % ", " / "),
    (r" \+= ", " -= "), (r" -= ", " += "), (r"\btrue\b", "false"), (r"\bfalse\b", "true"),
    (r"\bstd::min\b", "std::max"), (r"\bstd::max\b", "std::min"),
    (r"\+\+(?=\w)", "--"), (r"(?<=[(\s])!(?=[\w(])", ""),
]
NUMBER = re.compile(r"(?<![\w.'<])(\d+(?:\.\d+)?(?:e[+-]?\d+)?)(?![\w.'>])")
STATEMENT = re.compile(r"^(\s+)([A-Za-z_][\w:.\->\[\]]*(?:\(.*\)|\s*[-+*/|&]?=\s.+));$")
NO_STATEMENT = re.compile(r"^\s*(return|using|static|const|constexpr|auto|throw|friend|typename|template|case|goto|else)\b")
LEFT_OUT = re.compile(r"^\s*(#|//|static_assert|namespace|inline namespace|template|using|friend|requires|concept)")


@dataclass
class Mutant:
    header: str
    line: int
    column: int
    before: str
    after: str
    text: str

    @property
    def key(self):
        return (self.header, self.text.strip(), self.column - len(self.text) + len(self.text.lstrip()), self.after)

    def apply(self, source):
        lines = source.split("\n")
        text = lines[self.line - 1]
        lines[self.line - 1] = text[: self.column] + self.after + text[self.column + len(self.before):]
        return "\n".join(lines)


def mutants_of(path):
    """Returns all mutants of a header, from top to bottom."""
    header = path.relative_to(HEADERS).as_posix()
    found, in_sentence = [], False
    for number, text in enumerate(path.read_text().split("\n"), 1):
        # A static_assert over several lines is a check, not something to be checked.
        in_sentence = in_sentence or bool(re.match(r"\s*static_assert", text))
        if in_sentence or LEFT_OUT.match(text):
            in_sentence = in_sentence and not text.rstrip().endswith(";")
            continue
        code = re.sub(r"//.*", "", text).rstrip()
        blank = re.sub(r'"(?:[^"\\]|\\.)*"', lambda m: "\x00" * len(m.group()), code)
        for pattern, after in SWAPS:
            found += [Mutant(header, number, m.start(), m.group(), after, text) for m in re.finditer(pattern, blank)]
        for m in NUMBER.finditer(blank):
            value = m.group(1)
            after = str(int(value) + 1) if value.isdigit() else repr(2 * float(value))
            found.append(Mutant(header, number, m.start(1), value, after, text))
        statement = STATEMENT.match(code)
        if statement and not NO_STATEMENT.match(code) and "\x00" not in blank:
            found.append(Mutant(header, number, statement.start(2), statement.group(2), "", text))
    return found


def chosen(options):
    """Returns the mutants in the order in which they are tried: from all rooms in turn."""
    rooms = {}
    for path in sorted(HEADERS.rglob("*.hpp")):
        header = path.relative_to(HEADERS).as_posix()
        if "/" in header and (not options.rooms or header.split("/")[0] in options.rooms):
            rooms.setdefault(header.split("/")[0], []).extend(mutants_of(path))
    if options.at:
        wanted = {tuple(place.split(":")) for place in options.at}
        return [m for room in rooms.values() for m in room if (m.header, str(m.line)) in wanted]
    # Mutants of one header follow each other, so that the unchanged tests are built once.
    for room, mutants in rooms.items():
        draw = random.Random(f"{options.seed}/{room}")
        headers = {}
        for mutant in mutants:
            headers.setdefault(mutant.header, []).append(mutant)
        groups = [draw.sample(of, min(options.each, len(of))) for of in headers.values()]
        draw.shuffle(groups)
        rooms[room] = [group for group in groups if group]
    order = []
    while any(rooms.values()) and len(order) < options.count:
        order += [mutant for groups in rooms.values() if groups for mutant in groups.pop()]
    return order[: options.count]


class Tests:
    """Finds the tests that see a header, by their includes."""

    def __init__(self):
        self.closures = {}
        self.files = {path: self.reached(path) for path in sorted(TESTS.rglob("*_test.cpp"))
                      if not {"hard_cases", "examples"} & set(path.parts) and "peers" not in path.name}

    def included(self, path):
        text = path.read_text()
        names = re.findall(r'#include [<"]([\w/.]+)[>"]', text)
        # An umbrella of operators names its file of each folder in the list.
        if file := re.search(r"#define TACTNET_FILE_OF\(folder\) <(.*)>", text):
            folders = re.findall(r"#include TACTNET_FILE_\w+\((\w+)\)", (HEADERS / "operators/folders.hpp").read_text())
            names += [file[1].replace("/folder/", f"/{folder}/") for folder in folders]
        return names

    def reached(self, path):
        """Returns all headers of the library that a file includes, directly or not."""
        if path in self.closures:
            return self.closures[path]
        self.closures[path] = reached = set()
        for name in self.included(path):
            if name.startswith("tactnet/"):
                header = name[len("tactnet/"):]
                if (HEADERS / header).exists():
                    reached.add(header)
                    reached |= self.reached(HEADERS / header)
            else:
                folders = (path.parent, TESTS, TESTS / path.relative_to(ROOT).parts[1])
                for folder in [folder for folder in folders if (folder / name).exists()][:1]:
                    reached |= self.reached(folder / name)
        return reached

    def of(self, header):
        """Nearest first: the header's or its folder's own test, tests of its room, tests that include it, all others; small
        ones first."""
        stem, folder, room = header[: -len(".hpp")], header.rpartition("/")[0], header.split("/")[0]
        own = re.compile(f"({re.escape(stem)}|{folder}|{room}/{room})(_\\w+)?_test\\.cpp")

        def distance(path):
            test = path.relative_to(TESTS).as_posix()
            direct = "tactnet/" + header in self.included(path)
            return (not (own.fullmatch(test) and direct), test.split("/")[0] != room, not direct, len(self.files[path]), test)

        of_all = OF_ALL if folder.startswith("operators/") else []
        return of_all + sorted((path for path, seen in self.files.items() if header in seen), key=distance)


class Builder:
    """Compiles tests against a copy of the headers."""

    def __init__(self, options):
        self.options = options
        self.folder = Path(tempfile.mkdtemp(prefix="mutate_"))
        shutil.copytree(ROOT / "include", self.folder / "include")
        self.flags = ["-std=c++20", *options.flags.split(), "-w", f'-DTACTNET_SOURCE_DIR="{ROOT}"',
                      "-DDOCTEST_CONFIG_SUPER_FAST_ASSERTS", f"-I{self.folder}/include", f"-I{TESTS}",
                      f"-I{TESTS}/support/files"]
        self.flags += [f"-isystem{folder}/eigen3" for folder in ("/usr/include", "/usr/local/include")]
        # Headers of other libraries are precompiled. A compiler with other flags ignores the precompiled header.
        self.precompiled = ["-include", str(self.folder / "precompiled.hpp")]
        shutil.copy(TESTS / "support" / "precompiled.hpp", self.folder)
        subprocess.run([options.compiler, *self.flags, "-x", "c++-header", self.precompiled[1]], capture_output=True)
        self.baselines = {}
        self.operator = ""
        self.complete = False
        self.help_with([TESTS / "support" / "main.cpp", TESTS / "support" / "allocations.cpp"])

    def help_with(self, sources):
        """Adds the shared sources of tests to an archive, from which the linker takes what a test needs."""
        helpers = []
        for source in sources:
            output = self.folder / f"helper_{source.stem}.o"
            if self.compile(source, output, []).returncode == 0:
                helpers.append(output)
        subprocess.run(["ar", "rcs", self.folder / "helpers.a", *helpers], check=True)

    def compile(self, source, output, first=None):
        first = self.precompiled if first is None else first
        room = TESTS / source.relative_to(TESTS).parts[0]
        if source in OF_ALL:
            first = [*first, "-DTACTNET_SLICE=0", "-DTACTNET_SLICES=1", f'-DTACTNET_FOLDER="{self.operator}"', "-x", "c++"]
        command = [self.options.compiler, *self.flags, *first, "-I", room, "-c", source, "-o", output]
        try:
            return subprocess.run(command, capture_output=True, text=True, timeout=600)
        except subprocess.TimeoutExpired:
            return subprocess.CompletedProcess(command, 1, "", "compiler: time-out")

    def link(self, objects, program):
        """Links; if that fails for the first time, once more with everything in tests/support."""
        command = [self.options.compiler, *objects, "-Wl,--whole-archive", self.folder / "helper_main.o",
                   "-Wl,--no-whole-archive", self.folder / "helpers.a", "-lpthread", "-o", program]
        if subprocess.run(command, capture_output=True).returncode == 0:
            return True
        if self.complete:
            return False
        self.complete = True
        self.help_with(sorted((TESTS / "support").rglob("*.cpp")))
        return self.link(objects, program)

    def run(self, program, seconds):
        """Limits the processor time, so that a busy machine kills no mutant; returns (None, …) if it took too long."""
        def limits():
            resource.setrlimit(resource.RLIMIT_CPU, (int(seconds) + 1, int(seconds) + 2))

        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        try:
            done = subprocess.run([str(program), "--abort-after=1", "--no-breaks"], capture_output=True, text=True,
                                  errors="replace", timeout=10 * seconds + 60, cwd=self.folder,
                                  preexec_fn=limits)
        except subprocess.TimeoutExpired:
            return None, seconds
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        if done.returncode == -9 and used < seconds:
            sys.exit(f"{program.name}: ended from outside, not by its limit of time; is there memory enough?")
        return (None if done.returncode in (-24, -9) else done), used

    def baseline(self, test):
        """Returns (object code, seconds of a run) of the unchanged test; None if it fails."""
        key = (test, self.operator if test in OF_ALL else "")
        if key not in self.baselines:
            unit, program = self.folder / "unit.o", self.folder / "program"
            self.baselines[key] = None
            if self.compile(test, unit).returncode == 0 and self.link([unit], program):
                done, seconds = self.run(program, LIMIT)
                if done is not None and done.returncode == 0:
                    self.baselines[key] = (unit.read_bytes(), seconds)
        return self.baselines[key]

    def with_header(self, header, source):
        (self.folder / "include" / "tactnet" / header).write_text(source)


def killed_by(test, done):
    """Names the failed test case, the last one that is printed, or how the program ended."""
    name = test.relative_to(TESTS).as_posix()
    if done is None:
        return name + ": time-out"
    cases = re.findall(r"^TEST CASE:\s+(.*)$", done.stdout, re.MULTILINE)
    status = done.returncode
    return f"{name}: {cases[-1].strip() if cases else f'signal {-status}' if status < 0 else f'exit {status}'}"


def tried(builder, mutant, test):
    """Returns (result, by what) of one mutant and one test."""
    builder.operator = Path(mutant.header).parent.name
    before = builder.baseline(test)
    if before is None:
        return "left out", ""
    source = (HEADERS / mutant.header).read_text()
    unit, program = builder.folder / "unit.o", builder.folder / "program"
    builder.with_header(mutant.header, mutant.apply(source))
    compiled = builder.compile(test, unit)
    builder.with_header(mutant.header, source)
    if compiled.returncode < 0 or "terminated program" in compiled.stderr:
        sys.exit("The compiler was ended from outside; the results so far are kept.")
    if compiled.returncode != 0:
        # A test's static_assert is a test.
        if re.search(re.escape(str(TESTS)) + r"\S+ error: (static assertion|static_assert)", compiled.stderr):
            return "killed", f"{test.relative_to(TESTS).as_posix()}: static_assert"
        return "does not compile", ""
    if unit.read_bytes() == before[0]:
        return "same code", ""
    if not builder.link([unit], program):
        return "does not compile", ""
    done, _ = builder.run(program, max(2.0, 5 * before[1]))
    return ("survived", "") if done is not None and done.returncode == 0 else ("killed", killed_by(test, done))


def outcome(builder, tests, mutant, options):
    """Returns killed, survived, same code (in all tests that were tried), does not compile, or no test."""
    results = []
    for test in tests.of(mutant.header):
        if len(results) == options.units:
            break
        result, by = tried(builder, mutant, test)
        if result == "left out":
            continue
        results.append(result)
        if result in ("killed", "does not compile"):
            return result, by
    return ("survived" if "survived" in results else "same code" if "same code" in results else "no test"), ""


def table(lines):
    """Returns how many mutants of each room the tests killed."""
    rooms = {}
    for line in lines:
        rooms.setdefault(line["header"].split("/")[0], []).append(line["result"])
    rows = ["| room | killed | alive | killed, % | same code | does not compile |", "|---|---|---|---|---|---|"]
    for room, results in [*sorted(rooms.items()), ("all", [line["result"] for line in lines])]:
        killed, alive = results.count("killed"), results.count("survived") + results.count("no test")
        share = f"{100 * killed / (killed + alive):.1f}" if killed + alive else "–"
        rows.append(f"| {room} | {killed} | {alive} | {share} | {results.count('same code')} "
                    f"| {results.count('does not compile')} |")
    return "\n".join(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=17)
    parser.add_argument("--count", type=int, default=60, help="how many mutants, from all rooms together")
    parser.add_argument("--each", type=int, default=3, help="how many mutants of a header, if it has as many")
    parser.add_argument("--rooms", type=lambda text: text.split(","), default=[])
    parser.add_argument("--at", action="append", default=[], metavar="HEADER:LINE")
    parser.add_argument("--units", type=int, default=3, help="how many tests a mutant has to survive")
    parser.add_argument("--compiler", default=os.environ.get("CXX", "g++"))
    parser.add_argument("--flags", default="-O1 -march=native")
    parser.add_argument("--results", type=Path, help="where to write results and to resume from")
    options = parser.parse_args()
    results = (options.results or ROOT / "output" / "mutants.jsonl").resolve()
    results.parent.mkdir(parents=True, exist_ok=True)

    lines = [json.loads(line) for line in results.read_text().splitlines()] if results.exists() else []
    done = {(line["header"], line["text"], line["column"], line["after"]) for line in lines}
    order = [mutant for mutant in chosen(options) if mutant.key not in done]
    if order:
        builder, tests = Builder(options), Tests()
        begin = time.monotonic()
        for number, mutant in enumerate(order, 1):
            result, by = outcome(builder, tests, mutant, options)
            place = f"[{number}/{len(order)}] {mutant.header}:{mutant.line}"
            lines.append({"header": mutant.header, "line": mutant.line, "column": mutant.key[2], "before": mutant.before,
                          "after": mutant.after, "text": mutant.text.strip(), "result": result, "by": by})
            with results.open("a") as file:
                file.write(json.dumps(lines[-1], ensure_ascii=False) + "\n")
            left = (time.monotonic() - begin) / number * (len(order) - number)
            print(f"{place} '{mutant.before.strip()}' to '{mutant.after.strip()}': {result}{' by ' + by if by else ''} "
                  f"({left / 60:.0f} min left)", flush=True)
        shutil.rmtree(builder.folder)
    print(table(lines))


if __name__ == "__main__":
    main()

"""Examples from outside: what they print, write and are made of.

python3 check.py experiment PROGRAM FOLDER
python3 check.py rooted PROGRAM FOLDER SOURCE COMPILER [flag...]
python3 check.py names NM LINKED=COMPILED...
python3 check.py optimised NM LIBRARY FAST_OBJECT... -- OTHER_OBJECT...
python3 check.py windows EMULATOR FOLDER EXAMPLES DECODE STREAM [PROGRAM]
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import time


def emptied(folder):
    shutil.rmtree(folder, ignore_errors=True)
    pathlib.Path(folder).mkdir(parents=True)
    return pathlib.Path(folder)


def run(folder, *command):
    done = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        sys.exit(f"Expected status 0 of {command}, found {done.returncode}")
    return done.stdout


def expect(text, *patterns):
    for pattern in patterns:
        if not re.search(pattern, text):
            sys.exit(f"Expected '{pattern}', found: {text}")


def experiment(program, folder):
    """The example of your own networks and sizes, as its header says."""
    folder = emptied(folder)
    run(folder, program, "simulate", "--out", "touches", "--per-class", "10")
    table = run(folder, program, "study", "--data", "touches", "--results", "study", "--splits", "1", "--recipes", "default")
    rows = ("small_pooling +7 × 13", "small_pooling +11 × 20", "small_striding +9 × 16", "svm-rbf +9 × 16")
    expect(table, *(row + ".* ± " for row in rows))
    rows = ("small_pooling .* 7 × 13", "small_pooling .* 11 × 20", "small_striding .* 9 × 16")
    expect((folder / "study/study.md").read_text(), *(row + " .[ 0-9]+.[ 0-9]+.\n" for row in rows))  # with their bytes
    expect(
        run(folder, program, "recommend", "--results", "study", "--rows", "9", "--columns", "16"),
        r"experiment::small_(pooling|striding)<tactnet::shape{(9, 16|7, 13)}, 22>\n$",
    )


def windows(emulator, folder, examples, decode, stream, program=None):
    """What differs there: names with spaces, backslashes and, by the library UCRT, umlauts; bytes that text would change (the end of a
    file, of a line); no colours; files that are there, or that another program holds open."""
    ucrt = b"api-ms-win-crt" in pathlib.Path(decode).read_bytes()
    name = "Messung am 3. März" if ucrt else "Messung am 3. Mai"
    place = emptied(folder) / name
    place.mkdir()
    os.environ.update(WINEDEBUG="-all", LANG="C.UTF-8")

    starter = [emulator] if emulator else []

    def windows_run(*words, status=0, given=None):
        done = subprocess.run([*starter, *words], cwd=folder, input=given, capture_output=True, check=False)
        if done.returncode != status or b"\x1b" in done.stdout + done.stderr or b"\r" in done.stdout:
            sys.exit(f"Expected status {status} of {words}, no colours and lines as elsewhere, found {done.returncode}: "
                     f"{done.stdout[-500:]} {done.stderr[-500:]}")
        return (done.stdout + done.stderr).decode()

    frame = [26, 13, 10, 0, 255, 10]
    (place / "a frame.pgm").write_bytes(b"P5 3 2 255\n" + bytes(frame))
    expect(windows_run(decode, "--csv", name + "\\a frame.pgm"), r"frame,1,.*\n26,13,10\n0,255,10\n")
    expect(windows_run(decode, name + "\\none.pgm", status=2), re.escape(name))

    pliers = re.search(r"\{([\d,\s]+)\}", (pathlib.Path(examples) / "recognise/pliers.hpp").read_text())[1]
    counts = bytes(int(count) for count in pliers.split(",") if count.strip())
    weights = place / "simulated weights.safetensors"
    shutil.copy(pathlib.Path(examples) / "recognise/simulated.safetensors", weights)
    weights_name = f"{name}\\{weights.name}"
    lines = windows_run(stream, weights_name, given=3 * counts).splitlines()
    if [line.split()[1] for line in lines[:3]] != 3 * ["pliers"]:
        sys.exit(f"Expected pliers in three frames, found: {lines}")

    if not program:
        print("The program tactnet was left out: it needs JPEG and PNG for Windows")
        return
    images = name + "\\simulated images"
    windows_run(program, "simulate", "--out", images, "--per-class", "5")
    windows_run(program, "check", "--data", images)
    some = sorted(path for path in (place / "simulated images").rglob("*.png") if path.name.endswith(("0.png", "1.png")))
    found = windows_run(program, "classify", "--weights", weights_name, "--resize", *(str(path.relative_to(folder)).replace("/", "\\") for path in some))
    right = sum(row.split(",")[2] == path.parent.name for row, path in zip(found.splitlines(), some))
    if 2 * right < len(some):
        sys.exit(f"Expected at least half of {len(some)} images recognised, found {right}: {found}")
    own = name + "\\own.safetensors"
    train = [program, "train", "--data", images, "--method", "tactnet4", "--rows", "14", "--columns", "25", "--resize", "--epochs", "2",
             "--augmentation", "none", "--output", own]
    windows_run(*train)
    before = (place / "own.safetensors").read_bytes()
    windows_run(*train)  # replaces what is there, with the same bytes
    expect(windows_run(program, "evaluate", "--weights", own, "--data", images, "--resize"), "accuracy|Accuracy")
    windows_run(program, "export", "--weights", own, "--output", name + "\\own.hpp")
    (place / "other.hpp").write_bytes(b"replaced")
    windows_run(program, "export", "--weights", own, "--output", name + "\\other.hpp")
    if (place / "own.hpp").read_bytes() != (place / "other.hpp").read_bytes() or (place / "own.safetensors").read_bytes() != before:
        sys.exit("Expected the same weights and the same header twice")

    held = place / "held.hpp"  # another program writes it
    with subprocess.Popen([*starter, "cmd", "/c", "ping -n 8 127.0.0.1 >held.hpp"], cwd=place, stderr=subprocess.DEVNULL):
        until = time.monotonic() + 60
        while not held.exists() and time.monotonic() < until:
            time.sleep(0.1)
        files = sorted(place.iterdir())
        expect(windows_run(program, "export", "--weights", own, "--output", name + "\\held.hpp", status=2), r"held\.hpp: expected to write")
        if sorted(place.iterdir()) != files:
            sys.exit(f"Expected no other file beside the one that is open, found {sorted(place.iterdir())}")


def rooted(program, folder, source, compiler, *flags):
    """A network of your own with roots and a softmax, through the program in 8 bits: trained, reported in both formats, and exported as a
    header that gives the same bits."""
    folder, data = emptied(folder), ["--data", "touches"]
    run(folder, program, "simulate", "--out", "touches", "--per-class", "10")
    sizes = "--method roots --rows 7 --columns 13 --resize --epochs 12 --output float.safetensors".split()
    run(folder, program, "train", *data, *sizes)
    for to in ("bytes.safetensors", "roots.hpp"):
        written = f"--weights float.safetensors --bits 8 --resize --namespace rooted --output {to}".split()
        run(folder, program, "export", *data, *written)
    image = min(folder.glob("touches/*/*"))
    # Two files, one class and nearly one probability: which it would not be of a softmax that is taken twice.
    classes, shares = set(), []
    for form in ("float", "bytes"):
        answer = run(folder, program, "classify", "--weights", f"{form}.safetensors", "--resize", image)
        found = re.search(r"[^,]+,([0-9]+,[^,]*),(0\.[0-9]{3})[0-9]*\n", answer)
        if not found:
            sys.exit(f"Expected a class and a probability, found: {answer}")
        classes.add(found[1])
        shares.append(float(found[2]))
        run(folder, program, "evaluate", "--weights", f"{form}.safetensors", *data, "--resize")
    print(f"{classes}: {shares[0]} in single precision, {shares[1]} in 8 bits")
    if len(classes) != 1 or abs(shares[0] - shares[1]) > 0.015:
        sys.exit("Expected one class and nearly one probability of both forms")
    if shares[0] < 0.15:
        sys.exit("Expected a probability that a softmax taken twice could not give")
    run(folder, compiler, "-std=c++20", "-O1", "-fno-exceptions", "-fno-rtti", f"-I{folder}", *flags, source, "-o", "firmware")
    run(folder, folder / "firmware")


def names(nm, *units):
    """Units for different instruction sets in one program: as compiled, they share no name of the library; as linked, each shows one name
    and no more, so that neither do they share what templates of the standard library became."""

    def names_of(file):
        return [line.split()[0] for line in run(None, nm, "--defined-only", "--extern-only", "--format=posix", file).splitlines()]

    seen = set()
    for unit in filter(None, units):
        linked, compiled = unit.split("=")
        shown, own = names_of(linked), {name for name in names_of(compiled) if "tactnet" in name}
        if len(shown) != 1 or not re.fullmatch("recogniser_[a-z0-9]+", shown[0]):
            sys.exit(f"{linked}: expected one name, recogniser_..., found {shown}")
        if not own:
            sys.exit(f"{compiled}: expected names of the library, found none: this would prove nothing")
        if seen & own:
            sys.exit(f"{compiled}: another unit has {seen & own} too")
        seen |= own
    if len(list(filter(None, units))) < 2:
        sys.exit(f"expected several units, found {units}")


def optimised(nm, library, *objects):
    """No object of the program that is compiled quickly defines a kernel."""
    split = objects.index("--")
    fast, others = {pathlib.Path(one).name for one in objects[:split]}, objects[split + 1:]
    one, with_kernels = "", set()
    for line in run(None, nm, "--defined-only", library, *others).splitlines():
        if line.endswith(":"):
            one = line[:-1]
        elif re.search(" [TtWw] .*7kernels", line):
            with_kernels.add(one)
    if not with_kernels & fast:
        sys.exit(f"Expected kernels in one of {fast}, found none: this test looks in the wrong place.")
    if with_kernels - fast:
        sys.exit(f"Expected kernels in optimised objects only, found some in {with_kernels - fast}: move its sources in "
                 "examples/tactnet/CMakeLists.txt to tactnet_program_methods.")


CHECKS = {check.__name__: check for check in (experiment, rooted, names, optimised, windows)}

if __name__ == "__main__":
    CHECKS[sys.argv[1]](*sys.argv[2:])

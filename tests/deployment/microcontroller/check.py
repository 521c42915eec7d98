"""What a deployed network takes of a microcontroller: TactNet-4 for 14 × 25 tactels in single precision and in 8 bits, on every processor of
examples/embedded/firmware. Fails if 8 bits take more than 24 kB of flash or 16 kB of RAM with the stack, if a program holds a heap or
exceptions, if a self-test fails, if the table on the page is another one, or if what Clang makes takes more than 1.2 times the instructions of
GCC's.

python3 check.py COMPILER EMULATOR CLANG RISCV INCLUDE HEADERS FOLDER PAGE [--write]      HEADERS as write_headers.cpp writes them

With --write the table takes the place of the one on the page. Without an emulator only flash and static RAM are checked. RISCV is a compiler
for RISC-V; without one, that row stays as it is.
"""

import os
import pathlib
import re
import subprocess
import sys

compiler, emulator, clang, riscv, include, headers, folder, page = sys.argv[1:9]
if compiler == "-":
    print("skipped: there is no arm-none-eabi-g++ (Debian: gcc-arm-none-eabi, libstdc++-arm-none-eabi-newlib)")
    sys.exit(77)
HERE, page = pathlib.Path(__file__).parent, pathlib.Path(page)
FIRMWARE = HERE.parents[2] / "examples/embedded/firmware"
# The instructions from one tick of a board's timer to the next, one a nanosecond of its clock.
TICKS = {"cortex-m0plus": 62.5, "cortex-m3": 40, "cortex-m4": 40, "cortex-m7": 40, "cortex-m33": 50, "cortex-m55": 31.25, "rv32imc_zicsr": 1}
FORBIDDEN = r" (_?(?:malloc|free|sbrk)(?:_r)?|_Z(?:nw|na|dl)\w*|__cxa_throw|abort)$"
BEGIN, END = "<!-- microcontroller -->\n", "<!-- microcontroller ends -->"
WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]


def output(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout


def number(pattern, text):
    found = re.search(pattern, text)
    if not found:
        sys.exit(f"microcontroller: expected '{pattern}', found:\n{text}")
    return int(found[1])


def for_clang(target):
    """How Clang is called for a target of the GNU compiler: with that one's libraries."""
    told = subprocess.run([compiler, *target, "-E", "-v", "-x", "c++", "/dev/null"], capture_output=True, text=True, check=True).stderr
    folders = re.search("#include <...> search starts here:\n(.*?)End of search list", told, re.S)[1].split()
    return ["--target=arm-none-eabi", *(word for word in target if word != "-mfpu=auto"),
            *(f"-isystem{folder}" for folder in folders if not re.search("/lib/gcc/[^/]*/[^/]*/include", folder))]


def build(source, processor, level, form, *more, by=None):
    """Bytes of flash and of RAM with the stack, and the instructions of a frame. Stack and instructions are 0 without an emulator. `by` is
    another compiler than the GNU one, which links."""
    gnu = riscv if processor.startswith("rv") else compiler
    program = f"{folder}/{form}_{processor}{level}{'_clang' if by else ''}"
    options = [level, *WARNINGS, f'-DTEST_HEADER="{form}.hpp"', f"-I{headers}", f"-I{include}"]
    options += ["-DTEST_SAME_BITS"] if form == "eight_bit" else []

    def compile_to(result, *defines):
        compiled = [f"{HERE}/{source}.cpp", *options, *defines]
        if by:
            target = for_clang(output(FIRMWARE, "flags", processor).split())
            subprocess.run([by, "-std=c++20", "-fno-exceptions", "-fno-rtti", "-ffunction-sections", "-DNDEBUG", *target, *compiled,
                            f"-I{FIRMWARE.parent}", "-c", "-o", f"{result}.o"], check=True)
            compiled = [f"{result}.o", *defines]
        subprocess.run([FIRMWARE, "build", processor, result, *compiled, *more], check=True, env={**os.environ, "CXX": gnu})

    compile_to(f"{program}.elf")  # without what counts, which no product has
    text, data, bss = map(int, output(re.sub(r"g\+\+([^/]*)$", r"size\1", gnu), f"{program}.elf").splitlines()[1].split()[:3])
    if found := re.findall(FORBIDDEN, output(re.sub(r"g\+\+([^/]*)$", r"nm\1", gnu), f"{program}.elf"), re.M):
        sys.exit(f"microcontroller: {program}.elf holds {found}: no heap, no exceptions.")
    stack = instructions = 0
    if emulator != "-":
        compile_to(f"{program}_report.elf", "-DSEMIHOSTING")
        found_there = os.environ if processor.startswith("rv") else {**os.environ, "EMULATOR": emulator}
        done = subprocess.run([FIRMWARE, "run", processor, f"{program}_report.elf"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              timeout=60, check=False, env=found_there)
        if done.returncode:
            sys.exit(f"microcontroller: {program}_report.elf ended with {done.returncode} (2: the self-test failed, 3: other bits):\n{done.stdout}")
        stack = number("stack ([0-9]+)\n", done.stdout)
        instructions = int(number("ticks of 20 frames ([0-9]+)\n", done.stdout) * TICKS[processor]) // 20
    print(f"{by or gnu} {processor} {level} {form}: flash {text + data} bytes, static RAM {data + bss}, stack {stack}, instructions of a frame {instructions}")
    return text + data, data + bss + stack, instructions


def expect_at_most(what, flash, ram, found):
    if found[0] > flash or found[1] > ram:
        sys.exit(f"microcontroller: expected at most {flash} bytes of flash and {ram} of RAM {what}, found {found[0]} and {found[1]}.")


def compare_with_page(rows):
    """What stands on the page must be these tables, each number within 5 %: compilers differ, and a table is not written anew for every
    change."""
    text = page.read_text()
    before, begin, rest = text.partition(BEGIN)
    old, end, after = rest.partition(END)
    if not begin or not end:
        sys.exit(f"microcontroller: {page}: expected '{BEGIN}' and '{END}' behind it.")
    there = [dict(re.findall(r"^(\| [\w, +-]+ \|)(.*\n)", each + "\n", re.M)) for each in old.split("\n\n")]
    table = "\n".join(f"| TactNet-4 14 × 25, {form} | flash, kB | RAM, kB | thousand instructions |\n|---|---|---|---|\n" +
                      "".join(what + (row or known.get(what, "\n")) for what, row in of_form.items())
                      for (form, of_form), known in zip(rows.items(), [*there, {}]))
    if "--write" in sys.argv:
        page.write_text(before + begin + table + end + after)
        return
    cell = r"(?<=\| )[0-9][0-9 .]*(?= \|)"
    if re.sub(cell, "", old) != re.sub(cell, "", table):
        sys.exit(f"microcontroller: {page} has another table; the target microcontroller_table writes it:\n{table}")
    for one, other in zip(re.findall(cell, old), re.findall(cell, table)):
        was, now = (float(value.replace(" ", "")) for value in (one, other))
        if abs(was - now) > was / 20 + (0.1 if "." in one else 1):  # and a unit of the last place
            sys.exit(f"microcontroller: {page} says {one} where {other} was found; the target microcontroller_table writes the table.")


if __name__ == "__main__":
    pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
    rows = {"8 bits": {}, "single precision": {}}
    for processor in TICKS:
        title = f"| {processor.title().replace('Plus', '+') if processor.startswith('cortex') else 'RISC-V, RV32IMC'} |"
        for of_form in rows.values():
            of_form[title] = ""
        if processor.startswith("rv") and riscv == "-":
            print("RISC-V is left out: there is no riscv64-unknown-elf-g++ with a C++ library (Debian 13: libstdc++-riscv64-unknown-elf-picolibc)")
            continue
        forms = {form: build("firmware", processor, "-O2", form) for form in ("eight_bit", "single_precision")}
        if processor in ("cortex-m4", "cortex-m7", "cortex-m55"):
            expect_at_most(f"in 8 bits on {processor}", 24000, 16000, build("firmware", processor, "-Os", "eight_bit"))
        for of_form, (form, (flash, ram, instructions)) in zip(rows.values(), forms.items()):
            of_form[title] = f" {flash / 1000:.1f} | {ram / 1000:.1f} | {f'{(instructions + 500) // 1000:,}'.replace(',', ' ')} |\n"
            if processor in ("cortex-m7", "cortex-m55") and clang != "-" and emulator != "-":
                other = build("firmware", processor, "-O2", form, by=clang)
                if other[2] > 1.2 * instructions:
                    sys.exit(f"microcontroller: {clang} makes {other[2]} instructions of {form} on {processor}, {compiler} {instructions}: expected at most 1.2 times")
    # A GRU of 16 units for 3 features, frame by frame.
    for form in ("stream", "stream_eight_bit"):
        expect_at_most("for a stream", 16000, 8000, build("stream", "cortex-m7", "-Os", form))
    # All that decides in the control loop without a network, for 28 × 50 tactels.
    expect_at_most("for decisions", 32000, 24000, build("decisions", "cortex-m7", "-Os", "decisions_expected", "-Wl,--defsym=ram_bytes=65536"))
    build("decisions", "cortex-m7", "-O2", "decisions_expected", "-Wl,--defsym=ram_bytes=65536")
    if emulator != "-":
        compare_with_page(rows)

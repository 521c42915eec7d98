"""What a deployed network takes of a microcontroller: TactNet-4 for 14 × 25 tactels in single precision and in 8 bits, on Cortex-M7, M4 and
M55. Fails if 8 bits take more than 24 kB of flash or 16 kB of RAM with the stack, if a program holds a heap or exceptions, if a
self-test fails, if the table on the page is another one, or if what Clang makes takes more than 1.2 times the instructions of GCC's.

python3 check.py COMPILER EMULATOR CLANG INCLUDE HEADERS FOLDER PAGE [--write]      HEADERS as write_headers.cpp writes them

With --write the table takes the place of the one on the page. Without an emulator only flash and static RAM are checked.
"""

import pathlib
import re
import subprocess
import sys

compiler, emulator, clang, include, headers, folder, page = sys.argv[1:8]
if compiler == "-":
    print("skipped: there is no arm-none-eabi-g++ (Debian: gcc-arm-none-eabi, libstdc++-arm-none-eabi-newlib)")
    sys.exit(77)
HERE, page = pathlib.Path(__file__).parent, pathlib.Path(page)
UNITS = {"cortex-m7": ["-mfpu=fpv5-sp-d16"], "cortex-m4": ["-mfpu=fpv4-sp-d16"], "cortex-m55": []}
# The board, the nanoseconds from one tick of its timer to the next, and where its flash and its RAM begin.
BOARDS = {"cortex-m7": ("mps2-an500", 40, 0, 0x20000000), "cortex-m4": ("mps2-an386", 40, 0, 0x20000000),
          "cortex-m55": ("mps3-an547", 31.25, 0x10000000, 0x30000000)}
FORBIDDEN = r" (_?(?:malloc|free|sbrk)(?:_r)?|_Z(?:nw|na|dl)\w*|__cxa_throw|abort)$"
BEGIN, END = "<!-- microcontroller -->\n", "<!-- microcontroller ends -->"


def output(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout


def tool(name):
    return re.sub(r"g\+\+([^/]*)$", name + r"\1", compiler)


def number(pattern, text):
    found = re.search(pattern, text)
    if not found:
        sys.exit(f"microcontroller: expected '{pattern}', found:\n{text}")
    return int(found[1])


def for_clang(target):
    """How Clang is called for a target of the GNU compiler: with that one's libraries."""
    told = subprocess.run([compiler, *target, "-E", "-v", "-x", "c++", "/dev/null"], capture_output=True, text=True, check=True).stderr
    folders = re.search("#include <...> search starts here:\n(.*?)End of search list", told, re.S)[1].split()
    return ["--target=arm-none-eabi", *(f"-isystem{folder}" for folder in folders if not re.search("/lib/gcc/[^/]*/[^/]*/include", folder))]


def build(source, processor, level, form, ram=None, by=None):
    """Bytes of flash and of RAM with the stack, and the instructions of a frame. Stack and instructions are 0 without an emulator. `by` is
    another compiler than the GNU one, which links."""
    board, tick, flash_begins, ram_begins = BOARDS[processor]
    target = ["-mthumb", f"-mcpu={processor}", *(UNITS[processor] or ([] if by else ["-mfpu=auto"])), "-mfloat-abi=hard"]
    options = ["-std=c++20", level, *target, "-fno-exceptions",
               "-fno-rtti", "-ffunction-sections", "-fdata-sections", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror",
               f'-DTEST_HEADER="{form}.hpp"', "-DNDEBUG", f"-I{headers}", f"-I{include}"]
    link = ["-nostartfiles", "-Wl,--gc-sections", f"-T{HERE}/firmware.ld", f"-Wl,--defsym=flash_begins={flash_begins}",
            f"-Wl,--defsym=ram_begins={ram_begins}", *([f"-Wl,--defsym=ram_bytes={ram}"] if ram else [])]
    options += ["-DTEST_SAME_BITS"] if form == "eight_bit" else []
    program = f"{folder}/{form}_{processor}{level}{'_clang' if by else ''}"

    def compile_to(result, *more):
        if not by:
            subprocess.run([compiler, *options, *more, *link, f"{HERE}/{source}.cpp", "-o", result], check=True)
            return
        subprocess.run([by, *options, *more, *for_clang(target), "-c", f"{HERE}/{source}.cpp", "-o", f"{result}.o"], check=True)
        subprocess.run([compiler, *target, *link, f"{result}.o", "-o", result], check=True, stderr=subprocess.DEVNULL)

    compile_to(f"{program}.elf")  # without what counts, which no product has
    text, data, bss = map(int, output(tool("size"), f"{program}.elf").splitlines()[1].split()[:3])
    if found := re.findall(FORBIDDEN, output(tool("nm"), f"{program}.elf"), re.M):
        sys.exit(f"microcontroller: {program}.elf holds {found}: no heap, no exceptions.")
    stack = instructions = 0
    if emulator != "-":
        compile_to(f"{program}_report.elf", "-DTEST_REPORT")
        # One nanosecond of the emulated clock an instruction; the timer ticks once in some tens of them.
        machine = f"-M {board} -nographic -monitor none -serial none -icount shift=0 -semihosting-config enable=on,target=native"
        done = subprocess.run([emulator, *machine.split(), "-kernel", f"{program}_report.elf"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, timeout=60, check=False)
        if done.returncode:
            sys.exit(f"microcontroller: {program}_report.elf ended with {done.returncode} (2: the self-test failed, 3: other bits):\n{done.stdout}")
        stack = number("stack ([0-9]+)\n", done.stdout)
        instructions = int(number("ticks of 20 frames ([0-9]+)\n", done.stdout) * tick) // 20
    print(f"{by or compiler} {processor} {level} {form}: flash {text + data} bytes, static RAM {data + bss}, stack {stack}, instructions of a frame {instructions}")
    return text + data, data + bss + stack, instructions


def expect_at_most(what, flash, ram, found):
    if found[0] > flash or found[1] > ram:
        sys.exit(f"microcontroller: expected at most {flash} bytes of flash and {ram} of RAM {what}, found {found[0]} and {found[1]}.")


def compare_with_page(table):
    """What stands on the page must be this table, each number within 5 %: compilers differ, and a table is not written anew for every
    change."""
    text = page.read_text()
    before, begin, rest = text.partition(BEGIN)
    old, end, after = rest.partition(END)
    if not begin or not end:
        sys.exit(f"microcontroller: {page}: expected '{BEGIN}' and '{END}' behind it.")
    if "--write" in sys.argv:
        page.write_text(before + begin + table + end + after)
        return
    cells = r"\| ([0-9.]+) \| ([0-9.]+) \|"
    if re.sub(cells, "| |", old) != re.sub(cells, "| |", table):
        sys.exit(f"microcontroller: {page} has another table; the target microcontroller_table writes it.")
    for was, now in zip(re.findall(cells, old), re.findall(cells, table)):
        for one, other in zip(was, now):
            least = 0.1 if "." in one else 1  # a unit of the last place
            if abs(float(one) - float(other)) > float(one) / 20 + least:
                sys.exit(f"microcontroller: {page} says {one} where {other} was found; the target microcontroller_table writes the table.")


pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
table = "| TactNet-4, 14 × 25 | | single precision | 8 bits |\n|---|---|---|---|\n"
for processor in UNITS:
    for level in ("-Os", "-O2"):
        one, eight = (build("firmware", processor, level, form) for form in ("single_precision", "eight_bit"))
        if level == "-Os":
            expect_at_most(f"in 8 bits on {processor}", 24000, 16000, eight)

        def row(what, place, scale, digits):
            return f"| {what} | " + " | ".join(f"{(form[place] + scale // 2) // scale / 10**digits:.{digits}f}" for form in (one, eight)) + " |\n"

        if level == "-O2" and processor != "cortex-m4" and clang != "-" and emulator != "-":
            for form, gnu in (("single_precision", one), ("eight_bit", eight)):
                other = build("firmware", processor, level, form, by=clang)
                if other[2] > 1.2 * gnu[2]:
                    sys.exit(f"microcontroller: {clang} makes {other[2]} instructions of {form} on {processor}, {compiler} {gnu[2]}: expected at most 1.2 times")
        table += row(f"{processor.title()}, `{level}` | flash, kB", 0, 100, 1)
        table += row("| RAM with the stack, kB", 1, 100, 1) + row("| thousands of instructions per frame", 2, 1000, 0)
# A GRU of 16 units for 3 features, frame by frame.
for form in ("stream", "stream_eight_bit"):
    expect_at_most("for a stream", 16000, 8000, build("stream", "cortex-m7", "-Os", form))
# All that decides in the control loop without a network, for 28 × 50 tactels.
expect_at_most("for decisions", 32000, 24000, build("decisions", "cortex-m7", "-Os", "decisions_expected", 65536))
build("decisions", "cortex-m7", "-O2", "decisions_expected", 65536)
print(table)
if emulator != "-":
    compare_with_page(table)

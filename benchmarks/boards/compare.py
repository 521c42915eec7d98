#!/usr/bin/env python3
"""Instructions per frame of exported networks and of CMSIS-NN on the same networks, each compiled with examples/embedded/firmware and run in
QEMU. Both check their logits before they are counted.

python3 compare.py COMPILER EMULATOR CMSIS_NN INCLUDE NETWORKS FOLDER

CMSIS_NN is a copy of https://github.com/ARM-software/CMSIS-NN, NETWORKS the folder that benchmark_boards wrote. The frame is given to CMSIS-NN in
the type of its first layer, and its weights in the layout of fewer instructions; tactnet takes counts and converts them itself.
"""

import os
import pathlib
import re
import subprocess
import sys

compiler, emulator, cmsis_nn, include, networks, folder = sys.argv[1:7]
ROOT = pathlib.Path(__file__).parents[2]
COSTS = ROOT / "tests/deployment/microcontroller"
FIRMWARE = ROOT / "examples/embedded/firmware"
SOURCES = [str(file) for room in ("Convolution", "FullyConnected", "NNSupport", "Pooling")
           for file in sorted(pathlib.Path(cmsis_nn, "Source", f"{room}Functions").resolve().glob("*.c")) if re.search("s8|s16|f32", file.name)]
TICKS = {"cortex-m7": 40, "cortex-m4": 40, "cortex-m55": 31.25}  # instructions from one tick of the board's timer to the next
# GCC 12's vaddq(vector, number) does not take an unsigned number, as in these.
UNSIGNED = "#ifdef ARM_MATH_MVEF\n#include <arm_mve.h>\n#undef vaddq\n#define vaddq(a, b) vaddq_n_u32(a, b)\n#endif\n"
known = {**os.environ, "CXX": compiler, "EMULATOR": emulator}


def instructions(processor, name, *sources):
    """Of a frame."""
    program = pathlib.Path(folder, f"{name}_{processor}.elf")
    subprocess.run([FIRMWARE, "build", processor, program, *sources, "-DSEMIHOSTING", f"-I{COSTS}", "-fconstexpr-ops-limit=1000000000",
                    "-Wl,--defsym=flash_bytes=524288", "-Wl,--defsym=ram_bytes=262144"], check=True, env=known)
    done = subprocess.run([FIRMWARE, "run", processor, program], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, env=known)
    if done.returncode:
        sys.exit(f"compare: {program} ended with {done.returncode} (2: a call failed, 3: wrong logits):\n{done.stdout}")
    return int(re.search("ticks of 20 frames ([0-9]+)", done.stdout)[1]) * TICKS[processor] / 20


def thousands(number):
    return f"{number / 1000:,.0f}".replace(",", " ")


print("Thousand instructions per frame:\n\n| network | processor | tactnet | CMSIS-NN | ratio |\n|---|---|---|---|---|")
for processor in TICKS:
    objects = pathlib.Path(folder, processor)
    objects.mkdir(parents=True, exist_ok=True)
    target = subprocess.run([FIRMWARE, "flags", processor], stdout=subprocess.PIPE, text=True, check=True).stdout.split()
    theirs = ["-DARM_NN_ENABLE_F32=1", f"-I{cmsis_nn}/Include"]
    (objects / "unsigned.h").write_text(UNSIGNED)
    for adds in (True, False):
        sources = [source for source in SOURCES if adds == ("vaddq(offsets, (uint32_t)" in pathlib.Path(source).read_text())]
        subprocess.run([re.sub(r"g\+\+([^/]*)$", r"gcc\1", compiler), "-O2", *target, "-ffunction-sections", "-fdata-sections", *theirs, "-c", *sources,
                        *(["-include", "arm_nn_math_types.h", "-include", "unsigned.h", "-I."] if adds else [])], check=True, cwd=objects)
    for network in ("tactnet4", "tactnet6"):
        for form in ("eight_bit", "single_precision"):
            name = f"{network}_{form}"
            own = instructions(processor, name, COSTS / "firmware.cpp", f"-I{include}", f'-DTEST_HEADER="{networks}/{name}.hpp"',
                               *(["-DTEST_SAME_BITS"] if form == "eight_bit" else []))
            peer = min(instructions(processor, f"{name}{packed}_cmsis_nn", pathlib.Path(__file__).with_name("cmsis_nn.cpp"), *theirs,
                                    *map(str, objects.glob("*.o")), f"-DBYTES={int(form == 'eight_bit')}",
                                    f'-DTEST_TABLES="{networks}/{name}{packed}_tables.hpp"')
                       for packed in (("", "_packed") if form == "single_precision" else ("",)))
            print(f"| {network.title().replace('net', 'Net-')} {form.replace('_', ' ')} | {processor.title()} | {thousands(own)} | {thousands(peer)} "
                  f"| {peer / own:.2f} |", flush=True)

"""A deployed frame runs without dispatch: no call or jump in its object code goes where a register or a place in memory says, and nothing
outside the object is called but what copies and clears memory: no heap, no lock, no operating system.

python3 check.py OBJDUMP NM FRAMES_OBJECT DISPATCHES_OBJECT COUNT_OF_FRAMES
"""

import re
import subprocess
import sys

# Calls and jumps by register or memory, as x86 and 64-bit ARM have them.
INDIRECT = r".*[ \t](?:(?:call|jmp)q?[ \t]+\*|(?:blr|br|blraa|braa)[ \t]+x[0-9]).*"
# Copying and clearing memory; what a call that must not throw refers to in case it did.
HARMLESS = r"(memcpy|memmove|memset|(DW\.ref\.)?__gxx_personality_v0|_ZSt9terminatev|__cxa_begin_catch|_GLOBAL_OFFSET_TABLE_)$"

objdump, nm, frames, dispatches, count = sys.argv[1:]


def output(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def examine(file):
    """Lines that dispatch, and names that are called outside."""
    lines = re.findall(INDIRECT, output(objdump, "--disassemble", "--no-show-raw-insn", file))
    names = [line.split()[0] for line in output(nm, "--undefined-only", "--format=posix", file).splitlines()]
    return lines, [name for name in names if not re.match(HARMLESS, name)]


lines, names = examine(dispatches)  # what would be found
for found in (lines, [name for name in names if name.startswith("_Znw")], [name for name in names if "mutex_lock" in name]):
    if not found:
        sys.exit(f"{dispatches}: a virtual call, a heap or a lock was not found among {names}: this would prove nothing")
functions = re.findall(r"frame_of_\S* T ", output(nm, "--defined-only", "--extern-only", "--format=posix", frames))
if len(functions) != int(count):
    sys.exit(f"{frames}: expected {count} frames, found {functions}")
lines, names = examine(frames)
if lines or names:
    sys.exit("\n".join([f"{frames}: calls or jumps by register or memory, or out of the object: {names}", *lines]))
print(f"{count} frames without dispatch, and without a call to anything else")

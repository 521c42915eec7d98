"""Builds firmware.cpp without exceptions and run-time type information, sees what it asks of the system, and runs it.

python3 check.py COMPILER PROGRAM_TO_WRITE [--headers FOLDER] [--emulator PROGRAM] [--nm PROGRAM] -- [flag...]
"""

import argparse
import pathlib
import re
import subprocess
import sys

split = sys.argv.index("--")
parser = argparse.ArgumentParser()
parser.add_argument("compiler")
parser.add_argument("program")
parser.add_argument("--headers")
parser.add_argument("--emulator", default="")
parser.add_argument("--nm")
options = parser.parse_args(sys.argv[1:split])
# Include folders come after everything else, or the headers of this machine would stand before those of another that is built for.
flags = [re.sub("^-I", "-idirafter", flag) for flag in sys.argv[split + 1:]]
own = [flag for flag in flags if not flag.startswith("-idirafter")]
common = "-std=c++20 -O2 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -fno-exceptions -fno-rtti".split()
source = pathlib.Path(__file__).parent / "firmware.cpp"
unit, list_of_headers = options.program + ".o", pathlib.Path(options.program + ".d")
subprocess.run([options.compiler, *common, *flags, f"-I{options.headers}", "-MD", "-MF", list_of_headers, "-c", source, "-o", unit], check=True)

# What an output means is a header that needs nothing else of its room.
included = list_of_headers.read_text().replace("tactnet/networks/recognition.hpp", "")
for name in ("/iostream", "/fstream", "/filesystem", "/Eigen/", "operators/[a-z_]+/layer", "operators/layer", "tactnet/networks", "tactnet/io"):
    if re.search(name, included):
        sys.exit(f"The header brings in {name}, which a target without files may not have.")

if options.nm:
    needs = subprocess.run([options.nm, "-u", unit], capture_output=True, text=True, check=True).stdout
    if found := re.findall(" (?:__cxa_|_Znw|_Zna|_Zdl|malloc|free|f?open|_ZSt[0-9]*__throw).*", needs):
        sys.exit(f"The program needs {found}: no heap, no exceptions, no files. All it needs:\n{needs}")

# Linked statically where it runs in an emulator, which then needs no libraries of that machine.
link = ["-static"] if options.emulator else []
subprocess.run([options.compiler, *own, *link, unit, "-o", options.program], check=True)
status = subprocess.run([*options.emulator.split(), options.program], check=False).returncode
if status:
    sys.exit(f"The program ended with {status}; firmware.cpp says what that means.")

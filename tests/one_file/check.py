"""The one-file forms of the library.

python3 check.py redirect FOLDER FILE…     for each header that a file holds, a file of its name that includes the whole
python3 check.py same_bytes AMALGAMATE FOLDER      the same sources give the same bytes
"""

import pathlib
import re
import shutil
import subprocess
import sys


def redirect(folder, *files):
    shutil.rmtree(folder, ignore_errors=True)
    for file in files:
        headers = re.findall("^// ---- (tactnet/.*)$", pathlib.Path(file).read_text(), re.M)
        if not headers:
            sys.exit(f"{file}: expected headers, found none")
        # Two units of every program, first.cpp and second.cpp, include everything by the last name.
        for path in (pathlib.Path(folder, header) for header in [*headers, "one_file.hpp"]):
            path.parent.mkdir(parents=True, exist_ok=True)
            before = path.read_text() if path.exists() else "#pragma once\n"
            path.write_text(f'{before}#include "{file}"\n')


def same_bytes(script, folder):
    for time in ("once", "twice"):
        subprocess.run([sys.executable, script, "--out", f"{folder}/{time}"], check=True)
    for name in ("tactnet.hpp", "tactnet_sensors.hpp"):
        text = pathlib.Path(folder, "once", name).read_text()
        if text != pathlib.Path(folder, "twice", name).read_text():
            sys.exit(f"{name}: expected the same bytes from the same sources, found others")
        head = "\n".join(text.splitlines()[:12])
        if not re.search(r"tactnet [0-9]+\.[0-9]+\.[0-9]+.*MIT License", head, re.S):
            sys.exit(f"{name}: expected version and licence; found {head}")
        if "cannot be mixed" not in text.partition("// ---- ")[0]:
            sys.exit(f"{name}: expected a refusal of headers of include/ before the first header, found none")
    for umbrella in sorted(pathlib.Path(script).parent.parent.glob("include/tactnet/*.hpp")):
        subprocess.run([sys.executable, script, f"tactnet/{umbrella.name}", "--out", f"{folder}/once/of_{umbrella.name}"], check=True)
    for file in sorted(pathlib.Path(folder, "once").glob("*.hpp")):
        # A line that needs a second file would stop a reader who pastes it.
        if own := re.findall(r'^ *# *include +[<"]tactnet/.*', file.read_text(), re.M):
            sys.exit(f"{file}: expected no header of its own beside it; found {own}")
    nowhere = subprocess.run([sys.executable, script, "tactnet/nowhere.hpp", "--out", f"{folder}/nowhere.hpp"], capture_output=True, text=True,
                             check=False)
    if not nowhere.returncode or "found no 'tactnet/nowhere.hpp'" not in nowhere.stderr:
        sys.exit(f"a header that there is not: expected a refusal, found {nowhere.returncode}: {nowhere.stderr}")


if __name__ == "__main__":
    {check.__name__: check for check in (redirect, same_bytes)}[sys.argv[1]](*sys.argv[2:])

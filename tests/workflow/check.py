"""The workflow file of the public forge: it can be read, names presets that there are, and may change nothing.

python3 check.py SOURCE_FOLDER; the exit status 77 says that there is no YAML reader (python3-yaml).
"""

import json
import pathlib
import subprocess
import sys

try:
    import yaml
except ImportError:
    sys.exit(77)

root = pathlib.Path(sys.argv[1])
workflow = yaml.safe_load((root / ".github/workflows/ci.yml").read_text())
presets = {preset["name"] for preset in json.loads((root / "CMakePresets.json").read_text())["testPresets"]}
listed = subprocess.run([sys.executable, root / "scripts/matrix", "--list"], capture_output=True, text=True, check=True)
cells = [line.partition(":")[0] for line in listed.stdout.splitlines()]
problems = []

# What is allowed is said, and it is to read.
if workflow.get("permissions") != {"contents": "read"}:
    problems.append(f"expected permissions to read contents alone, found {workflow.get('permissions')}")
if "schedule" not in workflow[True]:  # YAML takes the key `on` for a truth value
    problems.append("expected a weekly run, found no schedule")

named = set()
for name, job in workflow["jobs"].items():
    if "permissions" in job:
        problems.append(f"job {name}: expected no permissions of its own, found {job['permissions']}")
    if job.get("container") != "debian:12":
        problems.append(f"job {name}: expected the container debian:12, found {job.get('container')}")
    matrix = job.get("strategy", {}).get("matrix", {}).get("preset", [])
    runs = [step["run"] for step in job["steps"] if "run" in step]
    for command in runs:
        words = command.split()
        if words[0] != ".ci/run":
            continue
        asked = command.removeprefix(".ci/run").strip() or "default"
        named |= set(matrix) if asked == "${{ matrix.preset }}" else {asked}
    if not any(
        command.startswith((".ci/run", "scripts/lint", "scripts/matrix", "cmake --build build --target site ")) for command in runs
    ):
        problems.append(f"job {name}: expected a step .ci/run, scripts/lint, scripts/matrix or the site, found {runs}")
    for entry in job.get("strategy", {}).get("matrix", {}).get("include", []):
        if not any(entry["cells"] in cell for cell in cells):
            problems.append(f"job {name}: expected a part of a cell's name in scripts/matrix, found '{entry['cells']}'")
if "reference" not in workflow["jobs"]:
    problems.append("expected a job that makes the site with the reference, found none")
for preset in sorted(named - presets):
    problems.append(f"expected a preset of CMakePresets.json, found '{preset}'")
for preset in sorted({"default", "clang", "no-simd", "sanitize"} - named):
    problems.append(f"expected a run of the preset {preset}, found none")

print("\n".join(problems) or f"{len(named)} presets, all there")
sys.exit(1 if problems else 0)

"""What the project's own tools name is there.

python3 check.py SOURCE_FOLDER paths      scripts, workflow, presets, recipes and Python programs name files, folders and presets
                                          that there are, and each cell of scripts/matrix finds its sources
python3 check.py SOURCE_FOLDER            the workflow file of the public forge can be read, names presets that there are, and may
                                          change nothing; the exit status 77 says that there is no YAML reader (python3-yaml)
"""

import fnmatch
import json
import pathlib
import re
import subprocess
import sys

root = pathlib.Path(sys.argv[1])


def missing_in(text, folders, presets):
    """What a text names and is not there: paths that begin with a folder of the project, and presets."""
    begin = "|".join(map(re.escape, folders))
    for path in re.findall(rf"(?<![\w./$}}{{>@-])(?:{begin})/[\w.*/+-]*", text):
        path = path.rstrip("./")
        # A star also stands for folders, as it does to git.
        inside = (file.relative_to(root).as_posix() for file in (root / path.partition("/")[0]).rglob("*")) if "*" in path else ()
        if not any(root.glob(path)) and not any(fnmatch.fnmatch(file, path) for file in inside):
            yield f"there is no {path}"
    for preset in re.findall(r"(?:--preset |scripts/test |\.ci/run )([a-z][\w-]*)", text):
        if preset not in presets:
            yield f"there is no preset {preset}"


def check_paths():
    folders = [path.name for path in root.iterdir() if path.is_dir() and not re.match(r"build|output|\.git$", path.name)]
    configured = json.loads((root / "CMakePresets.json").read_text())["configurePresets"]
    presets = {preset["name"] for preset in configured} | {"full"}
    named = [root / "CMakePresets.json", root / "conanfile.py", root / "README.md", root / "CONTRIBUTING.md"]
    for folder in ("scripts", ".ci", ".github", "packaging"):
        named += (path for path in (root / folder).rglob("*") if path.is_file() and "boards" not in path.parts)  # which name what they make
    for folder in ("docs", "examples", "benchmarks"):
        for pattern in ("*.py", "*.sh", "make"):
            named += (root / folder).rglob(pattern)
    problems = []
    for path in named:
        problems += (f"{path.relative_to(root)}: {missing}" for missing in missing_in(path.read_text(), folders, presets))
    for path in sorted((root / "docs").rglob("*.md")):  # pages name paths of the user's as well: presets alone
        problems += (f"{path.relative_to(root)}: {missing}" for missing in missing_in(path.read_text(), ["\0"], presets))
    listed = subprocess.run([sys.executable, root / "scripts/matrix", "--list"], capture_output=True, text=True, check=False)
    if listed.returncode:
        problems.append(listed.stderr)
    # A check of the check.
    wrong = "cat tests/gone/x.cpp scripts/g*ne .ci/run; cmake --preset gone"
    found = list(missing_in(wrong, folders, presets))
    if found != ["there is no tests/gone/x.cpp", "there is no scripts/g*ne", "there is no preset gone"]:
        problems.append(f"check.py does not find what is missing in '{wrong}': {found}")
    print("\n".join(problems) or f"{len(named)} files name what is there")
    sys.exit(1 if problems else 0)


if sys.argv[2:] == ["paths"]:
    check_paths()

try:
    import yaml
except ImportError:
    sys.exit(77)

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
    container = {"debian": "debian:${{ matrix.suite }}", "untried": None}.get(name, "debian:12")
    if job.get("container") != container:
        problems.append(f"job {name}: expected the container {container}, found {job.get('container')}")
    if container is None and not job.get("continue-on-error"):
        problems.append(f"job {name}: expected a job that may fail, since nobody has seen it pass")
    matrix = job.get("strategy", {}).get("matrix", {}).get("preset", [])
    runs = [step["run"] for step in job["steps"] if "run" in step]
    for command in runs:
        words = command.split()
        if words[0] != ".ci/run":
            continue
        asked = command.removeprefix(".ci/run").strip() or "default"
        named |= set(matrix) if asked == "${{ matrix.preset }}" else {asked}
    if not any(
        command.startswith((".ci/run", "scripts/test", "brew install", "scripts/lint", "scripts/matrix", "cmake --build build --target reference")) for command in runs
    ):
        problems.append(f"job {name}: expected a step .ci/run, scripts/lint, scripts/matrix or the reference, found {runs}")
    for entry in job.get("strategy", {}).get("matrix", {}).get("include", []):
        if not any(entry["cells"] in cell for cell in cells):
            problems.append(f"job {name}: expected a part of a cell's name in scripts/matrix, found '{entry['cells']}'")
if "reference" not in workflow["jobs"]:
    problems.append("expected a job that makes the reference, found none")
for preset in sorted(named - presets):
    problems.append(f"expected a preset of CMakePresets.json, found '{preset}'")
for preset in sorted({"default", "clang", "no-simd", "sanitize"} - named):
    problems.append(f"expected a run of the preset {preset}, found none")

print("\n".join(problems) or f"{len(named)} presets, all there")
sys.exit(1 if problems else 0)

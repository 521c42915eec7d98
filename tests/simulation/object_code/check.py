"""An effect that is not in a scene's list has no trace in the object code: including its header changes no symbol and no size. One that is
listed is there, which shows that the check can see it.

python3 check.py COMPILER NM FOLDER [flag...]
"""

import pathlib
import subprocess
import sys

EFFECTS = {"gain_map": "film/response", "hysteresis": "film/time", "resistive_network": "circuit/resistive_network", "noise": "circuit/conversion"}

compiler, nm, folder, *flags = sys.argv[1:]


def symbols(name, *more):
    """Name, size and kind of each symbol of the compiled scene, without the address."""
    target = pathlib.Path(folder, f"{name}.o")
    target.parent.mkdir(parents=True, exist_ok=True)
    source = pathlib.Path(__file__).parent / "touch.cpp"
    subprocess.run([compiler, "-std=c++20", "-O2", "-c", *flags, *more, source, "-o", target], check=True)
    lines = subprocess.run([nm, "-S", "--defined-only", target], capture_output=True, text=True, check=True).stdout.splitlines()
    print(f"{name}: {target.stat().st_size} bytes")
    return "\n".join(line.partition(" ")[2] for line in lines)


without = symbols("without")
for effect, header in EFFECTS.items():
    include = f"-DTACTNET_TEST_HEADER=<tactnet/simulation/effects/{header}.hpp>"
    included, listed = symbols(f"{effect}/included", include), symbols(f"{effect}/listed", include, f"-DTACTNET_TEST_EFFECT={effect},")
    if not without or effect in without:
        sys.exit(f"The scene without {effect} has these symbols:\n{without}")
    if included != without:
        sys.exit(f"Including {header}.hpp changes the object code:\n{included}\nWithout it:\n{without}")
    if effect not in listed:
        sys.exit(f"The scene with {effect} has no symbol of it:\n{listed}")

"""Rules of the source tree: which room may include which, what tests are called.

python3 check.py includes|names SOURCE_FOLDER
python3 check.py self_check SOURCE_FOLDER                 each mistake in wrong.txt is found
"""

import pathlib
import re
import sys
import tempfile

# What each room may include, apart from itself, detail and the version.
ROOMS = {
    "detail": "",
    "version": "",
    "tensor": "",
    "text": "",
    "runtime": "tensor",
    "kernels": "runtime tensor",
    "lowering": "kernels runtime tensor",
    "operators": "lowering kernels runtime tensor",
    "networks": "operators lowering kernels runtime tensor",
    "deployment": "text networks operators lowering kernels runtime tensor",
    "quantisation": "text deployment networks operators lowering kernels runtime tensor",
    "decision": "networks operators lowering kernels runtime tensor",
    "training": "text image networks operators lowering kernels runtime tensor",
    "image": "kernels runtime tensor",
    "transfer": "io text deployment image networks operators lowering kernels runtime tensor",
    "svm": "text kernels runtime tensor",
    "features": "text kernels runtime tensor",
    "io": "text kernels runtime tensor",  # io/model_file.hpp and others take a network as a template argument and include none
    "sensors": "io text tensor",
    "eigen": "text tensor sensors svm",
    "simulation": "sensors text image kernels runtime tensor",
    # The core umbrella: a user of inference never pays for training.
    "tactnet": "tensor operators lowering networks deployment",
}
# What some headers may include in addition.
HEADERS = {
    "io.hpp": "networks",  # what loading a model computes
    "io/model_file.hpp": "networks",  # it is the file of a networks/model.hpp
    "io/model_description.hpp": "networks lowering",  # which temperatures and input functions there are
    "io/svm_file.hpp": "svm",
    "io/deployed_file.hpp": "deployment networks",
    "io/eight_bit_file.hpp": "deployment networks",
    "io/eight_bit_file.hpp": "deployment",
}
# Of some rooms only these headers.
ONLY = {
    ("sensors", "io"): "file_error read_file safetensors/json_scanner",  # what needs nothing but the standard library, as sensors must work without any other
    ("eigen", "sensors"): "frame",  # what has frames and rows in it, which needs nothing but tensors
    ("eigen", "svm"): "feature_rows",
    ("simulation", "sensors"): "tekscan_6077",  # what sensors there are, not what they send
}
# What the folders of kernels/ may include of each other; "" stands for headers next to the folders. What a deployed network runs includes
# nothing that only trainings need.
KERNELS = {"arch": "", "simd": "arch", "batch": "simd", "integer": "arch simd", "map": "simd", "panels": "simd", "frame": "arch panels simd", "rows": "arch panels simd", "": "simd"}
# What the files of operators/ may include of each other, by their names: a layer nothing that is deployed, a step nothing that is trained.
# All other files are shared: what activation functions and cells compute.
OPERATORS = {
    "layer": "layer shared",
    "training": "training layer shared",
    "lowering": "lowering layer step shared",
    "step": "step shared",
    "eight_bit": "eight_bit reference step shared",
    "reference": "reference eight_bit step shared",
    "shared": "shared",
}
OPERATOR_KINDS = {"trained_layer": "training"}
# The list of the folders of operators/, which its umbrellas read.
FOLDERS = "operators/folders.hpp"
TESTED_OPERATORS = "tests/operators/list.hpp"
# Folders that only these and they themselves include: a simulation of your own objects does not pay for the paper's 22 classes.
CLOSED = {"simulation/paper": "simulation.hpp"}
# What only kernels/ may know.
KERNEL_HEADERS = r"xsimd/|(immintrin|x86intrin|arm_acle|arm_mve|arm_neon|arm_sve|wasm_simd128)\.h$"
# What may include Eigen, apart from the room eigen: programs that include none of it need no Eigen.
EIGEN_USERS = "simulation/effects/circuit/resistive_network.hpp"
# What the standard library leaves to the system: files that are safe on disk, an interrupt from the keyboard.
SYSTEM_HEADERS = r"(unistd|fcntl|io|windows)\.h$|sys/[a-z]+\.h$"


def room_of(header):
    """A room is a folder; an umbrella <room>.hpp next to the folders belongs to the room."""
    return header.partition("/")[0].removesuffix(".hpp")


def operator_kind(header):
    """What a file of operators/ is for, by its name."""
    name = pathlib.PurePosixPath(header).stem
    return OPERATOR_KINDS.get(name, name if name in OPERATORS else "shared")


def include_problem(header, included):
    """What is wrong with an include of a header, or nothing."""
    room = room_of(header)
    if included.startswith("tactnet/"):
        named = included.removeprefix("tactnet/")
        target = room_of(named)
        if target not in ROOMS:
            return f"<{included}> is in no room"
        allowed = f"{ROOMS[room]} {HEADERS.get(header, '')} {room} detail version".split()
        part = re.sub(r"^[a-z_]+/|\.hpp$", "", named)
        if target not in allowed or (room, target) in ONLY and part not in ONLY[room, target].split():
            return f"room '{room}' may not include <{included}>"
        if room == "kernels" and named.count("/") > 1:
            folder = header.split("/")[1] if header.count("/") > 1 else ""
            if named.split("/")[1] not in [folder, *KERNELS.get(folder, "").split()]:
                return f"'{'/'.join(['kernels', folder]).rstrip('/')}' may not include <{included}>"
        if header.startswith("operators/"):
            kind = operator_kind(header)
            if named.startswith("operators/") and operator_kind(named) not in OPERATORS[kind].split():
                return f"a file of operators/ with this name may not include <{included}>"
            if named.startswith("kernels/batch/") and kind != "training":
                return f"only training.hpp may include <{included}>"
        for closed, users in CLOSED.items():
            if named.startswith(closed + "/") and not header.startswith(closed + "/") and header not in users.split():
                return f"only {closed}/ and {users} may include <{included}>"
    elif re.match(KERNEL_HEADERS, included):
        if room != "kernels":
            return f"only kernels/ may include <{included}>"
    elif re.match("(Eigen|unsupported)/", included):
        if room != "eigen" and header not in EIGEN_USERS.split():
            return f"only eigen/ and {EIGEN_USERS} may include <{included}>"
    elif re.search("[./]", included) and not re.match(SYSTEM_HEADERS, included):
        return f"<{included}> is neither the library's nor the standard's, nor Eigen or xsimd"
    return None


def check_includes(root):
    """The arrows between the library's rooms point one way."""
    folder, purposes = root / "include/tactnet", {}
    headers = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())
    for header in headers:
        if room_of(header) not in ROOMS:
            yield f"{header}: there is no room '{room_of(header)}'; give it its place in tests/layering/check.py"
            continue
        text = (folder / header).read_text()
        if not re.search(r"^#pragma once$", text, re.M) and header != FOLDERS:
            yield f"{header}: has no '#pragma once'"
        if re.match(r"#pragma once\n+(//.*\n)+\n+#include", text):
            yield f"{header}: has its comment in front of its includes, not behind them"
        for number, line in enumerate(text.splitlines(), 1):
            place = f"{header}:{number}"
            if re.match(r" *namespace tactnet", line) and not line.startswith("namespace tactnet { inline namespace TACTNET_ARCH {"):
                yield f"{place}: opens namespace tactnet without 'inline namespace TACTNET_ARCH {{' behind it"
            elif re.match(r' *# *include +"', line):
                yield f"{place}: public headers include by angle brackets, found {line}"
            elif found := re.match(r" *# *include +<([^>]*)>", line):
                if problem := include_problem(header, found[1]):
                    yield f"{place}: {problem}"
            elif found := re.search(r"(random_purpose|effect_purpose) ([a-z_]+){([0-9]+)}", line):
                # Two purposes with one number would draw the same numbers.
                first = purposes.setdefault((found[1], found[3]), place)
                if first != place:
                    yield f"{place}: the number of {found[2]} is that of {first}"
    # An operator that the list leaves out would be no part of the library, and one that the list of tests leaves out would not be tested.
    def listed(file, pattern):
        return re.findall(pattern, file.read_text() if file.exists() else "", re.M)

    included = {name: macro for macro, name in listed(folder / FOLDERS, r"^#include (TACTNET_FILE_\w+)\((\w+)\)$")}
    tested = set(listed(root / TESTED_OPERATORS, r'^ *example<"(\w+)"'))
    operators = {header.split("/")[1] for header in headers if re.fullmatch(r"operators/[a-z_]+/layer\.hpp", header)}
    for name in sorted(operators | included.keys() | tested):
        macro = "TACTNET_FILE_OF" if f"operators/{name}/eight_bit.hpp" in headers else "TACTNET_FILE_WITHOUT_STEP"
        if name not in operators:
            yield f"operators/{name}: there is no layer.hpp, but it is listed"
        elif included.get(name) != macro:
            yield f"{FOLDERS}: expected #include {macro}({name})"
        if name in operators and name not in tested:
            yield f'{TESTED_OPERATORS}: expected an example<"{name}", …>'
    references = (folder / "operators/reference.hpp").read_text() if (folder / "operators/reference.hpp").exists() else ""
    for header in headers:
        if re.fullmatch(r"operators/[a-z_]+/reference\.hpp", header) and f"<tactnet/{header}>" not in references:
            yield f"operators/reference.hpp: does not include <tactnet/{header}>"
    if not headers:
        yield f"there are no headers in {folder}"


def mirrors(include, test):
    """Whether a test is called after a header, after one and a topic, or after a folder of headers, or is in a folder called after a header."""
    room, name = test.partition("/")[0], test.removesuffix("_test.cpp")
    if "/" in test.rpartition("/")[0] and (include / f"{test.rpartition('/')[0]}.hpp").exists():
        return True
    while True:
        if (include / f"{name}.hpp").exists() or (include / name).is_dir() or name == f"{room}/{room}" and (include / room).is_dir():
            return True
        name, _, topic = name.rpartition("_")
        if not name or "/" in topic:
            return False


def check_names(root):
    """tests/ mirrors include/, so that the test of a header is easy to find: under its own name, or, of several headers of a folder, under
    the name of the folder: those of io/images/ in io/images_test.cpp, those of io/ itself in io/io_test.cpp. And each test case says first
    what it tests."""
    folder = root / "tests"
    tests = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*_test.cpp"))
    if not tests:
        yield f"there are no tests in {folder}"
    for test in tests:
        # The tests of examples/ mirror that folder. Hard cases are of many headers: their files are topics.
        if not test.startswith(("examples/", "hard_cases/")) and not mirrors(root / "include/tactnet", test):
            yield (f"{test}: tests no header of that name; expected <header>_test.cpp or <header>_<topic>_test.cpp, or a folder of headers in "
                   "place of the header")
        # A room finds its tests by their names, but for those in folders with lists of their own.
        for parent in list((folder / test).relative_to(folder).parents)[:-2]:
            listed = folder / parent / "CMakeLists.txt"
            if listed.exists() and pathlib.Path(test).name not in listed.read_text():
                yield f"{test}: tests/{parent}/CMakeLists.txt does not list it"
        text = (folder / test).read_text()
        if "find_data(" in text and 'test_suite("data")' not in text:
            yield f'{test}: reads data that do not belong to the project; expected * doctest::test_suite("data")'
        for case in re.findall(r'TEST_CASE[A-Z_]*\(\s*"([^"]*)', text):
            if not re.match(r"[A-Za-z_][A-Za-z0-9_:]*: ", case):
                yield f"{test}: expected a test case 'subject: what holds', found '{case}'"
            else:
                subject = case.partition(":")[0].replace("_", "[ _]")
                if re.match(rf"[^:]*: {subject}[a-z ]*: ", case):
                    yield f"{test}: says its subject twice: '{case}'"


def self_check(root):
    """What the checks find in a tree in which each file breaks one rule."""
    here = pathlib.Path(__file__).parent
    with tempfile.TemporaryDirectory() as folder:
        for part in ("==> " + (here / "wrong.txt").read_text().removeprefix("==> ")).split("==> ")[1:]:
            name, _, text = part.partition("\n")
            path = pathlib.Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        yield from expect("includes", check_includes(pathlib.Path(folder)), [
            "image/includes_quoted.hpp:3: ",
            "io/includes_image.hpp:4: room 'io' may not include",
            "io/includes_stranger.hpp:5: <fmt/core.h> is neither",
            "kernels/frame/includes_batch.hpp:4: 'kernels/frame' may not include",
            "kernels/includes_operators.hpp:4: room 'kernels' may not include",
            "operators/comment_first.hpp: has its comment in front",
            "operators/folders.hpp: expected #include TACTNET_FILE_WITHOUT_STEP\\(unlisted\\)",
            'tests/operators/list.hpp: expected an example<"unlisted", …>',
            "operators/dense/step.hpp:3: a file of operators/ with this name may not include",
            "operators/dense/step.hpp:4: only training.hpp may include",
            "operators/includes_unknown.hpp:3: .* no room",
            "operators/other_namespace.hpp:4: opens namespace tactnet without",
            "operators/same_purpose.hpp:9: the number of other is that of operators/same_purpose.hpp:8",
            "sensors/includes_parameters.hpp:4: room 'sensors' may not include",
            "simulation/includes_paper.hpp:3: only simulation/paper/ and simulation.hpp may include",
            "simulation/includes_recording.hpp:3: room 'simulation' may not include",
            "tactnet.hpp:3: room 'tactnet' may not include",
            "tensor/includes_eigen.hpp:5: only eigen/ and simulation/[a-z_/]+.hpp may include <Eigen/Core>",
            "tensor/not_guarded.hpp: has no '#pragma once'",
        ])
        for path in pathlib.Path(folder, "include/tactnet").rglob("*.hpp"):
            path.unlink()
        for name in ("svm/kernel/rbf", "svm/solvers/one", "tensor/shape", "io/images/one"):
            path = pathlib.Path(folder, "include/tactnet", name + ".hpp")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch()
        yield from expect("names", check_names(pathlib.Path(folder)), [
            "svm/kernels_test.cpp: tests no header",
            "svm/solvers/one_test.cpp: .*/solvers/CMakeLists.txt does not list it",
            "tensor/shape_test.cpp: expected a test case .*found 'sizes are multiplied'",
            "tensor/shape_test.cpp: says its subject twice: 'shape: shape: sizes are positive'",
            "tensor/unknown_test.cpp: tests no header",
            "tensor/shape_data_test.cpp: reads data",
            "unknown/unknown_test.cpp: tests no header",
        ])


def expect(check, found, patterns):
    found = list(found)
    for pattern in patterns:
        if not any(re.match(pattern, problem) for problem in found):
            yield f"{check}: expected '{pattern}', found {found}"
    for problem in found:
        if not any(re.match(pattern, problem) for pattern in patterns):
            yield f"{check}: expected nothing like '{problem}'"


CHECKS = {"includes": check_includes, "names": check_names, "self_check": self_check}

if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[1] not in CHECKS:
        sys.exit(__doc__)
    problems = list(CHECKS[sys.argv[1]](pathlib.Path(sys.argv[2])))
    if problems:
        sys.exit("Rules of the rooms and of tests (see docs/contribute/rooms.md):\n" + "\n".join(problems))
    print(f"{sys.argv[1]}: as it should be")

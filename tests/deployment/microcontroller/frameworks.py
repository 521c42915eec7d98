"""The folders that packaging/boards/lay_out makes: each manifest against the rules of its framework, and each example compiled as the
framework would, and run in an emulator with the frame of its header. It must print the label that the firmware of examples/embedded prints.

python3 frameworks.py COMPILER EMULATOR RISCV HEADER FOLDER
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

compiler, emulator, riscv, header, folder = sys.argv[1:6]
if compiler == "-" or emulator == "-":
    print("skipped: there is no arm-none-eabi-g++ or no qemu-system-arm")
    sys.exit(77)
HERE, folder = pathlib.Path(__file__).parent, pathlib.Path(folder)
ROOT = HERE.parents[2]
FIRMWARE = ROOT / "examples/embedded/firmware"
VERSION = ".".join(re.findall(r"define TACTNET_VERSION_\w+ (\d+)", (ROOT / "include/tactnet/version.hpp").read_text())[:3])
URL = "https://github.com/owner/tactnet"


def expect(holds, what):
    if not holds:
        sys.exit(f"frameworks: expected {what}")


def includes_of(place, define=None):
    """The folders of headers that a CMakeLists.txt of ESP-IDF or Zephyr states."""
    script = folder / "stated.cmake"
    script.write_text(f"""{f'set({define} y)' if define else ''}
function(idf_component_register)
    cmake_parse_arguments(PARSE_ARGV 0 stated "" "" "INCLUDE_DIRS;SRCS")
    message("${{stated_INCLUDE_DIRS}}")
endfunction()
function(zephyr_include_directories)
    message("${{ARGV}}")
endfunction()
include("{place}/CMakeLists.txt")
""")
    done = subprocess.run(["cmake", "-P", script], stderr=subprocess.PIPE, text=True, check=True)
    return [place / name for name in done.stderr.split()]


def arduino(library):
    stated = dict(line.split("=", 1) for line in (library / "library.properties").read_text().splitlines())
    fields = ("name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url", "architectures", "includes")
    expect(tuple(stated) == fields and all(stated.values()), f"the fields {fields} in library.properties, found {tuple(stated)}")
    expect(stated["version"] == VERSION and stated["url"] == URL, f"version {VERSION} and {URL} in library.properties")
    expect(stated["category"] in ("Display", "Communication", "Signal Input/Output", "Sensors", "Device Control", "Timing", "Data Storage",
                                  "Data Processing", "Other"), f"a category of Arduino's list, found {stated['category']}")
    expect((library / "src" / stated["includes"]).is_file(), f"src/{stated['includes']}")
    return [library / "src"], sketch(library / "examples/matrix"), ["-std=gnu++20", "-DARDUINO=10819"]


def sketch(place):
    """As the tools make C++ of it: with Arduino's header before it."""
    source, = place.rglob("*.ino")
    made = source.with_suffix(".ino.cpp")
    made.write_text(f'#include <Arduino.h>\n#line 1 "{source}"\n{source.read_text()}')
    return made


def platformio(library):
    stated = json.loads((library / "library.json").read_text())
    expect(re.fullmatch("[a-z0-9]+(-[a-z0-9]+)*", stated["name"]) and len(stated["description"]) <= 255 and stated["version"] == VERSION
           and stated["repository"] == {"type": "git", "url": f"{URL}.git"}, f"name, version {VERSION} and repository in library.json")
    expect(all(re.fullmatch("[a-z0-9]+(-[a-z0-9]+)*", word) for word in stated["keywords"]), "keywords of letters, digits and dashes")
    expect(all((library / "include" / name).is_file() for name in stated["headers"]), f"the headers {stated['headers']} in include/")
    for example in stated["examples"]:
        expect(all((library / example["base"] / file).is_file() for file in example["files"]), f"the files of the example {example['name']}")
    settings = (library / "examples/matrix/platformio.ini").read_text()
    flags = re.search("^build_flags = (.*)$", settings, re.M)[1].split()
    return [library / "include"], sketch(library / "examples/matrix"), [*flags, "-DARDUINO=10819"]


def esp_idf(library):
    text = (library / "idf_component.yml").read_text()
    stated = dict(re.findall(r'^(\w+):(?: "?([^"\n]*)"?)?$', text, re.M))
    expect(set(stated) <= {"version", "description", "url", "repository", "license", "tags", "dependencies", "targets", "maintainers"}
           and (stated["version"], stated["url"]) == (VERSION, URL), f"known fields, version {VERSION} and {URL} in idf_component.yml, found {stated}")
    expect(all(3 <= len(tag) <= 32 for tag in re.findall("^  - (.*)$", text, re.M)), "tags of 3 to 32 characters")
    return includes_of(library), library / "examples/label/main/label.cpp", ["-std=gnu++2b", "-DESP_PLATFORM"]


def zephyr(library):
    stated = (library / "zephyr/module.yml").read_text()
    found = dict(re.findall(r"^ *(?:- )?(\w+): *(.*)$", stated, re.M))
    expect(set(found) == {"name", "build", "cmake", "kconfig", "samples"} and (library / found["kconfig"]).is_file()
           and (library / found["cmake"] / "CMakeLists.txt").is_file() and (library / re.search("- (.*)", stated)[1] / "prj.conf").is_file(),
           f"name, build and samples in module.yml, and the files that it names, found {found}")
    option, = re.findall(r"^config (\w+)$", (library / found["kconfig"]).read_text(), re.M)
    expect(f"CONFIG_{option}=y" in (library / "samples/label/prj.conf").read_text(), f"CONFIG_{option}=y in prj.conf")
    expect(not includes_of(library / found["cmake"]), f"no folder of headers without CONFIG_{option}")
    return includes_of(library / found["cmake"], f"CONFIG_{option}"), library / "samples/label/src/label.cpp", ["-std=c++20"]


def label(processor, name, *sources):
    """What a program prints."""
    program = folder / f"{name}_{processor}"
    known = {**os.environ, "CXX": riscv if processor.startswith("rv") else compiler}
    known |= {} if processor.startswith("rv") else {"EMULATOR": emulator}
    subprocess.run([FIRMWARE, "build", processor, program, *sources, "-Os", "-Wall", "-Wextra", "-Werror", "-DSEMIHOSTING"], check=True, env=known)
    done = subprocess.run([FIRMWARE, "run", processor, program], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=60,
                          check=False, env=known)
    expect(done.returncode == 0 and done.stdout, f"{program} to end with 0 and to print a label, found {done.returncode} and '{done.stdout}'")
    return done.stdout.split()[0]


shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)
shutil.copy(header, folder / "recogniser.hpp")
expected = label("cortex-m3", "firmware", FIRMWARE.parent / "main.cpp", f"-I{folder}", f"-I{ROOT}/include")
expect(expected in ("ball", "bar", "ring", "plane"), f"a class of the header, found {expected}")
# The processors that each meets most.
TARGETS = {arduino: ("cortex-m0plus", "cortex-m4"), platformio: ("cortex-m7",), zephyr: ("cortex-m33", "cortex-m55"),
           esp_idf: ("cortex-m3" if riscv == "-" else "rv32imc_zicsr",)}
if riscv == "-":
    print("ESP-IDF's example is compiled for another processor: there is no riscv64-unknown-elf-g++ with a C++ library")
for repository, file, said in (('a"b/c', header, "expected OWNER/NAME"), ("owner/tactnet", sys.executable, "expected an exported network")):
    refused = subprocess.run([ROOT / "packaging/boards/lay_out", "zephyr", folder / "refused", "--repository", repository, "--header", file],
                             capture_output=True, text=True, check=False)
    expect(refused.returncode == 2 and said in refused.stderr, f"'{said}', found {refused.stderr}")
for check, processors in TARGETS.items():
    library = folder / check.__name__ / "tactnet"
    subprocess.run([ROOT / "packaging/boards/lay_out", check.__name__, library, "--repository", "owner/tactnet", "--header", header], check=True)
    includes, source, flags = check(library)
    expect(all((include / "tactnet/version.hpp").is_file() for include in includes) and includes, f"headers where {check.__name__} looks for them")
    expect((library / "LICENSE").is_file() and "@" not in "".join(file.read_text() for file in library.glob("*.[jpy]*")), "a licence, and no gaps")
    for processor in processors:
        found = label(processor, check.__name__, source, HERE / "frameworks/core.cpp", f"-I{HERE}/frameworks", f"-I{source.parent}",
                      *(f"-I{include}" for include in includes), *flags)
        expect(found == expected, f"the label {expected} of {check.__name__} on {processor}, found {found}")
        print(f"{check.__name__} on {processor}: {found}")

"""How headers respond to the compiler's options.

python3 check.py configuration INCLUDE X86 ARMHF_COMPILER COMPILER...    an older language or compiler gets one sentence, and where there are no vectors
                                 the library does without, and without xsimd, even without TACTNET_NO_SIMD
python3 check.py sources INCLUDE PAGE TO       writes units of each header by itself, of all, and of those that PAGE lists as fit for programs
                                 without exceptions; lists the first, apart those that include xsimd
python3 check.py instruction_sets INCLUDE COMPILER       each macro in the table of instruction sets changes the inline namespace
"""

import os
import pathlib
import re
import subprocess
import sys

WITHOUT_VECTORS = """#include <tactnet/deployment/deployed_view.hpp>
#include <tactnet/networks.hpp>
#if !defined(TACTNET_NO_SIMD) || defined(XSIMD_VERSION_MAJOR)
#error "vectors, where there are none"
#endif
static_assert(tactnet::kernels::lanes<float> == 1 && tactnet::kernels::lanes<double> == 1);
static_assert(tactnet::tactnet4<tactnet::shape{7, 13}, 22>::parameters > 0);
"""


def compiled(include, text, *command):
    """Whether a text compiles, and what the compiler prints."""
    done = subprocess.run([*command, f"-I{include}", "-x", "c++", "-"], input=text, capture_output=True, text=True, check=False,
                          env={**os.environ, "LC_ALL": "C"})
    return done.returncode == 0, done.stdout + done.stderr


def configuration(include, x86, armhf, *compilers):
    for header in ("tactnet", "training", "sensors", "version"):
        for compiler in compilers:
            # The last: a compiler that is too old, though it knows the language.
            for standard in ("c++11", "c++17", "c++20 -U__GNUC__ -D__GNUC__=11 -U__clang_major__ -D__clang_major__=13"):
                fine, output = compiled(include, f"#include <tactnet/{header}.hpp>\nint main() {{}}\n", compiler, *f"-std={standard}".split(), "-fsyntax-only")
                sentence = "tactnet needs C++20: GCC 12, Clang 14 or newer with -std=c++20" in output
                if header == "version" and not fine:
                    sys.exit(f"version.hpp must be read in any language, found with {standard}\n{output}")
                if header != "version" and (fine or not sentence):
                    sys.exit(f"{header}.hpp with {standard}: expected a sentence on C++20, found\n{output}")
                if output.count("error: ") > 2:  # the sentence, and that the compiler stops there
                    sys.exit(f"{header}.hpp with {standard}: the sentence is lost among others:\n{output}")
    cases = [(compiler, "-U__SSE2__") for compiler in compilers if x86 == "ON"]  # as -mno-sse, which no 64-bit system's headers bear
    if armhf != "-":
        cases += [(armhf,), (armhf, "-mfpu=neon")]  # vectors of float, but not of double
    for case in cases:
        fine, output = compiled(include, WITHOUT_VECTORS, *case, "-std=c++20", "-fsyntax-only")
        if not fine:
            sys.exit(f"{case}: expected to do without vectors, found\n{output}")
        print("without vectors:", *case)


def instruction_sets(include, compiler):
    """Units for different instruction sets must not share a name."""
    table = re.search("// The table of names(.*)// Arguments are expanded", (pathlib.Path(include) / "tactnet/detail/config.hpp").read_text(), re.S)
    macros = dict.fromkeys(re.findall(r"__[A-Za-z0-9_]+", table[1]))
    macros["__ARM_FEATURE_SVE_BITS"] = "-D__ARM_FEATURE_SVE=1"
    sets = ["-undef", *(f"-undef -D{macro}=1 {others or ''}" for macro, others in macros.items()), "-undef -D__ARM_FEATURE_MVE=3", "-undef -D__ARM_FEATURE_DOTPROD=1",
            "-undef -D__ARM_FEATURE_MVE=3 -DTACTNET_NO_SIMD", "-undef -D__SSE2__ -DTACTNET_NO_SIMD"]
    names = {}
    for options in [*sets, "-march=x86-64-v3", "-march=x86-64-v3 -DTACTNET_NO_SIMD"]:
        _, output = compiled(include, "#include <tactnet/detail/config.hpp>\nname: TACTNET_ARCH\n", compiler, "-std=c++20", *options.split(), "-E", "-P")
        name = re.search("name: ([a-zA-Z0-9_]+)\n", output)
        if not name:
            sys.exit(f"With '{options}' the namespace's name is no identifier:\n{output}")
        if name[1] in names:
            sys.exit(f"'{options}' gives the name {name[1]}, which '{names[name[1]]}' has")
        names[name[1]] = options
    print(*names)
    if len(names) < 25 or not {"for_avx2fbl", "for_scalar_avx2fbl"} <= names.keys():
        sys.exit("expected a name for each macro in the table of detail/config.hpp, and for_avx2fbl")


def sources(include, page, to):
    to, include = pathlib.Path(to), pathlib.Path(include)

    def write(name, text):  # only what is other than before, or all would be compiled again
        path = to / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists() or path.read_text() != text:
            path.write_text(text)
        return path

    headers = sorted(path.relative_to(include).as_posix() for path in include.rglob("*.hpp"))
    included = {header: set(re.findall("^ *# *include +<([^>]*)>", (include / header).read_text(), re.M)) for header in headers}
    with_xsimd, more = {"xsimd/xsimd.hpp"}, True
    while more:
        more = {header for header in headers if included[header] & with_xsimd} - with_xsimd
        with_xsimd |= more
    for header in headers:
        # The second time it must be guarded.
        path = write("alone/" + header.replace("/", "_").replace(".hpp", ".cpp"), f"#include <{header}>\n" * 2)
        print(f"{'with_xsimd' if header in with_xsimd else 'alone'}={path}")
    write("every_header.hpp", "#pragma once\n" + "".join(f"#include <{header}>\n" for header in headers))
    section = re.search("^## Without exceptions\n(.*?)(?=^## |\\Z)", pathlib.Path(page).read_text(), re.M | re.S)
    listed = [header for row in re.findall("^[|].*", section[1], re.M) for header in re.findall("`(tactnet/[^`]*[.]hpp)`", row)] if section else []
    if len(listed) < 10:
        sys.exit(f"{page}: expected a section 'Without exceptions' with a table of headers, found {listed}")
    write("without_exceptions.cpp", "".join(f"#include <{header}>\n" for header in listed))


if __name__ == "__main__":
    {check.__name__: check for check in (configuration, sources, instruction_sets)}[sys.argv[1]](*sys.argv[2:])

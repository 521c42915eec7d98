"""The package as package managers and pkg-config give it, and its version. Each test ends with 77 where its program is missing.

python3 check.py conan PROGRAM FOLDER [option...]
python3 check.py vcpkg PROGRAM FOLDER VERSION classic|manifest|registry TOOLCHAIN COMPILER GENERATOR
python3 check.py pkg_config PROGRAM FOLDER VERSION PREFIX COMPILER [flag...]
python3 check.py version VERSION
"""

import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tarfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
CONSUMER = ROOT / "packaging/conan/test_package"  # deploys a tiny network and runs


def skip(why):
    print(f"skipped: {why}")
    sys.exit(77)


def run(*command, **options):
    """What a program printed; its text ends the test if it failed."""
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **options)
    if done.returncode:
        sys.exit(f"{shlex.join(map(str, command))} ended with {done.returncode}:\n{done.stdout}")
    return done.stdout


def conan(program, folder, *options):
    """`conan create .`, which ends with the test package."""
    if program == "-":
        skip("no conan on the PATH, and none in TACTNET_CONAN")
    # Under a name of its own, so that a package of the user's stays as it is.
    settings = ["--user", "package_test", "--channel", "local", "-s", "compiler.cppstd=20", "-s", "build_type=Release", *options]
    try:
        output = run(program, "create", ROOT, *settings, "-c", "tools.build:jobs=1", "-c", f"tools.cmake.cmake_layout:test_folder={folder}")
    finally:
        subprocess.run([program, "remove", "tactnet/*@package_test/local", "--confirm"], capture_output=True, check=False)
    for sentence in ("tactnet decodes recordings", "tactnet [0-9.]+ recognises", "tactnet takes Eigen's matrices"):
        if not re.search(sentence, output) and (not options or "recordings" in sentence):
            sys.exit(f"Expected the test package to say '{sentence}', found\n{output}")


def vcpkg(program, folder, version, mode, toolchain, compiler, generator):
    """vcpkg installs the port, and a consumer takes it from there, compiles and runs. classic: `vcpkg install tactnet`; manifest: the
    consumer's vcpkg.json asks for it; registry: sensors alone, from the port that write_registry_port.py makes, with an archive of the
    release that lies among the downloads already."""
    if program == "-":
        skip("no vcpkg on the PATH, and none in TACTNET_VCPKG")
    if not os.path.exists(toolchain):
        skip("no vcpkg.cmake in VCPKG_ROOT, and none in TACTNET_VCPKG_TOOLCHAIN")
    folder = pathlib.Path(folder)
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(CONSUMER, folder / "consumer", ignore=shutil.ignore_patterns("*.py"))
    # What was built before is not taken: the port packages the checkout, of which vcpkg sees no changes.
    options = ["--binarysource=clear", f"--x-install-root={folder}/installed", f"--x-buildtrees-root={folder}/buildtrees",
               f"--x-packages-root={folder}/packages"]
    ports, what, components, programs = ROOT / "packaging/vcpkg", "tactnet", "core;eigen;sensors", ["deploy", "eigen", "sensors"]
    if mode == "manifest":
        (folder / "consumer/vcpkg.json").write_text('{"dependencies": ["tactnet"]}\n')
        what, components, programs = f"--x-manifest-root={folder}/consumer", "core", ["deploy"]
    else:
        options.append("--classic")  # away from a vcpkg.json that may lie above the working folder
    if mode == "registry":
        # The name by which vcpkg_from_github looks for what it would download.
        archive = folder / f"downloads/owner-tactnet-v{version}.tar.gz"
        archive.parent.mkdir()
        with tarfile.open(archive, "w:gz") as release:
            for part in ("CMakeLists.txt", "LICENSE", "cmake", "include"):
                release.add(ROOT / part, f"tactnet-{version}/{part}")
        ports = folder / "ports"
        run(sys.executable, ROOT / "packaging/vcpkg/write_registry_port.py", archive, "owner/tactnet", ports / "tactnet")
        options.append(f"--downloads-root={folder}/downloads")
        what, components, programs = "tactnet[core]", "sensors", ["sensors"]
    output = run(program, "install", what, f"--overlay-ports={ports}", *options, cwd=folder)
    if "post-build check problem" in output:
        sys.exit(f"vcpkg finds fault with the port:\n{output}")
    if "target_link_libraries(main PRIVATE tactnet::tactnet)" not in output:
        sys.exit(f"vcpkg does not tell how to use the port:\n{output}")
    settings = {"CMAKE_TOOLCHAIN_FILE": toolchain, "CMAKE_CXX_COMPILER": compiler, "CMAKE_BUILD_TYPE": "Release", "COMPONENTS": components,
                "VCPKG_MANIFEST_INSTALL": "OFF", "VCPKG_INSTALLED_DIR": folder / "installed", "CMAKE_FIND_USE_PACKAGE_REGISTRY": "OFF"}
    run("cmake", "-S", folder / "consumer", "-B", folder / "build", "-G", generator, *(f"-D{name}={value}" for name, value in settings.items()))
    run("cmake", "--build", folder / "build", "--parallel", "1")
    for name in programs:
        run(folder / f"build/test_{name}")
    # Taken from there, and not from elsewhere on this machine.
    for line in re.findall("^(?:tactnet|xsimd|Eigen3)_DIR:.*", (folder / "build/CMakeCache.txt").read_text(), re.M):
        if f"={folder}/" not in line:
            sys.exit(f"Found elsewhere than where vcpkg has installed it: {line}")


def pkg_config(program, folder, version, prefix, compiler, *flags):
    """A consumer without CMake: what pkg-config says of the installed package is enough to compile, link and run."""
    if program == "-":
        skip("no pkg-config on the PATH, and none in TACTNET_PKG_CONFIG")
    files = list(pathlib.Path(prefix).rglob("*.pc"))
    if len(files) != 4:
        sys.exit(f"Expected four files of pkg-config in {prefix}, found {files}.")
    environment = {**os.environ, "PKG_CONFIG_PATH": f"{files[0].parent}:{os.environ.get('PKG_CONFIG_PATH', '')}"}
    for component in ("sensors", "eigen"):
        name = f"tactnet-{component}"
        known = subprocess.run([program, "--print-errors", "--exists", f"{name} = {version}"], capture_output=True, text=True, env=environment,
                               check=False)
        if found := re.search("Package '?(xsimd|eigen3)'?.*not found", known.stderr):
            skip(f"pkg-config does not know {found[1]} here")
        if known.returncode:
            sys.exit(f"pkg-config does not take {name}: {known.stderr}")
        options = shlex.split(run(program, "--cflags", "--libs", name, env=environment))
        run(compiler, "-std=c++20", *flags, CONSUMER / f"{component}.cpp", *options, "-o", f"{folder}/with_{name}")
        run(f"{folder}/with_{name}")


def version(expected):
    """The places that cannot read the version from the header say the same as it does."""
    port = json.loads((ROOT / "packaging/vcpkg/tactnet/vcpkg.json").read_text())["version"]
    if port != expected:
        sys.exit(f"packaging/vcpkg/tactnet/vcpkg.json: expected version {expected}, found {port}.")
    dated = re.search(rf"\n## \[{re.escape(expected)}\] - (.*)", (ROOT / "CHANGELOG.md").read_text())
    if not dated:
        sys.exit(f"CHANGELOG.md: expected a section '## [{expected}] - DATE', found none.")
    if f"\nversion: {expected}\ndate-released: {dated[1]}\n" not in (ROOT / "CITATION.cff").read_text():
        sys.exit(f"CITATION.cff: expected version {expected}, released on {dated[1]} as in the changelog.")
    if f"\ntactnet/{expected}\n" not in (ROOT / "docs/install.md").read_text():
        sys.exit(f"docs/install.md: expected 'tactnet/{expected}' in the conanfile.txt.")


if __name__ == "__main__":
    {check.__name__: check for check in (conan, vcpkg, pkg_config, version)}[sys.argv[1]](*sys.argv[2:])

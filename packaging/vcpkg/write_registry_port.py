"""Writes the port of a release for a registry: the overlay port of this checkout, with the archive that the forge offers of the release's
tag instead of the checkout. Needed once for each release, when its archive is there:

    python3 packaging/vcpkg/write_registry_port.py v0.3.0.tar.gz <owner>/<name> <registry>/ports/tactnet
"""

import hashlib
import json
import pathlib
import re
import shutil
import sys

if len(sys.argv) != 4 or not re.fullmatch("[^/]+/[^/]+", sys.argv[2]) or not pathlib.Path(sys.argv[1]).exists():
    sys.exit(f"write_registry_port: expected an archive, <owner>/<name> and a folder, found {sys.argv[1:]}\n{__doc__}")
archive, repository, output = pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])
port = pathlib.Path(__file__).parent / "tactnet"
# Without what is said of the overlay in front of it.
_, found, rest = (port / "portfile.cmake").read_text().partition('set(SOURCE_PATH "${CURRENT_PORT_DIR}/../../..")\n')
if not found:
    sys.exit(f"write_registry_port: {port}/portfile.cmake: expected a line that sets SOURCE_PATH, found none.")
output.mkdir(parents=True, exist_ok=True)
(output / "portfile.cmake").write_text(f"""vcpkg_from_github(
    OUT_SOURCE_PATH SOURCE_PATH
    REPO {repository}
    REF "v${{VERSION}}"
    SHA512 {hashlib.sha512(archive.read_bytes()).hexdigest()}
    HEAD_REF main
)
{rest}""")
for file in ("vcpkg.json", "usage"):
    shutil.copy(port / file, output)
version = json.loads((port / "vcpkg.json").read_text())["version"]
print(f"{output}: tactnet {version} of {repository}")

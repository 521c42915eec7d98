"""Makes the reference and reports its warnings as errors; then looks for what a reader of it relies on.

python3 make.py DOXYGEN FOLDER    FOLDER has a Doxyfile and gets html/
python3 make.py FOLDER            looks at the pages alone
"""

import pathlib
import re
import shutil
import subprocess
import sys

# Every type, concept, function and constant needs a sentence; members whose names explain themselves, `bound` of an effect and `layer` of
# a specification, and the room kernels, do not.
UNDOCUMENTED = (r"(Compound (tactnet::kernels|\S*<|\S*::layer::)|of (struct|class|union) |of namespace tactnet::kernels).*is not documented"
                r"|Compound \S*::(bound|layer) is not documented"
                r"|potential recursive class relation")  # of a template that derives from its next lower number
PAGES = {
    "index.html": "structtactnet_1_1shape.html",  # the first page leads to the rooms
    "structtactnet_1_1shape.html": "The size of one sample",
    "classtactnet_1_1kernel__machine.html": "svm/kernel_machine.hpp",  # the header to include
    "examples.html": "own_network/main.cpp",
    "concepttactnet_1_1batch__layer.html": "requires",
}
SEARCHED = ("conv2d", "deploy", "load_model", "kernel_machine", "classify_logits", "any_recording")


def make(doxygen, folder):
    shutil.rmtree(folder / "html", ignore_errors=True)
    subprocess.run([doxygen, folder / "Doxyfile"], check=True)
    if not (folder / "html/index.html").exists() or not (folder / "html/search/all_0.js").exists():
        yield f"expected {folder}/html/index.html with its search, found none"
    for warning in (folder / "warnings.txt").read_text().splitlines():
        if warning and not re.search(UNDOCUMENTED, warning):
            yield warning


def check(html):
    for page, what in PAGES.items():
        if what not in (html / page).read_text():
            yield f"{page}: expected '{what}'"
    for page in html.glob("*.html"):
        found = re.search(r"TACTNET_ARCH::|for_[a-z0-9]+::|tactnet::detail::[a-z_]+ (Struct|Class)", page.read_text())
        if found and not page.name.endswith("_source.html") and "config_8hpp" not in page.name:
            yield f"{page}: a name that should not be there: {found[0]}"
    names = "".join(index.read_text() for index in html.glob("search/all_*.js"))
    for name in SEARCHED:
        if f"['{name}'" not in names:
            yield f"the search does not find {name}"


target = pathlib.Path(sys.argv[-1])
problems = list(make(sys.argv[1], target) if len(sys.argv) == 3 else check(target / "html"))
if problems:
    sys.exit("The reference:\n" + "\n".join(problems))

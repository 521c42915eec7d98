"""The pages: README, CONTRIBUTING, SECURITY, examples/README, benchmarks/README and docs/.

python3 pages.py units SOURCE_FOLDER TO     writes the C++ and the scripts of the pages as files, and lists programs and other units
python3 pages.py links SOURCE_FOLDER        what they link to is there
python3 pages.py fields SOURCE_FOLDER       tables of the fields of a struct name each of them, and no other
python3 pages.py self_check                 each mistake in wrong.txt is found
"""

import pathlib
import re
import sys
import tempfile

ALONE = ("README.md", "CONTRIBUTING.md", "SECURITY.md", "examples/README.md", "benchmarks/README.md")


def pages_of(root):
    documentation = [path for path in (root / "docs").rglob("*.md") if "reference" not in path.parts]
    return sorted([root / name for name in ALONE if (root / name).exists()] + documentation)


def write(path, text):
    """Only what is other than before, or all would be compiled again."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def units(root, to):
    """A block that includes something begins a unit, one that does not continues the unit before it on its page, or gets the core where there
    is none. Scripts name their file in the first line."""
    root, to = pathlib.Path(root), pathlib.Path(to)
    for page in pages_of(root):
        gathered, text = [], page.read_text()
        for block in re.findall("^```cpp\n(.*?)^```", text, re.M | re.S):
            if "#include" in block or not gathered:
                gathered.append("" if "#include" in block else "#include <tactnet/tactnet.hpp>\n")
            gathered[-1] += block
        name = re.sub("[^a-z0-9_]", "_", page.relative_to(root).as_posix().removesuffix(".md").lower())
        for number, unit in enumerate(gathered):
            write(to / f"{name}_{number}.cpp", unit)
            print(f"{'program' if 'int main(' in unit else 'unit'}={to}/{name}_{number}.cpp")
        for script, block in re.findall("^```(?:python|matlab)\n[#%] (\\w+[.]\\w+)\n(.*?)^```", text, re.M | re.S):
            write(to / page.stem / script, block)


def prose(page):
    """The lines of a page, those of blocks of code empty."""
    in_block = False
    for line in page.read_text().splitlines():
        fence = line.startswith("```")
        yield "" if fence or in_block else line
        in_block ^= fence


def broken_links(root):
    pages, anchors, listed, count = pages_of(root), {}, set(), 0
    for page in pages:  # as GitHub names headings
        anchors[page] = known = []
        for number, line in enumerate(prose(page), 1):
            if heading := re.match("#+ +(.*)", line):
                anchor = re.sub(r"\]\([^)]*\)", "", heading[1].lower())
                anchor = re.sub("[^a-z0-9_ -]", "", anchor).strip().replace(" ", "-")
                if anchor in known:
                    yield f"{page.relative_to(root)}:{number}: the heading '#{anchor}' stands there twice"
                known.append(anchor)
    for page in pages:
        for number, line in enumerate(prose(page), 1):
            for link in re.findall(r'(?:\]\(| (?:src|srcset|href)=")([^) "]*)', line):
                if re.match("[a-z]+:", link):
                    continue
                count += 1
                file, _, anchor = link.partition("#")
                target = (page.parent / file).resolve() if file else page.resolve()
                if not target.exists():
                    yield f"{page.relative_to(root)}:{number}: there is no '{file}'"
                elif anchor and anchor not in anchors.get(target, [anchor]):
                    yield f"{page.relative_to(root)}:{number}: '{target.relative_to(root)}' has no heading for '#{anchor}'"
                if page == root / "docs/README.md":
                    listed.add(target)
    for page in pages:
        name = page.relative_to(root).as_posix()
        if name.startswith("docs/") and page not in listed and name != "docs/README.md" and not name.endswith("/study.md"):
            yield f"{name}: docs/README.md does not link to it"
    if not count and not pages:
        yield f"there are no pages in {root}"


def links(root):
    if problems := list(broken_links(pathlib.Path(root).resolve())):
        sys.exit(f"{len(problems)} problems with links:\n" + "\n".join(problems))
    print("all links lead somewhere")


FIELDS = (  # page, header, struct; a table of the page begins with the first field
    ("docs/train/training.md", "include/tactnet/training/recipe.hpp", "recipe"),
    ("docs/train/training.md", "include/tactnet/training/evaluate.hpp", "evaluation"),
)


def fields(root):
    for page, header, struct in FIELDS:
        body = re.search(rf"^struct {struct} {{\n(.*?)^}};", pathlib.Path(root, header).read_text(), re.M | re.S)[1]
        known = re.findall(r"^    [\w:]+(?:<[^;(]*>)? (\w+)(?: = [^;]+|{})?;", body, re.M)
        table = re.search(rf"^\| `{known[0]}` \|.*?\n\n", pathlib.Path(root, page).read_text(), re.M | re.S)
        if not table or re.findall(r"^\| `(\w+)` \|", table[0], re.M) != known:
            sys.exit(f"{page}: expected a table of the fields of {struct}, in their order: {', '.join(known)}")
    print("all fields are in the tables")


def self_check():
    with tempfile.TemporaryDirectory() as folder:
        for part in ("\n" + (pathlib.Path(__file__).parent / "wrong.txt").read_text()).split("\n==> ")[1:]:
            name, _, text = part.partition("\n")
            write(pathlib.Path(folder, name), text + "\n")
        found = list(broken_links(pathlib.Path(folder).resolve()))
    expected = [
        "docs/page.md:5: the heading '#twice' stands there twice",
        "README.md:3: there is no 'docs/nowhere.md'",
        "README.md:4: there is no 'docs/picture.png'",
        "README.md:5: 'docs/page.md' has no heading for '#gone'",
        "README.md:6: 'README.md' has no heading for '#in-a-block'",
        "README.md:8: there is no 'docs/dark.svg'",
        "docs/page.md: docs/README.md does not link to it",
    ]
    if sorted(found) != sorted(expected):
        sys.exit(f"Expected {expected}, found {found}")


if __name__ == "__main__":
    {check.__name__: check for check in (units, links, fields, self_check)}[sys.argv[1]](*sys.argv[2:])

#!/usr/bin/env python3
"""What Doxygen reads of a header, line for line: python3 filter.py HEADER.

- The inline namespace that tells instruction sets apart is left out: nobody writes it.
- A plain comment at the end of a member's line is the member's sentence.
- A member that has no sentence because it is part of what many types have in common (a layer, a step, a decoder)
  gets it from members.txt, where it stands once. Variables that share a declaration come apart.

Lines keep their numbers.
"""

import fnmatch
import re
import sys
from pathlib import Path

OPEN, CLOSE = "inline namespace TACTNET_ARCH {", "} // namespace TACTNET_ARCH"
SCOPE = re.compile(r"^(?:inline\s+)?(namespace|struct|class|union|enum(?:\s+class)?)\b\s*(?:alignas\([^)]*\)\s*)?([\w:]*)")


def read_members(path):
    """Sections `[files types]` of lines `name: sentence`; patterns of several files are joined by commas."""
    sections = []
    for line in path.read_text().splitlines():
        if line.startswith("["):
            files, types = line.strip("[]").split(" ")
            sections.append((files.split(","), types.split(","), {}))
        elif line and not line.startswith("#"):
            name, sentence = line.split(": ", 1)
            for each in name.split(", "):
                sections[-1][2][each] = sentence
    return sections


def without_template(text):
    """A declaration without what stands in front of it: template parameters, constraints, attributes."""
    text = text.strip()
    while True:
        before = text
        if text.startswith("template"):
            depth = 0
            for i, c in enumerate(text):
                if c in "<({[":
                    depth += 1
                elif c in ")}]" or (c == ">" and text[i - 1] not in "-=" and not text[i + 1 : i + 2] == "="):
                    depth -= 1
                    if depth == 0 and c == ">":
                        text = text[i + 1 :].strip()
                        break
        if text.startswith("requires"):
            depth, end = 0, None
            for i, c in enumerate(text):
                depth += (c in "(<{") - (c in ")}" or (c == ">" and text[i - 1] != "-"))
                if depth == 0 and c == ")" and not re.match(r"\s*(&&|\|\|)", text[i + 1 :]):
                    end = i
                    break
            if end is not None:
                text = text[end + 1 :].strip()
        text = re.sub(r"^\[\[\w+(\([^)]*\))?\]\]\s*", "", text)
        if text == before:
            return text


def parts_of(text):
    """At commas that no bracket holds."""
    parts, depth, begin = [], 0, 0
    for i, c in enumerate(text):
        depth += (c in "(<{[") - (c in ")}]" or (c == ">" and text[i - 1] != "-"))
        if c == "," and depth == 0:
            parts.append(text[begin:i])
            begin = i + 1
    return [*parts, text[begin:]]


def assigns(text):
    """Whether a declaration gives a value: what stands in brackets, as a parameter's default, is none."""
    text = re.sub(r"operator\s*(\(\)|[^\s\w(]+)", "", text)
    while (shorter := re.sub(r"\([^()]*\)", "", text)) != text:
        text = shorter
    return re.search(r"(?<![=!<>])=(?!=)", text) is not None


def names_of(text):
    """What a declaration declares."""
    text = without_template(text)
    if found := re.match(r"using\s+(\w+)\s*=", text):
        return [found[1]]
    if found := re.match(r"concept\s+(\w+)", text):
        return [found[1]]
    if re.match(r"(using|static_assert|namespace|public|private|protected)\b", text):
        return []
    if found := SCOPE.match(text):
        return [found[2]] if found[2] else []
    head = re.sub(r"\s*=\s*(default|delete|0)$", "", text)
    if found := re.search(r"\boperator\s*(\(\)|[^\s\w(]+|(?:[\w:<>,\s]+?)\s*[&*]?)\s*\(", head):
        return ["operator " + re.sub(r"<.*", "", found[1]) if found[1][0].isalnum() else "operator" + found[1]]
    depth = 0
    for i, c in enumerate(head):
        if c == "=" and depth == 0 or c == "{" and depth == 0:
            break
        if c == "(" and depth == 0:
            found = re.search(r"(~?\w+)\s*$", head[:i])
            if found and found[1] not in ("decltype", "alignas", "explicit", "noexcept"):
                return [found[1]]
        depth += (c in "(<[") - (c in ")]" or (c == ">" and head[i - 1] != "-"))
    names = []
    for part in parts_of(text):
        bare = re.split(r"=|\{|\[", re.sub(r"<.*?>", "", part), maxsplit=1)[0]
        if found := re.search(r"(\w+)\s*$", bare):
            names.append(found[1])
    return names


class Header:
    def __init__(self, path, sections):
        self.lines = path.read_text().split("\n")
        name = path.as_posix().split("include/tactnet/")[-1]
        self.sections = [s for s in sections if any(fnmatch.fnmatch(name, f) for f in s[0])]

    def sentence(self, scopes, name):
        types = "::".join(s for kind, s in scopes if kind != "namespace")
        for _, patterns, members in self.sections:
            if name in members and any(fnmatch.fnmatch(types, p) for p in patterns):
                return members[name]
        return None

    def filtered(self):
        scopes, braces = [], []  # what is open, and for each open brace whether it is a scope
        declaration, first, skipping, parentheses, continued = "", None, 0, 0, False
        for number, line in enumerate(self.lines):
            if line in (OPEN, CLOSE):
                self.lines[number] = ""
                continue
            if continued or line.lstrip().startswith("#"):
                continued = line.endswith("\\")
                continue
            code = re.sub(r"//.*", "", re.sub(r'"(\\.|[^"\\])*"|\'(\\.|[^\'\\])\'', '""', line))
            if scopes and not skipping:
                self.say_trailing(number, code)
            for c in code:
                if skipping:
                    skipping += (c == "{") - (c == "}")
                    if not skipping:
                        if initialiser:
                            declaration += "}"
                        else:
                            declaration, first = "", None
                    continue
                if c in "()":
                    parentheses += 1 if c == "(" else -1
                if c == "{":
                    head = without_template(declaration)
                    found = SCOPE.match(head)
                    brackets = re.sub(r"->|<=>|<=|>=|<<| [<>] ", "", head)
                    listed = brackets.count("<") > brackets.count(">")  # among template arguments
                    if found and not parentheses and not listed:
                        self.document(first, number, declaration, scopes, False)
                        scopes.append((found[1], found[2]))
                        if found[1].startswith("enum"):
                            scopes.pop()
                            skipping, initialiser = 1, False
                        else:
                            declaration, first = "", None
                    else:
                        # The braces of a value belong to its declaration; those of a function end it.
                        initialiser = (listed or bool(parentheses) or not declaration[-1:].isspace()
                                       or assigns(head) or re.search(r"\brequires(\s*\([^{}()]*\))?$", head.rstrip()))
                        if not initialiser:
                            self.document(first, number, declaration, scopes, False)
                        else:
                            declaration += "{"
                        skipping = 1
                elif c == "}":
                    if scopes:
                        scopes.pop()
                    declaration, first = "", None
                elif c == ";" and not parentheses:
                    self.document(first, number, declaration, scopes, True)
                    declaration, first = "", None
                elif c == ":" and declaration.strip() in ("public", "private", "protected"):
                    declaration, first = "", None
                else:
                    if first is None and not c.isspace():
                        first = number
                    if first is not None:
                        declaration += c
            if first is not None:
                declaration += "\n"
        # A constraint behind a function's parameters, in brackets: Doxygen 1.9 takes it for the body's beginning.
        return re.sub(r"\) (.*)requires ([\w:<>, ]+?)( :|\s*\{)", r") \1requires (\2)\3", "\n".join(self.lines))

    def say_trailing(self, number, code):
        line = self.lines[number]
        if code.rstrip().endswith((";", ",")) and not re.match(r"\s*(return|static_assert|#|using namespace)", code):
            found = re.search(r"(?<=[;,])\s+// (.*)$", line)
            if found and not re.match(r"\s*//", line):
                self.lines[number] = line[: found.start()] + " ///< " + found[1]

    def said_in_header(self, first, last):
        """The sentence that a header has for a declaration, above it or at its end."""
        for line in self.lines[first : last + 1]:
            if "///<" in line:
                return line.split("///<", 1)[1].strip()
        above = []
        for line in reversed(self.lines[:first]):
            if not line.strip().startswith("///") or line.strip().startswith("///<"):
                break
            above.insert(0, line.strip()[3:].strip())
        return " ".join(above) if above else None

    def document(self, first, last, declaration, scopes, whole):
        if first is None or not scopes:
            return
        names = names_of(declaration)
        shared = self.said_in_header(first, last)
        if shared is not None and len(names) < 2:
            return
        said = [shared or self.sentence(scopes, name) for name in names]
        if not any(said):
            return
        line = self.lines[first]
        indent = line[: len(line) - len(line.lstrip())]
        if whole and len(names) > 1:
            parts = parts_of(" ".join(declaration.split()))
            kind = re.match(r"(.*?[\w>*&]\s+)\w+\s*(=|\{|$)", parts[0])
            if kind is None:
                return
            texts = [parts[0]] + [kind[1] + part.strip() for part in parts[1:]]
            above = shared is not None and "///<" not in "".join(self.lines[first : last + 1])
            self.lines[first] = indent + " ".join(
                (f"/** {s} */ " if s and not (above and i == 0) else "") + t.strip() + ";"
                for i, (s, t) in enumerate(zip(said, texts)))
            for number in range(first + 1, last + 1):
                self.lines[number] = ""
        else:
            self.lines[first] = f"{indent}/** {said[0]} */ {line.lstrip()}"


if __name__ == "__main__":
    table = read_members(Path(__file__).with_name("members.txt"))
    sys.stdout.write(Header(Path(sys.argv[1]), table).filtered())

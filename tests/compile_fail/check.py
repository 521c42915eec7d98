"""One case: code that must not compile, the part of a source after #ifdef CASE_name or #elif defined(CASE_name). Its first lines say what
the compiler must print:

  // expect: a regular expression found somewhere in the output, in which braces stand for themselves
  // expect: another; all must be found
  // at-most: 2          errors, so that the sentence is not buried under others; without this line, one
  // characters: 20000   of output at most, for the same reason (optional)

python3 check.py SOURCE CASE PRECOMPILED COMPILER [flag...]
python3 check.py - - PRECOMPILED COMPILER [flag...]         only precompiles what all cases read
"""

import os
import pathlib
import re
import subprocess
import sys

source, case, precompiled, *command = sys.argv[1:]
command.append("-std=c++20")
if source == "-":
    sys.exit(subprocess.run([*command, "-x", "c++-header", precompiled, "-o", precompiled + ".gch"], check=False).returncode)


def fail(text):
    sys.exit(f"{source} {case}: {text}")


head = re.search(rf"^#(?:ifdef CASE_{case}|elif defined\(CASE_{case}\))\n((?://.*\n)*)", pathlib.Path(source).read_text(), re.M)
if not head:
    fail("has no such case.")
said = re.findall("// *(expect|at-most|characters): *(.*)\n", head[1])
patterns = [value for key, value in said if key == "expect"]
limits = {key: int(value) for key, value in said if key != "expect"}
if not patterns:
    fail("says nothing of what is expected: the first line must be '// expect: ...'.")

done = subprocess.run(
    [*command, f"-DCASE_{case}", "-include", precompiled, "-fsyntax-only", source], capture_output=True, text=True, check=False,
    env={**os.environ, "LC_ALL": "C"},  # quotation marks and words as they are written in the cases
)
output = done.stdout + done.stderr
if done.returncode == 0:
    fail("it compiles, but must not.")
# A missing header stops the compiler before it has seen anything of the case.
if done.returncode != 1 or "fatal error:" in output:
    fail(f"the compiler could not do its work ({done.returncode}):\n{output}")
for pattern in patterns:
    if not re.search(re.sub(r"(?<!\\)[{}]", r"\\\g<0>", pattern), output, re.S):
        fail(f"expected the compiler to say\n  {pattern}\nfound\n{output}")
count, at_most = output.count(" error: "), limits.get("at-most", 1)
if count > at_most:
    fail(f"expected at most {at_most} error, found {count}:\n{output}")
if len(output) > limits.get("characters", len(output)):
    fail(f"expected at most {limits['characters']} characters, found {len(output)}:\n{output}")
print(output)

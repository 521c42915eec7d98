"""Units for several instruction sets, and for caches of other sizes.

python3 check.py together PROGRAM ALONE...    a unit finds the same bits alone as in one program with units for other instruction sets:
                                              otherwise it took functions of theirs
python3 check.py caches FIRST SECOND          units that cut their work by caches of other sizes find the same bits
"""

import subprocess
import sys

outputs = [subprocess.run([program], stdout=subprocess.PIPE, text=True, check=True).stdout for program in sys.argv[2:]]
if sys.argv[1] == "together":
    if outputs[0] != "".join(outputs[1:]):
        sys.exit(f"Together the units found\n{outputs[0]}alone they found\n{''.join(outputs[1:])}")
    names = [line.split(" ")[0] for line in outputs[0].splitlines()]
    if len(set(names)) < len(names):  # what was compiled alike would prove nothing
        sys.exit(f"expected units for different instruction sets, found {names}")
else:
    (first, _, first_bits), (second, _, second_bits) = (output.partition(" ") for output in outputs)
    if first == second:
        sys.exit(f"Both programs are for the same caches: {first}")
    if first_bits != second_bits:
        sys.exit(f"{first} found\n{first_bits}{second} found\n{second_bits}")

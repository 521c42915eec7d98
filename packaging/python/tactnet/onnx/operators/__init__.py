"""A file for each family of operators. Each operator has a function that evaluates it (`evaluates`, or a line of EVALUATIONS) and one that
makes layers of it (`imports`; `joins` for one that several branches end in), or a sentence in REFUSED. `install` finds the files by
themselves."""

import importlib
import pkgutil
from typing import Callable, Dict, Tuple

EVALUATIONS: Dict[str, Callable] = {}
IMPORTS: Dict[str, Callable] = {}
JOINS: Dict[str, Callable] = {}
REFUSED: Dict[str, Tuple[str, str]] = {}  # why it is no layer, and the nearest that can be imported


def registers(table):
    def of(*names):
        def add(function):
            table.update((name, function) for name in names)
            return function
        return add
    return of


evaluates, imports, joins = registers(EVALUATIONS), registers(IMPORTS), registers(JOINS)


def install():
    for module in pkgutil.iter_modules(__path__):
        importlib.import_module(f"{__name__}.{module.name}")

"""A file for each family of operators. Each operator has a function that evaluates it (`evaluates`) and one that makes
layers of it (`imports`; `joins` for one that several branches end in). `install` finds the files by themselves."""

import importlib
import pkgutil
from typing import Callable, Dict

EVALUATIONS: Dict[str, Callable] = {}
IMPORTS: Dict[str, Callable] = {}
JOINS: Dict[str, Callable] = {}


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

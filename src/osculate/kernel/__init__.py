"""Ways to make scalar functions fast: one decorator, own maths, tuples in lanes, tables, composition."""

from osculate.kernel.compose import compiled, compose
from osculate.kernel.decorator import kernel
from osculate.kernel.lanes import load, lookup, scratch, store
from osculate.kernel.table import Grid, Tables, hermite, locate, read
from osculate.kernel.tuples import Nothing, axpy, finite_sum, leaves, names, rebuild, select

__all__ = [
    "Grid",
    "Nothing",
    "Tables",
    "axpy",
    "compiled",
    "compose",
    "finite_sum",
    "hermite",
    "kernel",
    "leaves",
    "load",
    "locate",
    "lookup",
    "names",
    "read",
    "rebuild",
    "scratch",
    "select",
    "store",
]

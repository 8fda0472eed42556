"""Fast scalar functions: decorator, maths, random numbers, tuples in lanes, tables, composition."""

from osculate.kernel.compose import compiled, compose
from osculate.kernel.decorator import kernel
from osculate.kernel.lanes import load, lookup, scratch, store
from osculate.kernel.random import normals, uniforms
from osculate.kernel.table import Grid, Tables, hermite, locate, read
from osculate.kernel.tuples import (
    Nothing,
    axpy,
    dot,
    finite_sum,
    leaves,
    names,
    rebuild,
    select,
    transpose,
    zeros,
)

__all__ = [
    "Grid",
    "Nothing",
    "Tables",
    "axpy",
    "compiled",
    "compose",
    "dot",
    "finite_sum",
    "hermite",
    "kernel",
    "leaves",
    "load",
    "locate",
    "lookup",
    "names",
    "normals",
    "read",
    "rebuild",
    "scratch",
    "select",
    "store",
    "transpose",
    "uniforms",
    "zeros",
]

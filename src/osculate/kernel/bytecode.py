"""What a function's bytecode does and reads, whatever its file, line numbers and docstrings are.

Constants are numbered in the order of their use, so that a docstring (a constant that no instruction
loads) has no influence. Global names are collected together with the attributes that are read from them
at once: ``constants.GAIN`` is the read ``("constants", "GAIN")``.
"""

import dis
import sys
from array import array
from collections.abc import Callable, Iterator
from types import CodeType
from typing import Any, NamedTuple

CACHE = dis.opmap["CACHE"]
EXTENDED_ARG = dis.opmap["EXTENDED_ARG"]
IMPORT_NAME = dis.opmap["IMPORT_NAME"]
CONSTANTS = frozenset(dis.hasconst)
GLOBALS = {dis.opmap["LOAD_GLOBAL"]: 1, dis.opmap["LOAD_NAME"]: 0}  # bits before the name's index
ATTRIBUTES = {
    dis.opmap[name]: int(sys.version_info >= (3, 12))
    for name in ("LOAD_ATTR", "LOAD_METHOD")
    if name in dis.opmap
}
BEHAVIOUR = 0xFF  # of the flags: kinds of arguments and of function

Read = tuple[str, ...]


class Anatomy(NamedTuple):
    """A code object taken apart, nested functions included."""

    essence: tuple[Any, ...]  # instructions, constants, names: equal where the behaviour is equal
    reads: tuple[Read, ...]  # global names with the attributes read from them
    imports: tuple[str, ...]  # modules imported when the function runs


def dissect(code: CodeType, constant: Callable[[Any], Any]) -> Anatomy:
    """Take ``code`` apart; ``constant`` gives what stands for a constant in the essence."""
    instructions = list(_instructions(code))
    used = list(dict.fromkeys(arg for op, arg in instructions if op in CONSTANTS))
    order = {index: n for n, index in enumerate(used)}
    flat = array("I")
    for op, arg in instructions:
        flat.append(op)
        flat.append(order[arg] if op in CONSTANTS else arg)
    nested = {
        index: dissect(code.co_consts[index], constant)
        for index in used
        if isinstance(code.co_consts[index], CodeType)
    }
    essence = (
        flat.tobytes(),
        tuple(nested[i].essence if i in nested else constant(code.co_consts[i]) for i in used),
        *_names(code),
    )
    inner = nested.values()
    reads = [*_reads(code, instructions), *(read for part in inner for read in part.reads)]
    imports = [code.co_names[arg] for op, arg in instructions if op == IMPORT_NAME]
    imports += [name for part in inner for name in part.imports]
    return Anatomy(essence, tuple(dict.fromkeys(reads)), tuple(dict.fromkeys(imports)))


def _instructions(code: CodeType) -> Iterator[tuple[int, int]]:
    raw, extended = code.co_code, 0
    for op, low in zip(raw[::2], raw[1::2], strict=True):
        arg = extended << 8 | low
        extended = arg if op == EXTENDED_ARG else 0
        if op not in (EXTENDED_ARG, CACHE):
            yield op, arg


def _names(code: CodeType) -> tuple[Any, ...]:
    """Names and layout that instructions and callers refer to; those of local variables do not matter."""
    flags = code.co_flags & BEHAVIOUR
    arguments = code.co_argcount + code.co_kwonlyargcount
    return (
        code.co_names,
        code.co_varnames[:arguments],
        code.co_freevars,
        code.co_cellvars,
        (code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_nlocals, flags),
        code.co_exceptiontable,
    )


def _reads(code: CodeType, instructions: list[tuple[int, int]]) -> Iterator[Read]:
    read: Read = ()
    for op, arg in instructions:
        if op in ATTRIBUTES and read:
            read += (code.co_names[arg >> ATTRIBUTES[op]],)
            continue
        if read:
            yield read
        read = (code.co_names[arg >> GLOBALS[op]],) if op in GLOBALS else ()

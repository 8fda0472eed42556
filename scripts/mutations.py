"""The changes that `mutants.py` makes: signs, operators, comparisons, numbers, branches."""

import ast
from collections.abc import Iterator

OPERATORS: dict[type, type] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult,
    ast.Lt: ast.GtE, ast.GtE: ast.Lt, ast.Gt: ast.LtE, ast.LtE: ast.Gt, ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq, ast.And: ast.Or, ast.Or: ast.And,
}  # fmt: skip
NAMES = {"min": "max", "max": "min", "sin": "cos", "cos": "sin", "minimum": "maximum"}
FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)


def changes(tree: ast.Module) -> Iterator[tuple[ast.AST, str, object]]:
    """Every single change: a node, its attribute, and the attribute's other value."""
    for node in _code(tree):
        if isinstance(node, (ast.BinOp, ast.BoolOp)) and type(node.op) in OPERATORS:
            yield node, "op", OPERATORS[type(node.op)]()
        elif isinstance(node, ast.Compare) and type(node.ops[0]) in OPERATORS:
            yield node, "ops", [OPERATORS[type(node.ops[0])](), *node.ops[1:]]
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            yield node, "op", ast.UAdd()
        elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
            whole = type(node.value) is int
            yield node, "value", node.value + 1 if whole else 1.5 * node.value + 0.5
        elif isinstance(node, ast.Name) and node.id in NAMES:
            yield node, "id", NAMES[node.id]
        elif isinstance(node, ast.IfExp):
            yield node, "test", ast.UnaryOp(ast.Not(), node.test)
        elif isinstance(node, ast.Call) and getattr(node.func, "id", "") == "select":
            yield node, "args", [node.args[0], node.args[2], node.args[1]]


def count_of(tree: ast.Module) -> int:
    """How many changes a file admits."""
    return len(list(changes(tree)))


def _code(node: ast.AST) -> Iterator[ast.AST]:
    """All nodes that run: no annotations, no decorators, nothing for type checkers."""
    yield node
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list"):
            continue
        for child in value if isinstance(value, list) else [value]:
            checked = isinstance(child, ast.If) and getattr(child.test, "id", "") == "TYPE_CHECKING"
            if isinstance(child, ast.AST) and not checked:
                yield from _code(child)


def mutated(source: str, number: int) -> tuple[str, tuple[int, ...], str]:
    """The source with its change ``number``, where that is, and what was changed, in words.

    Where: the changed line, then the first lines of the functions around it, inside ones first; for what
    runs at import there are none.
    """
    tree = ast.parse(source)
    node, attribute, value = list(changes(tree))[number]
    around = [
        n for n in ast.walk(tree) if isinstance(n, (ast.stmt, ast.Lambda)) and _holds(n, node)
    ]
    innermost = min((n for n in around if isinstance(n, ast.stmt)), key=_height)
    functions = sorted((n for n in around if isinstance(n, FUNCTIONS)), key=_height)
    before = ast.unparse(node)
    setattr(node, attribute, value)
    after, line = ast.unparse(node), ast.unparse(innermost).splitlines()[0]
    lines = (node.lineno, *(_first_line(function) for function in functions))
    return ast.unparse(tree), lines, f"{before} → {after}, in: {line}"


def _holds(outer: ast.AST, inner: ast.AST) -> bool:
    if isinstance(outer, FUNCTIONS):  # a default is evaluated where the function is made
        body = outer.body if isinstance(outer.body, list) else [outer.body]
        return any(inner is node for part in body for node in ast.walk(part))
    return outer.lineno <= inner.lineno <= (outer.end_lineno or outer.lineno)


def _height(node: ast.AST) -> int:
    return (node.end_lineno or node.lineno) - node.lineno


def _first_line(function: ast.AST) -> int:
    """The line that Python calls the first of a function: that of its first decorator."""
    return min([function.lineno, *(d.lineno for d in getattr(function, "decorator_list", []))])

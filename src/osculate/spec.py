"""`Spec`: a validated, immutable description; the same fields in Python and in a scenario file.

Every public object that a user configures (robot, curve, target, controller, ...) is a `Spec`.
Validation is pydantic's; this module only turns its reports into the package's own errors and gives
physical quantities one way to state their unit.
"""

from collections.abc import Iterator, Mapping
from copy import deepcopy
from typing import Any, ClassVar, Self, get_args

import pydantic
from pydantic import BaseModel, ConfigDict, Field

from osculate.errors import (
    InvalidInput,
    InvalidScenario,
    NoSolution,
    OsculateError,
    uncomputable,
)


def quantity(unit: str, meaning: str, **field: Any) -> Any:
    """Declare a field that carries a physical unit.

    Args:
        unit: SI unit as printed to users, for example ``"kg m²"``; ``"1"`` for pure numbers.
        meaning: One line of what the field is.
        **field: Passed to `pydantic.Field` (``default``, ``gt``, ``ge``, ``lt``, ``le``, ...).
    """
    return Field(
        description=f"{meaning} [{unit}]",
        json_schema_extra={"unit": unit},
        **field,
    )


class Spec(BaseModel):
    """Base of every configurable object: frozen, no unknown fields, clear errors.

    Raises:
        InvalidInput: One field is wrong; says which one, its value and what is valid.
        InvalidScenario: Several fields are wrong; lists all of them.
    """

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, arbitrary_types_allowed=True
    )
    kept_when_pickled: ClassVar[tuple[str, ...]] = ()  # cached properties read from elsewhere

    @pydantic.model_validator(mode="before")
    @classmethod
    def _no_truth_value(cls, given: Any) -> Any:
        """``true`` is no 1: refuse it where a number is meant, in lists too."""
        for name, field in cls.model_fields.items() if isinstance(given, dict) else ():
            value = given.get(name)
            if _holds_nameless(value):
                raise InvalidInput(name, value, "must have names of fields, which are texts")
            if _holds_truth(value) and not _mentions(field.annotation, bool):
                raise InvalidInput(name, value, "is no number but a truth value")
        return given

    def __init__(self, **fields: Any) -> None:
        try:
            super().__init__(**fields)
        except pydantic.ValidationError as error:
            raise explain(error, type(self)) from None
        except ArithmeticError as error:
            raise uncomputable(type(self).__name__, fields, error) from error

    @classmethod
    def parse(cls, fields: Mapping[str, Any]) -> Self:
        """Build from plain nested data such as a YAML file holds."""
        if not isinstance(fields, Mapping):
            raise InvalidInput(cls.__name__, fields, "must be a mapping of fields to values")
        return cls(**{str(key): value for key, value in fields.items()})

    def but(self, **changes: Any) -> Self:
        """A copy with other values of some fields, as valid as a new one.

        It equals what writing the object again with these values would make: nothing that was computed from
        the old values goes along, and fields that were never given keep following their defaults.

        Args:
            **changes: Fields and their new values.

        Raises:
            InvalidInput: One value is wrong, or no such field.
            InvalidScenario: Several are wrong.
        """
        return type(self)(**{**self._given(), **changes})

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """`but` under the name that pydantic gives it; ``deep`` copies the kept values as well."""
        given = deepcopy(self._given()) if deep else self._given()
        return type(self)(**{**given, **(update or {})})

    def _given(self) -> dict[str, Any]:
        names = (name for name in type(self).model_fields if name in self.model_fields_set)
        return {name: getattr(self, name) for name in names}

    def __eq__(self, other: object) -> bool:
        """Same class, same fields; what was computed from them (arrays, often) is not compared."""
        if type(self) is not type(other):
            return NotImplemented
        return all(getattr(self, name) == getattr(other, name) for name in type(self).model_fields)

    def __hash__(self) -> int:
        return hash((type(self), *(getattr(self, name) for name in type(self).model_fields)))

    def __getstate__(self) -> dict[Any, Any]:
        """What a pickle holds: the fields, and what was read from elsewhere, not what follows from them."""
        state = super().__getstate__()
        names = {*type(self).model_fields, *self.kept_when_pickled}
        kept = {name: value for name, value in state["__dict__"].items() if name in names}
        return {**state, "__dict__": kept}


def _mentions(annotation: Any, kind: type) -> bool:
    """Whether a type is this one or one of its arguments is."""
    return annotation in (kind, Any) or any(_mentions(part, kind) for part in get_args(annotation))


def _holds_nameless(value: Any) -> bool:
    """Whether a mapping in it has a key that is no text, and so no name of a field."""
    if isinstance(value, (list, tuple)):
        return any(map(_holds_nameless, value))
    return isinstance(value, Mapping) and not all(isinstance(key, str) for key in value)


def _holds_truth(value: Any) -> bool:
    if isinstance(value, (list, tuple)):
        return any(map(_holds_truth, value))
    return isinstance(value, bool)


def explain(error: pydantic.ValidationError, spec: type[BaseModel]) -> OsculateError:
    """Translate a pydantic report into the package's error for the class ``spec``."""
    for details in error.errors():
        cause = details.get("ctx", {}).get("error")
        if isinstance(cause, NoSolution):
            return cause
    problems = [
        problem
        for details in error.errors()
        for problem in _problems(details, spec.__name__, spec.model_fields)
    ]
    return problems[0] if len(problems) == 1 else InvalidScenario(problems)


def _problems(
    details: Mapping[str, Any], name: str, fields: Mapping[str, Any]
) -> Iterator[InvalidInput]:
    path = ".".join([name, *(str(part) for part in details["loc"])])
    cause = details.get("ctx", {}).get("error")
    if isinstance(cause, InvalidScenario):
        for problem in cause.problems:
            yield InvalidInput(_join(path, problem.field), problem.value, problem.valid)
    elif isinstance(cause, InvalidInput):
        yield InvalidInput(_join(path, cause.field), cause.value, cause.valid)
    elif details["type"] == "extra_forbidden":
        yield InvalidInput(
            path, details["input"], f"unknown field; valid fields: {', '.join(fields)}"
        )
    elif details["type"] == "union_tag_invalid":
        tags = details["ctx"]["expected_tags"]
        yield InvalidInput(f"{path}.kind", details["ctx"]["tag"], f"must be one of {tags}")
    elif details["type"] == "union_tag_not_found":
        yield InvalidInput(path, details["input"], "needs a field 'kind' that says which one it is")
    elif details["type"] == "missing":
        yield InvalidInput(path, None, "required field is missing")
    else:
        yield InvalidInput(path, details["input"], _valid(details, fields))


def _valid(details: Mapping[str, Any], fields: Mapping[str, Any]) -> str:
    if details["type"] in ("model_attributes_type", "model_type", "dict_type"):
        return "must be a mapping of fields to values, such as {kind: …}"
    message = str(details["msg"])
    message = message.removeprefix("Value error, ").removeprefix("Input should be ")
    message = message if message.startswith("must") else f"must be {message}"
    field = fields.get(str(details["loc"][0])) if details["loc"] else None
    extra = getattr(field, "json_schema_extra", None)
    unit = extra.get("unit") if isinstance(extra, dict) else None
    return f"{message} ({unit})" if unit and unit != "1" else message


def _join(path: str, inner: str) -> str:
    """``Scenario.robot`` and ``Tricycle.wheelbase`` make ``Scenario.robot.wheelbase``."""
    head, _, rest = inner.partition(".")
    return f"{path}.{rest}" if rest and head[:1].isupper() else f"{path}.{inner}" if inner else path

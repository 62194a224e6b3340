"""What docstrings say of the shapes of arrays holds in every call that the tests make.

A docstring says `rows : (m, n); values, noise : (m,)`, of the arguments of a function or of the fields of a class. The
modules of the package are loaded with a look at each such call: an array has as many dimensions as it is said to have,
a number is that number, and a name is one length throughout the call. Lengths that are said in other words are free.
"""

import inspect
import re
import sys
from collections.abc import Callable, Sequence
from functools import wraps
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from operator import attrgetter, itemgetter
from types import FunctionType, ModuleType
from typing import Any

import numpy as np
from jaxtyping import Shaped, jaxtyped

NOTE = re.compile(r"(\w+(?:, \w+)*) : (?:[A-Z] )?\(([^()]*)\)(?! or)")
ARRAY = re.compile(r"(Array|NDArray\[[\w.]+\])( \||$)")

SHAPE = attrgetter("shape")
REFUSES = re.compile(r"raises [^.]*(Shape|Covariance|Input)Error", re.IGNORECASE)


class ShapeSaidError(AssertionError):
    """An array is not of the shape that a docstring says."""


def said(docstring: str | None) -> dict[str, str]:
    """Return the shapes that a docstring gives to names, as jaxtyping writes them: {"rows": "m n"}."""
    found = NOTE.findall(docstring or "")
    return {name: _dimensions(shape) for names, shape in found for name in names.split(", ")}


def _dimensions(shape: str) -> str:
    words = [word.strip() for word in shape.split(",") if word.strip()]
    return " ".join(word if re.fullmatch(r"\w+|\.\.\.", word) else "_" for word in words)


def checked(function: Callable[..., Any], docstring: str | None) -> Callable[..., Any]:
    """Return the function with a look at its arrays; the function itself if nothing is said, or if it looks itself."""
    if REFUSES.search(docstring or ""):
        return function
    given = list(inspect.signature(function).parameters.values())
    shapes = said(docstring)
    looks: list[tuple[int, str, Any]] = [
        (place, each.name, Shaped[np.ndarray, shapes[each.name]])
        for place, each in enumerate(given)
        if each.name in shapes and ARRAY.match(getattr(each.annotation, "__forward_arg__", str(each.annotation)))
    ]
    if not looks:
        return function

    right = set[tuple[tuple[int, ...] | None, ...]]()  # found so before: nearly every call is one of few
    places = [place for place, _, _ in looks]
    first, *more = places
    given_by_place: Callable[[Any], Any] = itemgetter(first, *more) if more else itemgetter(slice(first, first + 1))

    @wraps(function)
    def looked_at(*arguments: Any, **named: Any) -> Any:
        if len(arguments) > places[-1]:  # the usual case, in two thirds of the time
            try:
                if tuple(map(SHAPE, given_by_place(arguments))) in right:
                    return function(*arguments, **named)
            except AttributeError:  # one that is no array
                pass
        values = [arguments[place] if place < len(arguments) else named.get(name) for place, name, _ in looks]
        found = tuple([value.shape if isinstance(value, np.ndarray) else None for value in values])
        if found not in right:
            with jaxtyped("context"):
                for value, (_, name, shape) in zip(values, looks, strict=True):
                    if isinstance(value, np.ndarray) and not isinstance(value, shape):
                        raise ShapeSaidError(_complaint(function, name, value, shape))
            right.add(found)
        return function(*arguments, **named)

    return looked_at


def _complaint(function: Callable[..., Any], name: str, value: Any, shape: Any) -> str:
    where = f"{function.__module__}.{function.__qualname__}"
    return f"{where}: {name} is said to be ({shape.dim_str}) and has the shape {value.shape}"


def look_at(module: ModuleType) -> None:
    """Let every function, method and record of a module be looked at."""
    for name, value in list(vars(module).items()):
        if getattr(value, "__module__", None) != module.__name__:
            continue
        if isinstance(value, FunctionType):
            setattr(module, name, checked(value, value.__doc__))
        elif isinstance(value, type):
            _look_at_class(value)


def _look_at_class(owner: type) -> None:
    maker = "__new__" if issubclass(owner, tuple) else "__init__"
    for name, value in list(vars(owner).items()):
        kind = type(value) if isinstance(value, classmethod | staticmethod) else None
        function = value.__func__ if kind else value
        if isinstance(function, FunctionType):
            wrapped = checked(function, owner.__doc__ if name == maker else function.__doc__)
            if wrapped is not function:
                setattr(owner, name, (kind or (staticmethod if name == "__new__" else _as_it_is))(wrapped))


def _as_it_is(function: Callable[..., Any]) -> Callable[..., Any]:
    return function


class _Loader(SourceFileLoader):
    def exec_module(self, module: ModuleType) -> None:
        """Load a module and look at it."""
        super().exec_module(module)
        look_at(module)


class _Finder(MetaPathFinder):
    def find_spec(self, name: str, path: Sequence[str] | None, target: ModuleType | None = None) -> ModuleSpec | None:
        """Find the modules of the product and of the core."""
        spec = PathFinder.find_spec(name, path, target) if name.startswith(("axiscal.", "axiscal_core.")) else None
        if spec is not None and isinstance(spec.loader, SourceFileLoader):
            spec.loader = _Loader(spec.loader.name, spec.loader.path)
        return spec


def install() -> None:
    """Look at every module of both that is loaded from now on."""
    sys.meta_path.insert(0, _Finder())

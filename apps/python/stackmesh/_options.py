"""Keyword arguments: their names, defaults and checks are those of the command line, which is asked for them."""

import difflib
import inspect
import os

from . import _stackmesh

#: What the functions take beside the command line's options, and what it calls otherwise.
_OWN = {"report", "output", "names", "spacing", "against"}


def keywords(command):
    """{name: (kind, default as text, description)} of "mesh", "surface", "fem" or "validate"."""
    return {name: (kind, initial, description) for name, kind, initial, description in _stackmesh.keywords(command)}


def is_path(value):
    return isinstance(value, (str, os.PathLike))


def _text(value):
    if isinstance(value, bool):
        raise TypeError("True and False are for flags")
    if is_path(value):
        return os.fspath(value)
    if isinstance(value, float):
        return repr(value)
    if hasattr(value, "item"):  # a number of numpy
        return _text(value.item())
    return str(value)


def joined(name, value):
    """One text of a list ([1, 4] is "1,4") or of a dict ({5: 2.0} is "5=2.0")."""
    if isinstance(value, dict):
        if not value:
            return ""
        return ",".join(f"{_text(key)}={_text(item)}" for key, item in value.items())
    if isinstance(value, (list, tuple, set, frozenset, range)):
        return ",".join(_text(item) for item in value)
    try:
        return _text(value)
    except TypeError:
        raise TypeError(f"{name}={value!r}: {name} takes a value, not True or False") from None


def _texts(name, value):
    """The texts of a repeatable option: "a", ["a", "b"] or {"A": [1, 3]} for "A=1,3"."""
    if isinstance(value, dict):
        return [f"{_text(key)}={joined(name, item)}" for key, item in value.items()]
    if isinstance(value, (list, tuple)):
        return [joined(name, item) for item in value]
    return [joined(name, value)]


def arguments(command, given):
    """The keyword arguments `given` as the command line takes them."""
    known = keywords(command)
    out = []
    for name, value in given.items():
        if name not in known:
            near = difflib.get_close_matches(name, known, 1)
            raise TypeError(f"{command}() got an unexpected keyword argument '{name}'" + (f" (did you mean {near[0]}?)" if near else ""))
        kind = known[name][0]
        if value is None:
            continue
        if kind == "flag":
            if not isinstance(value, bool) and not (hasattr(value, "dtype") and value.dtype == bool):
                raise TypeError(f"{name}={value!r}: {name} is True or False")
            if value:
                out.append((name, ""))
        elif kind == "optional" and isinstance(value, bool):
            if value:
                out.append((name, ""))
        elif kind == "texts":
            out += [(name, text) for text in _texts(name, value)]
        else:
            text = joined(name, value)
            if text:
                out.append((name, text))
    return out


def _default(kind, initial):
    if kind == "flag":
        return False
    if not initial:
        return None
    if kind == "number":
        number = float(initial)
        return int(number) if number == int(number) and "." not in initial else number
    return initial


def parameters(command, without=()):
    """The options of a command as keyword-only parameters, in its order."""
    return [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=_default(kind, initial))
        for name, (kind, initial, _) in keywords(command).items()
        if name not in _OWN and name not in without
    ]


def described(command, without=()):
    """The options of a command as the paragraph of a docstring."""
    lines = []
    for name, (kind, initial, description) in keywords(command).items():
        if name in _OWN or name in without:
            continue
        default = _default(kind, initial)
        lines.append(f"{name} : default {default!r}\n    {description}")
    return "\n".join(lines)


def documented(command, without=()):
    """Gives a function the signature and the docstring of its command's options."""

    def add(function):
        signature = inspect.signature(function)
        own = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
        names = {p.name for p in own}
        more = [p for p in parameters(command, without) if p.name not in names]
        function.__signature__ = signature.replace(parameters=own + more)
        function.__doc__ = inspect.cleandoc(function.__doc__) + "\n\nOptions of the command line\n---------------------------\n" + described(command, without) + "\n"
        return function

    return add

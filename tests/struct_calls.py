"""A plugin of mypy, named in pyproject.toml: msgspec's structs are no dataclasses, though mypy takes them for such.

`dataclasses.replace`, `asdict`, `astuple` and `fields`, and `vars`, end in a TypeError when they are given one; there are
`msgspec.structs.replace` and the like.
"""

from collections.abc import Callable

from mypy.plugin import FunctionContext, Plugin
from mypy.types import CallableType, Instance, ProperType, Type, TypeType, TypeVarType, UnionType, get_proper_type

OF_DATACLASSES = tuple(f"dataclasses.{name}" for name in ("replace", "asdict", "astuple", "fields"))
STRUCT = "msgspec.Struct"


class StructCalls(Plugin):
    """Refuses structs where only dataclasses, or objects with a dictionary, may stand."""

    def get_function_hook(self, fullname: str) -> Callable[[FunctionContext], Type] | None:
        """Return what looks at the calls of a function."""
        return _refuse_structs if fullname in OF_DATACLASSES or fullname == "builtins.vars" else None


def _refuse_structs(context: FunctionContext) -> Type:
    given = context.arg_types[0] if context.arg_types else []
    for one in given[:1]:
        for kind in _instances(get_proper_type(one)):
            if any(base.fullname == STRUCT for base in kind.type.mro):
                context.api.fail(f"{kind.type.name} is a struct, no dataclass: use msgspec.structs", context.context)
    return context.default_return_type


def _instances(kind: ProperType) -> list[Instance]:
    """Return the classes that an argument may be of, or may be itself."""
    if isinstance(kind, TypeVarType):
        return _instances(get_proper_type(kind.upper_bound))
    if isinstance(kind, TypeType):
        return _instances(kind.item)
    if isinstance(kind, CallableType) and kind.is_type_obj():
        return _instances(get_proper_type(kind.ret_type))
    if isinstance(kind, UnionType):
        return [one for item in kind.items for one in _instances(get_proper_type(item))]
    return [kind] if isinstance(kind, Instance) else []


def plugin(_version: str) -> type[Plugin]:
    """Return the plugin, as mypy asks for it."""
    return StructCalls

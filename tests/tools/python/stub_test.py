"""The stubs say what the module holds, no more and no less."""

import ast
import inspect
import json
import re
import subprocess
from pathlib import Path

import pytest

import mvtp

PACKAGE = Path(mvtp.__file__).parent
TREE = ast.parse((PACKAGE / "__init__.pyi").read_text())
CLASSES = {node.name: node for node in TREE.body if isinstance(node, ast.ClassDef)}
FUNCTIONS = {node.name: node for node in TREE.body if isinstance(node, ast.FunctionDef)}
PUBLIC = {name: node for name, node in CLASSES.items() if not name.startswith("_")}


def test_every_public_name_is_in_both():
    values = {node.target.id for node in TREE.body if isinstance(node, ast.AnnAssign)}
    assert sorted({*PUBLIC, *FUNCTIONS, *values}) == mvtp.__all__
    assert (PACKAGE / "py.typed").exists()


def members_of_stub(node):
    names = {item.name for item in node.body if isinstance(item, ast.FunctionDef)}
    names |= {item.target.id for item in node.body if isinstance(item, ast.AnnAssign)}
    return {name for name in names if not name.startswith("_")}


def members_of(kind):
    """Those that it adds to what every object, exception or tuple has."""
    fields = set(getattr(kind, "__annotations__", {})) | set(getattr(kind, "_fields", ()))
    bases = (BaseException, tuple)
    inherited = {name for base in bases if issubclass(kind, base) for name in dir(base)}
    return {name for name in {*dir(kind), *fields} - inherited if not name.startswith("_")}


@pytest.mark.parametrize("name", sorted(PUBLIC))
def test_every_member_is_in_both(name):
    kind = getattr(mvtp, name)
    own_attributes = {"Interrupted": {"result"}, "RunError": {"run"}}.get(name, set())
    assert members_of_stub(PUBLIC[name]) == members_of(kind) | own_attributes


def parameters_of_stub(node):
    spec = node.args
    return [a.arg for a in spec.posonlyargs + spec.args + spec.kwonlyargs if a.arg != "self"]


def parameters_of(function):
    """Also of functions in C++, whose docstrings begin with their signature."""
    try:
        signature = inspect.signature(function)
    except ValueError:
        line = function.__doc__.splitlines()[0]
        names = re.findall(r"(?:\(|, )(\w+): ", re.sub(r"\[[^]]*\]", "", line))
        return [name for name in names if name != "self"]
    kinds = (inspect.Parameter.VAR_KEYWORD, inspect.Parameter.VAR_POSITIONAL)
    named = [p.name for p in signature.parameters.values() if p.kind not in kinds]
    return [name for name in named if name != "self"]


def all_functions():
    for name, node in FUNCTIONS.items():
        yield pytest.param(node, getattr(mvtp, name), id=name)
    for name, kind in PUBLIC.items():
        for item in kind.body:
            if not isinstance(item, ast.FunctionDef):
                continue
            is_property = "property" in [d.id for d in item.decorator_list]
            by_file_format = (name, item.name) == ("Vehicle", "__init__")  # takes its fields
            if not is_property and not by_file_format:
                function = getattr(getattr(mvtp, name), item.name)
                yield pytest.param(item, function, id=f"{name}.{item.name}")


@pytest.mark.parametrize(("node", "function"), all_functions())
def test_every_parameter_is_in_both(node, function):
    assert parameters_of_stub(node) == parameters_of(function)


@pytest.mark.parametrize("name", sorted({*PUBLIC, *FUNCTIONS}))
def test_everything_says_what_it_is(name):
    thing = getattr(mvtp, name)
    assert thing.__doc__, name
    for member in members_of(thing) if name in PUBLIC else ():
        attribute = inspect.getattr_static(thing, member, None)
        field = member in getattr(thing, "_fields", ()) or attribute is None
        assert field or attribute.__doc__ or member in thing.__annotations__, f"{name}.{member}"


@pytest.mark.parametrize(
    ("command", "stub", "own"),
    [
        ("coordinate", "_CoordinateOptions", {"configuration", "output_dir", "quiet"}),
        ("compare", "_CompareOptions", {"configuration", "output_dir", "quiet"}),
    ],
)
def test_the_options_are_those_of_the_commands(command, stub, own, program):
    def keys(name):
        node = CLASSES[name]
        inherited = [base.id for base in node.bases if base.id in CLASSES]
        own_keys = {item.target.id for item in node.body if isinstance(item, ast.AnnAssign)}
        return own_keys.union(*map(keys, inherited))

    sumo_program = Path(program).parents[1] / "libexec" / "mvtp" / "mvtp-sumo"
    described = subprocess.run([sumo_program, "describe"], capture_output=True, check=True)
    names = set()
    for sub in json.loads(described.stdout)["commands"]:
        if sub["name"] == f"mvtp {command}":
            for option in sub["options"]:
                long = [n for n in option["names"] if n.startswith("--")]
                names.add((long or option["names"])[0].lstrip("-").replace("-", "_"))
    assert keys(stub) == names - own - {"help"}

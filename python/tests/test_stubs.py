"""The type stubs name what the module has, with the same arguments, and everything has a docstring."""

import ast
import importlib.util
import re
import unittest
from pathlib import Path

import lodeline
from lodeline import _lodeline

STUB = Path(importlib.util.find_spec("lodeline").origin).with_name("_lodeline.pyi")


def arguments_of(function):
    """Names of the arguments of a function of the stub."""
    wanted = function.args
    return [a.arg for a in wanted.posonlyargs + wanted.args + wanted.kwonlyargs if a.arg != "self"]


def arguments_in(documentation):
    """Names of the arguments in the signature that pybind11 puts before a docstring."""
    text = documentation.splitlines()[0]
    text = text[text.index("(") + 1 : text.rindex(") ->")]
    depth, parts = 0, [""]
    for letter in re.sub(r"<[^<>]*>", "", text):
        depth += (letter in "[({") - (letter in "])}")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    names = [part.split(":")[0].split("=")[0].strip() for part in parts]
    return [name for name in names if name and name != "self" and not name.startswith("*")]


class StubTest(unittest.TestCase):
    def setUp(self):
        tree = ast.parse(STUB.read_text())
        self.classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
        self.functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}

    def test_names(self):
        there = {name for name in dir(_lodeline) if not name.startswith("_")}
        self.assertEqual(there, self.classes.keys() | self.functions.keys())
        self.assertEqual(there | {"feed"}, set(lodeline.__all__))

    def test_functions(self):
        for name, node in self.functions.items():
            documentation = getattr(_lodeline, name).__doc__
            self.assertEqual(arguments_in(documentation), arguments_of(node), name)
            self.assertGreater(len(documentation.split("\n\n", 1)[-1]), 20, name)

    def test_members(self):
        for name, node in self.classes.items():
            kind = getattr(_lodeline, name)
            self.assertTrue(kind.__doc__, name)
            stub = {item.name: item for item in node.body if isinstance(item, ast.FunctionDef)}
            there = {member for member in vars(kind) if not member.startswith("_")}
            self.assertEqual(there, {member for member in stub if not member.startswith("_")}, name)
            for member, item in stub.items():
                is_property = any(isinstance(d, ast.Name) and d.id == "property" for d in item.decorator_list)
                found = vars(kind)[member] if member in vars(kind) else None
                self.assertEqual(is_property, isinstance(found, property), f"{name}.{member}")
                if found is not None and not is_property and member not in ("__iter__", "__next__", "__len__"):
                    self.assertEqual(arguments_in(found.__doc__), arguments_of(item), f"{name}.{member}")


if __name__ == "__main__":
    unittest.main()

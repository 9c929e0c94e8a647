"""_kinship.pyi says what the module has, no less and no more; everything in it is documented."""
import ast
import doctest
import inspect
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import kinship
from kinship import _kinship

STUB = pathlib.Path(_kinship.__file__).with_name("_kinship.pyi")
SOURCE = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"])
MYPY = shutil.which("mypy", path="/usr/bin")
OTHERS = {"__repr__", "__getstate__", "__setstate__", "__new__", "__init__",
          "_pybind11_conduit_v1_"}  # not part of a class's face; the last is of pybind11 2.13


def parameters_of(function: ast.FunctionDef):
    arguments = function.args
    return [a.arg for a in arguments.posonlyargs + arguments.args + arguments.kwonlyargs if a.arg != "self"]


def stub_members(node: ast.ClassDef):
    """Name to parameters, or to None for a property."""
    members = {}
    for item in node.body:
        if isinstance(item, ast.AnnAssign):
            members[item.target.id] = None
        elif isinstance(item, ast.FunctionDef):
            is_value = any(ast.unparse(mark) == "property" or ast.unparse(mark).endswith(".setter")
                           for mark in item.decorator_list)
            members[item.name] = None if is_value else parameters_of(item)
    return members


def real_parameters(docstring: str):
    """Of pybind11's first line: name(self: T, a: T = x, *, b: T) -> T."""
    depth, inside = 0, ""
    for letter in docstring[docstring.index("("):]:
        depth += (letter in "([{") - (letter in ")]}")
        if depth == 0:
            break
        inside += letter if depth == 1 or letter not in ",:" else " "
    return [name for name in re.findall(r"(?:^|[(,])\s*(\w+)\s*:", inside) if name not in ("self", "arg0")]


def real_members(owner):
    members = {}
    for name, value in vars(owner).items():
        if isinstance(value, property):
            members[name] = None
        elif (callable(value) or isinstance(value, staticmethod)) and name not in OTHERS:
            members[name] = real_parameters(inspect.getdoc(getattr(owner, name)))
    return members


class Stub(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        tree = ast.parse(STUB.read_text())
        cls.classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
        cls.functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}

    def test_names_the_classes_and_functions_of_the_module(self):
        real = {name for name in vars(_kinship) if not name.startswith("_")}
        self.assertEqual(set(self.classes) | set(self.functions), real)
        errors = {name for name, value in vars(kinship.errors).items() if inspect.isclass(value)}
        self.assertEqual(set(kinship.__all__), real | errors)

    def test_has_the_members_and_parameters_of_each_class(self):
        for name, node in self.classes.items():
            with self.subTest(name):
                owner = getattr(_kinship, name)
                told, real = stub_members(node), real_members(owner)
                initial = told.pop("__init__", None)
                if initial is not None and name != "Attempt":  # takes any of its properties
                    self.assertEqual(initial, real_parameters(owner.__init__.__doc__))
                for context in ("__enter__", "__exit__", "__len__"):
                    self.assertEqual(context in told, context in real)
                    told.pop(context, None), real.pop(context, None)
                self.assertEqual(told, real)

    def test_has_the_parameters_of_each_function(self):
        for name, node in self.functions.items():
            self.assertEqual(parameters_of(node), real_parameters(getattr(_kinship, name).__doc__), name)

    def test_everything_is_documented(self):
        for name, value in vars(_kinship).items():
            if name.startswith("_"):
                continue
            self.assertTrue(value.__doc__, name)
            for member in real_members(value) if inspect.isclass(value) else ():
                text = inspect.getdoc(getattr(value, member))
                self.assertGreater(len(re.sub(r"^\w+\(.*?\) -> .*", "", text).strip()), 3, f"{name}.{member}")

    def test_examples_in_docstrings_do_what_they_say(self):
        parser, runner = doctest.DocTestParser(), doctest.DocTestRunner()
        for name, value in vars(_kinship).items():
            if not name.startswith("_"):
                runner.run(parser.get_doctest(inspect.getdoc(value), {"kinship": kinship}, name, None, 0))
        self.assertGreater(runner.summarize(verbose=False).attempted, 5)
        self.assertEqual(runner.failures, 0)


@unittest.skipUnless(MYPY, "needs mypy")
class TypeCheck(unittest.TestCase):
    """What users' mypy says of the types, in a process of its own: one run, for it takes seconds."""

    def test_the_stub_and_the_example_pass_and_what_is_wrong_is_found(self):
        wrong = "import kinship\nkinship.Sampler('panda', [0.0]).sample(1)\nkinship.Robot('x').fk([0.0]).upper()\n"
        with tempfile.TemporaryDirectory(prefix="kinship-python-") as folder:
            program = pathlib.Path(folder) / "wrong.py"
            program.write_text(wrong)
            run = subprocess.run(
                [MYPY, "--strict", "--ignore-missing-imports", "--allow-untyped-calls", "--allow-untyped-defs",
                 "--allow-incomplete-defs", "--disable-error-code", "type-arg", "--python-executable", sys.executable,
                 "--cache-dir", pathlib.Path(os.environ["KINSHIP_BIN_DIR"]).parent / "mypy", STUB.parent,
                 SOURCE / "client" / "python" / "examples" / "plot_distribution.py", program],
                env={**os.environ, "MYPYPATH": str(STUB.parent.parent)},
                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=250)
        errors = [line for line in run.stdout.splitlines() if " error: " in line]
        self.assertEqual([error for error in errors if "wrong.py" not in error], [], run.stdout)
        self.assertEqual(len(errors), 2, run.stdout)
        self.assertIn('Argument 1 to "Sampler" has incompatible type "str"', errors[0])
        self.assertIn('has no attribute "upper"', errors[1])


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Dependencies of a function: every change changes the digest, a new interpreter does not."""

import collections.abc
import functools
import importlib.machinery
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import textwrap
import types
import unittest
import unittest.mock

import numpy as np

from salbench.models.fingerprint import Unwalkable, fingerprint
from salbench.models.function import Model, key_of

IMPORTS = """\
import collections, dataclasses, decimal, enum, functools, operator, os, pathlib, random, re, sys, threading, types, weakref
import numpy as np
"""


def made(text, name="f"):
    """Object with this name, defined by a text in a new module."""
    module = types.ModuleType("made")
    exec(compile(IMPORTS + textwrap.dedent(text), f"/made/{random.random()}.py", "exec"), vars(module))
    return vars(module)[name]


def of(text, name="f"):
    return fingerprint(made(text, name))


# A change of each pair must be seen: one text with two values of {}.
CHANGES = {
    "constant": ("def f(s): return s * {}", "1", "2"),
    "sign of zero": ("def f(s): return s * {}", "0.0", "-0.0"),
    "kind of number": ("A = {}\ndef f(s): return s * A", "1", "1.0"),
    "list and tuple": ("A = {}\ndef f(s): return A", "[1]", "(1,)"),
    "closure in a closure": ("def mk(s):\n def g(x): return s * x\n def f(x): return g(x)\n return f\nf = mk({})", "1", "-1"),
    "global in a nested function": ("A = {}\ndef f(s):\n def g():\n  return A\n return g()", "1", "2"),
    "helper through helpers": ("def h(x): return x * {}\ndef g(x): return h(x)\ndef f(s): return g(s)", "1", "2"),
    "builtin that is shadowed": ("def sorted(x): return x * {}\ndef f(s): return sorted(s)", "1", "2"),
    "default": ("def f(s, a={}): return s * a", "1", "2"),
    "keyword default": ("def f(s, *, a={}): return s * a", "1", "2"),
    "attribute of the function": ("def f(s): return f.a\nf.a = {}", "1", "2"),
    "operator": ("def f(s): return s {} 2", "+", "-"),
    "method called": ("def f(s): return s.{}()", "min", "max"),
    "handler": ("def f(s):\n try:\n  return s()\n except {}:\n  return 1", "KeyError", "IndexError"),
    "partial by keyword": ("def g(s, a): return a * s\nf = functools.partial(g, a={})", "1", "2"),
    "what was decorated": ("def d(g):\n @functools.wraps(g)\n def w(s): return g(s)\n return w\n@d\ndef f(s): return s * {}", "1", "2"),
    "cached function": ("@functools.lru_cache\ndef g(x): return x * {}\ndef f(s): return g(s)", "1", "2"),
    "attribute of a cached function": ("@functools.cache\ndef g(x): return x\ng.a = {}\ndef f(s): return g.a", "1", "2"),
    "size of a cache": ("@functools.lru_cache(maxsize={})\ndef f(s): return s", "1", "2"),
    "function by type": ("@functools.singledispatch\ndef g(x): return 1\n@g.register\ndef _(x: int): return {}\ndef f(s): return g(s)", "1", "2"),
    "function by type, by itself": ("@functools.singledispatch\ndef f(x): return {}", "1", "2"),
    "function by type, found": ("@functools.singledispatch\ndef g(x): return {}\nh = g.dispatch\ndef f(s): return h(int)(s)", "1", "2"),
    "function by type, cached": ("@functools.cache\n@functools.singledispatch\ndef f(x): return {}", "1", "2"),
    "method by type": ("class C:\n @functools.singledispatchmethod\n def g(self, x): return 1\n @g.register\n def _(self, x: int): return {}\n"
                       "c = C()\ndef f(s): return c.g(s)", "1", "2"),
    "partial method": ("class C:\n def h(self, a, s): return a\n g = functools.partialmethod(h, {})\nc = C()\ndef f(s): return c.g(s)", "1", "2"),
    "attribute of a partial": ("f = functools.partial(max, 1)\nf.a = {}", "1", "2"),
    "order by comparison": ("c = functools.cmp_to_key(lambda a, b: a * {})\ndef f(s): return sorted(s, key=c)", "1", "2"),
    "order filled in": ("@functools.total_ordering\nclass C:\n def __lt__(self, o): return {}\ndef f(s): return C() >= C()", "1", "2"),
    "method of a base": ("class B:\n def g(self): return {}\nclass N(B):\n def __call__(self, s): return self.g()\nf = N()", "1", "2"),
    "class attribute of a base": ("class B:\n A = {}\nclass N(B):\n def __call__(self, s): return self.A\nf = N()", "1", "2"),
    "static method": ("class C:\n @staticmethod\n def g(): return {}\ndef f(s): return C.g()", "1", "2"),
    "class method": ("class C:\n @classmethod\n def g(c): return {}\ndef f(s): return C.g()", "1", "2"),
    "property": ("class C:\n @property\n def g(self): return {}\nc = C()\ndef f(s): return c.g", "1", "2"),
    "cached property": ("class C:\n @functools.cached_property\n def g(self): return {}\nc = C()\ndef f(s): return c.g", "1", "2"),
    "metaclass": ("class M(type):\n A = {}\nclass C(metaclass=M): pass\ndef f(s): return C.A", "1", "2"),
    "bound method": ("class C:\n def __init__(self, w): self.w = w\n def g(self, s): return self.w * s\nf = C({}).g", "1", "2"),
    "slots and more": ("class B:\n __slots__ = ('a',)\nclass C(B): pass\nc = C()\nc.a, c.b = 1, {}\ndef f(s): return c", "1", "2"),
    "object that hides its attributes": (
        "class C:\n def __init__(self, w): object.__setattr__(self, 'w', w)\n def __getattribute__(self, n): raise AttributeError(n)\n"
        "c = C({})\ndef f(s): return c", "1", "2"),
    "object that pickle takes for another": (
        "class C:\n def __init__(self, w): self.w = w\n def __reduce__(self): return (int, ())\nc = C({})\ndef f(s): return c.w", "1", "2"),
    "list that hides": ("class L(list):\n def __iter__(self): return iter(())\nc = L([{}])\ndef f(s): return c[0]", "1", "2"),
    "text with more": ("class T(str): pass\nc = T('a')\nc.b = {}\ndef f(s): return c", "1", "2"),
    "number with a unit": ("class T(float): pass\nc = T({})\ndef f(s): return c", "1", "2"),
    "own default dictionary": ("class D(collections.defaultdict): pass\nc = D(lambda: {})\ndef f(s): return c", "1", "2"),
    "ordered dictionary": ("c = collections.OrderedDict(a=1, b=2)\nc.move_to_end({})\ndef f(s): return c", "'a'", "'b'"),
    "order of a dictionary": ("c = {}\ndef f(s): return c", "{'a': 1, 'b': 2}", "{'b': 2, 'a': 1}"),
    "words in a set": ("c = {{'a', 'b', {}}}\ndef f(s): return s in c", "'c'", "'d'"),
    "set in code": ("def f(s): return s in {{'a', {}}}", "'b'", "'c'"),
    "set and frozen set": ("c = {}({{1}})\ndef f(s): return c", "set", "frozenset"),
    "objects in a set": ("class C:\n def __init__(self, w): self.w = w\nc = {{C(1), C({})}}\ndef f(s): return c", "2", "3"),
    "queue": ("c = collections.deque([1], maxlen={})\ndef f(s): return c", "1", "2"),
    "named tuple": ("N = collections.namedtuple('N', 'a')\nc = N({})\ndef f(s): return c", "1", "2"),
    "fields of a named tuple": ("N = collections.namedtuple('N', {})\ndef f(s): return N", "'a b'", "'b a'"),
    "default of a data class that is made": (
        "@dataclasses.dataclass\nclass D:\n a: list = dataclasses.field(default_factory=lambda: [{}])\ndef f(s): return D()", "1", "2"),
    "member": ("class E(enum.Enum):\n A = 1\n B = 2\nc = E.{}\ndef f(s): return c", "A", "B"),
    "method of an enumeration": ("class E(enum.IntEnum):\n A = 1\n def g(self): return {}\ndef f(s): return E.A.g()", "1", "2"),
    "base through super": ("class B:\n def g(self): return {}\nclass C(B):\n def __call__(self, s): return super().g()\nf = C()", "1", "2"),
    "context as a decorator": ("import contextlib\n@contextlib.contextmanager\ndef g(): yield {}\n@g()\ndef f(s): return s", "1", "2"),
    "argument of a context as a decorator": ("import contextlib\n@contextlib.contextmanager\ndef g(a): yield a\n@g({})\ndef f(s): return s", "1", "2"),
    "new type": ("import typing\nN = typing.NewType('N', {})\ndef f(s): return N(s)", "int", "float"),
    "type variable": ("import typing\nT = typing.TypeVar('T', bound={})\ndef f(s): return typing.cast(T, s)", "int", "float"),
    "docstring": ("def f(s):\n '{}'\n return s", "a", "b"),
    "objects that know each other": (
        "class N: pass\nc = [N() for _ in range(6)]\nfor i, n in enumerate(c): n.w, n.near = i, {{c[i - 1], c[(i + 1) % 6]}}\n"
        "c[3].w = {}\ndef f(s): return c", "3", "9"),
    "tree of points": ("from scipy.spatial import KDTree\nc = KDTree(np.random.default_rng({}).random((99, 3)))\ndef f(s): return c", "1", "2"),
    "module of an installed function": ("from scipy.{} import convolve\ndef f(s): return convolve(s, s)", "ndimage", "signal"),
    "alias of an installed module": ("from scipy import {} as m\ndef f(s): return m.convolve(s, s)", "ndimage", "signal"),
    "module of an installed class": ("from {} import Formatter\ndef f(s): return Formatter", "string", "logging"),
    "table": ("import pandas\nc = pandas.DataFrame({{'a': [1, {}]}})\ndef f(s): return c", "1", "2"),
    "vectorized": ("c = np.vectorize(lambda x: x * {})\ndef f(s): return c(s)", "1", "2"),
    "decimal": ("c = decimal.Decimal('{}')\ndef f(s): return c", "1.0", "1.00"),
    "pattern": ("c = re.compile('a{}')\ndef f(s): return c", "b", "c"),
    "operator as an object": ("c = operator.itemgetter({})\ndef f(s): return c", "1", "2"),
    "read-only dictionary": ("c = types.MappingProxyType({{'a': {}}})\ndef f(s): return c", "1", "2"),
    "view of memory": ("c = memoryview(bytes([{}]))\ndef f(s): return c", "1", "2"),
    "iterator": ("c = iter([1, {}])\ndef f(s): return c", "1", "2"),
    "method of a generator": ("c = np.random.default_rng({}).normal\ndef f(s): return c", "1", "2"),
    "old generator": ("c = np.random.RandomState({})\ndef f(s): return c", "1", "2"),
    "array": ("c = np.arange(5) * {}\ndef f(s): return c", "1", "2"),
    "type of an array": ("c = np.zeros(8, {})\ndef f(s): return c", "'<i4'", "'<f4'"),
    "byte order": ("c = np.zeros(8, {})\ndef f(s): return c", "'<i4'", "'>i4'"),
    "shape of an array": ("c = np.zeros({})\ndef f(s): return c", "(2, 3)", "(3, 2)"),
    "array without values": ("c = np.zeros({})\ndef f(s): return c", "(0, 3)", "(3, 0)"),
    "transposed": ("c = np.arange(4).reshape(2, 2){}\ndef f(s): return c", "", ".T"),
    "array of objects": ("c = np.array([None, {}], object)\ndef f(s): return c", "1", "2"),
    "array with names": ("c = np.zeros(2, [('a', 'i4'), ('{}', 'f4')])\ndef f(s): return c", "b", "c"),
    "mask of an array": ("c = np.ma.array([1.0, 2.0], mask=[0, {}])\ndef f(s): return c", "0", "1"),
    "kind of NumPy's number": ("c = {}(1)\ndef f(s): return c", "np.float32", "np.float64"),
    "type of NumPy": ("c = np.dtype('{}')\ndef f(s): return c", "f4", "f8"),
    "function of NumPy that is named": ("def f(s): return {}(s)", "np.mean", "np.median"),
    "cycle": ("c = [{}]\nc.append(c)\ndef f(s): return c", "1", "2"),
    "what is shared": ("a, b = [1], [1]\nc = [a, {}]\ndef f(s): return c", "a", "b"),
    "functions that call each other": ("def g(x): return f(x) * {}\ndef f(s): return g(s)", "1", "2"),
    "module through another name": ("m = types.ModuleType('m')\nm.a = {}\ndef f(s):\n n = m\n return n.a", "1", "2"),
    "name that is not there yet": ("{}\ndef f(s): return A", "", "A = None"),
}


def key_of_user(folder):
    """Fingerprint of f() of user.py in the folder, by a child: each call imports it anew."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.chdir(folder)
            sys.path.insert(0, folder)
            sys.dont_write_bytecode = True  # by time and size, it would be that of a text edited within a second
            sys.modules.pop("statistics", None)
            importlib.invalidate_caches()
            os.write(writing, fingerprint(importlib.import_module("user").f).encode())
        finally:
            os._exit(0)
    os.close(writing)
    os.waitpid(child, 0)
    with open(reading) as answer:
        found = answer.read()
    assert found
    return found


class Changes(unittest.TestCase):
    def test_every_change_is_seen_and_nothing_else(self):
        for name, (text, before, after) in CHANGES.items():
            with self.subTest(name):
                before, after = text.format(before), text.format(after)
                self.assertEqual(of(before), of(before))
                self.assertEqual(of(after), of("\n\n# moved\n" + after))
                self.assertNotEqual(of(before), of(after))

    def test_a_new_interpreter_finds_the_same(self):
        script = ("import sys\nsys.dont_write_bytecode = True\nimport fingerprint_test as t\n"
                  "for name, (text, before, after) in t.CHANGES.items():\n print(name, t.of(text.format(before)))\n"
                  "print(t.key_of('MINE', t.Model(t.made('def f(s): return s'), depends=[{'a', 'b'}])))\n")
        found = {subprocess.run([sys.executable, "-c", script], env=os.environ | {"PYTHONHASHSEED": seed}, check=True,
                                cwd=pathlib.Path(__file__).parent, capture_output=True, text=True).stdout for seed in "12"}
        self.assertEqual(len(found), 1, {line for text in found for line in text.splitlines() if not all(line in other for other in found)})
        self.assertEqual(len(found.pop().splitlines()), len(CHANGES) + 1)

    def test_what_a_package_imports_when_it_is_named_counts_before_as_after(self):
        script = ("import salbench; from salbench.models.fingerprint import fingerprint\n"
                  "def f(s): import colorsys; return salbench.stats.conclude(colorsys.rgb_to_hsv(s))\n"
                  "import sys; assert not {'salbench.stats', 'colorsys'} & {*sys.modules}\n"
                  "before = fingerprint(f); import salbench.stats, colorsys; print(before == fingerprint(f))")
        said = subprocess.run([sys.executable, "-B", "-c", script], capture_output=True, text=True, check=True).stdout
        self.assertEqual(said, "True\n")

    def test_what_was_called_often_is_the_same(self):
        f = made("def g(x): return x + 1\ndef f(s):\n t = 0\n for i in range(9):\n  t += g(i)\n return t")
        before = fingerprint(f)
        for _ in range(5000):
            f(1)
        self.assertEqual(fingerprint(f), before)

    def test_what_functools_has_cached_is_the_same(self):
        for name in ("cached function", "size of a cache", "function by type", "function by type, by itself", "function by type, found",
                     "function by type, cached", "method by type"):
            text, value, _ = CHANGES[name]
            f = made(text.format(value))
            before = fingerprint(f)
            f(1)
            collections.abc.Sized.register(type("Own", (), {}))  # as any library may, and what was dispatched is looked up again
            f("a")
            self.assertEqual(fingerprint(f), before, name)

    def test_one_middle_element_of_a_large_array(self):
        values = np.zeros((1000, 1000))
        keys = {fingerprint(values)}
        values[500, 500] = 1e-300
        keys.add(fingerprint(values))
        self.assertEqual(len(keys), 2)
        self.assertIn(fingerprint(np.asfortranarray(values)), keys)
        for view in (values.T, np.asfortranarray(values), values[::2], values[:, ::-1], values[::-1, 3:7]):
            self.assertEqual(fingerprint(view), fingerprint(view.copy()))

    def test_an_array_in_a_file_is_its_content(self):
        with tempfile.TemporaryDirectory() as folder:
            keys = []
            for name, value in (("a", 1), ("b", 1), ("c", 2)):
                np.save(f"{folder}/{name}.npy", np.full(99, value))
                keys.append(fingerprint(np.load(f"{folder}/{name}.npy", mmap_mode="r")))
        self.assertEqual(keys[0], keys[1])
        self.assertNotEqual(keys[0], keys[2])

    def test_a_compiled_function_of_the_user_counts_by_its_file(self):
        """Cython and nanobind have classes of functions that tell nothing but the function's module."""
        with tempfile.TemporaryDirectory() as folder:
            keys = []
            for content in "112":
                module = types.ModuleType("fast")
                module.__file__ = f"{folder}/{len(keys)}{importlib.machinery.EXTENSION_SUFFIXES[0]}"
                pathlib.Path(module.__file__).write_text(content)
                function = made("class F: pass\nf = F()\nf.__module__ = 'fast'")
                with unittest.mock.patch.dict(sys.modules, fast=module):
                    keys.append(fingerprint(function))
        self.assertEqual(keys[0], keys[1])
        self.assertNotEqual(keys[0], keys[2])

    def test_modules_of_the_user_count_by_what_is_named_and_installed_ones_by_version(self):
        with tempfile.TemporaryDirectory() as folder:
            def key(helper, *, text="import helper\ndef f(s): return helper.g(s)\n"):
                package = pathlib.Path(folder, "helper")
                package.mkdir(exist_ok=True)
                (package / "__init__.py").write_text(helper)
                (package / "sub.py").write_text("def h(x): return x" + (" * 2" if "sub" in helper else ""))
                pathlib.Path(folder, "user.py").write_text(text)
                return key_of_user(folder)

            one, two = "A = 1\ndef g(x): return x * A\n", "A = 2\ndef g(x): return x * A\n"
            other = one + "def unused(): return 3\n"
            self.assertEqual(key(one), key(other))
            self.assertNotEqual(key(one), key(two))
            for text in ("def f(s):\n import helper\n return helper.g(s)\n", "def f(s):\n from helper import g\n return g(s)\n",
                         "def f(s):\n from helper import g as k, A\n return k(s)\n", "import helper as k\ndef f(s): return k.g(s)\n",
                         "import helper\nfor_all = [helper]\ndef f(s): return for_all[0].g(s)\n",
                         "from helper import *\ndef f(s): return g(s)\n"):
                with self.subTest(text):
                    self.assertEqual(key(one, text=text), key(one, text=text))
                    self.assertNotEqual(key(one, text=text), key(two, text=text))
            for text in ("import helper.sub\ndef f(s): return helper.sub.h(s)\n", "def f(s):\n import helper.sub\n return helper.sub.h(s)\n",
                         "def f(s):\n from helper.sub import h\n return h(s)\n", "def f(s):\n from helper import sub\n return sub.h(s)\n"):
                with self.subTest(text):
                    self.assertNotEqual(key(one, text=text), key(one + "# sub", text=text))
            # A name of the standard library is the user's where his file has it.
            pathlib.Path(folder, "statistics.py").write_text("A = 1\n")
            text = "import statistics\ndef f(s): return statistics.A\n"
            before = key(one, text=text)
            pathlib.Path(folder, "statistics.py").write_text("A = 2\n")
            self.assertNotEqual(key(one, text=text), before)

    def test_a_package_that_somebody_changed(self):
        f = made("def f(s): return np.linalg.norm(s)")
        before = fingerprint(f)
        original = np.linalg.norm
        try:
            np.linalg.norm = lambda x: 1
            one = fingerprint(f)
            np.linalg.norm = lambda x: 2
            two = fingerprint(f)
        finally:
            np.linalg.norm = original
        self.assertEqual(len({before, one, two, fingerprint(f)}), 3)
        f = made("def f(s): return functools.partialmethod(s)")
        before = fingerprint(f)
        functools.partialmethod.extra = lambda self: 1
        try:
            self.assertNotEqual(fingerprint(f), before)
        finally:
            del functools.partialmethod.extra

    def test_state_of_installed_packages_does_not_count(self):
        f = made("from numpy.random import rand\nimport logging, sys\nfrom os import environ\nlog = logging.getLogger('a')\n"
                 "def f(s):\n np.random.seed(0)\n print(s, file=sys.stderr)\n log.info('a')\n return rand(3) + np.random.rand() + random.random()"
                 " + len(environ) + len(os.environ)")
        before = fingerprint(f)
        np.random.rand(3)
        random.random()
        os.environ["SALBENCH_TEST_OF_KEYS"] = "1"
        self.assertEqual(fingerprint(f), before)

    def test_tensors_and_networks(self):
        """PyTorch's look: tensors whose values are reached by detach(), cpu() and numpy()."""
        text = """
            class Tensor:
                __slots__ = ("_values", "dtype", "__weakref__")
                def __init__(self, values): self._values, self.dtype = values, "torch.float32"
                def detach(self): return Tensor(self._values)
                def cpu(self): return self
                def numpy(self):
                    if self.dtype == "torch.bfloat16": raise TypeError("Got unsupported ScalarType BFloat16")
                    return self._values()
                def float(self): return Tensor(self._values)
            class Module:
                training = True
                def __init__(self, weights): self._parameters, self._hooks = collections.OrderedDict(weight=weights), {}
                def parameters(self): yield from self._parameters.values()
                def state_dict(self): return dict(self._parameters)
                def __getattr__(self, name): return self.__dict__["_parameters"][name]
            class Net(Module):
                def forward(self, x): return self.weight * x
            def hidden(values): return [lambda: values][0]
            weights = np.arange(10000.0, dtype=np.float32)
            net = Net(Tensor(hidden(weights)))
            def f(s): return net.forward(s)
            """
        f = made(text)
        names = f.__globals__
        keys = [fingerprint(f)]
        names["weights"][5000] += 1
        keys.append(fingerprint(f))
        names["net"].training = False
        keys.append(fingerprint(f))
        names["net"]._hooks[0] = lambda x: x
        keys.append(fingerprint(f))
        names["net"].weight.dtype = "torch.bfloat16"
        keys.append(fingerprint(f))
        names["Net"].forward = lambda self, x: x
        keys.append(fingerprint(f))
        self.assertEqual(len(set(keys)), len(keys))
        self.assertEqual(fingerprint(made(text)), keys[0])

    def test_deep_and_wide_things(self):
        deep = None
        for _ in range(100_000):
            deep = [deep]
        self.assertEqual(len(fingerprint(deep)), 64)
        shared = ()
        for _ in range(100):
            shared = (shared, shared)
        with self.assertRaisesRegex(Unwalkable, "more than"):
            with unittest.mock.patch("salbench.models.fingerprint.MAX_OBJECTS", 10_000):
                fingerprint(shared)


UNWALKABLE = {
    "lock in an object": ("class N: pass\nc = N()\nc.layers = [1, N()]\nc.layers[1].lock = threading.Lock()\ndef f(s): return c",
                          r"^c\.layers\.lock: a lock"),
    "default": ("def f(s, c=threading.Lock()): return c", r"^default: a lock"),
    "file": ("c = sys.stderr\ndef f(s): return c", "TextIOWrapper"),
    "generator": ("c = (i for i in range(3))\ndef f(s): return c", "generator"),
    "weak reference": ("class C: pass\nd = C()\nc = weakref.ref(d)\ndef f(s): return c", "ReferenceType"),
    "values of a thread of one's own": ("class L(threading.local): pass\nc = L()\ndef f(s): return c", "L "),
    "eval": ("def f(s): return eval('A')", r"eval\(\) may read anything"),
    "modules": ("def f(s): return sys.modules['helper'].g(s)", "sys.modules may read anything"),
    "import of what is not there": ("def f(s):\n import nowhere_at_all\n return nowhere_at_all", "nowhere_at_all"),
    "library": ("import ctypes\nc = ctypes.CDLL(None)\ndef f(s): return c", "CDLL"),
    "function of a library": ("import ctypes\nc = ctypes.CDLL(None).abs\ndef f(s): return c", "pointers"),
    "function that NumPy hides": ("c = np.frompyfunc(lambda x: x, 1, 1)\ndef f(s): return c", "ufunc"),
    "error when asked": ("class E(collections.deque):\n def __reduce__(self): raise KeyError('a')\nc = E()\ndef f(s): return c", "KeyError"),
    "data set": ("import salbench, tempfile\nfolder = tempfile.TemporaryDirectory()\n"
                 "n = pathlib.Path(folder.name, 'a.off').write_text('OFF\\n4 4 0\\n0 0 0\\n1 0 0\\n0 1 0\\n0 0 1\\n3 0 2 1\\n3 0 1 3\\n3 1 2 3\\n"
                 "3 2 0 3\\n')\nc = salbench.Dataset('folder', folder.name)\ndef f(s): return c", r"^c: a Dataset \(salbench.datasets.dataset\) has no content"),
}


class Obstacles(unittest.TestCase):
    def test_what_cannot_be_walked_is_named(self):
        for name, (text, message) in UNWALKABLE.items():
            with self.subTest(name), self.assertRaisesRegex(Unwalkable, message):
                of(text)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Hostile arguments: each of thousands of calls ends in a result or in an exception of Python, and never ends the interpreter.

The calls are the same each time. `arguments_test.py CALL` carries out one of them, and prints what it gets;
`scripts/test asan` has all of them under AddressSanitizer.
"""

import contextlib
import faulthandler
import functools
import inspect
import io
import mmap
import os
import struct
import subprocess
import sys
import tempfile
import unittest
import warnings

import numpy as np

CALLS = int(os.environ.get("SALBENCH_FUZZ_CALLS", "5000"))
# Documented exceptions. UnicodeError is a ValueError.
EXPECTED = (ValueError, TypeError, KeyError, MemoryError)
# Larger values of these take longer, and nothing else.
COSTLY = {"splits", "thresholds", "rounds", "occlusion_samples"}
CHEAP = {"size": 24, "step_degrees": 3.0}


class Refusing:
    """No array, number or text, and says so in its own way."""

    def __array__(self, *_, **__):
        raise ValueError("no array")

    def __index__(self):
        raise ValueError("no index")

    def __float__(self):
        raise ValueError("no number")

    def __str__(self):
        raise ValueError("no text")


class Lying:
    """A sequence that is not as long as it says."""

    def __init__(self, length):
        self.length = length

    def __len__(self):
        return self.length

    def __getitem__(self, i):
        if i >= 3:
            raise IndexError
        return i


def values():
    """Values that are not arrays."""
    return [None, "text", "", b"bytes", 0, 1, -1, 3.5, float("nan"), 10**400, 2**31, 2**63, 2**64, True, 1j, {}, set(), object(),
            len, [], [[]], [None], [[1, 2], [3]], ["a"], {"a": 1}, range(3), iter([1, 2]), (i for i in range(3)), np.float64(1),
            np.int8(-1), np.datetime64("2026-01-01"), np.array("text"), "\0", "\ud800", "a\nb: c", Refusing(), Lying(10), Lying(2**40),
            Refusing, slice(1), Ellipsis, NotImplemented, memoryview(b"abc"), [np.zeros(3), np.zeros(2)], [[[1]]]]


def shapes_of(a):
    """The same numbers in other shapes."""
    yield from (a[:-1], a[None], a.ravel(), a[..., None], a.T, a[:0], a[:1], a.reshape(-1)[0], np.zeros((0, 3), a.dtype), np.zeros((3, 0), a.dtype),
                np.concatenate([a, a]), np.array(a.flat[0]), np.broadcast_to(a.flat[0], (10**13, *a.shape[1:])), np.broadcast_to(a.flat[0], a.shape))


def layouts_of(a):
    """The same numbers in other places of memory."""
    unaligned = np.frombuffer(b"x" + a.tobytes(), np.uint8)[1:].view(a.dtype).reshape(a.shape) if a.size else a
    read_only = a.copy()
    read_only.flags.writeable = False
    yield from (a[::-1], np.repeat(a, 2, axis=0)[::2], np.asfortranarray(a), unaligned, read_only, a[::-2], a.tolist(), a.astype(object),
                np.lib.stride_tricks.as_strided(a, strides=[0] * a.ndim), np.ma.masked_array(a, a == a.flat[0] if a.size else None),
                a.byteswap().view(a.dtype.newbyteorder()))


def types_of(a):
    """The numbers in other types, as far as they fit."""
    for name in ("f2", "f4", ">f4", ">f8", "longdouble", "c16", "i1", "u1", ">i2", "u4", "i8", "u8", "bool", "O", "U9", "S9", "m8[s]", "V8"):
        with contextlib.suppress(TypeError, ValueError):
            yield a.astype(name)
    yield np.zeros(a.shape, [("x", "f8"), ("y", "i4")])


def numbers_of(a, rng):
    """Other numbers in the same shape and type."""
    is_real = a.dtype.kind == "f"
    special = ((np.nan, np.inf, -np.inf, 1e308, -1e308, 1e200, 1e154, 3e153, 1e150, 1e50, 1e20, 1e-20, 1e-100, 1e-154, 1e-160, 1e-308, 5e-324, -0.0, 0.0)
               if is_real else (-1, 0, 1, 10**6, 2**31 - 1, 2**31, -2**31, 2**32, 2**63 - 1, -2**63))
    for value in special:
        one = a.copy() if is_real else a.astype("i8")
        if one.size:
            one.flat[rng.integers(one.size)] = value
        yield one
        yield np.full_like(one, value)
        if is_real:
            yield a * value
    if is_real:
        yield from (a + 1e10, a.round(), a * 10.0 ** rng.integers(-300, 150, a.shape), np.where(rng.random(a.shape) < 0.5, a, 0), rng.normal(size=a.shape))
        if a.ndim == 2 and a.shape[1] == 3 and len(a):
            yield from (a * [1, 0, 0], a[rng.integers(0, len(a), len(a))])
    else:
        yield from (np.full(a.shape, 2**64 - 1, "u8"), rng.integers(-2, 40, a.shape), rng.integers(0, 12, (60, *a.shape[1:])))


def pick(rng, some):
    some = list(some)
    return some[rng.integers(len(some))]


def mutated(rng, value):
    """Something else in place of an argument; often the same with one thing changed."""
    kind = rng.random()
    if kind < 0.03:
        return None
    if kind < 0.15 or not isinstance(value, np.ndarray):
        return pick(rng, values())
    if kind < 0.35:
        return pick(rng, shapes_of(value))
    if kind < 0.5:
        return pick(rng, layouts_of(value))
    if kind < 0.65:
        return pick(rng, types_of(value))
    return pick(rng, numbers_of(value, rng))


def option(rng, parameter):
    """A value for an option; most are of its type."""
    if rng.random() < 0.2:
        return pick(rng, values())
    default = parameter.default
    if isinstance(default, bool):
        return bool(rng.integers(2))
    if isinstance(default, str):
        return pick(rng, ["nearest", "radius", "text", "published", "faces", "pca", "camera", "hoppe", "y", "z", "automatic", "area",
                          "inverse_square", "paper", "single", "cotangent", "taubin", default, "", "no"])
    small = [0, 1, 2, 3, 4, 5, 7, 16, 31, 0.5, 1.5, 0.1, 10.0, -1, -0.5, 1e-9, np.float32(0.5), np.int16(3), "3"]
    large = [100, 1000, 1e4, 1e6, 2**31 - 1, 2**31, 2**64, 1e300, 1e308, -1e308, float("nan"), float("inf"), 5e-324, 10**400]
    return pick(rng, small if parameter.name in COSTLY else small + large)


def shape(rng):
    """A small mesh, with normals, descriptors and what else there may be."""
    n = int(rng.integers(8, 30))
    points = rng.normal(size=(n, 3))
    around = np.arange(2, n)
    faces = np.stack([np.where(around % 2, around, around - 1), np.where(around % 2, around - 1, around), around - 2], axis=1).astype("i4")
    normals = points / np.linalg.norm(points, axis=1)[:, None]
    return {
        "points": points, "faces": faces, "normals": normals, "fpfh": (rng.random((n, 33)) * 50).astype("f4"),
        "viewpoint": rng.normal(size=3) * 9, "ground_truth": rng.random(n), "picks": rng.integers(0, n, 5), "areas": rng.random(n),
        "negatives": rng.random(n),
        "mask": rng.random(n) < 0.8, "prediction": rng.random(n), "reference": rng.random(100), "scan_points": points[::2] + 0.01,
        "samples": points[::2] + 0.01, "values": rng.random(n), "threads": 1, "seed": 3, "item": "a", "scan": bool(rng.integers(2)),
        "time": np.cumsum(1 + rng.random(n)) * 10, "origins": points * 5, "directions": -normals, "valid": rng.random(n) < 0.9,
        "face": rng.integers(0, len(faces), n), "weights": rng.dirichlet((1, 1, 1), n), "depth": rng.random(n), "mass": rng.random(n),
        "view": int(rng.integers(12)), "target_faces": int(rng.integers(n)), "k": 3, "max_distance": 1.0, "metrics": "all", **CHEAP,
    }


def functions():
    import salbench

    stages = [getattr(salbench, name) for name in salbench.__all__]
    chosen = [f for f in stages if inspect.isfunction(f) and f.__name__ not in ("cross_validate", "model", "plan", "run")]
    chosen += [getattr(salbench.models, name) for name in salbench.models.__all__ if name not in ("ModelFunction", "table")]
    return [*chosen, *[salbench.score] * 3, salbench.metrics.auc]


def call(number, known):
    """Function and arguments of a call."""
    import salbench

    rng = np.random.default_rng(number)
    function = known[number % len(known)]
    parts = shape(rng)
    parameters = inspect.signature(function).parameters
    arguments = {name: parts[name] for name, parameter in parameters.items()
                 if name in parts and (parameter.default is inspect.Parameter.empty or name in CHEAP or rng.random() < 0.6)}
    if function.__name__ == "vertex_values_of_samples":
        arguments["values"] = parts["values"][::2].copy()
    if function.__name__ == "vertex_values_of_faces":
        arguments["values"] = np.resize(parts["values"], len(parts["faces"]))
    if function.__name__ in salbench.models.__all__ and rng.random() < 0.15:
        whole = {name: mutated(rng, parts[name]) if rng.random() < 0.2 else parts[name] for name in ("points", "faces", "normals", "fpfh")}
        if rng.random() < 0.5:  # whose parts are checked when it is made
            return functools.wraps(function)(lambda **given: function(salbench.Shape("s", **given))), whole
        arguments = {"points": salbench.Scan(whole["points"], parts["viewpoint"])}
    for name in list(arguments):
        if rng.random() < 1.2 / len(arguments):
            arguments[name] = mutated(rng, arguments[name])
    options = [p for name, p in parameters.items() if name not in parts and p.kind is inspect.Parameter.KEYWORD_ONLY]
    for parameter in options:
        if rng.random() < 0.8 / len(options):
            arguments[parameter.name] = option(rng, parameter)
    if rng.random() < 0.01:
        arguments[pick(rng, ["no_option", "a b", "\ud800", "neighbour"])] = 1
    return function, arguments


def carry_out(first, last, progress):
    """The calls; how many ended in a result, by function. Raises for those that ended otherwise than they may."""
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")
    known = functions()
    done, failed = {}, []
    for number in range(first, last):
        progress(number)
        function, arguments = call(number, known)
        try:
            with contextlib.redirect_stderr(io.StringIO()):
                function(**arguments)
            done[function.__name__] = done.get(function.__name__, 0) + 1
        except EXPECTED:
            done.setdefault(function.__name__, 0)
        except BaseException as error:
            failed.append(f"call {number}, {function.__name__}(): {type(error).__name__}: {error}")
    if failed:
        raise AssertionError("\n".join(failed))
    return done


class Arguments(unittest.TestCase):
    def test_no_argument_ends_the_interpreter(self):
        """In a process of its own, which says how far it came."""
        with tempfile.NamedTemporaryFile() as file:
            file.write(struct.pack("q", -1))
            file.flush()
            ended = subprocess.run([sys.executable, "-B", __file__, "0", str(CALLS), file.name], capture_output=True, text=True)
            file.seek(0)
            reached = struct.unpack("q", file.read(8))[0]
        self.assertEqual(ended.returncode, 0, f"at call {reached}: {ended.stdout}\n{ended.stderr[-6000:]}")
        self.assertEqual(reached, CALLS - 1)
        # Arguments of which nothing is computed would test nothing.
        results = dict(line.split() for line in ended.stdout.splitlines())
        for name, count in results.items():
            self.assertGreater(int(count), 0.1 * CALLS / len(results) / 3, f"{name}: {results}")


def main():
    faulthandler.enable()
    numbers = [int(text) for text in sys.argv[1:3]]
    if len(numbers) == 1:
        function, arguments = call(numbers[0], functions())
        print(function.__name__, arguments, flush=True)
        print(function(**arguments))
        return
    with open(sys.argv[3], "r+b") as file, mmap.mmap(file.fileno(), 8) as reached:
        done = carry_out(*numbers, lambda number: reached.__setitem__(slice(0, 8), struct.pack("q", number)))
    for name, count in done.items():
        print(name, count)


if __name__ == "__main__":
    if len(sys.argv) > 1 and sys.argv[1].isdigit():
        main()
    else:
        unittest.main()

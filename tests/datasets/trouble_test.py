# SPDX-License-Identifier: GPL-3.0-or-later
"""A system in trouble while `import` and `inspect` are at work (full disks, limits, no memory, killed workers): status 3, and the set as it was.
Nothing that a file holds is to blame. The set in each row is one of which a source has changed and another one is gone, so that a call that goes
on would write and remove."""

import dataclasses
import errno
import os
import resource
import signal
import subprocess
import sys
from unittest import mock

from salbench._errors import StorageError, UnreadableError
from salbench import _workers
from salbench.datasets import importing, inspecting
from support import WithArchive, lines, off

ITEMS = ("cat", "cow", "dog", "eel")
LAYOUT = "places: [{meshes: 'm/*', truth: {saliency: 'v/{item}.txt'}}]\nindices: {base: 1}\n"  # of which Python reads every file

# A worker of which something is changed before it serves; it reads with these functions.
WORKER = """import sys; sys.path.insert(0, sys.argv.pop(1))
import builtins, errno, os, resource, shutil
from salbench import _files
from salbench.datasets import sets, worker
def of(function):
    # In place of what reads an item, all of them but cat, which comes first
    read = sets.read
    sets.read = lambda layout, root, item, licence="": read(layout, root, item, licence) if item.name == "cat" else function(item)
def fail(error):
    raise error
def refuse(number, *parts):
    # What opens a file with such a part in its name
    for module, name in ((builtins, "open"), (os, "open")):
        def opened(path, *more, work=getattr(module, name), **options):
            if any(part in os.fsencode(path) for part in parts if isinstance(path, (str, bytes))):
                raise OSError(number, os.strerror(number), path)
            return work(path, *more, **options)
        setattr(module, name, opened)
{trouble}
sys.exit(worker.main())"""

NUMBERS = ("ENOSPC", "EACCES")
SCRATCH = "salbench-scratch-[-0-9a-f]*: cannot be written: "
# Trouble in a worker: what is changed in it, and what is said.
WORKERS = {
    **{f"answers cannot be written: {number}": (f"refuse(errno.{number}, b'salbench-scratch-')", f"cat: .*{SCRATCH}{os.strerror(getattr(errno, number))}; ")
       for number in NUMBERS},
    "a limit on the size of files": ("resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))", f"{SCRATCH}File too large; raise the limit"),
    "the scratch folder is gone": ("of(lambda item: shutil.rmtree(os.environ['TMPDIR']) or fail(ValueError('x')))", f"{SCRATCH}No such file"),
    **{f"no file can be had: {number}": (f"refuse(errno.{number}, b'/v/cow.txt')", f"cow: .*/v/cow.txt: cannot be read: {os.strerror(getattr(errno, number))}")
       for number in ("EMFILE", "ENOMEM")},
    "a real limit on open files": ("resource.setrlimit(resource.RLIMIT_NOFILE, (3, 3))",
                                    "cat: the process that was to read it could not begin .status 1.; see above"),
    "a library cannot be loaded": ("of(lambda item: fail(ImportError('libopenblas.so: failed to map segment')))",
                                    "cow: a library cannot be loaded: libopenblas"),
    **{f"killed by signal {number}": (f"of(lambda item: os.kill(os.getpid(), {number}))",
                                      f"cow: the process that reads it was ended from outside, twice .signal {number}: .*; run it again, with more memory")
       for number in (signal.SIGKILL, signal.SIGTERM)},
    "it cannot begin": ("sys.exit(1)", "cat: the process that was to read it could not begin .status 1.; see above"),
    "it cannot begin, by a signal": ("os.abort()", "cat: the process that was to read it could not begin .signal 6: Aborted."),
}
# Trouble with one file, which `inspect` names and goes on.
FILES = {
    **{f"not handed over: {number}": (f"refuse(errno.{number}, b'/v/cow.txt')", f"cow: .*/v/cow.txt: cannot be read: {os.strerror(getattr(errno, number))}")
       for number in ("EACCES", "EIO")},
    "no memory": ("of(lambda item: fail(MemoryError()))", "cow: no memory for it; close other programs"),
    "no memory for an array": ("import numpy\nof(lambda item: numpy.zeros(1 << 45))", "cow: no memory for it; close other programs"),
    "a limit on memory": ("of(lambda item: worker._limits.limit(60, 0) or bytearray(1 << 30))", "cow: no memory for it; close other programs"),
    "no memory for the answer": ("from salbench.datasets import one_form\none_form.image = lambda form: fail(MemoryError())", "cat: no memory for it; close"),
}


class Trouble(WithArchive):
    def setUp(self):
        super().setUp()
        self.to = self.root.parent / "to"
        self.scratch = self.root.parent / "scratch"
        self.write_items()
        self.own.write_text(LAYOUT)
        self.imported()
        self.before = self.files()
        self.write({"v/cow.txt": lines([4, 3, 2, 2])})
        (self.root / "m/eel.off").unlink()
        (self.root / "v/eel.txt").unlink()

    def write_items(self):
        for name in ITEMS:
            self.write({f"m/{name}.off": off(), f"v/{name}.txt": lines([1, 2, 3, 4])})

    def files(self):
        return {str(path.relative_to(self.to)): (path.stat().st_mtime_ns, path.read_bytes()) for path in self.to.rglob("*") if path.is_file()}

    def imported(self):
        return importing.import_set(str(self.own), str(self.root), str(self.to))

    def inspected(self):
        return inspecting.inspected(str(self.own), str(self.root))

    def refused(self, work, said):
        with self.assertRaisesRegex(StorageError, said) as caught:
            work()
        self.assertNotIn("\n", str(caught.exception))
        self.assertNotRegex(str(caught.exception), "damaged|write the file again|defect")
        self.assertEqual(self.files(), self.before)

    def with_workers(self, trouble):
        """One worker, so that `cat` comes first."""
        self.scratch.mkdir(exist_ok=True)
        return (mock.patch.object(_workers, "_START", WORKER.replace("{trouble}", trouble)), mock.patch.dict(os.environ, {"TMPDIR": str(self.scratch)}),
                mock.patch.object(os, "sched_getaffinity", lambda _: {0}))

    def test_of_a_worker(self):
        for name, (trouble, said) in (WORKERS | FILES).items():
            one, two, three = self.with_workers(trouble)
            with self.subTest(name), one, two, three:
                self.refused(self.imported, f"{said}.*; the set in {self.to} is as it was")

    def test_of_a_worker_that_inspects(self):
        for name, (trouble, said) in WORKERS.items():
            one, two, three = self.with_workers(trouble)
            with self.subTest(name), one, two, three:
                self.refused(self.inspected, said)
        for name, (trouble, said) in FILES.items():
            if "answer" not in name:
                one, two, three = self.with_workers(trouble)
                with self.subTest(name), one, two, three:
                    self.assertRegex(self.inspected()["problems"][0], said)

    def test_of_the_folder_of_the_set(self):
        """At each of the files: what is changed, the index."""
        for number in (errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EFBIG, errno.EACCES, errno.EIO, errno.EMFILE):
            for at in range(2):
                count = 0

                def opened(path, *more, work=os.open, **options):
                    nonlocal count
                    if str(path).endswith(".unfinished"):
                        count += 1
                        if count > at:
                            raise OSError(number, os.strerror(number), path)
                    return work(path, *more, **options)

                with self.subTest(errno.errorcode[number], at=at):
                    self.refused(mock.patch("salbench._files.os.open", opened)(self.imported),
                                 f"{self.to}/{['items/cow.h5', 'index.csv'][at]}: cannot be written: {os.strerror(number)}; choose another")

    def test_of_this_process(self):
        for name, what, error, said in (
                ("no process", "subprocess.Popen", OSError(errno.EAGAIN, os.strerror(errno.EAGAIN)), "Resource temporarily unavailable"),
                ("no memory", "_workers._taken", MemoryError(), "no memory for it"),
                ("no descriptor", "_workers._taken", OSError(errno.EMFILE, os.strerror(errno.EMFILE), "out"), "out: cannot be read: Too many open"),
                ("no listing", "datasets._files.os.scandir", OSError(errno.EACCES, os.strerror(errno.EACCES), "m"), "cannot be listed: Permission denied"),
                ("no index", "datasets.one_form.read_index", UnreadableError("index.csv: cannot be read: Input/output error"), "cannot be read: Input")):
            target = what if what.startswith("subprocess") else f"salbench.{what}"
            with self.subTest(name):
                self.refused(mock.patch(target, mock.Mock(side_effect=error))(self.imported), f"{said}.*; the set in {self.to} is as it was")

    def test_of_a_set_that_is_written_by_hand(self):
        """The shape that cannot be written comes after one that can."""
        import salbench
        from salbench.datasets import one_form

        shapes = list(salbench.Dataset("hdf5", self.to))
        changed = [dataclasses.replace(shape, points=2 * shape.points) for shape in shapes]
        own = str(self.root.parent / "own")
        one_form.write(own, shapes)
        self.to = self.root.parent / "own"
        self.before = self.files()

        def all_but_the_last():
            yield from changed[:2]
            raise StorageError("the disk is full")

        self.refused(lambda: one_form.write(own, all_but_the_last()), "the disk is full")

    def test_status_of_the_commands(self):
        full = self.root.parent / "full"
        full.mkdir()
        mounted = os.geteuid() == 0 and subprocess.run(["mount", "-t", "tmpfs", "-o", "size=4k", "tmpfs", full], capture_output=True).returncode == 0
        if mounted:
            self.addCleanup(subprocess.run, ["umount", "-l", full])
            self.to_fill(full)

        def limited(kind, most):
            return lambda: resource.setrlimit(kind, (most, most))

        rows = [("ulimit -f", {"preexec_fn": limited(resource.RLIMIT_FSIZE, 1000)}, {}, "File too large; raise the limit"),
                ("no TMPDIR", {}, {"TMPDIR": "/proc"}, "set TMPDIR to another"),
                *([("a full TMPDIR", {}, {"TMPDIR": str(full)}, "No space left on device; ")] if mounted else [])]
        for command in ("import", "inspect"):
            words = [command, str(self.own), "--data", str(self.root), *(["--to", str(self.to)] if command == "import" else [])]
            for name, how, environment, said in rows:
                if command == "inspect" and name == "ulimit -f":
                    continue  # its answers are short
                with self.subTest(command, name=name):
                    done = subprocess.run([sys.executable, "-P", "-m", "salbench", *words], capture_output=True, text=True, env=os.environ | environment, **how)
                    self.assertEqual((done.returncode, done.stderr.count("\n"), done.stdout), (3, 1, ""), done.stderr)
                    self.assertIn(said, done.stderr)
                    self.assertEqual(self.files(), self.before)
        done = self.imported()
        self.assertEqual(({shape.name: shape.outcome for shape in done.shapes}, done.removed), ({"cat": "unchanged", "cow": "written", "dog": "unchanged"}, 1))

    def to_fill(self, folder):
        with open(folder / "filling", "wb") as file:
            try:
                while True:
                    file.write(b"x" * 512)
                    file.flush()
            except OSError:
                pass
            finally:
                os.dup2(os.open(os.devnull, os.O_WRONLY), file.fileno())

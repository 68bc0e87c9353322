# SPDX-License-Identifier: GPL-3.0-or-later
"""Subcommands of the package that stop where they are at work, in whichever of their processes, until a test says go or ends them."""

import os
import select
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.support import forked

PATIENCE = 100  # s, of a test that fails

HERE = """
def here(*_, **__):
    # Tells that this was reached, and waits for the word to go, which is for all who come after it, too. Polls: Python handles a signal that
    # arrives just before a blocking call only after that call returns.
    import os, time
    with open({at_work!r}, "wb") as told:
        told.write(b"x")
    while os.path.exists({stay!r}):
        time.sleep(.01)

def before(work):
    def call(*arguments, **options):
        here()
        return work(*arguments, **options)
    return call
"""
MAIN = "import sys\nfrom salbench.__main__ import main\nsys.exit(main())\n"


class Stopped:
    """`patch`: code that makes something call `here`, or `before(something)`. {HERE} in it is the text of these functions, for code that
    another process runs. Scratch folders are made below `self.scratch`. in_a_fork: for a process that will not come to the end of its
    interpreter, a fork of this one takes less time than a new one."""

    def __init__(self, patch, *words, line=None, in_a_fork=False, **environment):
        self._holder = tempfile.TemporaryDirectory()
        folder = Path(self._holder.name)
        self.scratch = folder / "scratch"
        self.scratch.mkdir()
        at_work, self._stay = folder / "at_work", folder / "stay"
        os.mkfifo(at_work)
        self._stay.touch()
        self._at_work = os.open(at_work, os.O_RDWR)
        self.here = HERE.format(at_work=str(at_work), stay=str(self._stay))
        patch, environment = f"HERE = {self.here!r}\n{self.here}\n{patch}\n", {"TMPDIR": str(self.scratch)} | environment
        line, words = line or [sys.executable, "-P", "-B", "-c", patch + MAIN], [*map(str, words)]

        def carry_out():
            os.closerange(3, os.sysconf("SC_OPEN_MAX"))  # also what Popen waits for until a program has started
            forked.carry_out(words, {}, lambda: exec(patch, {}), environment)

        self.process = subprocess.Popen([*line, *words], env=os.environ | environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                        start_new_session=True, restore_signals=not in_a_fork, preexec_fn=carry_out if in_a_fork else None)

    def __enter__(self):
        """At work."""
        end = os.pidfd_open(self.process.pid)
        try:
            reached, _, _ = select.select([self._at_work, end], [], [], PATIENCE)
        finally:
            os.close(end)
        if self._at_work not in reached:
            self.process.kill()
            raise AssertionError(f"it was never at work: {self.process.communicate()}")
        return self

    def go(self):
        self._stay.unlink()

    def signal(self, number, to_all=False):
        (os.killpg if to_all else os.kill)(self.process.pid, number)

    def ended(self):
        """Status, and what it wrote to the error stream: once no process is left that has it open."""
        _, errors = self.process.communicate(timeout=PATIENCE)
        return self.process.returncode, errors

    def __exit__(self, *_):
        if self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.communicate()
        os.close(self._at_work)
        self._holder.cleanup()

    def scratch_left(self):
        return sorted(os.listdir(self.scratch))

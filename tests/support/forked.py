# SPDX-License-Identifier: GPL-3.0-or-later
"""Subcommands of the package, each in a process of its own that has what the test has imported: half a second less than a new interpreter.
Not for tests that have computed anything themselves: threads do not come along."""

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import traceback
from pathlib import Path

from salbench import __main__

# Has its command line carried out by the process that reads {calls}; ends with the same status.
CALLER = """#!/bin/sh
mkfifo '{folder}/'$$
echo $$ > '{calls}'
read status < '{folder}/'$$
exit "$status"
"""


def salbench(*words, before=None, **environment):
    """`python3 -m salbench WORDS`. before: called in the process, such as to set limits."""
    words = [*map(str, words)]
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as errors:
        child = os.fork()
        if child == 0:
            carry_out(words, {1: out.fileno(), 2: errors.fileno()}, before, environment)
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        texts = []
        for file in (out, errors):
            file.seek(0)
            texts.append(file.read().decode(errors="replace"))
    return subprocess.CompletedProcess(words, status, *texts)


@contextlib.contextmanager
def named(folder, before=None):
    """`salbench` in a folder, for scripts that have it on their PATH: each call is forked from a process that is forked here.
    before: called in the process with the words of the command line."""
    with tempfile.TemporaryDirectory() as scratch:
        calls = f"{scratch}/calls"
        os.mkfifo(calls)
        file = Path(folder, "salbench")
        file.write_text(CALLER.format(folder=scratch, calls=calls))
        file.chmod(0o755)
        server = os.fork()
        if server == 0:
            try:
                _serve(calls, scratch, before)
            finally:
                os._exit(1)
        try:
            yield
        finally:
            os.kill(server, signal.SIGKILL)
            os.waitpid(server, 0)


def _serve(calls, scratch, before):
    with open(os.open(calls, os.O_RDWR)) as file:  # which never ends
        for caller in map(str.strip, file):
            if os.fork() == 0:
                _answer(caller, f"{scratch}/{caller}", before)
            with contextlib.suppress(ChildProcessError):
                while os.waitpid(-1, os.WNOHANG)[0]:
                    pass


def _answer(caller, place, before):
    """Carries out the command line of a process with the streams, the folder and the environment of it."""
    here = Path("/proc", caller)
    words, environment = (os.fsdecode((here / name).read_bytes()).split("\0")[:-1] for name in ("cmdline", "environ"))
    files = {number: os.open(here / f"fd/{number}", os.O_WRONLY | os.O_APPEND if number else os.O_RDONLY) for number in (0, 1, 2)}
    os.chdir(here / "cwd")
    child = os.fork()
    if child == 0:
        os.environ.clear()
        carry_out(words[2:], files, before and (lambda: before(words[2:])), dict(line.split("=", 1) for line in environment))
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    Path(place).write_text(f"{status if status >= 0 else 128 - status}\n")
    os._exit(0)


def carry_out(words, files, before, environment):
    status = 1  # as of an interpreter that an exception ends
    try:
        for number, file in files.items():
            os.dup2(file, number)
        sys.stdout, sys.stderr = open(1, "w", closefd=False), open(2, "w", closefd=False)
        sys.argv = ["salbench", *words]
        os.environ.update(environment)
        if before:
            before()
        status = __main__.main()
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else 1
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)

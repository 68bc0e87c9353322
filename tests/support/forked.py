# SPDX-License-Identifier: GPL-3.0-or-later
"""Subcommands of the package, each in a process of its own that has what the test has imported: half a second less than a new interpreter.
Not for tests that have computed anything themselves: threads do not come along."""

import os
import subprocess
import sys
import tempfile
import traceback

from salbench import __main__


def salbench(*words, before=None, **environment):
    """`python3 -m salbench WORDS`. before: called in the process, such as to set limits."""
    words = [*map(str, words)]
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as errors:
        child = os.fork()
        if child == 0:
            _carry_out(words, out, errors, before, environment)
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        texts = []
        for file in (out, errors):
            file.seek(0)
            texts.append(file.read().decode(errors="replace"))
    return subprocess.CompletedProcess(words, status, *texts)


def _carry_out(words, out, errors, before, environment):
    status = 1  # as of an interpreter that an exception ends
    try:
        os.dup2(out.fileno(), 1)
        os.dup2(errors.fileno(), 2)
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

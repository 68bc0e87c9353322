# SPDX-License-Identifier: GPL-3.0-or-later
"""Processes that read files of strangers (_serving.py), from the side that asks them. One that dies fails what it was asked, and the next question starts another. One that
somebody else killed says nothing about its input: another is asked the same, once, and then the system is in trouble, as it is where one cannot
begin, or not write."""

from __future__ import annotations

import array
import atexit
import fcntl
import os
import signal
import subprocess
import termios
import threading
from collections.abc import Callable, Sequence
from typing import Any

from salbench import _limits, _wire
from salbench._errors import InputError, Interrupted, StorageError
from salbench._limits import ERROR
from salbench._processes import FROM_OUTSIDE, start, text_of_signal
from salbench._scratch import ScratchFolder

_START = "import sys; sys.path.insert(0, sys.argv[1]); from salbench.datasets.worker import main; sys.exit(main(int(sys.argv[2])))"


class NotRead(StorageError):
    """The process that reads was ended by somebody else, twice: what it was to read is not to blame."""


class Worker:
    """One process, started by the first question. code: of Python, that serves; by default data sets."""

    def __init__(self, code: str = "") -> None:
        self._code, self._is_ended = code, False
        self._process: subprocess.Popen[bytes] | None = None
        self._scratch: ScratchFolder | None = None
        self._folder = ""

    def ask(self, request: dict[str, Any]) -> tuple[bytes | None, list[str]]:
        """What it made, and what is wrong with the input: lines. Throws StorageError for what is wrong with the system."""
        answer = self.answer_or_status(request)
        return (None, [how_ended(answer)]) if isinstance(answer, int) else answer

    def answer_or_status(self, request: dict[str, Any]) -> tuple[bytes | None, list[str]] | int:
        """Likewise; the status with which it ended in place of an answer, if that was not from outside."""
        answer = self._answer(request)
        if isinstance(answer, int) and -answer in FROM_OUTSIDE and not self._is_ended:
            answer = self._answer(request)
        if isinstance(answer, int) and -answer in FROM_OUTSIDE:
            raise NotRead(f"{_name(request)}: the process that reads it was ended from outside, twice ({text_of_signal(answer)}); run it again, with "
                          "more memory free")
        return answer

    def _answer(self, request: dict[str, Any]) -> tuple[bytes | None, list[str]] | int:
        """The status with which it ended in place of an answer."""
        if self._process is None:
            self._start()
        assert self._process is not None and self._process.stdin and self._process.stdout
        out = os.path.join(self._folder, "out")
        question = _wire.dumps(request) + f"\t{out}\n".encode()
        before: list[str] = []
        try:
            self._process.stdin.write(question)
            self._process.stdin.flush()
            while (line := self._process.stdout.readline()) not in (os.fsencode(out) + b"\n", b""):
                before.append(line.decode("utf-8", "surrogateescape").strip())
        except BrokenPipeError:
            line = b""
        made, problems = _taken(out), _taken(out + ERROR) or b""
        if not line:  # what it left is of no use
            unread = bytes_unread(self._process.stdin.fileno())
            status = self._end()
            if unread and -status not in FROM_OUTSIDE:
                raise StorageError(f"{_name(request)}: the process that was to read it could not begin ({_ended_by(status)}); see above, and run it again")
            return status
        if before or (made is None and not problems):
            raise StorageError(f"{_name(request)}: {' '.join(before) or f'{self._folder}: the answer is gone; set TMPDIR to another'}")
        return made, problems.decode("utf-8", "surrogateescape").splitlines()

    def end(self) -> None:
        """For another thread: what it was asked is not answered."""
        self._is_ended = True
        if (process := self._process) is not None:
            process.kill()

    def close(self) -> None:
        """A worker that is at work is ended."""
        if self._process is not None:
            self._process.kill()
            self._end()
        if self._scratch is not None:
            self._scratch.__exit__()
            self._scratch = None

    def _start(self) -> None:
        if self._scratch is None:
            self._scratch = ScratchFolder()
            self._folder = self._scratch.__enter__()
        # One thread: items are what is shared out, and stacks of more count as memory.
        self._process = start(self._code or _START, str(os.getpid()), stdout=subprocess.PIPE, env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
        if self._is_ended:
            self._process.kill()

    def _end(self) -> int:
        """Waits for it: its status, minus the signal that ended it."""
        process, self._process = self._process, None
        assert process is not None and process.stdin and process.stdout
        status = process.wait()
        process.stdout.close()
        try:
            process.stdin.close()
        except BrokenPipeError:
            pass
        return status


def bytes_unread(pipe: int) -> int:
    """That are still in it; 0 where that is not known."""
    count = array.array("i", [0])
    try:
        fcntl.ioctl(pipe, termios.FIONREAD, count)
    except OSError:
        return 0
    return count[0]


def _name(request: dict[str, Any]) -> str:
    """Of what a request is about."""
    row = request["item"] if "item" in request else next(iter(request.get("items", [])), {})
    return str(request.get("path") or row.get("shape") or row.get("name") or request.get("do"))


def _ended_by(status: int) -> str:
    return text_of_signal(status) if status < 0 else f"status {status}"


def how_ended(status: int) -> str:
    if status == -signal.SIGXCPU:
        return f"damaged: reading took more than {_limits.SECONDS} s, and {_limits.SECONDS_PER_MB} s per MB; write the file again"
    how = f"crashed ({text_of_signal(status)})" if status < 0 else f"ended with status {status}"
    return f"damaged: the process that reads it {how}; write the file again"


class Pool:
    """Workers that stay at work, as many as there are threads that ask at the same time. A child that was forked starts its own."""

    def __init__(self) -> None:
        self._begin_anew()
        os.register_at_fork(after_in_child=self._begin_anew)
        atexit.register(self.close)

    def _begin_anew(self) -> None:
        self._idle: list[Worker] = []
        self._at_work: set[Worker] = set()
        self._is_ending = False

    def ask(self, request: dict[str, Any]) -> bytes:
        """Throws InputError, StorageError, and Interrupted after `end_all`."""
        try:
            worker = self._idle.pop()
        except IndexError:
            worker = Worker()
        self._at_work.add(worker)
        try:
            answer = None if self._is_ending else worker.answer_or_status(request)
        except NotRead:
            if not self._is_ending:
                raise
        finally:
            self._at_work.discard(worker)
            if self._is_ending:
                worker.close()
            else:
                self._idle.append(worker)
        if self._is_ending or answer is None:
            raise Interrupted("the run ends")
        if isinstance(answer, int):
            raise InputError(f"{_name(request)}: {how_ended(answer)}")
        made, problems = answer
        if made is None:
            raise InputError(problems[0])
        return made

    def end_all(self) -> None:
        """For another thread: whoever waits for an answer has Interrupted, as has whoever asks, until `begin`."""
        self._is_ending = True
        for worker in list(self._at_work):
            worker.end()

    def begin(self) -> None:
        self._is_ending = False

    def close(self) -> None:
        """Ends those that nobody asks."""
        while self._idle:
            self._idle.pop().close()


asked = Pool().ask


def ask_all(requests: Sequence[dict[str, Any]], done: Callable[[int, bytes | None, list[str]], None], processes: int | None = None,
            each_by: str = "") -> bool:
    """Asks as many workers at once as there are processors. `done` is called with the number of the request and its answer, by one thread at
    a time. False after Ctrl-C, which lets the requests at work end; a second one is a KeyboardInterrupt. Throws what `Worker.ask` throws, and
    asks no more then.

    each_by: code of a process for each request alone, since one may take its process over. What such a process does is a problem of its
    request: others go on after one that was ended from outside, and Ctrl-C ends those at work."""
    numbers = iter(range(len(requests)))
    lock, stopped = threading.Lock(), False
    failures: list[BaseException] = []
    workers: set[Worker] = set()

    def ask(worker: Worker, number: int) -> None:
        try:
            made, problems = worker.ask(requests[number])
        except NotRead as error:
            if not each_by:
                raise
            made, problems = None, [str(error)]
        finally:
            if each_by:
                worker.close()
        with lock:
            if not (each_by and stopped):
                done(number, made, problems)

    def work(at_work: int) -> None:
        nonlocal stopped
        worker = Worker(each_by)
        workers.add(worker)
        try:
            while not stopped:
                with lock:
                    number = next(numbers, None)
                if number is None:
                    return
                ask(worker, number)
        except BaseException as error:  # of `done`, such as a full disk
            failures.append(error)
            stopped = True
        finally:
            worker.close()
            os.close(at_work)

    count = min(processes or len(os.sched_getaffinity(0)), len(requests))
    # A pipe whose writing ends the threads have. Ctrl-C leaves it whole; it breaks locks of threading, and join() of them.
    all_ended, at_work = os.pipe()
    for _ in range(count):
        threading.Thread(target=work, args=(os.dup(at_work),), daemon=True).start()
    os.close(at_work)
    interrupted, waits = False, True
    while waits:
        try:
            waits = os.read(all_ended, 1) != b""
        except KeyboardInterrupt:
            if interrupted:
                raise
            interrupted = stopped = True
            for worker in list(workers) if each_by else []:
                worker.end()
    os.close(all_ended)
    if failures and not (each_by and interrupted):
        raise failures[0]
    return not interrupted


def _taken(path: str) -> bytes | None:
    try:
        with open(path, "rb") as file:
            data = file.read()
    except FileNotFoundError:
        return None
    os.unlink(path)
    return data

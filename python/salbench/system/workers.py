# SPDX-License-Identifier: GPL-3.0-or-later
"""Processes that read untrusted files: a file can crash only its reader.

A question names a function and its arguments; the answer is its result or its error. Both are pickled, and
sent over a pair of sockets. A worker that dies fails its question, and the next question starts another one.
If a worker was killed from outside, for example for lack of memory, the question is repeated once, since its
file is not to blame.
"""

import atexit
import importlib
import os
import pickle
import signal
import subprocess
import threading
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection, Pipe
from typing import Any, NamedTuple

from salbench.system import limits
from salbench.system.errors import InputError, Interrupted, StorageError, UnreadableError, message
from salbench.system.files import ADVICE, LACKING
from salbench.system.processes import (
    FROM_OUTSIDE,
    end_with_parent,
    leave_interrupts_to_parent,
    start,
    text_of_signal,
)

_START = (
    "import sys; sys.path.insert(0, sys.argv[1]); from salbench.system.workers import serve; serve(*map(int,"
    " sys.argv[2:]))"
)
# factor from processor time to the timeout of an answer, since a reader may sleep
_WAITS = 10
_ERRORS: dict[str, type[Exception]] = {
    kind.__name__: kind for kind in (UnreadableError, InputError, StorageError, MemoryError)
}


class Question(NamedTuple):
    function: str  # "module:name"
    arguments: tuple[Any, ...]
    name: str  # prefix of messages about a process that ended
    files: Sequence[str] = ()  # their sizes determine the processor time
    of_map: bool = False  # needs little memory
    program: str = ""  # a user's Python file that reads them, and may be at fault instead


class NotRead(StorageError):
    """The reading process was ended from outside, twice: its file is not to blame."""


def is_of_the_system(error: BaseException) -> bool:
    """True for errors that say nothing about the input, such as an unloadable library or a limit on open
    files."""
    return isinstance(error, (StorageError, ImportError)) or (
        isinstance(error, OSError) and error.errno in LACKING
    )


class Worker:
    """One process, started by the first question."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._connection: Connection | None = None
        self.is_ended = False

    def ask(self, question: Question) -> Any:
        """Asks a question. Throws as `Pool.ask`; NotRead after `end`."""
        try:
            answer = self._answer(question)
            if isinstance(answer, int) and -answer in FROM_OUTSIDE and not self.is_ended:
                answer = self._answer(question)
        except MemoryError as error:  # in this process
            self.close()
            raise StorageError(f"{question.name}: {message(error)}") from None
        except BaseException:  # such as Ctrl-C: the answer would be taken for that to the next question
            self.close()
            raise
        if isinstance(answer, int):
            raise _error_of(answer, question)
        kind, value = answer
        if kind:
            # ends more than this question
            raise kind(f"{question.name}: {value}" if kind is StorageError else value)
        return value

    def _answer(self, question: Question) -> tuple[type[Exception] | None, Any] | int:
        """Returns the result of `_loaded`, or the status of a process that ended."""
        has_begun = self._process is not None
        if not has_begun:
            self._start(question.name)
        assert self._process and self._connection
        try:
            if not has_begun:
                self._connection.recv_bytes()
                has_begun = True
            self._connection.send(question)
            if not self._connection.poll(_WAITS * limits.seconds_for(question.files)):
                self.close()
                return -signal.SIGXCPU
            answer = self._connection.recv_bytes()
        except (EOFError, OSError):
            status = self._process.wait()
            self.close()
            if not has_begun and -status not in FROM_OUTSIDE:
                raise StorageError(
                    f"{question.name}: the process that was to read it could not begin ({_text_of(status)});"
                    " see above, and run it again"
                ) from None
            return status
        return _loaded(answer)

    def _start(self, name: str) -> None:
        # One thread each: files are read in parallel, and stacks of further threads count as memory.
        environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
        try:
            self._connection, theirs = Pipe()
            with theirs:  # output of libraries is no answer, and goes to standard error
                self._process = start(
                    _START,
                    str(os.getpid()),
                    str(theirs.fileno()),
                    pass_fds=[theirs.fileno()],
                    stdin=subprocess.DEVNULL,
                    stdout=2,
                    env=environment,
                )
        except OSError as error:
            raise StorageError(
                f"{name}: no process to read it:"
                f" {error.strerror}{ADVICE.get(error.errno or 0, '; run it again')}"
            ) from None
        if self.is_ended:
            self._process.kill()

    def end(self) -> None:
        """For another thread: ends the process without an answer."""
        self.is_ended = True
        if (process := self._process) is not None:
            process.kill()

    def close(self) -> None:
        if self._process is not None and self._connection is not None:
            self._process.kill()
            self._process.wait()
            self._connection.close()
        self._process = self._connection = None


class Pool:
    """Workers that stay alive, as many as there are threads that ask simultaneously. A forked child starts
    its own."""

    def __init__(self) -> None:
        self._begin_anew()
        os.register_at_fork(after_in_child=self._begin_anew)
        atexit.register(self.close)

    def _begin_anew(self) -> None:
        self._idle: list[Worker] = []
        self._at_work: set[Worker] = set()
        self._is_ending = False

    def ask(self, question: Question) -> Any:
        """Returns the function's result. Throws InputError, UnreadableError, MemoryError and, prefixed with
        the question's name, StorageError like the function; InputError for its other exceptions and for a
        process that crashes or takes too long; NotRead; Interrupted after `end_all`."""
        try:
            worker = self._idle.pop()
        except IndexError:
            worker = Worker()
        self._at_work.add(worker)
        try:
            if not self._is_ending:
                return worker.ask(question)
        except Exception:
            if not self._is_ending:
                raise
        finally:
            self._at_work.discard(worker)
            if worker.is_ended:
                worker.close()
            else:
                self._idle.append(worker)
        raise Interrupted("the run ends")

    def end_all(self) -> None:
        """For another thread: all callers that wait or ask get Interrupted, until `begin`."""
        self._is_ending = True
        for worker in list(self._at_work):
            worker.end()

    def begin(self) -> None:
        self._is_ending = False

    def close(self) -> None:
        """Ends idle workers."""
        while self._idle:
            self._idle.pop().close()


asked = Pool().ask


def ask_all(
    questions: Sequence[Question], done: Callable[[int, Any, str], None], processes: int | None = None
) -> bool:
    """Asks as many workers in parallel as there are processors. Calls `done` with the number of each
    question, its value and a problem, one line or "", from one thread at a time. False after Ctrl-C, which
    lets running questions end; a second one raises KeyboardInterrupt. Throws StorageError and exceptions of
    `done`, and stops then."""
    numbers, lock, stopped = iter(range(len(questions))), threading.Lock(), False
    workers = [Worker() for _ in range(min(processes or len(os.sched_getaffinity(0)), len(questions)))]
    failures: list[BaseException] = []

    def work(worker: Worker, at_work: int) -> None:
        nonlocal stopped
        try:
            while not stopped and (number := next(numbers, None)) is not None:
                value, problem = None, ""
                try:
                    value = worker.ask(questions[number])
                except (InputError, MemoryError) as error:
                    problem = message(error)
                with lock:
                    done(number, value, problem)
        except BaseException as error:  # from `done`, such as a full disk
            failures.append(error)
            stopped = True
        finally:
            worker.close()
            os.close(at_work)

    # The threads hold the writing ends of a pipe, which Ctrl-C cannot break; it breaks locks of threading,
    # and join().
    all_ended, at_work = os.pipe()
    for worker in workers:
        threading.Thread(target=work, args=(worker, os.dup(at_work)), daemon=True).start()
    os.close(at_work)
    interrupted, waits = False, True
    while waits:
        try:
            waits = os.read(all_ended, 1) != b""
        except KeyboardInterrupt:
            if interrupted:
                raise
            interrupted = stopped = True
    os.close(all_ended)
    if failures:
        raise failures[0]
    return not interrupted


def _error_of(status: int, question: Question) -> InputError | NotRead:
    name, is_late = question.name, status == -signal.SIGXCPU
    if -status in FROM_OUTSIDE:
        return NotRead(
            f"{name}: the process that reads it was ended from outside, twice ({_text_of(status)}); run it"
            " again, with more memory free"
        )
    how = (
        f"took more than {limits.SECONDS} s, and {limits.SECONDS_PER_MB} s per MB"
        if is_late
        else f"crashed ({_text_of(status)})"
    )
    if question.program:
        return InputError(
            f"{name}: read() of {question.program} {how} on this item; correct it, or leave the item out"
        )
    return InputError(
        f"{name}: damaged: {'reading' if is_late else 'the process that reads it'} {how}; write the file"
        " again"
    )


def _text_of(status: int) -> str:
    return text_of_signal(status) if status < 0 else f"status {status}"


def _loaded(answer: bytes) -> tuple[type[Exception] | None, Any]:
    """Class and text of an error, or None and the value."""
    kind, value = pickle.loads(answer)
    return _ERRORS[kind] if kind else None, value


def serve(parent: int, connection: int) -> None:
    """Answers questions until the connection, or the parent, ends."""
    import logging

    leave_interrupts_to_parent()
    end_with_parent(parent)
    logging.basicConfig(format="warning: %(message)s")
    with Connection(connection) as asking:
        asking.send_bytes(b"")  # reports readiness
        while True:
            try:
                question = asking.recv()
            except EOFError:
                return
            asking.send_bytes(_answer(question))


def _answer(question: Question) -> bytes:
    try:
        limits.limit(limits.seconds_for(question.files), limits.BYTES_OF_A_MAP if question.of_map else None)
        module, _, function = question.function.partition(":")
        return pickle.dumps(("", getattr(importlib.import_module(module), function)(*question.arguments)), 5)
    except Exception as error:  # the file of one question must not end the process that reads the others
        kinds = ["StorageError"] * is_of_the_system(error) + [
            name for name, kind in _ERRORS.items() if isinstance(error, kind)
        ]
        return pickle.dumps(((kinds or ["InputError"])[0], message(error)))

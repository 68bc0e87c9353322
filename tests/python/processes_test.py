# SPDX-License-Identifier: GPL-3.0-or-later
"""How processes of the package end by signals, and with their parent. Subcommands: ended_test.py."""

import signal
import subprocess
import sys
import unittest

# Polls its input: Python handles a signal that arrives just before a blocking call only after that call returns.
WAITING = """
import select, sys
from salbench.system.processes import ends_at_once, raise_interrupts, say_interrupted
words = ["report", "a b"]
def wait():
    while not select.select([0], [], [], .01)[0]:
        pass
try:
    raise_interrupts(words)
    print("ready", flush=True)
    wait()
except KeyboardInterrupt:
    print("asked", flush=True)
    {then}
"""
LAST_WORDS = "\ninterrupted; everything finished so far is kept. To go on:\n  salbench report 'a b'\n"
PARENT = """
import os, subprocess, sys, threading
from salbench.system.processes import PYTHON
child = '''
import signal, sys
from salbench.system.processes import end_with_parent
end_with_parent(int(sys.argv[1]) if len(sys.argv) > 1 else None)
print("ready", flush=True)
signal.pause()
'''
def start():
    subprocess.Popen([*PYTHON, "-c", child, *map(str, [os.getpid()] if len(sys.argv) > 1 else [])])
thread = threading.Thread(target=start)  # a thread that ends is no parent that does
thread.start()
thread.join()
sys.stdin.read()
"""


class Processes(unittest.TestCase):
    def started(self, code, *arguments, before=None):
        process = subprocess.Popen([sys.executable, "-P", "-c", code, *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True, preexec_fn=before)
        self.addCleanup(process.communicate)
        return process

    def test_a_signal_is_an_interrupt_and_a_second_one_the_end(self):
        """The same one again ends a process as it does any, even one that is busy in compiled code."""
        for first in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            for second in (signal.SIGINT, signal.SIGTERM):
                with self.subTest(first=first, second=second):
                    process = self.started(WAITING.format(then="wait()"))
                    for said, number in (("ready\n", first), ("asked\n", second)):
                        self.assertEqual(process.stdout.readline(), said)
                        process.send_signal(number)
                    _, errors = process.communicate()
                    self.assertEqual((process.returncode, errors), (-first, "") if first == second else (130, LAST_WORDS))

    def test_one_signal_ends_what_leaves_nothing_half_done(self):
        within = "    with ends_at_once():\n        print('ready', flush=True)\n        wait()\n"
        for code in (WAITING.replace("(words)", "(words, at_once=True)"), WAITING.replace('    print("ready", flush=True)\n    wait()\n', within)):
            for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
                process = self.started(code.format(then="pass"))
                self.assertEqual(process.stdout.readline(), "ready\n")
                process.send_signal(number)
                out, errors = process.communicate()
                self.assertEqual((process.returncode, out, errors), (130, "", LAST_WORDS))

    def test_a_terminal_that_goes_says_so_twice(self):
        process = self.started(WAITING.format(then="wait(); sys.exit(say_interrupted(words))"))
        for said in ("ready\n", "asked\n"):
            self.assertEqual(process.stdout.readline(), said)
            process.send_signal(signal.SIGHUP)
        self.assertEqual((process.communicate()[1].count("\n"), process.returncode), (3, 130))

    def test_what_is_ignored_stays_so_and_what_is_blocked_until_then_comes_then(self):
        first_a_line = "import sys; sys.stdout.write('up\\n'); sys.stdout.flush(); sys.stdin.readline()\n"
        for begin, before, number, said in (
                ("", lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN), signal.SIGHUP, ("ready\n", "")),
                (first_a_line, lambda: signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTERM}), signal.SIGTERM, ("up\n", "asked\n"))):
            process = self.started(begin + WAITING.format(then="pass"), before=before)
            self.assertEqual(process.stdout.readline(), said[0])
            process.send_signal(number)
            self.assertEqual((process.communicate("go\n")[0], process.returncode), (said[1], 0))

    def test_a_child_ends_with_its_parent(self):
        for arguments in ((), ("named",)):
            for number in (signal.SIGKILL, signal.SIGTERM):
                with self.subTest(arguments, number=number):
                    parent = self.started(PARENT, *arguments)
                    self.assertEqual(parent.stdout.readline(), "ready\n")
                    parent.send_signal(number)
                    self.assertEqual(parent.communicate()[0], "", "which the child has open, too")

    def test_a_child_whose_parent_is_gone_ends_at_once(self):
        code = "from salbench.system.processes import end_with_parent\nend_with_parent(1 << 22)\nprint('alive')"
        self.assertEqual(subprocess.run([sys.executable, "-P", "-c", code], capture_output=True).stdout, b"")

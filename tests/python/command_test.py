# SPDX-License-Identifier: GPL-3.0-or-later
"""Commands of the user: what they are given and must write, what becomes of those that misbehave, and that nothing of them is left, however they or
the program end."""

import os
import shlex
import shutil
import signal
import sys
import threading
import time
from pathlib import Path
from unittest import mock

import numpy as np
import toy
from salbench import _core
from salbench.models import sessions, shell
from salbench.models.command import who_has_module
from salbench.models.depended import DependedFiles
from salbench.models.shell import Shell, TookTooLong, run
from salbench.runs import hooks
from salbench.shapes.shape import Shape
from salbench.system.errors import InputError, Interrupted, StorageError
from salbench.system.scratch import ScratchFolder, remove_abandoned, without_scratch_folders
from tests.support.processes import processes_with

PATIENCE = 100  # s, of a test that fails; processes that are forgotten live longer, but not for ever

# A shell's lines that start a process which gets out of its command's hands. $child writes its number, resists, and sleeps.
STRAYS = {"in the background": 'sh -c "$child" &', "in another group": 'timeout 1000 sh -c "$child" &', "of a dead parent": '(sh -c "$child" &)',
          "stopped": 'sh -c "${child%exec*}kill -STOP \\$\\$" &'}


def stray(start, number_file):
    return f"child='trap \"\" TERM HUP INT; echo $$ > {number_file}; exec sleep 1000'\n{start}\n"


def wait_for(file):
    """A shell's line."""
    return f"while [ ! -s '{file}' ]; do sleep .01; done\n"


def soon(condition):
    end = time.monotonic() + PATIENCE
    while not condition() and time.monotonic() < end:
        time.sleep(.01)
    return condition()


def is_gone(process):
    """Also if nobody has waited for it."""
    try:
        return Path(f"/proc/{process}/stat").read_bytes().rpartition(b") ")[2][:1] in b"ZX"
    except (FileNotFoundError, ProcessLookupError):
        return True


class InAFolder(toy.InAFolder):
    """TMPDIR is a folder of its own, in which nothing is left."""

    def setUp(self):
        super().setUp()
        self.scratch = self.folder / "scratch"
        self.scratch.mkdir()
        self.enterContext(mock.patch.dict(os.environ, {"TMPDIR": str(self.scratch)}))

    def write(self, name, text=""):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def failure(self, work, *arguments):
        """The message of an InputError; "" without one."""
        try:
            work(*arguments)
        except InputError as error:
            self.assertNotIn("\n", str(error))
            return str(error)
        return ""

    def program(self, work):
        """Number of a process that can be killed."""
        if (process := os.fork()) == 0:
            try:
                work()
            finally:
                os._exit(1)
        return process


class Scratch(InAFolder):
    def test_it_is_removed_with_all_that_is_in_it(self):
        kept = self.write("outside/kept")
        with ScratchFolder() as path:
            os.makedirs(f"{path}/a/b")
            Path(path, "a/b/c").touch()
            os.symlink(kept.parent, f"{path}/link")
        self.assertFalse(os.path.exists(path))
        self.assertTrue(kept.exists())

    def test_it_is_left_by_a_copy_of_the_process(self):
        scratch = ScratchFolder()
        with scratch as path:
            if (copy := os.fork()) == 0:
                scratch.__exit__()
                os._exit(0)
            os.waitpid(copy, 0)
            self.assertTrue(os.path.isdir(path))

    def test_its_place(self):
        os.environ["TMPDIR"] = os.path.relpath(self.scratch)
        with ScratchFolder() as path:
            self.assertEqual(os.path.dirname(path), str(self.scratch))
        os.environ["TMPDIR"] = str(self.write("file"))
        with ScratchFolder() as path:
            self.assertEqual(os.path.dirname(path), "/tmp", "in place of what is no folder")
        os.environ["TMPDIR"] = "/proc"
        with self.assertRaisesRegex(StorageError, "/proc/salbench-scratch-.*: the folder cannot be created: .*; set TMPDIR to another"), ScratchFolder():
            pass

    def test_those_of_dead_processes_are_removed_and_nothing_else(self):
        if (process := os.fork()) == 0:
            with ScratchFolder() as path:
                Path(path, "file").touch()
                os._exit(0)
        os.waitpid(process, 0)
        dead, = os.listdir(self.scratch)
        head, name, machine, number, start, random = dead.split("-")
        with ScratchFolder() as alive:
            kept = {os.path.basename(alive), "salbench-scratch-notes", "other", "linked", dead.replace(machine, "0123456789ab"), dead.upper()}
            for folder in kept:
                os.makedirs(self.scratch / folder, exist_ok=True)
            Path(self.scratch, dead[:-8] + "01234567").write_text("a file")
            os.symlink("linked", self.scratch / f"{dead[:-8]}76543210")
            own = os.path.basename(alive).split("-")
            reused = "-".join([*own[:4], str(int(own[4]) - 1), own[5]])  # number of a process that is alive, and another start
            os.mkdir(self.scratch / reused)
            remove_abandoned()
            self.assertEqual({*os.listdir(self.scratch)}, kept | {dead[:-8] + "01234567", dead[:-8] + "76543210"})

    def test_its_name_is_no_part_of_a_message(self):
        with ScratchFolder() as path:
            for message, without in ((f'File "{path}/m.py", line 1; {path}/a', 'File "m.py", line 1; a'), (path, path), (f"{path}0/a", f"{path}0/a"),
                                     (f"{path}/", ""), ("a/salbench-scratch-1/b", "a/salbench-scratch-1/b")):
                self.assertEqual(without_scratch_folders(message), without)


class Lines(InAFolder):
    """Shell lines, one by one."""

    def run_line(self, line, timeout=600.):
        run(line, str(self.folder), timeout)

    def fails(self, line, timeout=600.):
        return self.failure(self.run_line, line, timeout)

    def test_a_command_has_nothing_of_the_program_but_its_environment(self):
        inherited = os.open("/", os.O_RDONLY)
        os.set_inheritable(inherited, True)
        self.addCleanup(os.close, inherited)
        self.run_line("cat > in; pwd > here; echo $TMPDIR > place; ls /proc/self/fd > files; grep -E '^Sig(Blk|Ign)' /proc/self/status > signals", 1e300)
        self.assertEqual([(self.folder / name).read_text() for name in ("in", "here", "place")], ["", f"{self.folder}\n", f"{self.scratch}\n"])
        self.assertEqual((self.folder / "files").read_text(), "0\n1\n2\n3\n", "the last one is what ls lists")
        ignored = Path("/proc/self/status").read_text()
        before = {line.split()[0]: int(line.split()[1], 16) for line in ignored.splitlines() if line.startswith(("SigIgn", "SigBlk"))}
        own = 1 << signal.SIGPIPE - 1 | 1 << signal.SIGXFSZ - 1  # that Python ignores
        for line in (self.folder / "signals").read_text().splitlines():
            key, mask = line.split()
            self.assertEqual(int(mask, 16), before[key] & ~own, line)

    def test_how_it_ended_and_what_it_printed_last(self):
        for line, failure in {"exit 0": "", "exit 3": "the command ended with status 3; it printed nothing",
                              "echo one; echo two >&2; false": "the command ended with status 1; its last lines: one | two",
                              "kill -9 $$": "the command was killed by signal 9; it printed nothing",
                              "printf 'a\\t\\033[1;31mb\\033[0m\\000\\033c\\n\\n'; false": "the command ended with status 1; its last lines: a b??c",
                              "printf 'Größe 模型\\377\\n'; false": "the command ended with status 1; its last lines: Größe 模型\ufffd",
                              f": {'x' * 120_000}": "", f": {'x' * 1_000_000}": "the command is longer than the system allows"}.items():
            self.assertEqual(self.fails(line), failure)
        self.assertRegex(self.fails("no-such-program"), "^the command ended with status 127; its last lines: sh: .*no-such-program: not found$")

    def test_of_a_flood_the_last_lines_are_kept(self):
        failure = self.fails("yes 0123456789 | head -c 33000000; echo last; false")
        self.assertRegex(failure, r"0123456789 \| last$")
        self.assertLess(len(failure), 5000)
        self.assertLess(len(self.fails("head -c 30000000 /dev/zero; false")), 5000, "without a line end")

    def test_what_gets_out_of_its_hands_ends_with_it(self):
        for name, start in STRAYS.items():
            number = self.folder / name.replace(" ", "_")
            self.assertEqual(self.fails(stray(start, number) + wait_for(number)), "")
            self.assertTrue(is_gone(number.read_text().strip()), name)
        # Each process of a chain starts the next one and ends: there is always one, and never the same.
        link = self.write("link.sh", 'echo x >> "$0.log"\n[ $1 -gt 0 ] && sh "$0" $(($1-1)) &\n')
        self.assertEqual(self.fails(f"sh {link} 20000; {wait_for(f'{link}.log')}"), "")
        self.assertEqual(processes_with(link), [])

    def test_all_end_at_the_timeout_even_those_that_resist(self):
        numbers = {name: self.folder / name.replace(" ", "_") for name in STRAYS}
        line = "trap '' TERM\n" + "".join(stray(STRAYS[name], number) + wait_for(number) for name, number in numbers.items())
        failure, timeout = "", .25
        while not failure.endswith(": ready") and timeout < PATIENCE:  # before that it is not yet there
            for number in numbers.values():
                number.unlink(missing_ok=True)
            timeout *= 2
            failure = self.fails(f"{line}echo ready; wait; sleep 1000", timeout)
        self.assertEqual(failure, f"the command took longer than its timeout of {timeout:g} s, and was ended; its last lines: ready")
        for name, number in numbers.items():
            self.assertTrue(is_gone(number.read_text().strip()), name)

    def test_all_end_with_a_program_that_is_killed(self):
        for name, start in STRAYS.items():
            number = self.folder / name.replace(" ", "_")

            def work():
                with ScratchFolder() as folder:
                    run(stray(start, number) + "sleep 1000", folder, 600)

            program = self.program(work)
            self.assertTrue(soon(lambda: number.exists() and number.read_text()), name)
            self.assertEqual(len(os.listdir(self.scratch)), 1)
            os.kill(program, signal.SIGKILL)
            os.waitpid(program, 0)
            self.assertTrue(soon(lambda: is_gone(number.read_text().strip())), name)
            self.assertTrue(soon(lambda: not os.listdir(self.scratch)), name)

    def test_all_end_with_a_program_that_is_killed_at_any_moment(self):
        """Also in that of a start, when the program cannot have told anybody of it."""
        mark = self.folder / "mark"  # a program, so that its processes can be told from others
        shutil.copy("/bin/sleep", mark)

        def work():
            sessions.file_of_guard()
            threading.Timer(moment * .0003, os.kill, (os.getpid(), signal.SIGKILL)).start()
            run(f"exec {mark} 1000", "/", 600)

        for moment in range(20):
            os.waitpid(self.program(work), 0)
        self.assertTrue(soon(lambda: not processes_with(mark)))

    def test_scratch_folders_go_where_a_program_closes_its_files_before_it_is_dead(self):
        def work():
            ScratchFolder().__enter__()
            sessions.file_of_guard()
            sessions._guard.stdin.close()
            time.sleep(.3)
            os.kill(os.getpid(), signal.SIGKILL)

        os.waitpid(self.program(work), 0)
        self.assertTrue(soon(lambda: not os.listdir(self.scratch)))

    def test_a_guard_that_somebody_kills_is_replaced(self):
        self.run_line("true")
        sessions._guard.kill()
        sessions._guard.wait()
        self.run_line("true")
        self.assertIsNone(sessions._guard.poll())

    def test_who_waits_for_one_is_interrupted_when_the_run_ends(self):
        self.addCleanup(shell.begin)
        started = self.folder / "started"
        caught = []

        def wait(line):
            try:
                self.run_line(line)
            except Interrupted as error:
                caught.append(error)

        waiting = [threading.Thread(target=wait, args=(f"echo >> {started}; {line}",)) for line in ("sleep 1000", "trap '' TERM; sleep 1000")]
        for thread in waiting:
            thread.start()
        self.assertTrue(soon(lambda: started.exists() and len(started.read_text()) == 2))
        shell.end_all()
        for thread in waiting:
            thread.join(PATIENCE)
        wait("true")
        self.assertEqual(len(caught), 3)
        shell.begin()
        self.run_line("true")


class Serving(InAFolder):
    """A command that stays at work."""

    def serving(self, body):
        """Does this for every line that it reads, as $line."""
        return self.enterContext(Shell(f"while read -r line; do {body}; done", str(self.folder), serves=True))

    def asked(self, command, timeout=600.):
        """Message of the exception that a request raises; "" for an answer."""
        said = []
        return self.failure(lambda: said.append(command.ask(b"x\n", b"x", timeout))) or ("" if said[0] else "ended")

    def test_it_answers_line_by_line(self):
        command = self.serving('echo "$line" >> asked; echo "done $line"')
        for line in (b"one", b"two", b"three"):
            self.assertTrue(command.ask(line + b"\n", b"done " + line, 600))
        self.assertEqual((self.folder / "asked").read_text(), "one\ntwo\nthree\n")
        self.assertFalse(command.has_ended())

    def test_its_answer_is_found_in_whatever_else_it_prints(self):
        command = self.serving(r"head -c 3000000 /dev/zero; printf '\rloading x\nx y\nxx\n x\r'; echo x >&2; sleep .2; touch late; printf x; "
                               "sleep .1; echo")
        self.assertEqual(self.asked(command), "")
        self.assertTrue((self.folder / "late").exists(), "neither part of a line nor an error is an answer")
        self.assertIn("loading x | x y | xx", command.said())
        self.assertLess(len(command.said()), 5000)

    def test_its_output_and_its_errors_are_kept_by_themselves(self):
        """Two pipes have no order between them; a flood in the one must not push out what was said in the other."""
        flood = "yes 0123456789 | head -c 3300000"
        for body in (f"{flood}; echo; echo at last >&2", f"echo at last >&2; {flood}; echo"):
            self.assertRegex(self.asked(self.serving(f"{body}; exit 3")), r"0123456789 \| at last$")
        command = self.serving("echo no memory >&2; echo x")
        for _ in range(200):  # what it said before its answer is there with it
            self.assertEqual((self.asked(command), command.said()), ("", "its last lines: no memory"))

    def test_one_that_ends_after_an_answer_fails_no_line_that_it_has_not_read(self):
        for ending in ("exit 3", "kill -9 $$"):
            lines = {"early": f"read -r line; echo x; {ending}", "at fault": f"read -r line; echo x; read -r line; {ending}", "unready": ending}
            early, at_fault, unready = (self.enterContext(Shell(line, str(self.folder), serves=True)) for line in lines.values())
            self.assertEqual((self.asked(early), self.asked(early)), ("", "ended"))
            self.assertEqual((self.asked(at_fault), self.asked(at_fault)[:12]), ("", "the command "))
            self.assertEqual(self.asked(unready)[:12], "the command ")
            self.assertEqual([command.has_answered for command in (early, at_fault, unready)], [True, True, False])

    def test_one_that_is_late_is_ended_even_if_it_resists(self):
        command = self.enterContext(Shell("trap '' TERM; while :; do sleep .1; done", str(self.folder), serves=True))
        with self.assertRaisesRegex(TookTooLong, "^the command took longer than its timeout of 0.1 s, and was ended; it printed nothing$"):
            command.ask(b"x\n", b"x", .1)
        self.assertTrue(command.has_ended())

    def test_it_comes_to_the_end_of_its_lines_when_no_more_will_come(self):
        with Shell("while read -r line; do echo $line; done; touch end", str(self.folder), serves=True) as command:
            self.assertEqual(self.asked(command), "")
        self.assertTrue((self.folder / "end").exists())
        with Shell("trap '' TERM; while :; do sleep .1; done", str(self.folder), serves=True) as resisting:
            pass
        self.assertTrue(resisting.has_ended())

    def test_it_outlives_the_thread_that_started_it(self):
        started = []
        thread = threading.Thread(target=lambda: started.append(self.serving("echo $line")))
        thread.start()
        thread.join()
        self.assertEqual(self.asked(started[0]), "")

    def test_all_end_with_the_run(self):
        self.addCleanup(shell.begin)
        idle, busy = self.serving("echo x"), self.serving("touch busy; sleep 1000")
        self.assertEqual(self.asked(idle), "")
        ending = threading.Thread(target=lambda: soon((self.folder / "busy").exists) and shell.end_all())
        ending.start()
        with self.assertRaises(Interrupted):
            busy.ask(b"x\n", b"x", 600)
        ending.join()
        self.assertTrue(soon(idle.has_ended))


class Maps(InAFolder):
    """Maps of a shape by a command, as the engine requests them."""

    POINTS = np.random.default_rng(7).random((6, 3))
    COUNT = "n=$(grep -a -m1 'element vertex' {mesh} | cut -d' ' -f3); seq $n > {out}"
    SERVE = """echo start >> {0}/log; while IFS="$(printf '\\t')" read -r shape out; do {1}; seq 6 > "$out"; echo "$out"; {2}; done < {{list}}"""

    def setUp(self):
        super().setUp()
        self.shape = Shape("1_2", self.POINTS, np.array([[0, 1, 2], [3, 4, 5]], np.int32), source="/data/it's 1.off")
        self.addCleanup(lambda: self.assertEqual(os.listdir(self.scratch), []))
        self.addCleanup(hooks.finish)

    def command(self, line, timeout=600., depends=()):
        return hooks.command("MINE", line, timeout, list(depends))

    def fails(self, line, timeout=600.):
        return self.failure(self.command(line, timeout).map, self.shape, 0)

    def serving(self, first=":", then=":", timeout=600.):
        return self.command(self.SERVE.format(self.folder, first, then), timeout)

    def starts(self):
        return len((self.folder / "log").read_text().split())

    def test_each_form_of_what_is_read_and_written(self):
        reading = "import h5py, numpy, sys; numpy.save(sys.argv[2], h5py.File(sys.argv[1])['points'][:, 0])"
        writing = "import h5py, numpy, sys; h5py.File(sys.argv[1], 'w')['x'] = numpy.arange(6.)"
        for line, expected in ((self.COUNT, range(1, 7)), (f"{sys.executable} -c \"{reading}\" {{shape}} {{out}}", self.POINTS[:, 0]),
                               (f"{sys.executable} -c \"{writing}\" {{out.h5}}", range(6)), ("seq 2 > {out.npy}", [1, 2])):
            self.assertEqual(list(self.command(line).map(self.shape, 2)), list(expected), line)
        self.command("echo {item} {source} > " + shlex.quote(f"{self.folder}/told") + "; seq 6 > {out}").map(self.shape, 0)
        self.assertEqual((self.folder / "told").read_text(), "1_2 /data/it's 1.off\n")

    def test_placeholders_in_quotes_of_the_user(self):
        told = shlex.quote(f"{self.folder}/told")
        for source, line, said in (("/a b/1.off", "\"{source}\" --in='{source}' '{item}'", "/a b/1.off --in=/a b/1.off 1_2"), ("/it's.off", '"{source}"', "/it's.off"),
                                   ("/a.off", "\"f('{source}', '{item}')\"", "f('/a.off', '1_2')"), ("", '"{source}" x', " x")):
            self.shape = Shape("1_2", self.POINTS, self.shape.faces, source=source)
            self.command(f"echo {line} > {told}; seq 6 > {{out}}").map(self.shape, 0)
            self.assertEqual((self.folder / "told").read_text(), said + "\n")

    def test_what_it_must_write(self):
        for line, failure in {"true": "the command ended without a file {out}; it must write one value per point there; it printed nothing",
                              "echo no memory | tee log": "without a file {out}; it must write one value per point there; its last lines: no memory",
                              "seq 6 > {out}.txt": "it wrote out.val.txt: write exactly {out}",
                              "seq 5 > {out}": "the command's out.val: 5 values, but the shape has 6 points",
                              "mkdir {out}": "out.val: is a folder, where a file is expected"}.items():
            self.assertIn(failure, self.fails(line))
        self.assertEqual(self.fails("echo x > {out}; echo {out} >&2; false"), "the command ended with status 1; its last lines: out.val")

    def test_who_has_a_module_that_an_interpreter_lacks(self):
        self.assertRegex(self.fails("echo \"No module named 'numpy.linalg'\"; false"), "; /.*python3.* has numpy: start the command with it$")
        self.assertEqual(who_has_module("No module named 'there_is_none'"), "; no python3 on the PATH has there_is_none")
        self.assertEqual(who_has_module("no module named numpy"), "")

    def test_one_with_a_list_is_started_for_as_many_shapes_as_are_asked_for_at_once(self):
        # Answers when it is the second that has been started.
        command = self.serving(f"while [ $(wc -l < {self.folder}/log) -lt 2 ]; do sleep .01; done")
        threads = [threading.Thread(target=command.map, args=(self.shape, 0)) for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(PATIENCE)
        for _ in range(3):
            self.assertEqual(list(command.map(self.shape, 0)), [*range(1, 7)])
        self.assertEqual(self.starts(), 2)
        hooks.finish()
        command.map(self.shape, 0)
        self.assertEqual(self.starts(), 3)

    def test_one_with_a_list_that_ends_after_an_answer_fails_no_shape(self):
        with self.assertLogs("salbench", "WARNING") as logged:
            command = self.serving(then="echo no more >&2; exit 3")
            for _ in range(3):
                command.map(self.shape, 0)
        self.assertEqual(self.starts(), 3)
        (record,) = logged.records
        self.assertRegex(record.getMessage(), "^models.MINE: .* status 3 after an answer, .*; its last lines: no more$")

    def test_one_with_a_list_that_misbehaves_fails_its_shape(self):
        for first, failure in {"exit 0": "without an answer; .*; it printed nothing$", "kill -9 $$": "killed by signal 9; it printed nothing$",
                               "echo no memory >&2; echo \"$out\"; continue": "without a file {out}; .*; its last lines: no memory$",
                               "echo no memory >&2; exit 3": "status 3; its last lines: no memory$"}.items():
            self.assertRegex(self.failure(self.serving(first).map, self.shape, 0), failure)

    def test_one_with_a_list_that_never_answers_is_waited_for_three_times(self):
        command = self.serving("exec > /dev/null", timeout=.2)
        failures = [self.failure(command.map, self.shape, 0) for _ in range(4)]
        self.assertEqual(self.starts(), 3)
        for failure in failures:
            self.assertRegex(failure, "does it print the second file of each line, as a line, and flush its standard output after it.$")
        self.assertRegex(failures[3], "^the command was not asked any more: it has answered none of 3 shapes within its timeout of 0.2 s; ")

    def test_one_with_a_list_in_a_folder_that_no_line_can_name(self):
        (self.scratch / "a\tb").mkdir()
        with mock.patch.dict(os.environ, {"TMPDIR": f"{self.scratch}/a\tb"}), self.assertRaisesRegex(StorageError, "a tab or a line end in a path"):
            self.serving().map(self.shape, 0)
        (self.scratch / "a\tb").rmdir()

    def test_readers_and_commands_end_with_the_run(self):
        self.addCleanup(hooks.begin)
        hooks.end_all()
        for work in (lambda: self.command("true").map(self.shape, 0), lambda: hooks.names_of_maps("none.h5")):
            self.assertRaises(Interrupted, work)
        hooks.begin()
        self.command(self.COUNT).map(self.shape, 0)
        with self.assertRaisesRegex(InputError, "none.h5: "):
            hooks.names_of_maps("none.h5")


class Depended(InAFolder):
    """Files that a command needs."""

    def setUp(self):
        super().setUp()
        for name in ("a.py", "sub/b.py"):
            self.write(name, name)
        self.files = self.planned("a.py", "./sub/b.py")

    def planned(self, *names):
        files = DependedFiles([(name, str(self.folder / name), _core.digest((self.folder / name).read_bytes())) for name in names])
        self.addCleanup(files.close)
        return files

    def placed(self, files, below):
        place = self.folder / below
        place.mkdir()
        files.put_into(str(place))
        return sorted(str(path.relative_to(place)) for path in place.rglob("*") if path.is_file())

    def test_they_are_copied_once_for_all_shapes(self):
        (self.folder / "a.py").chmod(0o755)
        os.symlink("a.py", self.folder / "linked.py")
        files = self.planned("a.py", "sub/b.py", "linked.py")
        for below in ("first", "second"):
            self.assertEqual(self.placed(files, below), ["a.py", "linked.py", "sub/b.py"])
        first, second, original = (self.folder / below / "a.py" for below in ("first", "second", ""))
        self.assertTrue(first.samefile(second) and not first.samefile(original))
        self.assertFalse((self.folder / "first/linked.py").is_symlink())
        self.assertEqual(second.stat().st_mode & 0o777, 0o755)
        self.write("a.py", "edited")
        files.check_unchanged()
        self.assertEqual(self.placed(files, "third"), ["a.py", "linked.py", "sub/b.py"])
        self.assertEqual((self.folder / "third/a.py").read_text(), "a.py", "as they were planned")

    def test_one_that_was_edited_after_the_plan(self):
        self.write("a.py", "edited")
        for below in ("first", "second"):
            with self.assertRaisesRegex(InputError, "a.py: changed since this run was planned; run it again$"):
                self.placed(self.files, below)

    def test_what_a_command_writes_into_a_copy_is_noticed(self):
        self.placed(self.files, "first")
        self.files.check_unchanged()
        self.write("first/a.py", "b")
        for use in (self.files.check_unchanged, lambda: self.placed(self.files, "second")):
            with self.assertRaisesRegex(InputError, "^a.py: the command has written into its copy of this file"):
                use()
        self.assertEqual((self.folder / "a.py").read_text(), "a.py")

    def test_a_copy_that_somebody_removes_is_no_fault_of_the_command(self):
        self.placed(self.files, "first")
        for folder in self.scratch.iterdir():
            shutil.rmtree(folder)
        with self.assertRaisesRegex(StorageError, "the copy of a.py for all shapes was removed during the run; set TMPDIR to another"):
            self.files.check_unchanged()

    def test_one_that_is_left_out_is_named_where_a_failure_names_it(self):
        for name in ("helper.py", "weights", "sub/c.txt", "package/__init__.py", "tmp/notes"):
            self.write(name)
        end = "is not in the command's folder: add"
        for why, said in {"ModuleNotFoundError: No module named 'helper'": f"; helper.py {end} it to depends",
                          "No such file or directory: '/tmp/salbench-scratch-1/sub/c.txt'": f"; sub/c.txt {end} it to depends",
                          "cat: weights: No such file": f"; weights {end} it to depends",
                          "No module named 'package.parts'": f"; package {end} its files to depends",
                          "No module named 'helpers'": "", "No such file or directory: '/tmp/x'": "", 'File "a.py", line 3': "", "my weights are wrong": "", "": ""}.items():
            self.assertEqual(self.files.left_out_of(why), said)

    def test_one_with_a_whole_path_is_compared_by_its_content(self):
        """Whatever its size and times say."""
        path, other = self.write("weights", "weights 1"), self.write("other", "weights 2")
        times = path.stat().st_mtime_ns, path.stat().st_mtime_ns

        def replaced():
            os.replace(other, path)

        for change, said in ((lambda: None, ""), (lambda: path.write_text("weights 1"), ""), (lambda: path.write_text("weights 2"), "changed since"),
                             (replaced, "changed since"), (path.unlink, "weights: cannot be read: No such file")):
            path.write_text("weights 1")
            other.write_text("weights 2")
            files = DependedFiles([(str(path), str(path), _core.digest(b"weights 1"))])
            files.check_unchanged()
            change()
            if path.exists():
                os.utime(path, ns=times)
            self.assertIn(said, self.failure(files.check_unchanged))
            self.assertEqual(bool(said), bool(self.failure(files.check_unchanged)))

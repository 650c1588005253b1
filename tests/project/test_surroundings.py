#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The program in bad surroundings: caches and compilers with faults, full disks, limits, closed files, other
locales, signals at any moment. Wanted each time: a clear message and status, the last report whole, no child left
behind, no half file.

    test_surroundings.py PROGRAM [NAME...]
"""
import concurrent.futures
import contextlib
import json
import os
import pathlib
import random
import resource
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import time
import traceback

PROGRAM = os.path.abspath(sys.argv[1])
CASES = []
QUICK = ["crosscheck", "simple_pendulum", "--random", "2", "--no-drift", "--no-charts", "--processes", "1"]
KERNEL = QUICK + ["--witness", "newton_euler,kernel"]


class Skipped(Exception):
    pass


def case(function):
    CASES.append(function)
    return function


def check(holds, *what):
    if not holds:
        raise AssertionError("\n".join(str(part) for part in what))


class Place:
    """A folder of a case's own, where the program runs."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.cache = self.folder / "cache"
        self.work = self.folder / "work"
        self.work.mkdir()
        self.report = self.work / "report"
        self.environment = {**os.environ, "DYNWITNESS_CACHE": str(self.cache), "TMPDIR": str(self.folder)}
        for name in ("DYNWITNESS_CC", "DYNWITNESS_LANES", "LC_ALL"):
            self.environment.pop(name, None)

    def start(self, words, shell="", limits=(), **more):
        def limit():
            for kind, value in limits:
                resource.setrlimit(kind, (value, resource.getrlimit(kind)[1]))

        command = ["/bin/sh", "-c", 'exec "$0" "$@" ' + shell, PROGRAM, *words] if shell else [PROGRAM, *words]
        return subprocess.Popen(command, cwd=self.work, env=self.environment, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, preexec_fn=limit, **more)

    def run(self, words, shell="", limits=()):
        process = self.start(words, shell, limits)
        try:
            out, err = process.communicate(timeout=150)
        except subprocess.TimeoutExpired:
            process.kill()
            raise
        return process.returncode, out, err

    def agrees(self, words, *parts):
        """Runs something that must succeed; the parts must be in what it says on standard error."""
        status, out, err = self.run(words)
        check(status == 0, "status", status, out, err)
        for part in parts:
            check(part in err, "not said: " + part, err)
        return out

    def fails(self, words, status, *parts, **more):
        got, out, err = self.run(words, **more)
        check(got == status, "status", got, "expected", status, out, err)
        for part in parts:
            check(part in err, "not said: " + part, err)
        check("terminate called" not in err, err)

    def compiler(self, text):
        """A C compiler of our own making, a shell script; $CC is the real one."""
        real = shutil.which("cc")
        if not real:
            raise Skipped("no C compiler")
        file = self.folder / "own_cc"
        file.write_text("#!/bin/sh\nCC=" + real + "\n" + text)
        file.chmod(0o755)
        self.environment["DYNWITNESS_CC"] = str(file)

    def snapshot(self):
        return {str(file.relative_to(self.report)): file.read_bytes()
                for file in sorted(self.report.rglob("*")) if file.is_file()} if self.report.exists() else None

    def requireWhole(self, seeds):
        """The report is of one run, with one of these seeds, and nothing is missing or half written."""
        files = self.snapshot()
        listed = set(files["contents.txt"].decode().split("\n")[1:]) - {""} | {"contents.txt"}
        check(listed == set(files), "listed but missing, or there and not listed:", listed ^ set(files))
        seed = json.loads(files["report.json"])["seed"]
        check(seed in seeds, "seed", seed)
        page = files["index.html"].decode()
        check(page.rstrip().endswith("</html>") and "--seed %d" % seed in page, "index.html is not of this run")
        check(files["junit.xml"].decode().rstrip().endswith("</testsuites>"), "junit.xml is cut off")
        return seed

    def requireNothingLeft(self):
        left = [str(f) for f in self.work.rglob("*") if "unfinished" in f.name or "dynwitness-try" in f.name]
        if self.cache.exists():
            left += [str(f) for f in self.cache.iterdir() if f.name.startswith("draft")]
        check(not left, "left behind:", left)


@contextlib.contextmanager
def mounts():
    """A prefix for commands that mounts need: a name space of their own."""
    if subprocess.run(["unshare", "-rm", "true"], capture_output=True).returncode != 0:
        raise Skipped("no name space to mount a file system in")
    yield ["unshare", "-rm", "/bin/sh", "-ec"]


def descendants(process):
    found, open_ = [], [process]
    while open_:
        pid = open_.pop()
        with contextlib.suppress(OSError):
            for task in pathlib.Path("/proc/%d/task" % pid).iterdir():
                children = [int(child) for child in (task / "children").read_text().split()]
                found += children
                open_ += children
    return found


def copies(process):
    """Descendants that are copies of the program in its own process group: they share its work."""
    found = []
    for pid in descendants(process):
        with contextlib.suppress(OSError):
            if os.getpgid(pid) == os.getpgid(process):
                found.append(pid)
    return found


def alive(pid):
    try:
        return pathlib.Path("/proc/%d/stat" % pid).read_text().rsplit(")", 1)[1].split()[0] not in "ZX"
    except OSError:
        return False


def requireGone(pids):
    end = time.time() + 5
    while time.time() < end and any(alive(pid) for pid in pids):
        time.sleep(0.02)
    check(not any(alive(pid) for pid in pids), "still running:", [p for p in pids if alive(p)])


def working(folder):
    """Processes that stand in the folder or below it."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        if entry.name.isdigit():
            with contextlib.suppress(OSError):
                if pathlib.Path(os.readlink(entry / "cwd")).is_relative_to(folder):
                    found.append(int(entry.name))
    return found


def requireQuiet(folder):
    """What a program that was killed had started ends with it, a moment later: it still writes for that long."""
    end = time.time() + 20
    while time.time() < end and working(folder):
        time.sleep(0.02)
    check(not working(folder), "still running where the test ran:", working(folder))


# ---- compilers

@case
def a_compiler_that_hangs_is_killed_with_its_children(place):
    marker = place.folder / "pid"
    place.compiler("sleep 1000 & echo $! > %s; wait\n" % marker)
    place.agrees(QUICK, "kernels are left out", "did not end within")
    requireGone([int(marker.read_text())])
    place.requireNothingLeft()


@case
def what_a_compiler_leaves_in_a_session_of_its_own_ends_with_it(place):
    if not shutil.which("setsid"):
        raise Skipped("no setsid")
    marker = place.folder / "pid"
    detached = "setsid sh -c 'echo $$ >> %s; exec sleep 1000' >/dev/null 2>&1 &\nsleep 0.2\n" % marker
    place.compiler(detached + 'exec "$CC" "$@"\n')
    status, _, err = place.run(KERNEL)
    check(status == 0 and "left out" not in err, status, err)
    requireGone([int(pid) for pid in marker.read_text().split()])
    marker.unlink()
    shutil.rmtree(place.cache)
    place.compiler(detached + "sleep 1000\n")
    place.agrees(QUICK, "kernels are left out", "did not end within")
    requireGone([int(pid) for pid in marker.read_text().split()])


def compilerIsRefused(place, text, *parts):
    place.compiler(text)
    place.agrees(QUICK, "kernels are left out", *parts)
    place.requireNothingLeft()


@case
def a_compiler_that_reorders_sums_is_found_out(place):
    compilerIsRefused(place, 'exec "$CC" -ffast-math "$@"\n', "of no use")


@case
def options_of_the_compiler_are_taken_and_fast_math_is_found_out(place):
    if not shutil.which("cc"):
        raise Skipped("no C compiler")
    place.environment["DYNWITNESS_CC"] = "cc -ffast-math"
    place.agrees(QUICK, "kernels are left out", "cc -ffast-math", "of no use")
    place.environment["DYNWITNESS_CC"] = "cc -O1"
    status, _, err = place.run(KERNEL)
    check(status == 0 and "left out" not in err, status, err)


@case
def a_compiler_that_fuses_products_with_sums_is_found_out(place):
    if "fma" not in pathlib.Path("/proc/cpuinfo").read_text():
        raise Skipped("this processor fuses nothing")
    compilerIsRefused(place, 'exec "$CC" "$@" -O2 -mfma -ffp-contract=fast\n', "bit for bit")


@case
def a_compiler_that_flushes_small_numbers_is_found_out(place):
    source = place.folder / "flush.c"
    source.write_text("#include <xmmintrin.h>\n__attribute__((constructor)) static void f(void)"
                      "{ _mm_setcsr(_mm_getcsr() | 0x8040); }\n")
    if os.uname().machine != "x86_64":
        raise Skipped("not for this processor")
    compilerIsRefused(place, 'exec "$CC" "$@" %s\n' % source, "flush small numbers")


@case
def a_compiler_that_writes_rubbish_is_found_out(place):
    output = 'out=; for w; do [ "$last" = -o ] && out=$w; last=$w; done\n'
    for text in ("echo rubbish > $out", ": > $out", "true", "mkdir $out",
                 '"$CC" "$@"; truncate -s 9000 $out', "ln -s /dev/zero $out", "mkfifo $out", "kill -SEGV $$"):
        compilerIsRefused(place, output + text + "\n")


@case
def a_library_that_crashes_is_tried_before_it_is_loaded(place):
    source = place.folder / "crash.c"
    for text in ("static int* volatile p; *p = 1;", "abort();", "_exit(0);"):
        source.write_text("#include <stdlib.h>\n#include <unistd.h>\n"
                          "__attribute__((constructor)) static void f(void) { %s }\n" % text)
        compilerIsRefused(place, 'exec "$CC" "$@" %s\n' % source, "of no use")


@case
def a_compiler_that_never_stops_talking_does_no_harm(place):
    place.compiler('head -c 30000000 /dev/zero | tr "\\0" x; exec "$CC" "$@"\n')
    status, _, err = place.run(KERNEL)
    check(status == 0 and "left out" not in err, status, err[:500])


# ---- the cache

def libraries(place):
    return sorted(place.cache.glob("*.so"))


def spoiled(place, *faults):
    """Spoils the kept libraries in these ways, in turn; a run must make them again and agree."""
    if not shutil.which("cc"):
        raise Skipped("no C compiler")
    place.agrees(KERNEL)
    right = {file: file.read_bytes() for file in libraries(place)}
    check(len(right) >= 4, "kernels in the cache:", right.keys())
    files = list(right)
    for index, file in enumerate(files):
        faults[index % len(faults)](file, files[(index + 1) % len(files)])
    evil = place.folder / "ran"
    out = place.agrees(KERNEL)
    check(" agree " in out, out)
    check(not evil.exists(), "a foreign library was run")
    for file, text in right.items():
        if not file.is_dir() or file.is_symlink():
            check(file.is_file() and not file.is_symlink() and file.read_bytes() == text, "not made again:", file)
    place.requireNothingLeft()


def overwrite(file, text):
    file.unlink()
    file.write_bytes(text)
    file.chmod(0o700)


@case
def libraries_that_are_cut_off_zeroed_or_swapped_are_made_again(place):
    def cut(file, _):
        os.truncate(file, file.stat().st_size * 2 // 3)

    def zero(file, _):
        text = bytearray(file.read_bytes())
        middle = len(text) // 2
        text[middle - 2000:middle + 2000] = bytes(4000)
        overwrite(file, bytes(text))

    def swap(file, other):
        mine, its = file.read_bytes(), other.read_bytes()
        overwrite(file, its)
        overwrite(other, mine)

    def bit(file, _):
        text = bytearray(file.read_bytes())
        text[len(text) // 3] ^= 1
        overwrite(file, bytes(text))

    spoiled(place, cut, zero, swap, bit)


@case
def foreign_libraries_folders_pipes_and_links_are_never_run(place):
    if not shutil.which("cc"):
        raise Skipped("no C compiler")
    evil, marker = place.folder / "evil.so", place.folder / "ran"
    source = place.folder / "evil.c"
    source.write_text("#include <fcntl.h>\n__attribute__((constructor)) static void f(void)"
                      '{ open("%s", O_CREAT | O_WRONLY, 0600); }\n' % marker)
    subprocess.run(["cc", "-shared", "-fPIC", "-o", evil, source], check=True)

    def foreign(file, _):
        overwrite(file, evil.read_bytes())

    def folder(file, _):
        file.unlink()
        (file / "inner").mkdir(parents=True)

    def pipe(file, _):
        file.unlink()
        os.mkfifo(file)

    def link(file, _):
        elsewhere = place.folder / file.name
        file.rename(elsewhere)
        file.symlink_to(elsewhere)

    spoiled(place, foreign, folder, pipe, link)


@case
def records_with_faults_and_files_of_others_are_made_again(place):
    def record(file):
        return file.with_suffix(".c")

    def pipe(file, _):
        record(file).unlink()
        os.mkfifo(record(file))

    def endless(file, _):
        record(file).unlink()
        record(file).symlink_to("/dev/zero")

    def writable(file, _):
        text = bytearray(file.read_bytes())
        overwrite(file, bytes(text))
        file.chmod(0o777)

    def others(file, _):
        if os.geteuid() == 0:
            os.chown(file, 12345, 12345)

    spoiled(place, pipe, endless, writable, others)
    for file in libraries(place):
        about = file.stat()
        check(about.st_uid == os.geteuid() and not about.st_mode & 0o022, "kept as it was:", file)


@case
def a_cache_on_a_full_disk_leaves_kernels_out(place):
    with mounts() as prefix:
        place.cache.mkdir()
        done = subprocess.run([*prefix, 'mount -t tmpfs -o size=24k,mode=700 none "$0"; exec "$@"', place.cache, PROGRAM, *QUICK],
                              cwd=place.work, env=place.environment, capture_output=True, text=True)
        check(done.returncode == 0 and "kernels are left out" in done.stderr, done.returncode, done.stderr)


@case
def without_a_home_kernels_are_left_out(place):
    for name in ("DYNWITNESS_CACHE", "XDG_CACHE_HOME", "HOME"):
        place.environment.pop(name, None)
    place.agrees(QUICK, "kernels are left out", "none of DYNWITNESS_CACHE, XDG_CACHE_HOME and HOME is set")


# ---- limits, full and read-only disks

@case
def a_full_disk_leaves_the_last_report_whole(place):
    with mounts() as prefix:
        script = """mount -t tmpfs -o size=400k none work; mkdir work/x; cd work
            "$0" "$@" --seed 1 -o report >/dev/null
            cp -r report ../before
            head -c 1000000 /dev/zero > filler || true
            status=0; "$0" "$@" --seed 2 -o report >/dev/null 2>../said || status=$?
            ls -A . >../left; diff -r report ../before >../difference; echo $status"""
        done = subprocess.run([*prefix, script, PROGRAM, *QUICK, "--witness", "newton_euler"],
                              cwd=place.folder, env=place.environment, capture_output=True, text=True)
        said = (place.folder / "said").read_text()
        check(done.returncode == 0 and done.stdout.strip() in ("2", "3"), done.stdout, done.stderr, said)
        check("No space left on device" in said, said)
        left = (place.folder / "left").read_text().split()
        check(sorted(left) == ["filler", "report", "x"], "left behind:", left)


@case
def a_read_only_disk_is_refused_before_any_work(place):
    with mounts() as prefix:
        script = 'mount -t tmpfs none work; mount -o remount,ro work; cd work; exec "$0" "$@"'
        done = subprocess.run([*prefix, script, PROGRAM, *QUICK], cwd=place.folder, env=place.environment,
                              capture_output=True, text=True)
        check(done.returncode == 2 and "Read-only file system" in done.stderr, done.returncode, done.stderr)


@case
def files_that_may_not_grow_leave_the_last_report_whole(place):
    place.agrees(QUICK + ["--seed", "1"])
    before = place.snapshot()
    place.fails(QUICK + ["--seed", "2"], 3, "File too large", limits=[(resource.RLIMIT_FSIZE, 20000)])
    check(place.snapshot() == before, "the last report was changed")
    place.requireNothingLeft()


@case
def a_lack_of_memory_is_told(place):
    place.fails(["derive", "chain_400", "--operations"], 3, "not enough memory",
                limits=[(resource.RLIMIT_AS, 130 << 20)])


@case
def a_lack_of_stack_is_mended_or_told(place):
    little = 64 << 10
    status, out, err = place.run(["derive", "double_pendulum"], limits=[(resource.RLIMIT_STACK, little)])
    check(status == 0, "a soft limit", status, out, err)
    process = subprocess.run(["/bin/sh", "-c", "ulimit -s 64; exec \"$0\" derive double_pendulum", PROGRAM], cwd=place.work,
                             env=place.environment, capture_output=True, text=True)
    check(process.returncode == 3 and "the stack is limited to 64 KiB, at least 256 are needed" in process.stderr,
          "a hard limit", process.returncode, process.stderr)


@case
def a_limit_of_processor_time_is_told(place):
    place.fails(["crosscheck", "humanoid", "--random", "100000", "--processes", "1", "--no-charts"], -signal.SIGXCPU,
                "processor time", limits=[(resource.RLIMIT_CPU, 1)])
    check(not place.report.exists(), "a report of what was not done")
    place.requireNothingLeft()


# ---- standard files

@case
def output_that_cannot_be_written_is_told(place):
    for words in (["scenes"], ["version"], ["--help"], ["derive", "simple_pendulum"]):
        for where in (">/dev/full", ">&-"):
            place.fails(words, 3, "standard output", shell=where)


@case
def without_standard_error_the_work_is_done(place):
    for where in ("2>&-", "2>/dev/full", "<&- >/dev/null 2>&-"):
        status, out, _ = place.run(QUICK + ["--seed", "4"], shell=where)
        check(status == 0, where, status, out)
        place.requireWhole({4})
    # a full one may lose progress, but not what must be heard: the work is done, and the status says so
    for where, expected in (("2>&-", 0), ("2>/dev/full", 3)):
        status, out, _ = place.run(["derive", "two_handed"], shell=where)
        check(status == expected and "M" in out, where, status, out)
    status, out, _ = place.run(["crosscheck", "missing.toml"], shell="2>&-")
    check(status == 2, status)


@case
def no_file_gets_the_number_of_a_standard_file_that_is_closed(place):
    process = place.start(["crosscheck", "humanoid", "--random", "100000", "--no-charts", "--processes", "1"],
                          shell="<&- >&- 2>&-")
    try:
        seen, end = set(), time.time() + 2
        while time.time() < end and process.poll() is None:
            for number in (0, 1, 2):
                with contextlib.suppress(OSError):
                    seen.add(os.readlink("/proc/%d/fd/%d" % (process.pid, number)))
        check(process.poll() is None, "ended too early:", process.returncode)
    finally:
        process.kill()
        process.communicate()
    # what the shell had before it closed it, and what the loader reads before the program begins
    seen = {file for file in seen if not file.startswith("pipe:") and ".so" not in file}
    check(seen == {"/dev/null"}, seen)


@case
def a_reader_that_goes_away_ends_the_program_quietly(place):
    status, _, err = place.run(["derive", "puma_560", "--progress", "off"],
                               shell="| head -n 1 >/dev/null")
    check(status == 0 and err == "", status, err)


@case
def numbers_are_the_same_in_a_locale_with_decimal_commas(place):
    folder = place.folder / "locales"
    folder.mkdir()
    made = subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", str(folder / "de_DE.UTF-8")],
                          capture_output=True) if shutil.which("localedef") else None
    if made is None or not (folder / "de_DE.UTF-8").exists():
        raise Skipped("no localedef, or nothing for it to read")
    words = ["crosscheck", "double_pendulum", "--random", "2", "--no-charts"]
    drift = ["drift", "simple_pendulum", "--duration", "1", "--plot", "drift.svg"]
    plain = place.agrees(words), place.agrees(drift)
    picture = (place.work / "drift.svg").read_bytes() if shutil.which("gnuplot") else b""
    place.environment.update(LOCPATH=str(folder), LC_ALL="de_DE.UTF-8")
    check(place.agrees(words) == plain[0], "crosscheck says something else")
    place.agrees(drift)
    if picture:
        check((place.work / "drift.svg").read_bytes() == picture, "the picture is another one")


# ---- signals

def signalled(place, words, number, ready):
    """Sends a signal as soon as ready(process) holds. Returns status and message."""
    process = place.start(words)
    try:
        end = time.time() + 60
        while not ready(process.pid) and process.poll() is None and time.time() < end:
            time.sleep(0.01)
        check(process.poll() is None, "ended too early:", process.returncode)
        below = descendants(process.pid)
        process.send_signal(number)
        _, err = process.communicate(timeout=20)
    finally:
        process.kill()
    requireGone(below)
    return process.returncode, err


@case
def signals_end_the_work_and_its_copies(place):
    words = ["crosscheck", "humanoid", "puma_560", "--random", "100000", "--no-charts", "--processes", "2"]
    place.agrees(QUICK)  # with which the compiler was tried
    shutil.rmtree(place.report)
    for number, text in ((signal.SIGINT, "interrupted"), (signal.SIGTERM, "terminated"), (signal.SIGHUP, "hung up"),
                         (signal.SIGKILL, "")):
        status, err = signalled(place, words, number, lambda process: len(copies(process)) == 2)
        check(status == -number and text in err, number, status, err)  # a shell says 128 + number
        check(not place.report.exists(), "a report of what was not done")
        if number != signal.SIGKILL:
            place.requireNothingLeft()


@case
def signals_end_a_compiler_and_all_below_it(place):
    marker = place.folder / "pid"
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL):
        marker.unlink(missing_ok=True)
        place.compiler("sleep 1000 & echo $! > %s.new; mv %s.new %s; wait\n" % (marker, marker, marker))
        status, _ = signalled(place, QUICK, number, lambda _: marker.exists())
        check(status == -number, number, status)
        requireGone([int(marker.read_text())])
        if number != signal.SIGKILL:
            place.requireNothingLeft()
    # what KILL has left is swept by the next
    check(any(place.cache.glob("draft-*")), "KILL left nothing: this test tests nothing")
    del place.environment["DYNWITNESS_CC"]
    place.agrees(KERNEL)
    place.requireNothingLeft()


KILLER = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
/* before the n-th change to the names of files, KILL; after the last, the number of changes is in a file */
static int calls;
static void count(void) {
  const char* n = getenv("KILL_AT");
  if (n && ++calls == atoi(n)) kill(getpid(), SIGKILL);
}
#define WRAP(name, parameters, arguments) \
  int name parameters { count(); return ((int(*) parameters)dlsym(RTLD_NEXT, #name)) arguments; }
WRAP(rename, (const char* a, const char* b), (a, b))
WRAP(renameat2, (int f, const char* a, int g, const char* b, unsigned h), (f, a, g, b, h))
WRAP(mkdir, (const char* a, mode_t m), (a, m))
WRAP(rmdir, (const char* a), (a))
WRAP(unlink, (const char* a), (a))
WRAP(remove, (const char* a), (a))
WRAP(unlinkat, (int f, const char* a, int flags), (f, a, flags))
"""


def killer(place):
    if not shutil.which("cc"):
        raise Skipped("no C compiler")
    source, library = place.folder / "killer.c", place.folder / "killer.so"
    source.write_text(KILLER)
    subprocess.run(["cc", "-shared", "-fPIC", "-o", library, source, "-ldl"], check=True)
    return str(library)


@case
def a_kill_at_any_change_of_files_leaves_one_report_whole(place):
    words = QUICK + ["--witness", "newton_euler"]
    place.agrees(words + ["--seed", "1"])
    library, seeds, now = killer(place), [], 1
    for n in range(1, 200):
        place.environment.update(LD_PRELOAD=library, KILL_AT=str(n))
        status, _, err = place.run(words + ["--seed", str(3 - now)])
        del place.environment["LD_PRELOAD"]
        if status == 0:
            break
        check(status == -signal.SIGKILL, status, err)
        now = place.requireWhole({1, 2})
        seeds.append(now)
    check(n > 5 and n < 199, "changes of files:", n)
    check(set(seeds) == {1, 2}, "no KILL hit the time after the exchange:", seeds)
    place.requireNothingLeft()


@case
def signals_at_random_moments_leave_one_report_whole(place):
    words = ["crosscheck", "simple_pendulum", "--random", "2", "--processes", "2"]
    place.agrees(words + ["--seed", "1"])
    begin = time.time()
    place.agrees(words + ["--seed", "2"])
    length = time.time() - begin
    random.seed(1)
    for number in (signal.SIGTERM, signal.SIGKILL, signal.SIGINT) * 2:
        process = place.start(words + ["--seed", "1"])
        time.sleep(length * random.uniform(0.2, 1.05))
        below = descendants(process.pid)
        process.send_signal(number)
        process.communicate(timeout=20)
        requireGone(below)
        check(process.returncode in (0, -number), process.returncode)
        place.requireWhole({1, 2})
        left = [str(f) for f in place.work.rglob("*unfinished-%d*" % process.pid)]
        check(number == signal.SIGKILL or not left, "left behind:", left)
    place.agrees(words + ["--seed", "3"])
    place.requireWhole({3})
    place.requireNothingLeft()


@case
def an_atlas_that_was_killed_goes_on_to_the_same_bytes(place):
    words = ["stability", "gimbal,spinning_ball,light_cart", "--quick", "--witness", "articulated_body,kdl"]
    place.report = place.work / "stability"
    place.agrees(words)
    whole = place.snapshot()
    shutil.rmtree(place.report)
    kept = place.work / "stability.unfinished"
    finished = lambda: sorted(file.name for file in kept.glob("*.json"))
    for number in (signal.SIGKILL, signal.SIGTERM):
        for families in (1, 2):
            status, err = signalled(place, words, number, lambda _: len(finished()) >= families)
            check(status == -number, number, status, err)
            check(len(finished()) < 3 and not place.report.exists(), "killed too late:", finished())
            place.agrees(words + ["--resume"])
            check(place.snapshot() == whole, "not the same bytes:",
                  [name for name, text in place.snapshot().items() if whole.get(name) != text])
            check(not kept.exists(), "left behind:", finished())
            shutil.rmtree(place.report)
    # what is kept is what is shown: were all done anew, this would not be seen
    signalled(place, words, signal.SIGKILL, lambda _: len(finished()) >= 1)
    file = kept / "gimbal.json"
    family = json.loads(file.read_text())
    for course in family["methods"]:
        course["breaks_at"] = 12345.0
    file.write_text(json.dumps(family))
    check("1.23e+04" in place.agrees(words + ["--resume"]), "gimbal was turned again")


@case
def files_of_others_stay_where_they_are(place):
    place.agrees(QUICK + ["--seed", "1"])
    (place.report / "mine.txt").write_text("mine")
    place.agrees(QUICK + ["--seed", "2"])
    check((place.report / "mine.txt").read_text() == "mine", "gone")
    (place.report / "mine.txt").unlink()
    place.requireWhole({2})
    place.requireNothingLeft()


def run(function):
    begin = time.time()
    name = function.__name__.replace("_", " ")
    with tempfile.TemporaryDirectory(prefix="dynwitness_surroundings_",
                                     ignore_cleanup_errors=True) as folder:
        os.chmod(folder, 0o700)
        try:
            function(Place(folder))
            requireQuiet(folder)
            verdict = "ok"
        except Skipped as reason:
            verdict = "skipped: %s" % reason
        except Exception:
            verdict = "FAILED\n" + traceback.format_exc()
    print("%5.1f s  %s: %s" % (time.time() - begin, name, verdict), flush=True)
    return not verdict.startswith("FAILED")


def main():
    asked = [f for f in CASES if not sys.argv[2:] or any(word in f.__name__ for word in sys.argv[2:])]
    check(asked, "no such case")
    # the first waits for most of its time
    with concurrent.futures.ThreadPoolExecutor(max(2, len(os.sched_getaffinity(0)))) as pool:
        results = list(pool.map(run, asked))
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The man page and completion for bash and zsh know every command and every option that the programs know, and the shell and
the formatter take them. Usage: test_pages.py DYNWITNESS"""
import os
import re
import shutil
import subprocess
import sys
import tempfile

PROGRAM = sys.argv[1]
ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..")
COMMANDS = os.path.join(ROOT, "crosscheck", "cli", "commands.txt")


def run(*words, **more):
    return subprocess.run(words, capture_output=True, text=True, **more)


def completed(folder, *words):
    script = "source '%s/dynwitness.bash'; COMP_WORDS=(%s); COMP_CWORD=%d; _dynwitness; echo \"${COMPREPLY[*]}\"" % (
        folder, " ".join("'%s'" % w for w in words), len(words) - 1)
    done = run("bash", "-c", script)
    assert done.returncode == 0 and not done.stderr, done.stderr
    return done.stdout.split()


def main():
    with tempfile.TemporaryDirectory() as folder:
        made = run(sys.executable, os.path.join(ROOT, "crosscheck", "cli", "pages.py"), PROGRAM, COMMANDS, folder)
        assert made.returncode == 0, made.stderr
        page = open(os.path.join(folder, "dynwitness.1")).read()
        # what a reader gets to see, hyphens as on a keyboard
        seen = page.replace("\\-", "-")
        options = 0
        for line in open(COMMANDS):
            if line.startswith("#") or not line.strip():
                continue
            command = line.split()[0]
            section = re.search(r"^\.SS %s\n(.*?)(?=^\.S[SH] )" % command, seen, re.S | re.M)
            assert section, command
            assert re.search(r"^Examples?:$", section[1], re.M) and "\n  dynwitness %s" % command in section[1], command
            offered = completed(folder, PROGRAM, command, "-")
            # by another road than pages.py: every word of the help that stands where options begin
            known = re.findall(r"^  (?:-\w,)?(--[\w-]+)", run(PROGRAM, command, "--help").stdout, re.M)
            assert known, command
            for option in known:
                assert re.search(r"^\\fB(-\w, )?%s\\fR" % option, section[1], re.M), (command, option)
                assert option in offered, (command, option, offered)
            assert set(known) == {o for o in offered if o.startswith("--")}, command
            options += len(known)
        assert options >= 150, options
        notes = seen[seen.index("\n.SH NOTES\n"):]
        assert "Exit status: 0 all agree" in notes and "Subcommands" not in notes, notes
        assert completed(folder, PROGRAM, "der") == ["derive"]
        assert "--format" in completed(folder, PROGRAM, "derive", "--fo")
        assert "python" in completed(folder, PROGRAM, "derive", "--format", "py")
        assert completed(folder, PROGRAM, "derive", "furu") == ["furuta_pendulum"]
        zsh = open(os.path.join(folder, "_dynwitness")).read()
        assert zsh.startswith("#compdef dynwitness\n")
        for line in open(COMMANDS):
            if line.startswith("#") or not line.strip():
                continue
            command = line.split()[0]
            section = re.search(r"^    %s\)\n(.*?)^      ;;$" % command, zsh, re.S | re.M)
            assert section, command
            offered = set(re.findall(r"^        '(?:\*|\([^)]*\))(--[\w-]+)=?\[", section[1], re.M))
            assert offered == set(re.findall(r"^  (?:-\w,)?(--[\w-]+)", run(PROGRAM, command, "--help").stdout, re.M)), (
                command, offered)
        assert re.search(r"'\(--format\)--format=\[[^]]*\]:value:\([^)]*python", zsh)
        if shutil.which("zsh"):
            file = os.path.join(folder, "_dynwitness")
            read = run("zsh", "-n", file)
            assert read.returncode == 0 and not read.stderr, read.stderr
            loaded = run("zsh", "-f", "-c", "fpath=('%s'); autoload +X _dynwitness; whence -w _dynwitness" % folder)
            assert loaded.stdout == "_dynwitness: function\n" and not loaded.stderr, loaded
        if shutil.which("man"):
            shown = run("man", "--warnings", "-l", os.path.join(folder, "dynwitness.1"))
            assert shown.returncode == 0 and not shown.stderr, shown.stderr[:2000]
        print("%d options" % options)


main()

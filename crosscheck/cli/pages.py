#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A man page and completion for bash and zsh, from what the programs themselves say of their options.
Usage: pages.py DYNWITNESS COMMANDS FOLDER; COMMANDS is commands.txt, FOLDER gets dynwitness.1, dynwitness.bash and
_dynwitness."""
import os
import re
import subprocess
import sys

TEXTS = 30  # column where --help begins its texts (help.cpp)


def help_of(program, *words):
    done = subprocess.run([program, *words, "--help"], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit("pages.py: %s %s --help: %s" % (program, " ".join(words), done.stderr.strip()))
    return done.stdout


def read(text):
    """Usage, options and footer of a command: [(names, value, choices, text)]."""
    usage, options, footer, part = "", [], [], ""
    for line in text.splitlines():
        option = re.match(r"  ((?:-\w,)?--[\w-]+|-\w)(?:\{false\})?(?: (.*))?$", line)
        if line.startswith("Usage: "):
            usage = line[len("Usage: "):]
        elif line in ("Positionals:", "Options:"):
            part = line
        elif part == "Options:" and option:
            rest, said = option[2] or "", ""
            if len(line) > TEXTS and line[TEXTS - 2:TEXTS] == "  ":
                said, rest = line[TEXTS:], line[option.end(1):TEXTS].replace("{false}", "").strip()
            value = re.match(r"(?!Excludes|Needs|REQUIRED)([A-Za-z][A-Za-z,=_\[\]]*)", rest)
            choices = re.match(r"TEXT:\{(.*?)\}", rest)
            options.append([option[1].split(","), value[1] if value else "",
                            choices[1].split(",") if choices else [], said])
        elif part == "Options:" and options and line.startswith(" " * TEXTS):
            options[-1][3] += (" " if options[-1][3] else "") + line.strip()
        elif part == "Options:" and line and not line.startswith(" "):
            part = "footer"
        if part == "footer":
            footer.append(line)
    return usage, options, footer


def roff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return re.sub(r"^([.\\](?!-|e|\())", r"\\&\1", text)


def paragraphs(lines):
    """Flowing text; what can be copied keeps its lines."""
    out = []
    for line in lines:
        if not line:
            out.append(".PP")
        elif line.startswith(" "):
            out += [".nf", roff(line), ".fi"]
        else:
            out.append(roff(line))
    return out


def man_page(commands, pages, notes):
    out = [".TH DYNWITNESS 1", ".SH NAME",
           "dynwitness \\- independent computations of a mechanism\\(aqs dynamics testify against each other",
           ".SH SYNOPSIS", ".B dynwitness", ".I COMMAND", "[\\fIOPTION\\fR...] [\\fISCENE\\fR...]", ".SH COMMANDS"]
    for name, description in commands:
        usage, options, footer = pages[name]
        out += [".SS " + name, roff(description), ".PP", ".B " + roff(usage)]
        for names, value, choices, text in options:
            what = " \\fI%s\\fR" % ("|".join(map(roff, choices)) or value) if value else ""
            out += [".TP", "\\fB" + ", ".join(map(roff, names)) + "\\fR" + what, roff(text)]
        out += [".PP"] + paragraphs(footer)
    out += [".SH NOTES"] + paragraphs(notes)
    return "\n".join(out) + "\n"


def completion(commands, pages):
    out = ["# bash completion of dynwitness; written from its own --help", "_dynwitness() {",
           '  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} options="" values=""',
           "  COMPREPLY=()",
           "  if [[ $COMP_CWORD == 1 ]]; then",
           "    COMPREPLY=($(compgen -W '%s help --help --version' -- \"$word\"))" % " ".join(n for n, _ in commands),
           "    return", "  fi", '  case ${COMP_WORDS[1]} in']
    for name, _ in commands:
        options = pages[name][1]
        out.append("    %s)" % name)
        out.append("      options='%s'" % " ".join(n for names, *_ in options for n in names))
        cases = ["%s) values='%s' ;;" % ("|".join(names), " ".join(choices)) for names, _, choices, _ in options
                 if choices]
        if cases:
            out += ["      case $before in"] + ["        " + c for c in cases] + ["      esac"]
        out.append("      ;;")
    out += ["  esac",
            "  if [[ $word == -* ]]; then values=$options",
            "  elif [[ -z $values && $before != -* ]]; then  # a scene, or a file of one's own",
            "    values=$(\"${COMP_WORDS[0]}\" scenes 2>/dev/null | sed -n 's/^\\([a-z][a-z0-9_]*\\) .*/\\1/p')",
            "  fi",
            '  [[ -z $values ]] || COMPREPLY=($(compgen -W "$values" -- "$word"))',
            "}", "complete -o bashdefault -o default -F _dynwitness dynwitness ./dynwitness"]
    return "\n".join(out) + "\n"


def briefly(text):
    """What zsh shows beside a word: the first clause, without what its specifications are made of."""
    first = re.split(r"[:;.] |[:;.]$", text)[0]
    return re.sub(r"[\[\]:\\'\"`$]", "", first).strip()


def zsh_option(names, value, choices, text):
    """One line of _arguments a name; what a value may be stands behind the colons."""
    ends = ""
    if choices:
        ends = ":value:(%s)" % " ".join(choices)
    elif value:
        ends = ":%s:%s" % (re.sub(r"\W", " ", value), "_files" if value == "TEXT" else " ")
    others = "*" if "again for more" in text else "(%s)" % " ".join(names)
    return ["'%s%s%s[%s]%s'" % (others, name, "=" if value and name.startswith("--") else "", briefly(text), ends)
            for name in names]


def zsh_completion(commands, pages):
    out = ["#compdef dynwitness", "# zsh completion of dynwitness; written from its own --help", "",
           "_dynwitness_scenes() {", "  local -a scenes",
           "  scenes=(${(f)\"$($program scenes 2>/dev/null | sed -n 's/^\\([a-z][a-z0-9_]*\\) .*/\\1/p')\"})",
           "  _alternative 'scenes:scene:compadd -a scenes' 'files:file:_files'", "}", "", "_dynwitness() {",
           "  local program=$words[1] context state line", "  local -a commands", "  if (( CURRENT == 2 )); then",
           "    commands=("]
    out += ["      '%s:%s'" % (name, description.replace("'", "'\\''").replace(":", "\\:")) for name, description in commands]
    out += ["    )", "    _describe -t commands command commands", "    return", "  fi", "  local command=$words[2]",
            "  shift words", "  (( CURRENT-- ))", "  case $command in"]
    for name, _ in commands:
        out += ["    %s)" % name, "      _arguments -s \\"]
        for option in pages[name][1]:
            out += ["        %s \\" % line for line in zsh_option(*option)]
        out += ["        '*:scene or file:_dynwitness_scenes'", "      ;;"]
    return "\n".join(out + ["  esac", "}", "", "_dynwitness \"$@\""]) + "\n"


def main():
    program, listed, folder = sys.argv[1:]
    commands = [(words[0], words[2].strip()) for words in
                (line.split(None, 2) for line in open(listed) if line.strip() and not line.startswith("#"))]
    pages = {name: read(help_of(program, name)) for name, _ in commands}
    # what --help says of all commands stands behind the list of them
    help_of_all = help_of(program).splitlines()
    notes = help_of_all[max(k for k, line in enumerate(help_of_all) if line.startswith("  ")) + 1:]
    os.makedirs(folder, exist_ok=True)
    for file, text in (("dynwitness.1", man_page(commands, pages, notes)), ("dynwitness.bash", completion(commands, pages)),
                       ("_dynwitness", zsh_completion(commands, pages))):
        with open(os.path.join(folder, file), "w") as out:
            out.write(text)


main()

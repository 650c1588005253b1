#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Code for controllers, of all bundled scenes: compiled by gcc and clang without a warning, right by the test that
comes with it, with the operations that it says, and nothing of a library but cosines and sines; in MATLAB's words run by Octave.
Usage: test_controller_code.py DYNWITNESS. Exit status 77: no C compiler."""
import collections
import glob
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

PROGRAM = sys.argv[1]
DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "data", "scenes")
COMPILERS = [c for c in ("gcc", "clang") if shutil.which(c)]
WARNINGS = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Wconversion", "-Werror"]
ALL = "tau,qdd,M,C,c,g,Y"
# why a scene may have no code: each is a sentence of features.md or a number of operations
REASONS = ("programs are made for open trees alone", "no code is written for joints that share a rate",
           "operations in ", "degrees of freedom, at most", "there is nothing to ask", "M is singular", "division by zero",
           "what is computed here passes each axis of a joint by itself")


def run(*words, **more):
    return subprocess.run(words, capture_output=True, text=True, **more)


def derive(scene, *words):
    return run(PROGRAM, "derive", scene, *words)


def compiled(folder, name, compiler, libm=True):
    """The test program of a scene's code; what it needs from elsewhere is cosine and sine."""
    code = os.path.join(folder, name + ".c")
    made = run(compiler, *WARNINGS, "-O0", "-c", code, "-o", code + ".o")
    assert made.returncode == 0 and not made.stderr, (name, compiler, made.stderr[:3000])
    needs = {line.split()[-1] for line in run("nm", "-u", code + ".o").stdout.splitlines() if line.strip()}
    assert needs <= {"cos", "sin", "cosf", "sinf", "_GLOBAL_OFFSET_TABLE_", "sincos", "sincosf"}, (name, needs)
    program = os.path.join(folder, name + "_" + compiler)
    made = run(compiler, *WARNINGS, "-O0", os.path.join(folder, name + "_test.c"), code + ".o", "-o", program, "-lm")
    assert made.returncode == 0 and not made.stderr, (name, compiler, made.stderr[:3000])
    return program


def identifier(folder):
    return os.path.basename(glob.glob(os.path.join(folder, "*.h"))[0])[:-2]


def counted(folder, name):
    """{function: (multiplications, additions, divisions)} in the text; each is also what the header says."""
    header = open(os.path.join(folder, name + ".h")).read()
    said = dict((f, tuple(map(int, n))) for *n, f in
                re.findall(r"(?:a call|once): (\d+) multiplications, (\d+) additions,\s+(\d+) divisions(?:(?!a call|once:).)*?"
                           r"void (\w+)\(", header, re.S))
    found = {}
    source = open(os.path.join(folder, name + ".c")).read()
    for function, body in re.findall(r"void (\w+)\([^)]*\) \{\n(.*?)\n\}\n", source, re.S):
        found[function] = tuple(len(re.findall(r"(?<= )" + sign + "(?= )", body)) for sign in (r"\*", "[-+]", "/"))
        assert not re.search(r"\* 0\.0(?!\d)|\b0\.0 \*|(?<![\d.])1\.0 \*|\* 1\.0(?!\d)", body), function
        assert said[function] == found[function], (function, said[function], found[function])
    assert len(found) == len(said) > 0
    return found


def last_link(scene):
    shown = run(PROGRAM, "show", scene, "--format", "json").stdout
    return json.loads(shown)["links"][-1]["name"]


def all_scenes(work):
    held, refused = [], {}
    for file in sorted(glob.glob(os.path.join(DATA, "*.toml"))):
        scene = os.path.basename(file)[:-5]
        folder = os.path.join(work, scene)
        point = ["--point", last_link(scene)]
        done = derive(scene, "--format", "c", "--quantity", ALL + ",position,orientation,jacobian,jacobian_rate",
                      *point, "-o", folder)
        if done.returncode == 2 and "operations" in done.stderr:  # FD of a humanoid; its tau is short enough
            refused[scene] = done.stderr
            done = derive(scene, "--format", "c", "--quantity", "tau,c,g,jacobian", *point, "-o", folder)
        if done.returncode != 0:
            assert done.returncode == 2 and any(r in done.stderr for r in REASONS), (scene, done.stderr)
            assert not os.path.exists(folder), scene
            refused[scene] = done.stderr
            continue
        name = identifier(folder)
        counted(folder, name)
        for compiler in COMPILERS:
            answered = run(compiled(folder, name, compiler))
            assert answered.returncode == 0, (scene, compiler, answered.stdout[:3000])
        held.append(scene)
    print("%d scenes hold: %s" % (len(held), ", ".join(held)))
    for scene, why in refused.items():
        print("refused: %s: %s" % (scene, why.strip().splitlines()[-1]))
    assert len(held) >= 25, held
    return held


def with_parameters(scene, folder, *words):
    """The scene's code with its numbers in a struct; what it has if not, is what was tested folded."""
    for quantities in (ALL + ",position,orientation,jacobian,jacobian_rate", "tau,c,g,jacobian"):
        done = derive(scene, "--format", "c", "--parameters", "struct", "--quantity", quantities, "--point",
                      last_link(scene), "-o", folder, *words)
        if done.returncode == 0 or "operations" not in done.stderr:
            break
    return done


def fields(folder, name):
    """[(field, value, what --set calls it)] of masses and of the scene's own parameters, in the header's order."""
    header = open(os.path.join(folder, name + ".h")).read()
    values = dict(re.findall(r"^  \.(\w+) = \(?([^,]*?)\)?,$", open(os.path.join(folder, name + ".c")).read(), re.M))
    said = re.findall(r"^  double (\w+); /\* (?:\[[^]]*\]|unit as the scene has it)(?: (\S.*?))? \*/$", header, re.M)
    assert len(said) == len(values), (said, values)
    return [(field, float(values[field]), what or field) for field, what in said
            if not what or what.startswith("mass:")]


def changed_answers(scene, folder, name, work):
    """A field doubled gives what the scene has with --set, and what the field was does not: by the numbers that
    test the changed scene's own code. False where no field that was tried matters."""
    for field, value, what in fields(folder, name)[::-1][:4]:
        other = os.path.join(work, scene + "_other")
        shutil.rmtree(other, ignore_errors=True)
        done = with_parameters(scene, other, "--set", "%s=%r" % (what, 2 * value))
        if done.returncode != 0:  # impossible with that number
            continue
        test = open(os.path.join(other, name + "_changed_test.c")).read().replace(name + "_changed", name)
        call = "%s_init(&%s_parameters, constants);" % (name, name)
        assert test.count(call) == 1
        answers = []
        for factor in (1, 2):
            doubled = "%s_parameters_type changed = %s_parameters;\n  changed.%s *= %d.0;\n  %s_init(&changed, constants);" % (
                name, name, field, factor, name)
            file = os.path.join(folder, "changed.c")
            with open(file, "w") as out:
                out.write(test.replace(call, doubled))
            program = os.path.join(folder, "changed")
            made = run(COMPILERS[0], *WARNINGS, "-O0", file, os.path.join(folder, name + ".c.o"), "-o", program, "-lm")
            assert made.returncode == 0, made.stderr[:3000]
            answers.append(run(program))
        assert answers[1].returncode == 0, (scene, what, answers[1].stdout[:3000])
        if answers[0].returncode == 1:
            return True
    return False


def all_scenes_with_parameters(work, scenes):
    changed = []
    for scene in scenes:
        folder = os.path.join(work, scene + "_struct")
        done = with_parameters(scene, folder)
        assert done.returncode == 0, (scene, done.stderr)
        name = identifier(folder)
        assert name + "_init" in counted(folder, name)
        for compiler in COMPILERS:
            answered = run(compiled(folder, name, compiler))
            assert answered.returncode == 0, (scene, compiler, answered.stdout[:3000])
        if changed_answers(scene, folder, name, work):
            changed.append(scene)
    print("%d of %d scenes answer with a number changed in the struct" % (len(changed), len(scenes)))
    assert len(changed) >= len(scenes) - 2, set(scenes) - set(changed)


def parameters_of_other_languages(work):
    """Python with a mass doubled; single precision; angles and axes are folded, and the header says so."""
    folder = os.path.join(work, "struct_python")
    done = derive("puma_560_friction", "--format", "python", "--parameters", "struct", "--quantity", ALL, "-o", folder)
    assert done.returncode == 0, done.stderr
    assert run("/usr/bin/python3", "puma_560_friction_test.py", cwd=folder).returncode == 0
    other = os.path.join(work, "struct_python_other")
    assert derive("puma_560_friction", "--set", "mass:link_3=9.6", "--format", "python", "--parameters", "struct",
                  "--quantity", ALL, "-o", other).returncode == 0
    test = open(os.path.join(other, "puma_560_friction_changed_test.py")).read().replace("_changed", "")
    for mass, status in (("9.6", 0), ("4.8", 1)):
        with open(os.path.join(folder, "changed.py"), "w") as out:
            out.write(test.replace("_init(puma_560_friction.puma_560_friction_parameters)",
                                   "_init(__import__('dataclasses').replace(puma_560_friction."
                                   "puma_560_friction_parameters, mass_link_3=" + mass + "))"))
        assert run("/usr/bin/python3", "changed.py", cwd=folder).returncode == status, mass
    for scene in ("puma_560_friction", "satellite_arm", "lead_screw"):
        folder = os.path.join(work, scene + "_struct_float")
        done = derive(scene, "--format", "c", "--scalar", "float", "--parameters", "struct", "--quantity", "tau,qdd,M",
                      "-o", folder)
        assert done.returncode == 0, done.stderr
        name = identifier(folder)
        assert not re.search(r"\bdouble\b", open(os.path.join(folder, name + ".c")).read())
        for compiler in COMPILERS:
            answered = run(compiled(folder, name, compiler))
            assert answered.returncode == 0, (scene, compiler, answered.stdout[:3000])
    for language, says in (("matlab", "  parameters.mass_link_3 = 4.8; % [kg] mass:link_3"),
                           ("julia", "    mass_link_3 = 4.8,  # [kg] mass:link_3")):
        text = derive("puma_560_friction", "--format", language, "--parameters", "struct", "--quantity", "tau").stdout
        assert says in text, text[:3000]


# words of languages, names that become one, parameters of angles, made of others, of two units, 0, and without use
ODD = """title = "Odd parameters"
source = "made here"
gravity = [0, "-lambda/2", "-lambda"]
[parameters]
lambda = 9.81
alpha = 0.3
l = 0.5
half = "l/2"
b = 0
m_2 = "3*half"
unused = 4
[[link]]
name = "base"
[[link]]
name = "arm 1"
parent = "base"
mass = "m_2"
com = ["half", 0, "alpha*l"]
inertia = { xx = 0.1, yy = 0.1, zz = 0.12 }
[link.joint]
name = "j 1"
kind = "revolute"
rpy = [0, "alpha", "pi/3"]
axis = [1, 2, 2]
friction = { viscous = "b", coulomb = 0.3 }
rotor_inertia = 0.001
gear_ratio = 50
[[link]]
name = "arm/1"
parent = "arm 1"
mass = 2
com = [0.1, 0, 0]
inertia = { about = "origin", rpy = [0.1, 0, 0], xx = 0.1, yy = 0.2, zz = 0.22 }
[link.joint]
name = "screw"
kind = "helical"
pitch = 0.02
xyz = ["l", "half-0.25", 0]
stiffness = 10
rest = "pi/7"
[[wrench]]
link = "arm/1"
force = [1, 0, "l"]
at = [0, 0.2, 0]
axes = "world"
"""


def odd_parameters(work):
    scene = os.path.join(work, "odd.toml")
    with open(scene, "w") as out:
        out.write(ODD)
    for scalar in ("double", "float"):
        folder = os.path.join(work, "odd_" + scalar)
        done = derive(scene, "--format", "c", "--scalar", scalar, "--parameters", "struct", "--quantity",
                      ALL + ",jacobian,position", "--point", "arm/1,0,0,alpha*half", "-o", folder)
        assert done.returncode == 0, done.stderr
        for compiler in COMPILERS:
            answered = run(compiled(folder, "odd", compiler))
            assert answered.returncode == 0, (scalar, compiler, answered.stdout[:3000])
        header = open(os.path.join(folder, "odd.h")).read()
        assert "folded: alpha." in " ".join(header.split())
        assert not re.search(r"(alpha|half|m_2|unused);", header)
        for field in ("lambda_; /* [m/s^2] lambda */", "l; /* unit as the scene has it */", "b; /* [N m s/rad] */",
                      "inertia_xx_arm_1_2; /* [kg m^2] inertia_xx:arm/1 */"):
            assert "  %s %s\n" % (scalar, field) in header, field


def structs_line_by_line(work):
    """Julia and MATLAB with a mass doubled: what their lines say as assignments is what Python answers."""
    scene, change = "puma_560_friction", "mass_link_3"
    for language in ("python", "julia", "matlab"):
        done = derive(scene, "--format", language, "--parameters", "struct", "--quantity", ALL, "-o",
                      os.path.join(work, "lines_" + language))
        assert done.returncode == 0, done.stderr
    from dataclasses import asdict, replace
    from math import cos, sin
    state = {"q": [0.3 + 0.1 * k for k in range(6)], "qd": [(-1) ** k * (0.5 + 0.2 * k) for k in range(6)],
             "qdd": [0.7 - 0.1 * k for k in range(6)], "tau": [1.0 + k for k in range(6)]}
    names = {}
    exec(open(os.path.join(work, "lines_python", scene + ".py")).read(), names)
    own = names[scene + "_parameters"]
    other = replace(own, **{change: 2 * getattr(own, change)})
    constants = names[scene + "_init"](other)
    wanted = {}
    for name, function in names.items():
        if name.startswith(scene) and not name.endswith(("_init", "_parameters", "_parameters_type")):
            arguments = function.__code__.co_varnames[1:function.__code__.co_argcount]
            wanted[name] = [x for row in function(constants, *[state[a] for a in arguments])
                            for x in (row if isinstance(row, list) else [row])]
    assert len(wanted) == 7

    class Fields(dict):  # parameters.mass; of arrays, from 1
        __getattr__ = dict.__getitem__

    def run_lines(body, given):
        values = {"cos": cos, "sin": sin, "out": {}, "constants": collections.defaultdict(dict), **given}
        for line in body.splitlines():
            line = re.sub(r"\(\((\S+) > 0\.0\) \? (\S+) : \(\((\S+) < 0\.0\) \? (\S+) : 0\.0\)\)",
                          r"(\2 if \1 > 0.0 else (\4 if \3 < 0.0 else 0.0))", line.strip().rstrip(";"))
            line = re.sub(r"\b(q|qd|qdd|tau|out|k|friction)\((\d+(?:, \d+)?)\)", r"\1[\2]", line)
            line = re.sub(r"constants\.(\w+)(?:\((\d+)\))?", lambda m: "constants['%s']" % m[1] + ("[%s]" % m[2] if m[2] else ""),
                          line)
            if re.match(r"\w+(\['\w+'\])?(\[[\d, ]+\])? = (?!zeros|struct)", line):
                exec(line, values)
        return values

    def from_one(numbers):
        return {k + 1: x for k, x in enumerate(numbers)}

    text = open(os.path.join(work, "lines_julia", scene + ".jl")).read()
    bodies = {"julia " + f: b for f, b in re.findall(r"^function (\w+)!?\(.*?\)\n(.*?)^end$", text, re.S | re.M)}
    parameters = {"julia": dict(re.findall(r"^    (\w+) = \(?([^ ]*?)\)?,  #", text, re.M))}
    for file in glob.glob(os.path.join(work, "lines_matlab", "*.m")):
        bodies["matlab " + os.path.basename(file)[:-2]] = open(file).read()
    parameters["matlab"] = dict(re.findall(r"^  parameters\.(\w+) = \(?([^ ]*?)\)?; %", bodies["matlab %s_parameters" % scene],
                                           re.M))
    for language in ("julia", "matlab"):
        given = Fields({k: float(x) for k, x in parameters[language].items()})
        assert given == asdict(own), language
        given[change] *= 2
        made = run_lines(bodies["%s %s_init" % (language, scene)], {"parameters": given})
        constants = made["constants"] or {k[:-1]: from_one(x) for k, x in made.items() if k.endswith("_") and k[0] != "_"}
        for name, expected in wanted.items():
            out = run_lines(bodies[language + " " + name],
                            {"constants": constants, **{a: from_one(v) for a, v in state.items()}})["out"]
            columns = max([k[1] for k in out if isinstance(k, tuple)], default=1)
            got = [0.0] * len(expected)
            for key, x in out.items():
                got[(key[0] - 1) * columns + key[1] - 1 if isinstance(key, tuple) else key - 1] = x
            assert got == expected, (language, name)


def single_precision(work):
    for scene in ("puma_560_friction", "satellite_arm", "double_pendulum", "franka_panda", "lead_screw"):
        folder = os.path.join(work, scene + "_float")
        done = derive(scene, "--format", "c", "--scalar", "float", "--quantity", "tau,qdd,M", "-o", folder)
        assert done.returncode == 0, done.stderr
        name = identifier(folder)
        assert not re.search(r"\bdouble\b", open(os.path.join(folder, name + ".c")).read())
        for compiler in COMPILERS:
            answered = run(compiled(folder, name, compiler))
            assert answered.returncode == 0, (scene, compiler, answered.stdout[:3000])


def counts_are_those_of_the_smallest_road():
    table = derive("puma_560", "--operations").stdout
    smallest = dict(re.findall(r"^(ID|M|FD) {5,}.*?\* (\d+/\d+/\d+)", table, re.M))
    header = derive("puma_560", "--format", "c", "--quantity", "tau,M,qdd").stdout
    for function, formula in (("tau", "ID"), ("M", "M"), ("qdd", "FD")):
        call = re.search(r"a call: (\d+) multiplications, (\d+) additions,\s+(\d+) divisions(?:(?!a call).)*?void "
                         "puma_560_" + function + r"\(", header, re.S)
        assert "/".join(call.groups()) == smallest[formula], (function, call.groups(), smallest)


def faults_are_seen(work):
    """A sign in each function in turn: the test that was written with the code has to say no."""
    folder = os.path.join(work, "faults")
    assert derive("puma_560_friction", "--format", "c", "--quantity", ALL, "-o", folder).returncode == 0
    code = os.path.join(folder, "puma_560_friction.c")
    right = open(code).read()
    bodies = [m.span() for m in re.finditer(r"void (\w+)\([^)]*\) \{\n(.*?)\n\}\n", right, re.S)]
    for begin, end in bodies:
        sums = [m.start() for m in re.finditer(r" \+ ", right[begin:end])]
        at = begin + sums[len(sums) // 2]
        with open(code, "w") as file:
            file.write(right[:at] + " - " + right[at + 3:])
        answered = run(compiled(folder, "puma_560_friction", COMPILERS[0]))
        assert answered.returncode == 1, right[begin:begin + 80]
    with open(code, "w") as file:  # friction alone
        file.write(right.replace("+ friction2", "- friction2", 1))
    assert run(compiled(folder, "puma_560_friction", COMPILERS[0])).returncode == 1


def other_languages(work):
    """Python runs; Julia and MATLAB are read line by line, as assignments of Python with other indices."""
    for scene in ("puma_560_friction", "satellite_arm"):
        for language in ("python", "julia", "matlab"):
            done = derive(scene, "--format", language, "--quantity", ALL, "-o", os.path.join(work, scene + language))
            assert done.returncode == 0, done.stderr
        python = os.path.join(work, scene + "python")
        answered = run("/usr/bin/python3", scene + "_test.py", cwd=python)
        assert answered.returncode == 0, answered.stdout
        sys.path.insert(0, python)
        module = __import__(scene)
        wanted = {}
        from math import cos, sin
        state = {"q": [0.3 + 0.1 * k for k in range(20)], "qd": [(-1) ** k * (0.5 + 0.2 * k) for k in range(20)],
                 "qdd": [0.7 - 0.1 * k for k in range(20)], "tau": [1.0 + k for k in range(20)]}
        for line in open(os.path.join(python, scene + ".py")):
            found = re.match(r"def (\w+)\((.*)\):", line)
            if found:
                value = getattr(module, found[1])(*[state[a.strip()] for a in found[2].split(",")])
                wanted[found[1]] = [x for row in value for x in (row if isinstance(row, list) else [row])]
        assert len(wanted) == 7
        julia = open(os.path.join(work, scene + "julia", scene + ".jl")).read()
        texts = {}
        for function, body in re.findall(r"function (\w+)!\(.*?\)\n(.*?)\nend\n", julia, re.S):
            texts["julia " + function] = [
                re.sub(r"\(\((\S+) > 0\.0\) \? (\S+) : \(\((\S+) < 0\.0\) \? (\S+) : 0\.0\)\)",
                       r"(\2 if \1 > 0.0 else (\4 if \3 < 0.0 else 0.0))", line)
                for line in body.splitlines() if "=" in line]
        for file in glob.glob(os.path.join(work, scene + "matlab", "*.m")):
            if not file.endswith("_test.m"):
                texts["matlab " + os.path.basename(file)[:-2]] = [
                    re.sub(r"\b(q|qd|qdd|tau|out)\((\d+(?:, \d+)?)\)", r"\1[\2]", line.strip().rstrip(";"))
                    for line in open(file) if re.match(r"  \w+(\(\d+(, \d+)?\))? = (?!zeros)", line)]
        assert len(texts) == 14, texts.keys()

        class FromOne(dict):  # out[2, 3]
            pass

        for what, lines in texts.items():
            function, out = what.split()[1], FromOne()
            names = {"cos": cos, "sin": sin, "out": out}
            names.update({a: dict((k + 1, x) for k, x in enumerate(v)) for a, v in state.items()})
            for line in lines:
                exec(line.strip(), names)
            columns = max([k[1] for k in out if isinstance(k, tuple)], default=1)
            got = [0.0] * len(wanted[function])
            for key, x in out.items():
                got[(key[0] - 1) * columns + key[1] - 1 if isinstance(key, tuple) else key - 1] = x
            assert got == wanted[function], what


def run_by_octave(work, scenes):
    """MATLAB's code and its test, folded and with a struct, by Octave where that is there; a number that is off by
    1e-11 of itself is seen."""
    if not shutil.which("octave-cli"):
        print("not run: MATLAB's code, no octave-cli")
        return
    folders = {}
    for scene in scenes:
        for parameters in ("folded", "struct"):
            folder = os.path.join(work, "octave_%s_%s" % (scene, parameters))
            for quantities in (ALL + ",position,orientation,jacobian,jacobian_rate", "tau,c,g,jacobian"):
                done = derive(scene, "--format", "matlab", "--parameters", parameters, "--quantity", quantities,
                              "--point", last_link(scene), "-o", folder)
                if done.returncode == 0 or "operations" not in done.stderr:
                    break
            assert done.returncode == 0, (scene, done.stderr)
            folders[folder] = os.path.basename(glob.glob(os.path.join(folder, "*_test.m"))[0])[:-2]
    planted = os.path.join(work, "octave_planted")
    shutil.copytree(os.path.join(work, "octave_puma_560_folded"), planted)
    tau = os.path.join(planted, "puma_560_tau.m")
    text = open(tau).read()
    changed = re.sub(r"(?m)^(  out\(2\) = .*);$", r"\1 * (1 + 1e-11);", text)
    assert changed != text
    with open(tau, "w") as out:
        out.write(changed)
    folders[planted] = "puma_560_test"
    script = os.path.join(work, "all_tests.m")
    with open(script, "w") as out:
        for folder, test in folders.items():
            out.write("cd('%s'); rehash; printf('FAILURES %%d of %s\\n', %s()); clear('functions');\n" % (
                folder, os.path.basename(folder), test))
    answered = run("octave-cli", "--no-init-file", "--quiet", script).stdout
    failures = dict((name, int(count)) for count, name in re.findall(r"FAILURES (\d+) of (\w+)", answered))
    assert len(failures) == len(folders), answered[-3000:]
    assert failures.pop("octave_planted") > 0
    assert not any(failures.values()), failures
    print("Octave ran MATLAB's code of %d scenes, folded and with a struct" % len(scenes))


def refusals(work):
    for words, reason in (
            (["gripper"], "share a rate"), (["car_axis"], "open trees"), (["chain_1000"], "tau: 1000 degrees of freedom, at most 256"),
            (["acrobot", "--scalar", "float", "--format", "python"], "single precision is written in C"),
            (["acrobot", "--quantity", "jacobian"], "--point"), (["acrobot", "--point", "lower"], "--point"),
            (["acrobot", "--quantity", "taw"], "did you mean tau?"),
            (["acrobot", "--quantity", "jacobian", "--point", "lover"], "did you mean lower?")):
        words = words if "--quantity" in words else words + ["--quantity", "tau"]
        words = words if "--format" in words else words + ["--format", "c"]
        done = derive(*words, "-o", os.path.join(work, "none"))
        assert done.returncode == 2 and reason in done.stderr, (words, done.stderr)
    assert not os.path.exists(os.path.join(work, "none"))
    said = derive("puma_560_friction", "--format", "c", "--quantity", "M").stdout
    assert "friction (viscous, Coulomb; 0 at rest): in tau, qdd and their derivatives, not in M, c, g" in \
        " ".join(said.split())


def main():
    if not COMPILERS:
        print("skipped: no C compiler")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as work:
        counts_are_those_of_the_smallest_road()
        refusals(work)
        other_languages(work)
        faults_are_seen(work)
        single_precision(work)
        parameters_of_other_languages(work)
        structs_line_by_line(work)
        odd_parameters(work)
        scenes = all_scenes(work)
        all_scenes_with_parameters(work, scenes)
        run_by_octave(work, scenes)


main()

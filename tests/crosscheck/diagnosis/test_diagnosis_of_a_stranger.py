# SPDX-License-Identifier: GPL-3.0-or-later
"""Mistakes planted into a stranger's engine are named first, and a right engine is not blamed.

    python3 test_diagnosis_of_a_stranger.py PROGRAM [--long] [--trees N] [--each N] [--only NAME] [--jobs N] [--seconds S]
                                               [--table FILE]
    python3 test_diagnosis_of_a_stranger.py PROGRAM --crosscheck      # each mistake makes `crosscheck --engine` fail

The engine is data/museum/stranger.py. A single mistake is named when the first finding of `dynwitness check --format
json` explains it and is it: the same rule at the same link or joint, or a rule that makes the stranger give the same
answers (mechanics knows no difference), or when it is among those that `check` says no answer at any state tells from the
first. Whether a mistake changes anything on a scene, and whether two are one there, is computed with the stranger itself,
at states drawn here. Of a pair, the first finding names both.

Without --long: each mistake on one scene that has room for it. With it, all of them on all, with other ways to make
them, on five scenes, some more and N random trees (100).
"""
import argparse
import collections
import concurrent.futures
import json
import math
import os
import random
import re
import shlex
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve()
STRANGER = HERE.parents[3] / "data" / "museum" / "stranger.py"
sys.path.insert(0, str(STRANGER.parent))
import stranger  # noqa: E402

SCENES = ("simple_pendulum", "planar_3r", "puma_560", "kuka_iiwa_14", "humanoid")
MORE_SCENES = ("gyroscopic_wrist", "puma_560_friction", "humanoid_floating", "prismatic_revolute_mix")
SINGLES, PAIRS = 0.99, 0.90     # what the rates must reach
QUANTITIES = ("M", "c", "g", "tau", "kinetic", "potential", "momentum")
FORCES = ("c", "g", "tau")      # parts of one sum
FIGURES = ("mass_wrong", "length_wrong", "inertia_wrong")   # with a number of their own


# ---- what the stranger says

def states_of(scene, count, seed):
    draw = random.Random(seed)

    def some(n, reach):
        return [draw.uniform(-reach, reach) for _ in range(n)]
    n, m = scene["positions"], scene["dof"]
    return [{"q": some(n, 3), "qd": some(m, 3), "qdd": some(m, 10), "tau": some(m, 10)} for _ in range(count)]


class Subject:
    """A scene, and what the stranger answers about it with whatever planted."""

    def __init__(self, program, name, folder, toml=None):
        self.name, self.argument = name, name
        if toml is not None:
            self.argument = os.path.join(folder, name + ".toml")
            Path(self.argument).write_text(toml, encoding="utf-8")
        record = os.path.join(folder, name + ".json")
        words = [program, "evaluate", self.argument, "--quantity", "g", "--engine-seconds", "300", "--engine",
                 engine_words("--record", record)]
        done = subprocess.run(words, capture_output=True, text=True)
        if done.returncode:
            sys.exit("%s: %s" % (" ".join(words), done.stderr))
        self.scene = json.loads(Path(record).read_text(encoding="utf-8"))
        self.states = states_of(self.scene, 4, name)
        self.right_engine = stranger.Engine(self.scene)
        self.known = {}

    def answers(self, mistakes):
        if mistakes not in self.known:
            try:
                engine = stranger.Engine(self.scene, mistakes)
                self.known[mistakes] = [engine.answer(state, QUANTITIES) for state in self.states]
            except stranger.Refused:
                self.known[mistakes] = None
        return self.known[mistakes]

    def distance(self, one, other):
        """Of two answers: the largest difference of an entry, against the largest entry of that quantity, of a force against
        the largest of all: c that is rounding alone is zero."""
        if one is None or other is None:
            return math.inf
        worst, forces = 0.0, [x for answers in (one, other) for state in answers for quantity in FORCES
                              for x in flat(state[quantity]) if not isinstance(x, str)]
        for quantity in QUANTITIES:
            a, b = [flat(x[quantity]) for x in one], [flat(x[quantity]) for x in other]
            if any(isinstance(x, str) for row in a + b for x in row):
                worst = worst if a == b else math.inf
                continue
            scale = max(map(abs, forces if quantity in FORCES else sum(a + b, [])), default=0.0)
            for x, y in zip(a, b):
                worst = max([worst] + [abs(p - r) / scale for p, r in zip(x, y) if p != r])
        return worst

    def matters(self, mistakes):
        """More than rounding."""
        return self.distance(self.answers(mistakes), self.answers("")) > 1e-12

    def same(self, one, other):
        return self.distance(self.answers(one), self.answers(other)) < 1e-10

    def fitted(self, word, target):
        """The word with the figure that brings its answers nearest to the target's, by secants on the largest entry."""
        def miss(x):
            got, want = self.answers("%s=%r" % (word, x)), self.answers(target)
            if got is None:
                return None
            a, b = ([v for state in rows for q in ("M", "g") for v in flat(state[q])] for rows in (got, want))
            return None if any(isinstance(v, str) for v in a + b) else [p - r for p, r in zip(a, b)]
        x0, x1 = 1.0, 1.05
        f0, f1 = miss(x0), miss(x1)
        if f0 is None or f1 is None:
            return word
        k = max(range(len(f0)), key=lambda i: abs(f0[i] - f1[i]), default=None)
        for _ in range(30):
            if k is None or f1[k] == f0[k]:
                break
            x0, x1, f0 = x1, x1 - f1[k] * (x1 - x0) / (f1[k] - f0[k]), f1
            f1 = miss(x1)
        return "%s=%r" % (word, x1)


def flat(value):
    if isinstance(value, list):
        return [x for row in value for x in (row if isinstance(row, list) else [row])]
    return [value]


def engine_words(*words):
    return " ".join(shlex.quote(str(x)) for x in (sys.executable, STRANGER) + words)


# ---- what is planted

NAMES = list(stranger.MISTAKES)


def singles(subject, draw, rich, names=NAMES):
    """(name, word, kind) of what changes something: kind is "first" for the first way at one link, "everywhere" for all
    links at once, else "other way"."""
    engine = subject.right_engine
    for name in names:
        what, first = stranger.MISTAKES[name], True
        for variant in range(1, what.variants + 1):
            able = what.targets(engine, variant)
            if not able:
                continue
            kind = "first" if first else "other way"
            first = False
            words = [what.word(engine, index, variant, figure(name, draw)) for index in draw.sample(able, len(able))]
            word = next(filter(subject.matters, words), None)
            if word:
                yield name, word, kind
            everyone = what.word(engine, None, variant)
            if rich and what.whom and what.everybody and len(able) > 1 and subject.matters(everyone):
                yield name, everyone, "everywhere"


def figure(name, draw):
    return round(1 + draw.choice((-1, 1)) * draw.uniform(0.02, 0.4), 3) if name in FIGURES else None


def pairs(subject, found, draw, count):
    first = [(name, word) for name, word, kind in found if kind == "first"]
    tries = 0
    while count and len(first) > 1 and tries < 20 * count:
        tries += 1
        (a, one), (b, other) = draw.sample(first, 2)
        both = one + "," + other
        if subject.answers(both) is None or any(subject.same(both, x) for x in (one, other, "")):
            continue
        count -= 1
        yield (a, b), both


# ---- what is said about it

def check(program, subject, options, extra=()):
    """(exit status, findings, seconds, standard error)"""
    words = [program, "check", subject.argument, "--engine", engine_words(*options), "--engine-seconds", "300",
             "--format", "json", *extra]
    start = time.time()
    done = subprocess.run(words, capture_output=True, text=True)
    try:
        findings = json.loads(done.stdout).get("findings", [])
    except (ValueError, AttributeError):
        findings = None
    return done.returncode, findings, time.time() - start, done.stderr.strip()[-300:]


def rules_of(finding):
    """[(rule, link or joint or None, figure or None)]: one, or two of a pair. The figure is how many times as large an
    estimate is as in the scene, where there is one of them."""
    out = []
    for part in [finding] + finding.get("with", []):
        estimates = [x for x in part.get("estimates", []) if x.get("scene")]
        figure = estimates[0]["value"] / estimates[0]["scene"] if len(estimates) == 1 else None
        out.append((part["rule"], part.get("link") or part.get("joint"), figure))
    return out


def as_words(subject, rule, target, value):
    """How the stranger is told that: all ways to the name."""
    what = stranger.MISTAKES.get(rule)
    if what is None:
        return []
    at = ":" + target if target and what.whom else ""
    return ["%s~%d%s%s" % (rule, k, at, "=%r" % float(value) if value is not None and rule in FIGURES else "")
            for k in range(1, what.variants + 1) if what.targets(subject.right_engine, k)]


def target_of(word):
    return word.partition("=")[0].partition(":")[2]


def name_of(word):
    return re.split("[~:=]", word)[0]


def also_called(subject, target):
    """A link by its own name and by its joint's."""
    for link in subject.scene["links"]:
        names = {link["name"], link.get("joint", {}).get("name")}
        if target in names:
            return names
    return {target}


def is_named(subject, planted, finding):
    """Whether a finding is what was planted: by name, or by what the stranger answers with it."""
    if finding.get("explains") is not True:
        return False
    told, meant = rules_of(finding), planted.split(",")
    if len(told) == len(meant):
        left = list(told)
        for word in meant:
            target, of_the_whole = target_of(word), stranger.MISTAKES[name_of(word)].whom is None
            of_the_whole = of_the_whole or name_of(word) == "joint_order"  # of two joints
            hit = [t for t in left if t[0] == name_of(word) and (
                of_the_whole or (t[1] is None if not target else t[1] in also_called(subject, target)))]
            if hit:
                left.remove(hit[0])
        if not left:
            return True
    choices = [""]
    for rule, target, value in told:
        choices = [(a + "," if a else "") + b for a in choices for b in as_words(subject, rule, target, value)]
    if any(subject.same(planted, x) for x in choices):
        return True
    return len(told) == 1 and told[0][0] in FIGURES and any(
        subject.same(planted, subject.fitted(x.partition("=")[0], planted)) for x in choices)


# ---- random trees

def random_tree(seed):
    """A scene file: a tree of 2 to 8 joints of most kinds, with everything that can be mistaken."""
    draw = random.Random("tree %d" % seed)

    def number(low, high):
        return round(draw.uniform(low, high), 3)

    def vector(reach):
        return "[%s]" % ", ".join(str(number(-reach, reach)) for _ in range(3))

    def angle():
        return draw.choice(('"pi/2"', '"-pi/2"', '"pi"', "0", str(number(-3, 3)), str(number(-3, 3))))
    lines = ['title = "Random tree %d"' % seed, 'source = "drawn by a test"', "gravity = [0, 0, -9.81]",
             '[[link]]\nname = "base"']
    joints, made, index = draw.randint(2, 8), 0, 0
    while made < joints:
        index += 1
        fixed = index > 1 and draw.random() < 0.15
        parent = index - 1 if draw.random() < 0.6 else draw.randrange(index)
        lines.append('[[link]]\nname = "link_%d"\nparent = "%s"' % (index, "link_%d" % parent if parent else "base"))
        points = [(draw.uniform(0.1, 2), [draw.uniform(-0.3, 0.3) for _ in range(3)]) for _ in range(5)]
        mass = sum(m for m, _ in points)
        centre = [sum(m * r[k] for m, r in points) / mass for k in range(3)]
        I = [[0.0] * 3 for _ in range(3)]
        for m, r in points:
            d = [x - c for x, c in zip(r, centre)]
            I = stranger.plus(I, stranger.steiner(m, d))
        lines.append("mass = %.3f\ncom = %s" % (mass, vector(0.3)))
        turned = ", rpy = [%s, %s, %s]" % (angle(), angle(), angle()) if draw.random() < 0.4 else ""
        lines.append("inertia = { xx = %.5f, yy = %.5f, zz = %.5f, xy = %.5f, xz = %.5f, yz = %.5f%s }"
                     % (I[0][0], I[1][1], I[2][2], I[0][1], I[0][2], I[1][2], turned))
        kind = "fixed" if fixed else draw.choices(("revolute", "prismatic", "spherical"), (70, 25, 5))[0]
        if index == 1 and draw.random() < 0.2:
            kind = "floating"
        made += not fixed
        lines.append('[link.joint]\nname = "joint_%d"\nkind = "%s"' % (index, kind))
        if kind in ("revolute", "prismatic") and draw.random() < 0.4:
            lines.append("dh = { a = %s, alpha = %s, d = %s, theta = %s }"
                         % (number(-0.6, 0.6), angle(), number(-0.6, 0.6), angle()))
        else:
            lines.append("xyz = %s\nrpy = [%s, %s, %s]" % (vector(0.6), angle(), angle(), angle()))
            if kind in ("revolute", "prismatic") and draw.random() < 0.6:
                lines.append("axis = " + draw.choice(("[1, 0, 0]", "[0, 1, 0]", "[0, 0, -1]", "[3, 0, 4]", "[1, 2, 2]")))
        if kind in ("revolute", "prismatic"):
            if draw.random() < 0.4:
                lines.append("rotor_inertia = %s\ngear_ratio = %s" % (number(1e-3, 5e-3), number(5, 100)))
            if draw.random() < 0.3:
                lines.append("stiffness = %s\nrest = %s" % (number(1, 50), number(-1, 1)))
            if draw.random() < 0.4:
                dry = ", coulomb = %s" % number(0.1, 3) if draw.random() < 0.5 else ""
                lines.append("friction = { viscous = %s%s }" % (number(0.1, 3), dry))
    return "\n".join(lines) + "\n"


# ---- the runs

class Counts:
    def __init__(self):
        self.hit, self.all = collections.Counter(), collections.Counter()

    def add(self, key, good):
        self.all[key] += 1
        self.hit[key] += good

    def rate(self, key):
        return self.hit[key] / self.all[key] if self.all[key] else 1.0

    def __str__(self):
        return "\n".join("    %-34s %5d of %5d  %6.1f %%" % (key, self.hit[key], self.all[key], 100 * self.rate(key))
                         for key in sorted(self.all))


def names_by_scene(subjects, options, draw):
    """{scene: names}: all on all, or in the short form each on one that has room for it."""
    if options.only:
        return {subject.name: [options.only] for subject in subjects}
    if options.long:
        return {subject.name: draw.sample(NAMES, min(options.each or len(NAMES), len(NAMES))) for subject in subjects}
    out = {subject.name: [] for subject in subjects}
    for name in NAMES:
        able = [subject for subject in subjects if stranger.MISTAKES[name].targets(subject.right_engine)]
        if able:
            out[draw.choice(able).name].append(name)
    return out


def cases_of(subject, names, options, draw):
    """(kind, names, planted) of one scene."""
    found = list(singles(subject, draw, options.long, names))
    for name, word, kind in found:
        if options.long or kind == "first":
            yield kind, (name,), word
    if not options.only:
        for names, both in pairs(subject, found, draw, options.pairs):
            yield "pair", names, both


def right_engines(subject):
    yield "right", (), ()
    if len(subject.scene["joints"]) > 1:
        yield "right, joints reversed", ("--joints", "reversed"), ()
    yield "right, float", ("--mistake", "float_precision"), ("--scalar", "float")
    yield "right, M and tau alone", ("--quantities", "M,tau"), ()
    if stranger.floats(subject.right_engine, ("floating", "spherical")):
        yield "right, quaternion xyzw", ("--quaternion", "xyzw"), ()


def run(options, folder):
    by_kind, by_name, times, failures = Counts(), Counts(), [], []
    draw = random.Random(options.seed)
    subjects = [Subject(options.program, name, folder) for name in SCENES + MORE_SCENES * options.long
                if not options.scene or name in options.scene]
    subjects += [Subject(options.program, "tree_%d" % k, folder, random_tree(k))
                 for k in range(options.trees) if not options.scene]
    work, names_of = [], names_by_scene(subjects, options, draw)
    for subject in subjects:
        for what, words, extra in right_engines(subject):
            if options.long or what in ("right", "right, float"):
                work.append((subject, what, (), words, extra, None))
        group = "tree" if subject.name.startswith("tree_") else "scene"
        own = random.Random("%s %s" % (options.seed, subject.name))
        for kind, names, planted in cases_of(subject, names_of[subject.name], options, own):
            work.append((subject, "%s: %s" % (group, kind), names, ("--mistake", planted), (), planted))

    end, left_out = math.inf, 0
    if options.seconds:
        draw.shuffle(work)
        end = time.time() + options.seconds

    def one(case):
        subject, kind, names, words, extra, planted = case
        return case, check(options.program, subject, words, extra) if time.time() < end else None
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for case, said in pool.map(one, work):
            if said is None:
                left_out += 1
                continue
            (status, findings, seconds, err), (subject, kind, names, words, extra, planted) = said, case
            times.append((seconds, subject.name))
            findings = findings if findings is not None else []
            if planted is None:
                good = status == 0 and not any(f.get("explains") for f in findings)
            else:
                good = status == 1 and any(is_named(subject, planted, f) for f in findings[:1] + [
                    x for x in findings[1:] if x.get("same_as_first")])
                by_name.add(" + ".join(names) if len(names) == 1 else "pairs", good)
            by_kind.add(kind, good)
            if not good:
                said = "; ".join("%s%s %s%s" % (" + ".join(x[0] for x in rules_of(f)), [x[1] for x in rules_of(f)],
                                                f.get("residual_ulp"), "" if f.get("explains") else " (unexplained)")
                                 for f in findings[:3])
                failures.append("%s, %s: %s: exit %s, %s %s" % (kind, subject.argument, " ".join(words + tuple(extra)),
                                                              status, said or "no findings", err if status not in (0, 1) else ""))
                print("FAILS " + failures[-1], flush=True)
    print("named first, by kind\n%s\nby mistake\n%s" % (by_kind, by_name))
    if left_out:
        print("%d of %d checks left out, drawn: the time was over" % (left_out, len(work)))
    times.sort()
    print("%d checks, median %.2f s, slowest %s" % (len(times), times[len(times) // 2][0],
                                                    ", ".join("%.1f s (%s)" % x for x in times[-3:])))
    if options.table:
        Path(options.table).write_text(json.dumps({"kinds": {k: [by_kind.hit[k], by_kind.all[k]] for k in by_kind.all},
                                                   "names": {k: [by_name.hit[k], by_name.all[k]] for k in by_name.all},
                                                   "failures": failures}, indent=1), encoding="utf-8")
    total = Counts()
    for key in by_kind.all:
        group = ("right" if key.startswith("right") else "pairs" if key.endswith("pair") else
                 "other ways" if key.endswith("other way") else "singles")
        total.hit[group] += by_kind.hit[key]
        total.all[group] += by_kind.all[key]
    bad = [group for group, least in (("right", 1.0), ("singles", SINGLES), ("pairs", PAIRS)) if total.rate(group) < least]
    print(str(total))
    if not total.all["singles"]:
        sys.exit("nothing was planted")
    return bad


def noticed_by_crosscheck(options, folder):
    """Every mistake, on the first of these scenes where it shows."""
    names = ("gyroscopic_wrist", "puma_560_friction", "satellite_arm", "tree_0", "tree_1", "tree_2", "humanoid_floating")
    subjects, missed = {}, []
    for mistake in NAMES:
        planted = None
        for name in names:
            if name not in subjects:
                tree = random_tree(int(name[5:])) if name.startswith("tree_") else None
                subjects[name] = Subject(options.program, name, folder, tree)
            subject = subjects[name]
            planted = next((word for _, word, kind in singles(subject, random.Random(name), False, [mistake])), None)
            if planted:
                break
        if not planted:
            missed.append("%s has no room anywhere" % mistake)
            continue
        done = subprocess.run([options.program, "crosscheck", subject.argument, "--witness", "newton_euler", "--random", "3",
                               "--no-drift", "--no-charts", "-o", os.path.join(folder, "report"), "--engine-seconds",
                               "300", "--engine", engine_words("--mistake", planted)], capture_output=True, text=True)
        print("%-60s %-40s exit %d" % (planted, subject.name, done.returncode), flush=True)
        if done.returncode != 1:
            missed.append("%s on %s: exit %d" % (planted, subject.name, done.returncode))
    return missed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--long", action="store_true")
    parser.add_argument("--crosscheck", action="store_true")
    parser.add_argument("--trees", type=int)
    parser.add_argument("--each", type=int, help="names a scene at most, drawn")
    parser.add_argument("--pairs", type=int, help="pairs a scene")
    parser.add_argument("--only", help="one mistake")
    parser.add_argument("--scene", action="append", help="this bundled scene alone")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, help="in a drawn order, and no check begun later")
    parser.add_argument("--table", help="the rates as JSON, to this file")
    options = parser.parse_args()
    options.trees = options.trees if options.trees is not None else 100 if options.long else 2
    options.pairs = options.pairs if options.pairs is not None else 10 if options.long else 1
    with tempfile.TemporaryDirectory() as folder:
        bad = (noticed_by_crosscheck if options.crosscheck else run)(options, folder)
    if bad:
        sys.exit("not reached: " + "; ".join(bad))


if __name__ == "__main__":
    main()

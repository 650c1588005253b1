# SPDX-License-Identifier: GPL-3.0-or-later
"""The museum can be red: a list with something wrong in it, or an engine that is, makes `dynwitness museum` fail. And the
output of `check` that README.md shows is real.

    python3 test_museum.py PROGRAM
"""
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

DATA = Path(__file__).resolve().parents[3] / "data"
EXHIBIT = {
    "id": "webots_inertia_point", "tool": "Webots", "year": "2022", "kind": "reader", "link": "https://example.org/1",
    "what": "The matrix of inertia is about the solid's origin", "plant": "gravity_sign", "scene": "simple_pendulum",
    "named": ["gravity_sign"], "fidelity": "same"}


def toml(exhibits):
    return "\n".join("[[exhibit]]\n" + "\n".join(
        "%s = %s" % (key, "[%s]" % ", ".join('"%s"' % x for x in value) if isinstance(value, list) else '"%s"' % value)
        for key, value in exhibit.items()) for exhibit in exhibits)


def shown_in_readme(program):
    """What README.md shows below its `check` of the museum's engine is what is printed, but for last digits."""
    text = (DATA.parent / "README.md").read_text(encoding="utf-8")
    command, shown = re.search(r"```sh\n\./dynwitness (check puma_560 [^\n]*)\n```\n\n```text\n(.*?)```", text, re.S).groups()
    done = subprocess.run([program, *shlex.split(command)], capture_output=True, text=True, cwd=DATA.parent)

    def masked(lines):
        return [re.sub(r"(?<![\w\[,])\d+(\.\d+)?(e[-+]?\d+)?", "#", re.sub(" +", " ", line)) for line in lines.splitlines()]
    return [] if masked(shown) == masked(done.stdout) else ["README.md shows\n%s\nwhere this is printed:\n%s" % (shown, done.stdout)]


def main():
    program = os.path.abspath(sys.argv[1])
    failed = shown_in_readme(program)
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder) / "data"
        data.mkdir()
        for name in ("scenes", "reference", "audit"):
            (data / name).symlink_to(DATA / name)
        shutil.copytree(DATA / "museum", data / "museum")
        engine = (data / "museum" / "stranger.py").read_text(encoding="utf-8")

        def expect(what, status, *words, exhibits=(EXHIBIT,), arguments=(), stranger=engine):
            (data / "museum" / "museum.toml").write_text(toml(exhibits), encoding="utf-8")
            (data / "museum" / "stranger.py").write_text(stranger, encoding="utf-8")
            done = subprocess.run([program, "museum", *arguments], capture_output=True, text=True,
                                  env={**os.environ, "DYNWITNESS_DATA": str(data)})
            said = done.stdout + done.stderr
            missing = [word for word in words if word not in said]
            good = done.returncode == status and not missing
            print("%-50s %s" % (what, "as expected" if good else "FAILS"), flush=True)
            if not good:
                failed.append("%s: expected status %d and %s, got %d and\n%s" % (what, status, missing, done.returncode, said))

        def but(**changes):
            return [{key: value for key, value in {**EXHIBIT, **changes}.items() if value is not None}]

        expect("it is named", 0, "1 caught, 1 named first", "right on 1 of 1 scenes")
        expect("in full", 0, "https://example.org/1", "explained exactly by: gravity with the opposite sign",
               arguments=["webots_inertia_point"])
        expect("nothing planted", 2, "museum.toml:8: exhibit: plant: an empty string", exhibits=but(plant=""))
        expect("what is planted changes nothing", 1, "NOT CAUGHT", exhibits=but(plant="mass_wrong:bob=1"))
        expect("what is planted is not what should be named", 1, "NOT NAMED", exhibits=but(named=["com_dropped"]))
        expect("there is no such mistake", 1, "FAILED", exhibits=but(plant="gravity_sideways"))
        expect("the engine is wrong by itself", 1, "right on 0 of 1 scenes", "blamed",
               stranger=engine.replace('options = {"--mistake": ""', 'options = {"--mistake": "gravity_sign"'))
        expect("the engine is no program", 1, "FAILED", stranger="sys.exit(\n")
        expect("no rule", 2, "has no `named`", exhibits=but(named=None))
        expect("an unknown key", 2, "museum.toml:", exhibits=but(colour="red"))
        expect("an unknown kind", 2, "allowed: reader, dynamics", exhibits=but(kind="reading"))
        expect("a year in words", 2, "four digits", exhibits=but(year="last year"))
        expect("no link", 2, "https://", exhibits=but(link="issue 4"))
        expect("one id twice", 2, "each id once", exhibits=[EXHIBIT, EXHIBIT])
        expect("a scene that is not there", 2, 'exhibit "webots_inertia_point"', exhibits=but(scene="pendulum_of_foucault"))
        expect("an empty list", 2, "no exhibit", exhibits=())
        expect("an exhibit that is not there", 2, '(did you mean webots_inertia_point?)', arguments=["webots_inertia"])
    if failed:
        sys.exit("\n".join(failed))


if __name__ == "__main__":
    main()

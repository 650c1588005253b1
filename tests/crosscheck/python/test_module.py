#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python module in process, against the program's Lagrangian, hand derivations and itself.

    test_module.py PROGRAM [BUILD/python/dynwitness]

Ends with 77, which ctest takes for skipped, where the module is not built.
"""
import os
import sys
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "crosscheck" / "python"))
os.environ["DYNWITNESS_PROGRAM"] = sys.argv[1]
if len(sys.argv) > 2:
    os.environ["DYNWITNESS_PYTHON_BUILD"] = sys.argv[2]
try:
    import numpy as np
except ImportError:
    print("skipped: no numpy")
    sys.exit(77)
import dynwitness as dw  # noqa: E402

if not hasattr(dw, "Scene"):
    print("skipped: the module is not built (pybind11-dev and python3-dev, then ./dynwitness python)")
    sys.exit(77)

DRAW = np.random.default_rng(7)
EPS = np.finfo(float).eps


def near(a, b, ulps=100):
    """In ulp of the largest number: two roads of some hundred roundings each; 2.7 was the most seen."""
    a, b = np.asarray(a), np.asarray(b)
    assert a.shape == b.shape, (a.shape, b.shape)
    gap = np.abs(a - b).max() / (EPS * max(np.abs(b).max(), 1e-300))
    assert gap <= ulps, (gap, a, b)


def raises(kind, words, call, *arguments, **named):
    try:
        call(*arguments, **named)
    except kind as error:
        assert all(word in str(error) for word in words), str(error)
    else:
        raise AssertionError(f"nothing raised, expected {kind.__name__} with {words}")


def states(scene, count):
    return [DRAW.uniform(-2, 2, (count, width)) for width in (scene.nq, scene.n, scene.n)]


def test_double_pendulum_by_hand():
    arm = dw.load("double_pendulum")
    (q, qd, qdd), g, m1, m2, l1, l2 = states(arm, 50), 9.81, 1, .8, .5, .4
    c2, s2 = np.cos(q[:, 1]), np.sin(q[:, 1])
    M = np.empty((50, 2, 2))
    M[:, 0, 0] = (m1 / 3 + m2) * l1**2 + m2 * l2**2 / 3 + m2 * l1 * l2 * c2
    M[:, 0, 1] = M[:, 1, 0] = m2 * l2**2 / 3 + m2 * l1 * l2 * c2 / 2
    M[:, 1, 1] = m2 * l2**2 / 3
    c = m2 * l1 * l2 * s2 / 2 * np.array([-qd[:, 1] * (2 * qd[:, 0] + qd[:, 1]), qd[:, 0]**2])
    g_2 = m2 * g * l2 / 2 * np.sin(q[:, 0] + q[:, 1])
    gravity = np.array([(m1 / 2 + m2) * g * l1 * np.sin(q[:, 0]) + g_2, g_2])
    near(arm.M(q), M)
    near(arm.c(q, qd), c.T)
    near(arm.g(q), gravity.T)
    near(arm.id(q, qd, qdd), np.einsum("kij,kj->ki", M, qdd) + c.T + gravity.T)
    near(arm.kinetic(q, qd), np.einsum("ki,kij,kj->k", qd, M, qd) / 2)
    near(arm.potential(q), -(m1 / 2 + m2) * g * l1 * np.cos(q[:, 0]) - m2 * g * l2 / 2 * np.cos(q[:, 0] + q[:, 1]))


def test_check_and_what_notebooks_show():
    arm = dw.load("double_pendulum")
    report = dw.check(arm.id, arm)
    assert report.right and "right" in report, report
    wrong = dw.check(lambda q, qd, qdd: arm.id(q, qd, qdd) - 2 * arm.g(q), arm)
    assert not wrong.right and "WRONG" in wrong and wrong._repr_html_().startswith("<pre>"), wrong
    html = arm._repr_html_()  # what a notebook shows of a scene: its drawing, and which q is which joint
    for part in ("<svg", "</svg>", "<table>", "q1", "q2", arm.title):
        assert part in html, part
    facts, picture = dw.show("scara")
    assert facts["degrees_of_freedom"] == 4 and picture._repr_svg_().startswith("<svg"), picture
    short = dw.derive("double_pendulum", "--only", "g2", "--shorthand")
    assert short["shorthand"].equations == [r"s_{12} = \sin(q_{1} + q_{2})"] and short["shorthand"].check == "", short
    steps = dw.derive("double_pendulum", "--only", "M12")
    assert list(steps) == ["mass matrix M"], list(steps)
    assert steps["mass matrix M"]._repr_latex_().startswith("$$") and "M_{12}" in steps["mass matrix M"]._repr_latex_()
    entry = dw.audit("15")
    assert entry, entry
    raises(ValueError, ["quantity", "allowed: M, tau, qdd"], dw.chart, arm, "energy")


def test_stubs_are_what_is_there():
    import ast
    import inspect
    folder = Path(dw.program.__file__).parent
    for module in (dw.program, dw.testing):
        stub = ast.parse((folder / Path(module.__file__).with_suffix(".pyi").name).read_text())
        said = {node.name: node for node in stub.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
        for name, thing in vars(module).items():
            if getattr(thing, "__module__", None) != module.__name__ or name.startswith("_"):
                continue
            assert name in said, f"{module.__name__}.{name} has no stub"
            if inspect.isfunction(thing):
                arguments = said[name].args
                names = [a.arg for a in arguments.args + arguments.kwonlyargs]
                there = [p.name for p in inspect.signature(thing).parameters.values()
                         if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)]
                assert names == there, (name, names, there)
        assert set(said) <= set(vars(module)), set(said) - set(vars(module))


def test_the_programs_lagrangian():
    for name in ("puma_560", "scara", "prismatic_revolute_mix", "cart_pole", "puma_560_friction"):
        scene = dw.load(name)
        q, qd, qdd = states(scene, 5)
        said = dw.evaluate(name, "M,c,g,tau,kinetic,potential", witness="lagrange", q=q, qd=qd, qdd=qdd)
        near(scene.M(q), said["M"])
        near(scene.c(q, qd), said["c"])
        near(scene.g(q), said["g"])
        near(scene.id(q, qd, qdd), said["tau"])
        near(scene.kinetic(q, qd), said["kinetic"])
        near(scene.potential(q), said["potential"])


def test_fd_undoes_id_and_lanes_are_the_sweeps():
    for name in ("franka_panda", "double_pendulum"):
        scene = dw.load(name)
        q, qd, qdd = states(scene, 5000)
        tau = scene.id(q, qd, qdd, kernel=False)
        near(scene.fd(q, qd, tau, kernel=False), qdd, 2e4)  # times the condition of M; 431 was the most seen
        near(scene.id(q, qd, qdd), tau)
        near(scene.fd(q, qd, tau), qdd, 2e4)
        for odd in (1, 3, 257):  # blocks that are not full
            near(scene.id(q[:odd], qd[:odd], qdd[:odd], kernel=None), tau[:odd])


def test_one_state_is_a_row_of_a_batch():
    scene = dw.load("puma_560")
    q, qd, qdd = states(scene, 4)
    for call, parts in ((scene.M, (q,)), (scene.c, (q, qd)), (scene.g, (q,)), (scene.id, (q, qd, qdd)),
                        (scene.fd, (q, qd, qdd)), (scene.kinetic, (q, qd)), (scene.potential, (q,)),
                        (scene.momentum, (q, qd)), (scene.reactions, (q, qd, qdd)),
                        (scene.regressor, (q, qd, qdd))):
        many = call(*parts)
        for k in range(4):
            assert np.array_equal(many[k], call(*(part[k] for part in parts))), call
    assert np.array_equal(scene.id(q, qd[0], qdd), scene.id(q, np.tile(qd[0], (4, 1)), qdd))


def test_derivatives_and_jacobians_by_differences():
    scene, h = dw.load("puma_560"), 1e-6
    q, qd, qdd = (part[0] for part in states(scene, 1))
    tau = scene.id(q, qd, qdd)
    unit = np.eye(6) * h

    def difference(f):
        return np.array([(f(e) - f(-e)) / (2 * h) for e in unit]).T

    def close(a, b):  # h^2 of truncation and eps/h of rounding: 1e-9 and less; 1e-7 of the largest
        assert np.abs(a - b).max() < 1e-7 * max(1, np.abs(b).max()), np.abs(a - b).max()

    by_q, by_qd, M = scene.id_derivatives(q, qd, qdd)
    close(by_q, difference(lambda e: scene.id(q + e, qd, qdd)))
    close(by_qd, difference(lambda e: scene.id(q, qd + e, qdd)))
    assert np.array_equal(M, scene.M(q))
    fd_q, fd_qd, fd_tau = scene.fd_derivatives(q, qd, tau)
    close(fd_tau @ M, np.eye(6))
    close(M @ fd_q, -by_q)
    close(M @ fd_qd, -by_qd)
    at = (.1, .2, .3)
    J = scene.jacobian("link_6", q, at)
    close(J[:3], difference(lambda e: scene.position("link_6", q + e, at)))
    R, rate = scene.rotation("link_6", q), difference(lambda e: scene.jacobian("link_6", q + qd * e[0], at)[0])
    close(R @ R.T, np.eye(3))
    close(scene.jacobian_rate("link_6", q, qd, at)[0], rate[:, 0])


def test_regressor_momentum_and_reactions():
    scene = dw.load("puma_560")
    q, qd, qdd = (part[0] for part in states(scene, 1))
    Y = scene.regressor(q, qd, qdd)
    assert Y.shape == (6, len(scene.parameter_names))
    assert "[kg" in scene.parameter_names[0]
    assert scene.reactions(q, qd, qdd).shape == (len(scene.links) - 1, 6)
    assert np.array_equal(scene.momentum(q, 0 * qd), np.zeros(6))


def test_arguments_are_named():
    arm = dw.load("puma_560")
    good = np.zeros(6)
    raises(ValueError, ["q", "(6,) or (N, 6)", "(5,)"], arm.M, np.zeros(5))
    raises(ValueError, ["qdd", "(6,) or (N, 6)", "(2, 3)"], arm.id, good, good, np.zeros((2, 3)))
    raises(ValueError, ["qdd", "3 states as in q", "got 2"], arm.id, np.zeros((3, 6)), good, np.zeros((2, 6)))
    raises(ValueError, ["q", "()"], arm.M, 1.0)
    raises(TypeError, ["q", "real numbers"], arm.M, np.zeros(6, complex))
    raises(TypeError, ["q"], arm.M, "abcdef")
    raises(ValueError, ["no link 'link6'", "did you mean link_6"], arm.jacobian, "link6", good)
    raises(ValueError, ["at", "(3,)"], arm.position, "link_6", good, (1, 2))
    raises(dw.InputError, ["allowed"], dw.load, "no_such_robot")
    raises(dw.InputError, ["mine:1"], dw.from_text, "nonsense", "mine")
    raises(ValueError, ["closures"], dw.load("bricard").id, *([0.0] * dw.load("bricard").n for _ in range(3)))
    raises(ValueError, ["format"], arm.derive, "word")


def test_nothing_is_shared_and_types_are_float64():
    arm = dw.load("double_pendulum")
    q = np.array([[1, 2], [3, 4]], dtype=np.float32)
    kept = q.copy()
    first = arm.M(q)
    again = arm.M(q.astype(float)[:, ::1])
    assert first.dtype == np.float64 and np.array_equal(first, again) and first is not again
    first[:] = 7
    assert np.array_equal(q, kept) and np.array_equal(arm.M(q), again)
    turned = np.asfortranarray(q.astype(float))
    assert np.array_equal(arm.M(turned), again)
    assert arm.M(np.zeros((0, 2))).shape == (0, 2, 2)


def test_scenes_from_text_and_back():
    arm = dw.load("double_pendulum")
    again = dw.from_text(arm.toml(), "again")
    q = [.3, -.7]
    assert np.array_equal(arm.M(q), again.M(q)) and again.joints == arm.joints
    assert "M12 = " in arm.derive() and "\\cos" in arm.derive("latex")


def test_others_run_while_a_batch_computes():
    arm = dw.load("franka_panda")
    q, qd, qdd = states(arm, 200000)
    arm.id(q[:2], qd[:2], qdd[:2])
    seen, done = [0], threading.Event()

    def count():
        while not done.is_set():
            seen[0] += 1
            time.sleep(0)

    other = threading.Thread(target=count)
    other.start()
    before = seen[0]
    arm.id(q, qd, qdd, kernel=False)
    after = seen[0]
    done.set()
    other.join()
    assert after - before > 10, after - before  # held, the lock would let it count once or twice


def test_engines_are_right_or_diagnosed():
    arm = dw.load("puma_560")
    dw.testing.assert_engine(arm.id, arm)
    dw.testing.assert_engine({"M": arm.M, "g": arm.g, "c": arm.c, "tau": arm.id}, "puma_560")
    raises(AssertionError, ["not the dynamics", "WRONG", "wrong", "c"], dw.testing.assert_engine,
           lambda q, qd, qdd: arm.M(q) @ qdd + arm.g(q) - arm.c(q, qd), arm)
    raises(AssertionError, ["tau: expected shape (6,)"], dw.testing.assert_engine, lambda q, qd, qdd: qd[:3], arm)
    raises(ValueError, ["torque", "allowed: tau, M, c, g"], dw.testing.assert_engine, {"torque": arm.id}, arm)
    assert dw.crosscheck(dw.load("simple_pendulum"))["verdict"]


if __name__ == "__main__":
    for test_name, test in list(globals().items()):
        if test_name.startswith("test_"):
            test()
            print(test_name)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Hostile files: the program refuses them in words with status 2, or answers; it never hangs, crashes or fills memory.

    python3 test_hostile_files.py PROGRAM

Every run has a small stack (1 MiB), 6 GiB of address space and a time limit that is generous for linear work and
hopeless for quadratic work. What is expected of a run comes from the way its file was made, or from a formula here.
"""
import os
import resource
import signal
import stat
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PROGRAM = os.path.abspath(sys.argv[1])
HEAD = 'title = "x"\nsource = "x"\n'
failures = []


def small(address_space=6 << 30):
    def limits():
        resource.setrlimit(resource.RLIMIT_STACK, (1 << 20, 1 << 20))
        resource.setrlimit(resource.RLIMIT_AS, (address_space, address_space))
    return limits


def run(*words, seconds=20, stdin=subprocess.DEVNULL):
    """(status, standard output, standard error); a run past its time has status 'late'."""
    # a compiler that fails: kernels are another test's matter
    environment = dict(os.environ, DYNWITNESS_CC='/bin/false')
    process = subprocess.Popen([PROGRAM, *words], stdin=stdin, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               preexec_fn=small(), env=environment)
    try:
        out, err = process.communicate(timeout=seconds)
        return process.returncode, out, err
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return 'late', '', ''


def require(holds, what):
    print(('ok    ' if holds else 'FAILS ') + what, flush=True)
    if not holds:
        failures.append(what)


def refuses(part, *words, seconds=20, stdin=subprocess.DEVNULL):
    status, _, err = run(*words, seconds=seconds, stdin=stdin)
    require(status == 2 and part in err and len(err) < 2000,
            f'{" ".join(words)} is refused with "{part}" (status {status}: {err[:200]!r})')


def write(name, text):
    Path(name).write_text(text)
    return name


def asks(name):
    return 'evaluate', name, '--quantity', 'g'


def nested_values():
    n = 10**6
    many = '.'.join(['a'] * n)
    for name, text, part in [
            ('dots.toml', f'{many} = 1\n', 'dots.toml:3: more than 16 parts in a key'),
            ('quoted.toml', '"a b".' + many + ' = 1\n', 'quoted.toml:3: more than 16 parts'),
            ('header.toml', f'[{many}]\n', 'header.toml:3: more than 16 parts'),
            ('arrays.toml', 'a = ' + '[' * n + ']' * n, 'arrays.toml:3: more than 16 tables and arrays'),
            ('inline.toml', 'a = ' + '{a=' * n + '1' + '}' * n, 'inline.toml:3: more than 16 tables and arrays'),
            # strings and comments do not hide what comes after them
            ('hidden.toml', 'b = """x\n\\"""" # "\nc = \'"\' # [\n' + f'{many} = 1\n', 'hidden.toml:6: more than 16'),
            ('quotes.toml', 'b = {c = """x"""", ' + f'{many} = 1}}\n', 'quotes.toml:3: more than 16'),
            ('parentheses.toml', 'gravity = [0, 0, "' + '(' * n + '1' + ')' * n + '"]', 'parentheses.toml:3: '),
            ('signs.toml', 'gravity = [0, 0, "' + '-' * n + '1"]', 'signs.toml:3: '),
            ('sum.toml', 'gravity = [0, 0, "' + '+'.join('1' * n) + '"]', 'sum.toml:3: '),
            ('tall.toml', 'gravity = [0, 0, "' + '+'.join('1' * 999) + '"]', 'no root'),  # tall, and allowed
            ('word.toml', 'gravity = [0, 0, "' + 'a' * n + '"]', 'word.toml:3: ')]:
        refuses(part, *asks(write(name, HEAD + text)))
    refuses('more than 100 elements', *asks(write('deep.urdf', '<robot name="x">' + '<a>' * n)))
    # dots in numbers, strings and comments are not those of keys
    status, out, err = run(*asks(write('points.toml', HEAD + '''# a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q.r.s
gravity = [0.0, 0.0, -9.8]
[[link]]
name = "a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q.r.s"
[[link]]
name = "b"
parent = "a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q.r.s"
mass = 1.0
com = [1.0, 0.0, 0.0]
joint = { kind = "prismatic", axis = [0.0, 0.0, 1.0], xyz = [0.5, 0.25, 0.125] }
''')))
    require(status == 0 and abs(float(out.split()[1]) - 9.8) < 1e-12, f'points.toml is read ({status} {out} {err})')


def what_is_no_file():
    os.mkfifo('fifo.toml')
    os.mkdir('folder.toml')
    refuses('is a FIFO', *asks('fifo.toml'), seconds=5)
    refuses('is a folder', *asks('folder.toml'), seconds=5)
    refuses('is a device', *asks('/dev/zero'), seconds=5)
    with open('large.toml', 'wb') as file:
        file.truncate((64 << 20) + 1)
    refuses('longer than 64 MiB', *asks('large.toml'))
    refuses('zero.toml:2: has a zero byte', *asks(write('zero.toml', 'title = "x"\n\0')))
    write('like.toml', HEAD + 'like = "fifo"\n')
    refuses('like is "fifo"', *asks('like.toml'), seconds=5)
    refuses('is a FIFO', 'crosscheck', 'acrobot', '--bench', 'fifo.toml', seconds=5)
    if os.geteuid() != 0:  # root reads everything
        os.chmod(write('closed.toml', HEAD), 0)
        refuses('Permission denied', *asks('closed.toml'))


def chain_toml(count, rpy):
    links = ['[[link]]\nname = "ground"\n']
    for k in range(count + 1):
        kind = 'revolute' if k == 0 else 'fixed'
        links.append(f'[[link]]\nname = "l{k}"\nparent = "{f"l{k-1}" if k else "ground"}"\nmass = 2\n'
                     f'inertia = {{ xx = 0.1, yy = 0.1, zz = 0.1 }}\n'
                     f'joint = {{ kind = "{kind}", xyz = [0.5, 0, 0], rpy = [{rpy}, {rpy}, 0] }}\n')
    return HEAD + ''.join(links)


def chain_urdf(count, change=lambda k, parent: parent):
    parts = ['<robot name="r"><link name="base"/>']
    for k in range(count):
        parent = change(k, f'l{k-1}' if k else 'base')
        parts.append(f'<link name="l{k}"><inertial><mass value="2"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" '
                     f'ixz="0" iyz="0"/></inertial></link><joint name="j{k}" type="{"fixed" if k else "continuous"}">'
                     f'<origin xyz="0.5 0 0"/><parent link="{parent}"/><child link="l{k}"/><axis xyz="0 0 1"/></joint>\n')
    return ''.join(parts) + '</robot>'


def long_rows():
    n = 3000
    # all links on the x axis of the hinge: M = sum of m (k/2)^2 + I
    expected = sum(2 * (k / 2)**2 + 0.1 for k in range(n + 1))
    for name, text in [('row.toml', chain_toml(n, 0)), ('row.urdf', chain_urdf(n + 1))]:
        status, out, err = run('evaluate', write(name, text), '--quantity', 'M')
        require(status == 0 and abs(float(out.split()[1]) / expected - 1) < 1e-12,
                f'{name}: {n} fixed links give M = {expected} ({status} {out} {err[:200]})')
    status, _, err = run('evaluate', write('turned.toml', chain_toml(n, 0.1)), '--quantity', 'M')
    require(status == 0, f'{n} fixed links turned by angles without exact sines are answered ({status} {err[:200]})')
    n = 20000
    status, _, err = run('evaluate', write('long.urdf', chain_urdf(n)), '--quantity', 'M', seconds=40)
    require(status == 0, f'URDF chain of {n} links is answered on 1 MiB of stack ({status} {err[:200]})')
    two_roots = chain_urdf(n).replace('</robot>', '<link name="alone"/></robot>')
    refuses('allowed: one root', *asks(write('roots.urdf', two_roots)), seconds=40)
    cycle = chain_urdf(n, lambda k, parent: f'l{n-1}' if k == n // 2 else parent)
    refuses('through 10000 links', *asks(write('cycle.urdf', cycle)), seconds=40)
    twice = chain_urdf(n).replace('<link name="l9">', '<link name="l8">').replace('child link="l9"', 'child link="l8"')
    refuses('is the child of joint', *asks(write('twice.urdf', twice)), seconds=40)
    # one line, on which each number was once sought from its beginning
    numbers = ', '.join(['0.5'] * 20000)
    refuses('allowed: an array of 0 numbers', *asks(write('line.toml', HEAD + '[[link]]\nname = "a"\n[start]\n'
                                                          f'q = [{numbers}]\n')))


def mjcf(inside):
    return f'<mujoco><worldbody>{inside}</worldbody></mujoco>'


def mjcf_files():
    refuses('more than 500 elements', *asks(write('deep.xml', mjcf('<body>' * 10**6))))
    arm = '<joint axis="0 1 0"/><geom size="0.1" pos="0.1 0 0"/>'
    n = 490
    status, _, err = run(*asks(write('row.xml', mjcf(f'<body>{arm}' * n + '</body>' * n))))
    require(status == 0, f'MJCF chain of {n} links is answered on 1 MiB of stack ({status} {err[:200]})')
    n = 20000
    inertia = '<inertial mass="2" pos="0 0 0" diaginertia="0.1 0.1 0.1"/>'
    expected = sum(2 * (k / 2)**2 + 0.1 for k in range(n))
    text = ''.join(f'<body pos="{k/2} 0 0">{inertia}</body>' for k in range(1, n))
    status, out, err = run('evaluate', write('many.xml', mjcf(f'<body><joint/>{inertia}{text}</body>')), '--quantity', 'M',
                           seconds=40)
    require(status == 0 and abs(float(out.split()[1]) / expected - 1) < 1e-12,
            f'many.xml: {n} bodies give M = {expected} ({status} {out} {err[:200]})')
    arm = f'<body>{arm}</body>'
    os.mkfifo('fifo.xml')
    os.mkdir('folder.xml')
    for file, part in [('fifo.xml', 'is a FIFO'), ('self.xml', 'was read already'), ('/dev/zero', 'is a device'),
                       ('folder.xml', 'is a folder')]:
        refuses(part, *asks(write('self.xml', mjcf(arm).replace('<world', f'<include file="{file}"/><world'))), seconds=5)
    for size in ['1e300', '9' * 300, '1e-300', '-1e300']:
        refuses('size.xml:1: ', *asks(write('size.xml', mjcf(arm.replace('0.1"', f'{size}"')))))
    refuses('angle is "turns"', *asks(write('unit.xml', mjcf(arm).replace('<world', '<compiler angle="turns"/><world'))))


def states_files():
    header = 'q1,q2,qd1,qd2,qdd1,qdd2\n'
    evaluate = ('evaluate', 'acrobot', '--quantity', 'tau', '--states')
    os.mkfifo('fifo.csv')
    refuses('is a FIFO', *evaluate, 'fifo.csv', seconds=5)
    refuses('is a device', *evaluate, '/dev/zero', seconds=5)
    with open('/dev/zero') as zero:
        refuses('a line of more than', *evaluate, '-', stdin=zero, seconds=5)

    # memory does not grow with rows
    def largest_of(rows):
        write('rows.csv', header + '0.1,0.2,0.3,0.4,0.5,0.6\n' * rows)
        begin = time.time()
        pid = os.posix_spawn(PROGRAM, [PROGRAM, *evaluate, 'rows.csv', '-o', 'rows.out'], os.environ)
        _, status, usage = os.wait4(pid, 0)
        lines = Path('rows.out').read_text().splitlines()
        require(status == 0 and len(lines) == rows + 1 and len(set(lines[1:])) == 1,
                f'{rows} rows are answered ({time.time() - begin:.1f} s, {usage.ru_maxrss >> 10} MB)')
        return usage.ru_maxrss
    few, many = largest_of(10), largest_of(200000)
    require(many < few + (16 << 10), f'200000 rows take no more memory than 10: {few >> 10}, {many >> 10} MB')

    # a bad last row leaves the last result whole
    bad = write('bad.csv', header + '0,0,0,0,0,0\n' * 50000 + '0,0,0,0,0,x\n')
    refuses('bad.csv:50002: qdd2 is', *evaluate, bad, '-o', 'rows.out')
    require(len(Path('rows.out').read_text().splitlines()) == 200001, 'the last result is still there')
    require(not list(Path('.').glob('*unfinished*')), 'and nothing beside it')

    # rows that come slowly: told after a second, with how many there were
    process = subprocess.Popen([PROGRAM, *evaluate, '-'], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    process.stdin.write(header + '0,0,0,0,0,0\n' * 1000)
    process.stdin.flush()
    time.sleep(2)
    out, err = process.communicate('0,0,0,0,0,0\n')
    require(process.returncode == 0 and len(out.splitlines()) == 1002, 'standard input is read as it comes')
    require('rows' in err and 'end is not known' in err, f'progress is told: {err!r}')


def waits_are_told():
    """An estimate within seconds, of work that would take minutes here."""
    for words in [('geometry', 'chain_120'), ('parameters', 'chain_100'), ('action', 'chain_200')]:
        process = subprocess.Popen([PROGRAM, *words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        process_ends = time.time() + 30
        signal.signal(signal.SIGALRM, lambda *_: process.kill())
        signal.alarm(30)
        line = next((text for text in process.stderr if 'of about' in text), '')
        signal.alarm(0)
        process.kill()
        process.communicate()
        require('%' in line, f'{" ".join(words)} says when it ends: {line.strip()!r} '
                             f'({30 - (process_ends - time.time()):.0f} s)')


def only_what_is_asked():
    # M of 1000 joints would take 12 GB to derive
    status, out, err = run('evaluate', 'chain_1000', '--quantity', 'g', '--witness', 'lagrange', seconds=40)
    sweep = run('evaluate', 'chain_1000', '--quantity', 'g')[1]
    if status == 0:
        one, other = ([float(x) for x in text.splitlines()[1].split(',')] for text in (out, sweep))
        worst = max(abs(a - b) for a, b in zip(one, other)) / max(map(abs, other))
        require(worst < 1e-9, f'g of 1000 joints, derived without M, is that of the sweep ({worst:.1e})')
    require(status == 0, f'g of 1000 joints is derived without M ({status} {err[:200]})')
    refuses('GB of operations', 'derive', 'chain_1000', '--format', 'c')
    refuses('GB of operations', 'derive', 'chain_1000', '--quantity', 'g', seconds=5)
    refuses('Christoffel symbols', 'geometry', 'chain_1000', seconds=5)


def unwritable():
    write('file', '')
    for words in [('crosscheck', 'chain_100', '-o'), ('audit', '-o'), ('chart', 'chain_100', '-o'),
                  ('growth', '-o'), ('stability', '-o')]:
        refuses('file', *words, 'file', seconds=5)
        refuses('file', *words, 'file/below', seconds=5)
        refuses('/proc/none', *words, '/proc/none', seconds=5)
    for words in [('crosscheck', 'chain_100', '--json'), ('derive', 'chain_100', '-o'),
                  ('evaluate', 'chain_100', '--quantity', 'M', '-o'), ('parameters', 'chain_100', '--json'),
                  ('action', 'chain_100', '--json'), ('geometry', 'chain_100', '--json'),
                  ('impulse', 'chain_100', '--impulse', '1,0,0', '--json'), ('impedance', 'chain_100', '--json'),
                  ('same', 'chain_100', 'chain_100', '--json'), ('readers', 'none.urdf', '--json'),
                  ('readers', 'none.urdf', '--mend'), ('readers', 'none.urdf', '--html'), ('readers', 'none.urdf', '--plain'),
                  ('drift', 'chain_100', '--csv'), ('drift', 'chain_100', '--plot'), ('simulate', 'chain_100', '--json'),
                  ('simulate', 'chain_100', '--view'), ('show', 'chain_100', '-o')]:
        refuses('file/below', *words, 'file/below', seconds=5)
        refuses('/proc/none', *words, '/proc/none', seconds=5)


if __name__ == '__main__':
    parts = [nested_values, what_is_no_file, long_rows, mjcf_files, states_files, only_what_is_asked, unwritable, waits_are_told]
    chosen = sys.argv[2:]
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for part in parts:
            if not chosen or part.__name__ in chosen:
                begin = time.time()
                part()
                print(f'      {part.__name__}: {time.time() - begin:.1f} s', flush=True)
        os.chdir('/')
    print(f'{len(failures)} failures')
    sys.exit(1 if failures else 0)

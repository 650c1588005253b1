#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What may happen to a campaign while it runs, done to it: KILL two hundred times, a full disk, Slurm on this machine with a
task killed and a node drained, hosts by ssh of which one does not answer. Each time the merged result is byte for byte that of
a run to which nothing happened.

    test_campaigns_survive.py DYNWITNESS [kills disk slurm ssh]

Status 77: what was asked for needs programs that are not here."""
import getpass
import os
import pathlib
import random
import resource
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

PROGRAM = os.path.abspath(sys.argv[1])
CAMPAIGN = PROGRAM + "-campaign"
PLAN = 'title = "survivor"\n[[cases]]\nof = "mechanisms"\ncount = {}\nmost_joints = 2\n'


def campaign(*words, **options):
    return subprocess.run([PROGRAM, "campaign", *map(str, words)], capture_output=True, text=True, **options)


def require(holds, what):
    if not holds:
        sys.exit(f"test_campaigns_survive: {what}")


def result_of(folder):
    """The bytes that all shards of a folder come to."""
    with tempfile.TemporaryDirectory() as merged:
        done = campaign("merge", folder, "-o", merged)
        require(done.returncode == 0, f"merging {folder}: status {done.returncode}\n{done.stdout}{done.stderr}")
        return b"".join((pathlib.Path(merged) / name).read_bytes() for name in ("cases.jsonl", "campaign.json"))


def whole(folder, cases):
    """A plan, and what it comes to when nothing happens."""
    plan = folder / "plan.toml"
    plan.write_text(PLAN.format(cases))
    done = campaign(plan, "-o", folder / "whole")
    require(done.returncode == 0, f"the plan itself: {done.stdout}{done.stderr}")
    return plan, result_of(folder / "whole")


def kills(folder):
    plan, right = whole(folder, 600)
    dice = random.Random(1)
    out, deaths = folder / "killed", 0
    while deaths < 200:
        process = subprocess.Popen([CAMPAIGN, "campaign", str(plan), "-o", str(out)], stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        try:
            process.wait(dice.uniform(0.0, 0.4))
            require(process.returncode == 0, f"status {process.returncode} by itself")
            require(result_of(out) == right, f"another result than without kills, after {deaths}")
            shutil.rmtree(out)  # all is done: from the begin on
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
            process.wait()
            deaths += 1
    done = campaign(plan, "-o", out)
    require(done.returncode == 0, f"after the last one: {done.stdout}{done.stderr}")
    require(result_of(out) == right, "another result than without kills")
    require("more than once" not in done.stdout, f"a case was done twice: {done.stdout}")
    print(f"killed {deaths} times: the same bytes")


def disk(folder):
    plan, right = whole(folder, 60)
    out = folder / "full"
    size = 8000  # bytes of any file: less than a third of the cases
    full = campaign(plan, "-o", out, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)))
    require(full.returncode == 3 and "cannot be added to" in full.stderr, f"a full disk: {full.returncode} {full.stderr}")
    require(any(out.glob("shard-*")), "nothing is left of the work before the disk was full")
    require(campaign(plan, "-o", out).returncode == 0, "it does not go on")
    require(result_of(out) == right, "another result than with room")
    (folder / "file").write_text("")
    refused = campaign(plan, "-o", folder / "file")
    require(refused.returncode == 2, f"a file as folder: {refused.returncode} {refused.stderr}")
    print("a full disk: the same bytes")


def start(words, log, **options):
    return subprocess.Popen(words, stdout=open(log, "w"), stderr=subprocess.STDOUT, start_new_session=True, **options)


def stop(processes):
    """By process id, the last one started first."""
    for process in reversed(processes):
        if process.poll() is None:
            process.terminate()
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def wait_for(what, holds, seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if holds():
            return
        time.sleep(0.2)
    sys.exit(f"test_campaigns_survive: {what} was not so within {seconds} s")


def slurm_configuration(folder, ports):
    """Of two nodes on this machine. What is queued again waits until credentials have expired, two minutes by default."""
    host, user = socket.gethostname().split(".")[0], getpass.getuser()
    nodes = "".join(f"NodeName=node{k} NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[k]} CPUs=2 State=UNKNOWN\n"
                    for k in (1, 2))
    return f"""ClusterName=survivor
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/none
CredType=cred/none
AuthInfo=cred_expire=5
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/builtin
ReturnToService=2
MpiDefault=none
JobRequeue=1
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool.%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.%n.log
{nodes}PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def slurm(folder):
    missing = [name for name in ("slurmctld", "slurmd", "sbatch", "scontrol", "squeue") if not shutil.which(name)]
    if missing or os.geteuid() != 0:
        return f"Slurm: {', '.join(missing) or 'root'} is not here"
    plan, right = whole(folder, 320)
    cluster = folder / "cluster"
    for name in ("", "state", "spool.node1", "spool.node2"):
        (cluster / name).mkdir()
    (cluster / "slurm.conf").write_text(slurm_configuration(cluster, free_ports(3)))
    environment = dict(os.environ, SLURM_CONF=str(cluster / "slurm.conf"))

    def ask(*words):
        return subprocess.run(words, env=environment, capture_output=True, text=True).stdout

    out = folder / "slurm"
    ledger = out / "shard-1-of-8.jsonl"
    running = []
    try:
        running.append(start(["slurmctld", "-D", "-i"], cluster / "ctld.out", env=environment))
        for node in ("node1", "node2"):
            running.append(start(["slurmd", "-D", "-N", node], cluster / f"{node}.out", env=environment))
        wait_for("Slurm with two idle nodes", lambda: ask("sinfo", "-h", "-o", "%T %D").split() == ["idle", "2"], 60)
        done = campaign(plan, "--on", "slurm", "--shards", 8, "--processes", 1, "-o", out, env=environment)
        require(done.returncode == 0, f"submitting: {done.stdout}{done.stderr}")
        # one task is killed while it works, with all that it has started
        wait_for("the first shard at work", lambda: ledger.exists() and ledger.read_bytes().count(b"\n") > 1, 120)
        killed = kill_shard("1/8")
        require(killed, "there was no process of shard 1 to kill")
        ask("scontrol", "update", "nodename=node2", "state=drain", "reason=test")
        require("drain" in ask("sinfo", "-h", "-N", "-n", "node2", "-o", "%T"), "node2 is not drained")
        wait_for("an empty queue", lambda: ask("squeue", "-h") == "", 300)
        require((out / "campaign.json").exists(), "nothing was merged")
        require(result_of(out) == right, "another result than on this machine alone")
        print(f"Slurm, 8 tasks, one killed ({killed} processes), one of two nodes drained: the same bytes")
    finally:
        stop(running)
        for process in pathlib.Path("/proc").glob("[0-9]*"):  # a step's keeper, which slurmd leaves to itself
            if str(cluster).encode() in bytes_of(process / "environ"):
                os.kill(int(process.name), signal.SIGKILL)
    return None


def bytes_of(file):
    try:
        return file.read_bytes()
    except OSError:
        return b""


def kill_shard(words):
    count = 0
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        line = bytes_of(process / "cmdline").split(b"\0")
        if b"campaign" in line and words.encode() in line:
            try:
                os.kill(int(process.name), signal.SIGKILL)
                count += 1
            except ProcessLookupError:
                pass
    return count


def ssh(folder):
    server = shutil.which("sshd") or ("/usr/sbin/sshd" if os.path.exists("/usr/sbin/sshd") else None)
    if not server or not shutil.which("ssh") or not shutil.which("ssh-keygen"):
        return "ssh: sshd, ssh or ssh-keygen is not here"
    if os.geteuid() == 0:
        os.makedirs("/run/sshd", mode=0o755, exist_ok=True)  # where it locks its unprivileged half up
    plan, right = whole(folder, 120)
    keys = folder / "keys"
    keys.mkdir(mode=0o700)
    for name in ("host", "user"):
        subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", keys / name], check=True)
    shutil.copy(keys / "user.pub", keys / "authorized")
    ports = free_ports(3)
    config = "".join(f"Host here{k}\n  HostName 127.0.0.1\n  Port {ports[k]}\n" for k in range(3)) + (
        f"Host *\n  IdentityFile {keys}/user\n  IdentitiesOnly yes\n  StrictHostKeyChecking no\n"
        "  UserKnownHostsFile /dev/null\n  LogLevel ERROR\n")
    (folder / "ssh_config").write_text(config)
    (folder / "hosts.txt").write_text("here0  # answers\nhere1\nhere2  # nobody is there\n")
    environment = dict(os.environ, DYNWITNESS_SSH=f"ssh -F {folder}/ssh_config")

    def is_reached(k):
        return subprocess.run(["ssh", "-F", folder / "ssh_config", "-o", "BatchMode=yes", f"here{k}", "true"],
                              capture_output=True).returncode == 0

    running = []
    try:
        for k in range(2):
            running.append(start([server, "-D", "-e", "-f", "/dev/null", "-p", str(ports[k]), "-o", f"HostKey={keys}/host",
                                  "-o", f"AuthorizedKeysFile={keys}/authorized", "-o", "StrictModes=no",
                                  "-o", f"PidFile={folder}/sshd{k}.pid", "-o", "ListenAddress=127.0.0.1",
                                  "-o", "PermitRootLogin=prohibit-password", "-o", "UsePAM=no"], folder / f"sshd{k}.log"))
        for k in range(2):
            try:
                wait_for(f"sshd {k}", lambda: is_reached(k), 30)
            except SystemExit:
                return f"ssh: no sshd of ours can be reached here: {(folder / f'sshd{k}.log').read_text()[-300:]}"
        out = folder / "ssh"
        done = campaign(plan, "--on", f"ssh:{folder}/hosts.txt", "--shards", 6, "--processes", 1, "-o", out, env=environment)
        require(done.returncode == 0, f"{done.returncode}: {done.stdout}{done.stderr}")
        require("here2: given up" in done.stderr, f"who does not answer is not named: {done.stderr}")
        require(result_of(out) == right, "another result than on this machine alone")
        print("ssh, two hosts and one that does not answer: the same bytes")
    finally:
        stop(running)
    return None


def main():
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # and what was started is stopped
    asked = sys.argv[2:] or ["kills", "disk", "slurm", "ssh"]
    left_out = []
    for name in asked:
        with tempfile.TemporaryDirectory(prefix="dynwitness-") as folder:
            reason = {"kills": kills, "disk": disk, "slurm": slurm, "ssh": ssh}[name](pathlib.Path(folder))
            if reason:
                left_out.append(reason)
    for reason in left_out:
        print("left out:", reason)
    sys.exit(77 if len(left_out) == len(asked) else 0)


main()

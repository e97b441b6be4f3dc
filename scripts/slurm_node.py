#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A Slurm of this machine alone, with two workers, to try farms with.

usage: scripts/slurm_node.py FOLDER COMMAND...

Starts its daemons with all of their files in the new FOLDER, runs the command, for example bash, with SLURM_CONF set, and stops them.
Needs the packages slurm-wlm and munge, and to be root, who may start their daemons.
"""
import os
import pathlib
import signal
import socket
import subprocess
import sys
import time


def run(*command, status=0, **options):
    """Output of the command, which must end with status (None: any)."""
    done = subprocess.run(command, text=True, capture_output=True, **options)
    assert status is None or done.returncode == status, f"{command} ended with {done.returncode}: {done.stderr}"
    return done.stdout + done.stderr


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class SlurmNode:
    """The daemons, and in a new folder all of their files."""

    def __init__(self, folder):
        self.folder = folder
        self.is_started = False

    def start(self):
        folder = self.folder
        folder.mkdir(parents=True)
        name = socket.gethostname()
        memory_mib = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") * 9 // 10 >> 20
        for part in ("state", "spool"):
            (folder / part).mkdir()
        (folder / "munge.key").write_bytes(os.urandom(1024))
        os.chmod(folder / "munge.key", 0o400)
        (folder / "slurm.conf").write_text(f"""ClusterName=test
SlurmctldHost={name}(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
# Jobs that are put into the queue again start after cred_expire seconds.
AuthInfo=socket={folder}/munge.sock,cred_expire=5
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=none
ReturnToService=2
SlurmdTimeout=5
MinJobAge=60
SchedulerParameters=sched_interval=1,bf_interval=1
NodeName={name} NodeAddr=127.0.0.1 CPUs=2 RealMemory={memory_mib} State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
""")
        os.environ["SLURM_CONF"] = str(folder / "slurm.conf")
        self.is_started = True
        run("munged", "--force", *(f"--{what}={folder}/munge.{end}" for what, end in (
            ("key-file", "key"), ("socket", "sock"), ("pid-file", "pid"), ("log-file", "log"), ("seed-file", "seed"))))
        run("slurmctld")
        run("slurmd")
        self.wait_for(lambda: "idle" in run("sinfo", "-h", "-o", "%T", status=None), 60)

    def wait_for(self, condition, seconds, pause=0.2):
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, f"no end in {seconds} s:\n" + run("squeue", status=None)
            time.sleep(pause)

    def running_count(self):
        return len(run("squeue", "-h", "-r", "-t", "R", status=None).splitlines())

    def wait_for_end(self):
        self.wait_for(lambda: run("squeue", "-h", status=None).strip() == "", 300)

    def pid(self, daemon):
        return int((self.folder / f"{daemon}.pid").read_text())

    def kill_slurmd(self):
        os.kill(self.pid("slurmd"), signal.SIGKILL)
        time.sleep(1)
        run("slurmd")

    def stop(self):
        # Otherwise the files in the folder, and SLURM_CONF, are of another cluster.
        if not self.is_started:
            return
        run("scancel", "--user=root", status=None)
        end = time.monotonic() + 5
        while run("squeue", "-h", status=None).strip() and time.monotonic() < end:
            time.sleep(0.2)
        for daemon in ("slurmd", "slurmctld", "munge"):
            try:
                os.kill(self.pid(daemon), signal.SIGKILL)
            except (OSError, ValueError):
                pass


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    node = SlurmNode(pathlib.Path(sys.argv[1]).absolute())
    try:
        node.start()
        status = subprocess.run(sys.argv[2:]).returncode
    except (OSError, AssertionError) as error:
        status = f"scripts/slurm_node.py: {error}"
    finally:
        node.stop()
    sys.exit(status)


if __name__ == "__main__":
    main()

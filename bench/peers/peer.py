"""Runs of the peer: each in a process of its own, with a time limit."""
import json
import os
import pathlib
import subprocess

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent


def libraries(python, folder):
    """LD_LIBRARY_PATH for its wheel, which brings a libGLU that asks for the system's libGL. Where there is
    one, it does not go with the dispatcher that the wheel brings, and the import ends in a crash; nothing
    here draws, so the wheel's own OpenGL stands in."""
    found = sorted(pathlib.Path(python).parent.parent.glob("lib/python*/site-packages/pysplishsplash.libs/libOpenGL-*"))
    link = pathlib.Path(folder) / "libGL.so.1"
    if found and not link.exists():
        link.symlink_to(found[0])
    return str(folder)


def environment(python, folder, threads):
    # Threads that wait sleep: others may hold its cores.
    return {**os.environ, "LD_LIBRARY_PATH": libraries(python, folder), "OMP_NUM_THREADS": str(threads),
            "OMP_WAIT_POLICY": "passive"}


def run(python, scratch, job, positions, velocities=None, threads=1, limit=600):
    """(result or None, reason)."""
    folder = pathlib.Path(job["folder"])
    folder.mkdir(parents=True, exist_ok=True)
    np.save(folder / "positions.npy", np.asarray(positions, np.float32))
    np.save(folder / "velocities.npy", np.zeros_like(positions, np.float32) if velocities is None
            else np.asarray(velocities, np.float32))
    (folder / "job.json").write_text(json.dumps(job), encoding="utf-8")
    (folder / "result.json").unlink(missing_ok=True)
    with open(folder / "output.txt", "wb") as output:
        try:
            done = subprocess.run([python, "-B", str(HERE / "splishsplash.py"), str(folder / "job.json")],
                                  env=environment(python, scratch, threads), stdout=output,
                                  stderr=subprocess.STDOUT, timeout=limit, check=False)
        except subprocess.TimeoutExpired:
            return None, f"given up after {limit} s"
    if done.returncode != 0 or not (folder / "result.json").exists():
        return None, (f"ended by signal {-done.returncode}" if done.returncode < 0
                      else f"ended with exit code {done.returncode}")
    return json.loads((folder / "result.json").read_text(encoding="utf-8")), ""

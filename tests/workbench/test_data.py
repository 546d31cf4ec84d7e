"""Further files, given by --data: each converts or is refused with one line; nothing else may happen."""
import os
import signal
import subprocess
import sys


def test_a_file_converts_or_is_refused_with_one_line(data_file, tmp_path):
    out = tmp_path / "out"
    command = [sys.executable, "-m", "trimquad.cli", "convert", data_file, "--out", str(out), "--quiet"]
    environment = dict(os.environ, PYTHONPATH=os.pathsep.join(sys.path))
    done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=300)
    assert done.returncode in (0, 2, 3), signal.Signals(-done.returncode).name
    lines = done.stderr.splitlines()
    assert len(lines) == (0 if done.returncode == 0 else 1), lines
    assert "Traceback" not in done.stderr and "internal error" not in done.stderr
    if done.returncode == 2:
        assert not out.exists()

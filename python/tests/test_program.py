"""The console script: the program's output, exit codes and Ctrl-C."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import pytest

ETALON = [sys.executable, "-m", "etalon_bench"]


def etalon(*arguments, **options):
    return subprocess.run([*ETALON, *arguments], capture_output=True, text=True, timeout=300, **options)


def test_exit_codes_are_those_of_the_program(tmp_path):
    good = etalon("validate", "warp", "-o", str(tmp_path))
    assert good.returncode == 0 and "accepted" in good.stdout and not good.stderr
    assert etalon("--version").stdout.startswith("etalon ") and etalon("--help").returncode == 0
    usage = etalon("validate", "--detect", "x")
    assert usage.returncode == 2 and "--detect" in usage.stderr and not usage.stdout
    missing = etalon("compare", "missing.exr", "other.exr")
    assert missing.returncode == 2 and "missing.exr" in missing.stderr
    few = etalon("validate", "warp", "--samples", "100", "-o", str(tmp_path))
    assert few.returncode == 3


def test_a_rejected_check_is_1(tmp_path):
    client = tmp_path / "wrong.py"
    client.write_text(
        "import sys\n"
        "for line in sys.stdin:\n"
        "    verb, *n = line.split()\n"
        "    if verb == 'etalon': print('etalon 1 domain=line dimension=1')\n"
        "    elif verb == 'quit': break\n"
        "    else:\n"
        "        for _ in range(int(n[0])):\n"
        "            x = float(sys.stdin.readline())\n"
        "            print(x if verb == 'sample' else 2 * x)\n"
        "    print('end', flush=True)\n"
    )
    done = etalon("validate", "--exec", f"{sys.executable} {client}", "-o", str(tmp_path))
    assert done.returncode == 1 and "rejected" in done.stdout


def test_the_script_is_installed(tmp_path):
    script = os.path.join(os.path.dirname(sys.executable), "etalon")
    if not os.path.exists(script):
        pytest.skip("skipped: the package is not installed beside this Python")
    done = subprocess.run([script, "fresnel", "--json", "-o", str(tmp_path)], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and done.stdout.startswith("{")


@pytest.mark.skipif(os.name != "posix", reason="skipped: signals of POSIX")
def test_ctrl_c_ends_the_program_with_what_it_has(tmp_path):
    running = subprocess.Popen(
        [*ETALON, "validate", "--detect", "0.001", "-o", str(tmp_path)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    time.sleep(3)
    running.send_signal(signal.SIGINT)
    out, err = running.communicate(timeout=60)
    assert running.returncode == 3 and "interrupted" in out and "Traceback" not in err, (running.returncode, out, err)
    # The second one ends it at once
    running = subprocess.Popen([*ETALON, "validate", "--detect", "0.001", "-o", str(tmp_path)], stdout=subprocess.DEVNULL)
    time.sleep(2)
    running.send_signal(signal.SIGINT)
    running.send_signal(signal.SIGINT)
    time.sleep(0.1)
    if running.poll() is None:
        running.send_signal(signal.SIGINT)
    assert running.wait(10) in (130, -signal.SIGINT, 3)

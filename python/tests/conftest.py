"""What the tests share: the repository's examples, and runs of the program."""

from __future__ import annotations

import json
import shlex
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

pytest_plugins = ["pytester"]
# Tests send SIGINT, which is ignored, also by what they start, where they were started in the background of a script.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def examples() -> Path:
    return ROOT / "examples"


@pytest.fixture
def validate_exec(tmp_path: Path) -> Any:
    """Runs `etalon validate --exec COMMAND` and returns its JSON."""

    def run(command: list[str], *arguments: str) -> dict[str, Any]:
        program = [sys.executable, "-m", "etalon_bench", "validate", "--exec", shlex.join(command), *arguments]
        done = subprocess.run([*program, "--json", "-o", str(tmp_path)], capture_output=True, text=True, timeout=500)
        assert done.returncode in (0, 1, 3), done.stderr
        return dict(json.loads(done.stdout))

    return run

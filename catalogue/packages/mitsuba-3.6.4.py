# /// script
# dependencies = ["mitsuba==3.6.4"]
# ///
"""A version of Mitsuba 3 with a fault that was fixed since, by the entries of mitsuba.py."""

import runpy
import sys
from pathlib import Path

sys.argv += ["--only", "* texture bitmap *"]
runpy.run_path(str(Path(__file__).with_name("mitsuba.py")))

# /// script
# dependencies = ["numpy==2.3.3", "scipy==1.17.1"]
# ///
"""A version of NumPy with a fault that was fixed since, by the entries of numpy.py."""

import runpy
import sys
from pathlib import Path

sys.argv += ["--only", "wald(1*"]
runpy.run_path(str(Path(__file__).with_name("numpy.py")))

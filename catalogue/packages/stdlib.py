# /// script
# dependencies = []
# [tool.catalogue]
# version = "0.2.3"
# setup = ["npm install --silent --no-audit --no-fund @stdlib/random-base@0.2.3 @stdlib/stats-base-dists@0.2.2"]
# ///
"""stdlib (JavaScript): @stdlib/random-base against @stdlib/stats-base-dists, by serve.mjs."""

from pathlib import Path

from entry import library, run

run(library(["node", str(Path(__file__).with_name("serve.mjs")), "stdlib"], "normal(0, 1)"))

# /// script
# dependencies = []
# [tool.catalogue]
# version = "0.2.3"
# setup = ["npm install --silent --no-audit --no-fund @stdlib/random-base@0.2.3 @stdlib/stats-base-dists@0.2.2"]
# ///
"""stdlib (JavaScript): @stdlib/random-base against @stdlib/stats-base-dists, by serve.mjs."""

from entry import library, run

run(library("stdlib", "normal", [0, 1], "1.05"))

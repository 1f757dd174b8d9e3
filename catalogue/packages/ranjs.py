# /// script
# dependencies = []
# [tool.catalogue]
# version = "1.24.5"
# setup = ["npm install --silent --no-audit --no-fund ranjs@1.24.5"]
# ///
"""ranjs (JavaScript): all distributions with their default parameters and others, by serve.mjs."""

from entry import library, run

run(library("ranjs", "Normal", [], "1.05"))

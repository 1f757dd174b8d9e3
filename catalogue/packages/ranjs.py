# /// script
# dependencies = []
# [tool.catalogue]
# version = "1.24.5"
# setup = ["npm install --silent --no-audit --no-fund ranjs@1.24.5"]
# ///
"""ranjs (JavaScript): all distributions with their default parameters and others, by serve.mjs."""

from pathlib import Path

from entry import library, run

run(library(["node", str(Path(__file__).with_name("serve.mjs")), "ranjs"], "Normal()"))

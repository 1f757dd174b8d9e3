# /// script
# dependencies = []
# [tool.catalogue]
# version = "0.6.0"
# setup = ["cp -r $CATALOGUE/packages/rand_distr crate && cargo build --release --quiet --manifest-path crate/Cargo.toml && cp crate/target/release/client ."]
# ///
"""rand_distr (Rust), by the crate beside this script."""

from entry import library, run

run(library(["./client"], "StandardNormal"))

# /// script
# dependencies = []
# [tool.catalogue]
# version = "0.4.3"
# setup = ["cp -r $CATALOGUE/packages/rand_distr crate && cp $CATALOGUE/packages/rand_distr-0.4.3.toml crate/Cargo.toml && cargo build --release --quiet --manifest-path crate/Cargo.toml && cp crate/target/release/client ."]
# ///
"""A version of rand_distr with faults that were fixed since, by the entries of rand_distr."""

from entry import library, run

run(library(["./client"], "StandardNormal"))

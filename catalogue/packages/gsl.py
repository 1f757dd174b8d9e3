# /// script
# dependencies = []
# [tool.catalogue]
# version = "2.7.1"
# setup = [
#     "apt-get download -q libgsl-dev libgsl27 libgslcblas0 && for each in *.deb; do dpkg -x $each .; done",
#     "g++ -O2 -I$CATALOGUE/../include -Iusr/include $CATALOGUE/packages/gsl.cpp -o gsl -Lusr/lib/x86_64-linux-gnu -Wl,--disable-new-dtags,-rpath,$PWD/usr/lib/x86_64-linux-gnu -lgsl -lgslcblas -lm",
# ]
# ///
"""GSL (Debian's package), and the C++ standard library's distributions (libstdc++), by gsl.cpp; densities are those of GSL."""

import subprocess

from entry import program, run

LISTED = subprocess.run(["./gsl", "list"], capture_output=True, text=True, check=True).stdout.splitlines()
run([
    program("control/right", ["./gsl", "gaussian polar"], "real", control="right"),
    program("control/scale 1.05", ["./gsl", "gaussian polar", "1.05"], "real", control="wrong"),
    *(program(name, ["./gsl", name], domain) for name, domain in (line.split("\t") for line in LISTED)),
])  # fmt: skip

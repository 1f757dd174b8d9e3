# /// script
# dependencies = []
# [tool.catalogue]
# version = "12.2.0"
# setup = [
#     "apt-get download -q libgsl-dev libgsl27 libgslcblas0 && for each in *.deb; do dpkg -x $each .; done",
#     "g++ -O2 -I$CATALOGUE/../include -Iusr/include $CATALOGUE/packages/gsl.cpp -o client -Lusr/lib/x86_64-linux-gnu -Wl,--disable-new-dtags,-rpath,$PWD/usr/lib/x86_64-linux-gnu -lgsl -lgslcblas -lm",
# ]
# ///
"""The C++ standard library of GCC (Debian's g++), by gsl.cpp; densities are those of GSL."""

from entry import library, run

run(library(["./client", "std"], "normal"))

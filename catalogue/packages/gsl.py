# /// script
# dependencies = []
# [tool.catalogue]
# version = "2.7.1"
# setup = [
#     "apt-get download -q libgsl-dev libgsl27 libgslcblas0 && for each in *.deb; do dpkg -x $each .; done",
#     "g++ -O2 -I$CATALOGUE/../include -Iusr/include $CATALOGUE/packages/gsl.cpp -o client -Lusr/lib/x86_64-linux-gnu -Wl,--disable-new-dtags,-rpath,$PWD/usr/lib/x86_64-linux-gnu -lgsl -lgslcblas -lm",
# ]
# ///
"""GSL (Debian's package), by gsl.cpp."""

from entry import library, run

run(library(["./client", "gsl"], "gaussian polar"))

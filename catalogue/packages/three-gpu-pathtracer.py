# /// script
# dependencies = []
# [tool.catalogue]
# version = "0.0.26"
# setup = [
#     "npm install --silent --no-audit --no-fund --legacy-peer-deps --ignore-scripts three-gpu-pathtracer@0.0.26",
#     "apt-get download -q libglm-dev && dpkg -x libglm-dev*.deb .",
#     "node $CATALOGUE/packages/shader.mjs > shader.h",
#     "g++ -O2 -std=c++17 -fsingle-precision-constant -I. -I$CATALOGUE/../include -Iusr/include $CATALOGUE/packages/shader.cpp -o client",
# ]
# ///
"""three-gpu-pathtracer (GLSL for WebGL): normals, lobes and materials of its BSDF on the CPU, by shader.cpp and Debian's GLM."""

from entry import library, run

run(library(["./client"], "ggx normals, alpha 0.30, oblique"))

/* A client for `etalon validate --exec ./cosine`, after `cc -O2 -Iinclude examples/cosine.c -o cosine -lm`: cosine-weighted
   directions. With an argument it forgets the root of the radius. */
#include "etalon.h"
#include <math.h>

static int wrong;

static int sample(const double *u, double *w) {
    double r = wrong ? u[0] : sqrt(u[0]), phi = 6.283185307179586 * u[1];
    w[0] = r * cos(phi), w[1] = r * sin(phi), w[2] = sqrt(1 - r * r);
    return 1;
}

static double pdf(const double *w) { return w[2] > 0 ? w[2] / 3.141592653589793 : 0; }

int main(int argc, char **argv) {
    etalon_sampler cosine = {"cosine-c", "hemisphere", 2, sample, pdf, 0, 0, 0, 0, 0, 0};
    wrong = argc > 1 && argv[1][0];
    return etalon_serve_sampler(&cosine);
}

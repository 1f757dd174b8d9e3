/* A client for `etalon validate --exec ./sampler`, after `cc -O2 -Iinclude examples/sampler.c -o sampler -lm`: directions on the
   sphere with density (1 + cos t)/4 pi, from random numbers of its own. */
#include "etalon.h"
#include <math.h>
#include <stdint.h>

static const double PI = 3.141592653589793;
static uint64_t state;

static void seed(unsigned long value) { state = value; }

/* Steele, Lea and Flood's SplitMix64, 2014: 53 bits of it. */
static double uniform(void) {
    uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return ldexp((double)((z ^ z >> 31) >> 11), -53);
}

static int sample(const double *u, double *w) {
    double phi = 2 * PI * uniform();
    (void)u; /* random numbers of etalon's, which this sampler does not take */
    w[2] = 2 * sqrt(uniform()) - 1;
    w[0] = sqrt(1 - w[2] * w[2]) * cos(phi), w[1] = sqrt(1 - w[2] * w[2]) * sin(phi);
    return 1;
}

static double pdf(const double *w) { return fmax(1 + w[2], 0) / (4 * PI); }

int main(void) {
    etalon_sampler cardioid = {"cardioid-c", "sphere", 0, sample, pdf, 0, seed, 0, 0, 0, 0};
    return etalon_serve_sampler(&cardioid);
}

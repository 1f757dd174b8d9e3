/* A client for `etalon validate --exec ./sampler`, after `cc -O2 examples/sampler.c -o sampler -lm`: directions on the sphere
   with density (1 + cos θ)/4π, from random numbers of its own; hexadecimal, which is exact and fast. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static const double PI = 3.141592653589793;
static uint64_t state;

/* Steele, Lea and Flood's SplitMix64, 2014: 53 bits of it. */
static double uniform(void) {
    uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

static double pdf(double z) { return fmax(1 + z, 0) / (4 * PI); }

int main(void) {
    char line[256], verb[16];
    while (fgets(line, sizeof line, stdin)) {
        unsigned long count = 0, seed = 0;
        double x, y, z;
        if (sscanf(line, "%15s %lu %lu", verb, &count, &seed) < 1 || !strcmp(verb, "quit"))
            break;
        if (!strcmp(verb, "etalon")) {
            puts("etalon 1 name=cardioid-c domain=sphere dimension=0");
            count = 0;
        }
        state = seed;
        for (unsigned long i = 0; i < count; i++)
            if (!strcmp(verb, "sample")) {
                double phi = 2 * PI * uniform();
                z = 2 * sqrt(uniform()) - 1;
                x = sqrt(1 - z * z) * cos(phi), y = sqrt(1 - z * z) * sin(phi);
                printf("%a %a %a %a\n", x, y, z, pdf(z));
            } else if (fgets(line, sizeof line, stdin) && sscanf(line, "%lf %lf %lf", &x, &y, &z) == 3)
                printf("%a\n", pdf(z));
        puts("end");
        fflush(stdout);
    }
    return 0;
}

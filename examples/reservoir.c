/* A reservoir of 8 candidates on the line from 0 to 1, chosen by a power of x: a weight in place of a pdf, over the range of the
   power. `./reservoir wrong` forgets that a candidate below ¼ cannot have come from the second half of them. */
#include "etalon.h"
#include <math.h>

enum { CANDIDATES = 8 };
static double power = 1;
static int is_wrong;

static double importance(double x) { return 0.1 + pow(x, power); }

static int sample(const double *u, double *x) {
    double chosen = 0, sum = 0, able;
    for (int i = 0; i < CANDIDATES; i++) {
        const double y = i % 2 ? 0.25 + 0.75 * u[i] : u[i], weight = importance(y) * (i % 2 ? 0.75 : 1);
        sum += weight;
        if (u[CANDIDATES + i] * sum < weight) chosen = y;
    }
    able = chosen < 0.25 && !is_wrong ? CANDIDATES / 2 : CANDIDATES;
    x[0] = chosen, x[1] = sum / (able * importance(chosen));
    return 1;
}

static const char *set(const double *values) { return power = values[0], (const char *)0; }

int main(int count, char **words) {
    etalon_sampler reservoir = {"reservoir", "line", 2 * CANDIDATES, sample, 0, 0, 0, "weights=yes", 1, "power 1 0.5 4\n", set};
    is_wrong = count > 1 && !strcmp(words[1], "wrong");
    return etalon_serve_sampler(&reservoir);
}

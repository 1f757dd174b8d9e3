/* Points of the upper half of the unit disk, by a chart of its own: radius and angle. */
#include "etalon.h"
#include <math.h>

static const double pi = 3.14159265358979323846;

static void from_cube(const double *u, double *x) {
    x[0] = u[0] * cos(pi * u[1]), x[1] = u[0] * sin(pi * u[1]);
}

static int to_cube(const double *x, double *u) {
    u[0] = hypot(x[0], x[1]), u[1] = atan2(x[1], x[0]) / pi;
    return u[0] <= 1 && u[1] >= 0;
}

static double jacobian(const double *u) { return pi * u[0]; }

static int sample(const double *u, double *x) {
    const double place[] = {sqrt(u[0]), u[1]};
    from_cube(place, x);
    return 1;
}

static double pdf(const double *x) { return x[1] >= 0 ? 2 / pi : 0; }

int main(void) {
    const etalon_sampler half_disk = {"half-disk-c", 0, 2, sample, pdf, 0, 0, 0, 0, 0, 0};
    const etalon_chart chart = {2, 2, to_cube, from_cube, jacobian};
    return etalon_serve_sampler_on(&half_disk, &chart);
}

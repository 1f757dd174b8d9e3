/* A BSDF for `etalon validate --exec ./bsdf`, after `cc -O2 -Iinclude examples/bsdf.c -o bsdf -lm`: smooth glass, which has
   delta lobes alone. With an argument it forgets that radiance is divided by the square of the index of refraction. */
#include "etalon.h"
#include <math.h>

static double index_of_glass = 1.5;
static int wrong;

/* The index on the far side of the surface over that on the side of wo, and what the surface reflects (Fresnel). */
static double fresnel(double z, double *eta) {
    *eta = z > 0 ? index_of_glass : 1 / index_of_glass;
    double cos_o = fabs(z), sin2_i = (1 - z * z) / (*eta * *eta);
    if (sin2_i >= 1)
        return 1;
    double cos_i = sqrt(1 - sin2_i);
    double parallel = (*eta * cos_o - cos_i) / (*eta * cos_o + cos_i);
    double perpendicular = (cos_o - *eta * cos_i) / (cos_o + *eta * cos_i);
    return (parallel * parallel + perpendicular * perpendicular) / 2;
}

/* The direction of the refracted light. */
static void refract(const double *wo, double eta, double *wi) {
    double sin2 = (1 - wo[2] * wo[2]) / (eta * eta);
    wi[0] = -wo[0] / eta, wi[1] = -wo[1] / eta, wi[2] = copysign(sqrt(fmax(1 - sin2, 0)), -wo[2]);
}

/* Both delta lobes: reflection, and refraction unless reflection is total. */
static int lobes(const double *wo, etalon_bsdf_sample *s) {
    double eta, r = fresnel(wo[2], &eta);
    etalon_bsdf_sample reflection = {{-wo[0], -wo[1], wo[2]}, {1, 0, 0}, r, 1};
    etalon_bsdf_sample refraction = {{0, 0, 0}, {wrong ? 1 : 1 / (eta * eta), 0, 0}, 1 - r, 1};
    s[0] = reflection;
    if (r == 1)
        return 1;
    refract(wo, eta, refraction.wi);
    s[1] = refraction;
    return 2;
}

/* One of them, with its probability. */
static int sample(const double *wo, const double *u, etalon_bsdf_sample *s) {
    etalon_bsdf_sample both[ETALON_LOBES];
    lobes(wo, both);
    *s = both[u[0] < both[0].pdf ? 0 : 1];
    return 1;
}

/* Delta lobes have neither a value nor a pdf. */
static void eval(const double *wo, const double *wi, double *f) { (void)wo, (void)wi, f[0] = 0; }
static double pdf(const double *wo, const double *wi) { return (void)wo, (void)wi, 0; }

/* What the parameter changes: the index that the greeting has. */
static const char *set(const double *values) {
    static char keys[32];
    snprintf(keys, sizeof keys, "eta=%a", index_of_glass = values[0]);
    return keys;
}

int main(int argc, char **argv) {
    etalon_bsdf glass = {"glass-c", "scatters=both delta=yes energy=conserved", 1, 1, eval, pdf, sample, lobes,
                         1, "eta 1.5 1.01 3\n", set, 0};
    wrong = argc > 1 && argv[1][0];
    return etalon_serve_bsdf(&glass);
}

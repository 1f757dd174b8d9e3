/* A BSDF for `etalon validate --exec ./bsdf`, after `cc -O2 examples/bsdf.c -o bsdf -lm`: smooth glass, which has delta lobes
   alone. With an argument it forgets that radiance is divided by the square of the index of refraction. */
#include <math.h>
#include <stdio.h>
#include <string.h>

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

int main(int argc, char **argv) {
    char line[512], verb[16];
    wrong = argc > 1 && argv[1][0];
    while (fgets(line, sizeof line, stdin)) {
        unsigned long count = 0;
        if (sscanf(line, "%15s %lu", verb, &count) < 1 || !strcmp(verb, "quit"))
            break;
        if (!strcmp(verb, "etalon")) {
            puts("etalon 1 kind=bsdf name=glass-c scatters=both delta=yes energy=conserved");
            puts("eta 1.5 1.01 3"); /* name, usual value, range */
            count = 0;
        } else if (!strcmp(verb, "set")) {
            sscanf(line, "set %lf", &index_of_glass);
            printf("eta=%a\n", index_of_glass); /* what the parameters change */
            count = 0;
        }
        for (unsigned long i = 0; i < count && fgets(line, sizeof line, stdin); i++) {
            double wo[3], wi[3], u, eta;
            if (sscanf(line, "%lf %lf %lf %lf", wo, wo + 1, wo + 2, &u) < 3)
                return 1;
            double r = fresnel(wo[2], &eta), scale = wrong ? 1 : 1 / (eta * eta);
            refract(wo, eta, wi);
            if (!strcmp(verb, "lobes")) {
                printf("%a %a %a %a %a", -wo[0], -wo[1], wo[2], r, r);
                if (r < 1)
                    printf(" %a %a %a %a %a", wi[0], wi[1], wi[2], 1 - r, (1 - r) * scale);
                puts("");
            } else if (strcmp(verb, "sample"))
                puts("0"); /* f and pdf, which delta lobes have not */
            else if (u < r)
                printf("delta %a %a %a 1 %a\n", -wo[0], -wo[1], wo[2], r);
            else
                printf("delta %a %a %a %a %a\n", wi[0], wi[1], wi[2], scale, 1 - r);
        }
        puts("end");
        fflush(stdout);
    }
    return 0;
}

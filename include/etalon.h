/* etalon.h: a sampler or a BSDF in C99 or C++11 for `etalon validate --exec ./program`; needs the standard library alone.

   Fill in an etalon_sampler or an etalon_bsdf and let main return what etalon_serve_... returns: 0, or 2 with a message on standard
   error if a request made no sense. Members that are not needed are 0. Standard output belongs to the protocol.
   Directions are unit vectors; those of a BSDF are in the local frame, the normal at +z, and point away from the surface. `keys` are those
   of the protocol (docs/src/external-samplers.md, external-bsdfs.md), as one text: "mass=0.5", "scatters=both eta=1.5". */
#ifndef ETALON_H
#define ETALON_H
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const char *name, *domain; /* "sphere", "square", "line", "real", "discrete:N" …: docs/src/domains.md; 0 with an etalon_chart */
    int dimension; /* random numbers that a sample takes, at most 64; 0: random numbers of your own, see `seed` */
    int (*sample)(const double *u, double *x); /* from u in [0, 1): 1, and the sample x; 0 if there is none */
    double (*pdf)(const double *x);            /* per steradian, area, length, or outcome */
    int (*invert)(const double *x, double *u); /* optional: the random numbers of x; 0 if it has none */
    void (*seed)(unsigned long seed);          /* if dimension is 0: starts the random numbers of the samples that follow */
    const char *keys;                          /* optional: "mass=0.5" and the like; with "weights=yes" sample writes its weight behind x */
    int parameters;                            /* optional, with `about` and `set`: as of etalon_bsdf */
    const char *about;
    const char *(*set)(const double *values);
} etalon_sampler;

typedef struct { /* a domain of your own, by a chart to the unit cube: docs/src/domains.md */
    int dimension, coordinates; /* of the unit cube, 1 to 6; of points, 1 to 8 */
    int (*to_cube)(const double *x, double *u);    /* 1, and the place of x in the cube; 0 if x is not in the domain */
    void (*from_cube)(const double *u, double *x); /* its inverse */
    double (*jacobian)(const double *u);           /* area (length) of the domain per area of the cube */
} etalon_chart;

typedef struct {
    double wi[3], weight[3]; /* f |cos| / pdf in each channel; of a delta lobe, throughput over probability */
    double pdf;              /* per steradian; of a delta lobe, its probability */
    int delta;               /* 1: a delta lobe */
} etalon_bsdf_sample;

typedef struct {
    const char *name, *keys;
    int channels, dimension; /* 1 or 3 channels; random numbers that a sample takes, 1 to 64 */
    void (*eval)(const double *wo, const double *wi, double *f); /* without the cosine */
    double (*pdf)(const double *wo, const double *wi);           /* without delta lobes */
    int (*sample)(const double *wo, const double *u, etalon_bsdf_sample *s); /* 1; 0 if there is no sample */
    int (*lobes)(const double *wo, etalon_bsdf_sample *lobes);   /* optional: the number of delta lobes, at most 8 */
    int parameters;                                              /* how many, at most 64; the rest only if there are any */
    const char *about;                                           /* a line "NAME VALUE FROM TO\n" for each of them */
    const char *(*set)(const double *values);                    /* takes their values; returns keys that change, or 0 */
    const char *kind; /* "phase": eval is its value; "light": wo is a reference point and eval the radiance; 0: a BSDF */
} etalon_bsdf;

enum { ETALON_LINE = 4096, ETALON_MOST = 64, ETALON_LOBES = 8 };

/* Says what is wrong; returns the exit code. */
static inline int etalon_fail(const char *what, const char *line) {
    return fprintf(stderr, "etalon.h: %s: %.200s\n", what, line), 2;
}

/* Whether the text is n numbers and nothing else. */
static inline int etalon_parse(const char *at, double *numbers, int n) {
    const char *line = at;
    char *end;
    for (int i = 0; i < n; i++, at = end) {
        numbers[i] = strtod(at, &end);
        if (end == at)
            return !etalon_fail("too few numbers", line);
    }
    return at[strspn(at, " \r\n")] == 0 || !etalon_fail("too many numbers", line);
}

static inline int etalon_read(double *numbers, int n) {
    char line[ETALON_LINE];
    return fgets(line, sizeof line, stdin) ? etalon_parse(line, numbers, n) : !etalon_fail("the input ends early", "");
}

static inline void etalon_write(const double *numbers, int n) {
    for (int i = 0; i < n; i++)
        printf(" %a", numbers[i]);
}

/* Ends the answer before, and reads the next request: its verb and its first two numbers. */
static inline int etalon_next(char *line, char *verb, unsigned long *count, unsigned long *seed, unsigned long *first) {
    if (!*first && (puts("end") < 0 || fflush(stdout)))
        return 0;
    *first = 0, *count = *seed = 0;
    return fgets(line, ETALON_LINE, stdin) && sscanf(line, "%15s %lu %lu", verb, count, seed) > 0 && strcmp(verb, "quit");
}

/* The coordinates of a point of a domain. */
static inline int etalon_coordinates(const char *domain) {
    const char *names[] = {"square", "plane", "disk", "circle", "triangle", "sphere", "hemisphere", "simplex", "triangle:", "space", "ball", "rotations"};
    const char *star = strchr(domain, '*'), *name = star ? star + 1 + strspn(star + 1, " ") : domain;
    int n = 1;
    for (int i = 0; i < 12; i++)
        if (!strncmp(name, names[i], strlen(names[i]))) n = i < 5 ? 2 : i < 11 ? 3 : 4;
    if (!strncmp(name, "simplex:", 8)) n = atoi(name + 8);
    if (!strncmp(name, "box:", 4)) {
        n = 1;
        for (const char *at = name; *at; at++) n += *at == ',';
        n /= 2;
    }
    return star ? n + 1 : n;
}

/* Answers a request to set parameters. */
static inline int etalon_set(const char *line, int parameters, const char *(*set)(const double *values)) {
    double values[ETALON_MOST];
    if (!etalon_parse(line + 3, values, parameters)) return 2;
    const char *keys = set(values);
    printf("%s%s", keys ? keys : "", keys ? "\n" : "");
    return 0;
}

/* Answers a request of the chart. */
static inline int etalon_serve_chart(const etalon_chart *c, const char *verb, unsigned long count) {
    const int is_to_cube = !strcmp(verb, "to_cube"), is_from_cube = !strcmp(verb, "from_cube");
    for (; count > 0; count--) {
        double u[6], x[8];
        if (!etalon_read(is_to_cube ? x : u, is_to_cube ? c->coordinates : c->dimension))
            return 2;
        const int inside = !is_to_cube || c->to_cube(x, u);
        if (is_from_cube) c->from_cube(u, x);
        const double jacobian = is_to_cube || is_from_cube ? 0 : c->jacobian(u);
        etalon_write(is_to_cube ? u : is_from_cube ? x : &jacobian, is_to_cube ? inside * c->dimension : is_from_cube ? c->coordinates : 1);
        puts(inside ? "" : "none");
    }
    return 0;
}

/* Serves a sampler on a domain of its own; without one, c is 0. */
static inline int etalon_serve_sampler_on(const etalon_sampler *s, const etalon_chart *c) {
    const int n = c ? c->coordinates : etalon_coordinates(s->domain ? s->domain : "");
    char line[ETALON_LINE], verb[16];
    unsigned long count, seed, first = 1;
    const int weights = s->keys && strstr(s->keys, "weights=") ? 1 : 0;
    if (s->dimension < 0 || s->dimension > ETALON_MOST || s->parameters > ETALON_MOST || n < 1 || n > 8 || (c && (c->dimension < 1 || c->dimension > 6)))
        return etalon_fail("a dimension out of range", s->name);
    while (etalon_next(line, verb, &count, &seed, &first)) {
        const int is_sample = !strcmp(verb, "sample"), is_invert = !strcmp(verb, "invert") && s->invert;
        if (c && (!strcmp(verb, "to_cube") || !strcmp(verb, "from_cube") || !strcmp(verb, "jacobian"))) {
            if (etalon_serve_chart(c, verb, count)) return 2;
            continue;
        }
        if (!strcmp(verb, "etalon")) {
            count = 0, printf("etalon 1 name=%s dimension=%d%s ", s->name, s->dimension, s->invert ? " invert=yes" : "");
            if (c) printf("chart=%d", c->dimension);
            else printf("domain=%s", s->domain);
            printf(" %s\n%s", s->keys ? s->keys : "", s->parameters ? s->about : "");
        } else if (!strcmp(verb, "set") && s->parameters) {
            if (etalon_set(line, s->parameters, s->set)) return 2;
            continue;
        } else if (!is_sample && !is_invert && strcmp(verb, "pdf"))
            return etalon_fail("an unknown request", line);
        if (is_sample && s->dimension == 0 && s->seed) s->seed(seed);
        for (; count > 0; count--) {
            double u[ETALON_MOST], x[9];
            if (is_sample ? s->dimension > 0 && !etalon_read(u, s->dimension) : !etalon_read(x, n))
                return 2;
            const int found = is_sample ? s->sample(u, x) : is_invert ? s->invert(x, u) : 1;
            const int has_pdf = found && !is_invert && !(is_sample && weights);
            const double pdf = has_pdf ? s->pdf(x) : 0;
            etalon_write(is_invert ? u : x, !found ? 0 : is_invert ? s->dimension : is_sample ? n + weights : 0);
            etalon_write(&pdf, has_pdf);
            puts(found ? "" : "none");
        }
    }
    return ferror(stdout) ? etalon_fail("the output cannot be written", verb) : 0;
}

static inline int etalon_serve_sampler(const etalon_sampler *s) {
    return etalon_serve_sampler_on(s, 0);
}

static inline int etalon_serve_bsdf(const etalon_bsdf *b) {
    char line[ETALON_LINE], verb[16];
    unsigned long count, seed, first = 1;
    if (b->dimension < 1 || b->dimension > ETALON_MOST || b->parameters > ETALON_MOST)
        return etalon_fail("a dimension out of range", b->name);
    while (etalon_next(line, verb, &count, &seed, &first)) {
        const int is_eval = !strcmp(verb, "eval"), is_sample = !strcmp(verb, "sample");
        const int is_lobes = !strcmp(verb, "lobes") && b->lobes;
        double in[ETALON_MOST + 3], *more = in + 3, f[3];
        etalon_bsdf_sample s[ETALON_LOBES];
        if (!strcmp(verb, "etalon"))
            printf("etalon 1 kind=%s name=%s channels=%d dimension=%d %s\n%s", b->kind ? b->kind : "bsdf", b->name, b->channels, b->dimension,
                   b->keys ? b->keys : "", b->parameters ? b->about : "");
        else if (!strcmp(verb, "set") && b->parameters) {
            if (etalon_set(line, b->parameters, b->set)) return 2;
        } else if (!is_eval && !is_sample && !is_lobes && strcmp(verb, "pdf"))
            return etalon_fail("an unknown request", line);
        else
            for (; count > 0; count--) {
                if (!etalon_read(in, 3 + (is_sample ? b->dimension : is_lobes ? 0 : 3))) return 2;
                if (is_eval) b->eval(in, more, f);
                else if (!is_sample && !is_lobes) f[0] = b->pdf(in, more);
                const int found = is_sample ? b->sample(in, more, s) : is_lobes ? b->lobes(in, s) : 0;
                for (int i = 0; i < found; i++) {
                    for (int c = 0; c < b->channels; c++) /* a lobe has its throughput: weight times probability */
                        f[c] = s[i].weight[c] * (is_lobes ? s[i].pdf : 1);
                    printf("%s", is_sample && s[i].delta ? "delta" : "");
                    etalon_write(s[i].wi, 3);
                    etalon_write(&s[i].pdf, is_lobes);
                    etalon_write(f, b->channels);
                    etalon_write(&s[i].pdf, is_sample);
                }
                etalon_write(f, is_sample || is_lobes ? 0 : is_eval ? b->channels : 1);
                puts((is_sample || is_lobes) && found == 0 ? "none" : "");
            }
    }
    return ferror(stdout) ? etalon_fail("the output cannot be written", verb) : 0;
}
#endif

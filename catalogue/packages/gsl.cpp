// Distributions of GSL, and of the C++ standard library ("std"), in the protocol; densities are those of GSL.
//   client gsl|std list     names and domains;     client gsl|std NAME [SCALE]     serves one, samples multiplied by SCALE
#include "etalon.h"
#include <cmath>
#include <functional>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <random>
#include <string>
#include <vector>

static gsl_rng *r;
static std::mt19937_64 g;
static double scale = 1;
struct Case { std::string name, domain; std::function<double()> draw; std::function<double(double)> pdf; };
static const Case *now;

int main(int argc, char **argv) {
    r = gsl_rng_alloc(gsl_rng_mt19937);
    std::vector<Case> all;
    const std::string library = argc > 2 ? argv[1] : "", asked = argc > 2 ? argv[2] : "";
    const auto add = [&](std::string name, std::string domain, std::function<double()> draw, std::function<double(double)> pdf) {
        const bool isStd = name.rfind("std/", 0) == 0;
        if (isStd == (library == "std")) all.push_back({isStd ? name.substr(4) : name, domain, draw, pdf});
    };
#define REAL(NAME, DOMAIN, DRAW, PDF) add(NAME, DOMAIN, [=]() mutable { return double(DRAW); }, [=](double x) { return double(PDF); })
    REAL("gaussian polar", "real", gsl_ran_gaussian(r, 1), gsl_ran_gaussian_pdf(x, 1));
    REAL("gaussian ratio_method", "real", gsl_ran_gaussian_ratio_method(r, 1), gsl_ran_gaussian_pdf(x, 1));
    REAL("gaussian ziggurat", "real", gsl_ran_gaussian_ziggurat(r, 1), gsl_ran_gaussian_pdf(x, 1));
    for (double a : {0.5, 2.0, 6.0}) REAL("gaussian_tail " + std::to_string(a), "half-line:" + std::to_string(a), gsl_ran_gaussian_tail(r, a, 1), gsl_ran_gaussian_tail_pdf(x, a, 1));
    for (double b : {0.4, 1.5, 4.0, 8.0}) REAL("exppow " + std::to_string(b), "real", gsl_ran_exppow(r, 1, b), gsl_ran_exppow_pdf(x, 1, b));
    for (double a : {0.1, 0.9, 2.5, 30.0, 3000.0}) {
        REAL("gamma " + std::to_string(a), "half-line:0," + std::to_string(a), gsl_ran_gamma(r, a, 1), gsl_ran_gamma_pdf(x, a, 1));
        REAL("gamma_knuth " + std::to_string(a), "half-line:0," + std::to_string(a), gsl_ran_gamma_knuth(r, a, 1), gsl_ran_gamma_pdf(x, a, 1));
        std::gamma_distribution<double> d(a, 1);
        REAL("std/gamma " + std::to_string(a), "half-line:0," + std::to_string(a), d(g), gsl_ran_gamma_pdf(x, a, 1));
    }
    for (double k : {0.6, 3.0, 40.0}) {
        std::chi_squared_distribution<double> c(k);
        std::student_t_distribution<double> t(k);
        std::fisher_f_distribution<double> f(k, 4);
        std::weibull_distribution<double> w(k, 2);
        const std::string of = " " + std::to_string(k);
        REAL("chisq" + of, "half-line:0," + std::to_string(k), gsl_ran_chisq(r, k), gsl_ran_chisq_pdf(x, k));
        REAL("tdist" + of, "real", gsl_ran_tdist(r, k), gsl_ran_tdist_pdf(x, k));
        REAL("fdist" + of, "half-line", gsl_ran_fdist(r, k, 4), gsl_ran_fdist_pdf(x, k, 4));
        REAL("weibull" + of, "half-line:0,2", gsl_ran_weibull(r, 2, k), gsl_ran_weibull_pdf(x, 2, k));
        REAL("pareto" + of, "half-line:1", gsl_ran_pareto(r, k, 1), gsl_ran_pareto_pdf(x, k, 1));
        REAL("beta" + of, "line", gsl_ran_beta(r, k, 5), gsl_ran_beta_pdf(x, k, 5));
        REAL("erlang" + of, "half-line:0," + std::to_string(k), gsl_ran_erlang(r, 1, k), gsl_ran_erlang_pdf(x, 1, k));
        REAL("gumbel2" + of, "half-line", gsl_ran_gumbel2(r, k, 1), gsl_ran_gumbel2_pdf(x, k, 1));
        REAL("std/chi_squared" + of, "half-line:0," + std::to_string(k), c(g), gsl_ran_chisq_pdf(x, k));
        REAL("std/student_t" + of, "real", t(g), gsl_ran_tdist_pdf(x, k));
        REAL("std/fisher_f" + of, "half-line", f(g), gsl_ran_fdist_pdf(x, k, 4));
        REAL("std/weibull" + of, "half-line:0,2", w(g), gsl_ran_weibull_pdf(x, 2, k));
    }
    std::normal_distribution<double> n; std::exponential_distribution<double> e; std::cauchy_distribution<double> y; std::lognormal_distribution<double> l;
    std::extreme_value_distribution<double> v; std::uniform_real_distribution<double> u(-1, 3);
    std::piecewise_linear_distribution<double> p({0.0, 1.0, 3.0}, [](double x) { return x; });
    REAL("std/normal", "real", n(g), gsl_ran_gaussian_pdf(x, 1));
    REAL("std/exponential", "half-line", e(g), gsl_ran_exponential_pdf(x, 1));
    REAL("std/cauchy", "real", y(g), gsl_ran_cauchy_pdf(x, 1));
    REAL("std/lognormal", "half-line", l(g), gsl_ran_lognormal_pdf(x, 0, 1));
    REAL("std/extreme_value", "real", v(g), gsl_ran_gumbel1_pdf(x, 1, 1));
    REAL("std/uniform_real", "interval:-1,3", u(g), gsl_ran_flat_pdf(x, -1, 3));
    REAL("exponential", "half-line", gsl_ran_exponential(r, 1), gsl_ran_exponential_pdf(x, 1));
    REAL("laplace", "real", gsl_ran_laplace(r, 1), gsl_ran_laplace_pdf(x, 1));
    REAL("cauchy", "real", gsl_ran_cauchy(r, 1), gsl_ran_cauchy_pdf(x, 1));
    REAL("rayleigh", "half-line", gsl_ran_rayleigh(r, 1), gsl_ran_rayleigh_pdf(x, 1));
    REAL("rayleigh_tail", "half-line:2", gsl_ran_rayleigh_tail(r, 2, 1), gsl_ran_rayleigh_tail_pdf(x, 2, 1));
    REAL("landau", "real", gsl_ran_landau(r), gsl_ran_landau_pdf(x));
    REAL("levy 1 (Cauchy)", "real", gsl_ran_levy(r, 1, 1), gsl_ran_cauchy_pdf(x, 1));
    REAL("levy 2 (normal)", "real", gsl_ran_levy(r, 1, 2), gsl_ran_gaussian_pdf(x, std::sqrt(2.0)));
    REAL("levy_skew 1 (Cauchy)", "real", gsl_ran_levy_skew(r, 1, 1, 0), gsl_ran_cauchy_pdf(x, 1));
    REAL("lognormal", "half-line", gsl_ran_lognormal(r, 0, 1), gsl_ran_lognormal_pdf(x, 0, 1));
    REAL("logistic", "real", gsl_ran_logistic(r, 1), gsl_ran_logistic_pdf(x, 1));
    REAL("gumbel1", "real", gsl_ran_gumbel1(r, 1, 1), gsl_ran_gumbel1_pdf(x, 1, 1));
    for (double m : {0.3, 9.9, 12.1, 400.0}) {
        std::poisson_distribution<int> d(m);
        REAL("poisson " + std::to_string(m), "discrete:2000", gsl_ran_poisson(r, m), gsl_ran_poisson_pdf(unsigned(x), m));
        REAL("std/poisson " + std::to_string(m), "discrete:2000", d(g), gsl_ran_poisson_pdf(unsigned(x), m));
    }
    for (int k : {10, 1000}) for (double q : {0.02, 0.3, 0.9}) {
        std::binomial_distribution<int> d(k, q);
        std::negative_binomial_distribution<int> b(k, 0.5 + q / 2);
        const std::string of = " " + std::to_string(k) + " " + std::to_string(q);
        REAL("binomial" + of, "discrete:1001", gsl_ran_binomial(r, q, k), gsl_ran_binomial_pdf(unsigned(x), q, k));
        REAL("std/binomial" + of, "discrete:1001", d(g), gsl_ran_binomial_pdf(unsigned(x), q, k));
        REAL("std/negative_binomial" + of, "discrete:4000", b(g), gsl_ran_negative_binomial_pdf(unsigned(x), 0.5 + q / 2, k));
        REAL("negative_binomial" + of, "discrete:4000", gsl_ran_negative_binomial(r, 0.5 + q / 2, k), gsl_ran_negative_binomial_pdf(unsigned(x), 0.5 + q / 2, k));
    }
    REAL("hypergeometric", "discrete:400", gsl_ran_hypergeometric(r, 300, 500, 399), gsl_ran_hypergeometric_pdf(unsigned(x), 300, 500, 399));
    REAL("geometric", "discrete:2000", gsl_ran_geometric(r, 0.05), gsl_ran_geometric_pdf(unsigned(x), 0.05));
    REAL("logarithmic", "discrete:2000", gsl_ran_logarithmic(r, 0.7), gsl_ran_logarithmic_pdf(unsigned(x), 0.7));
    if (asked == "list")
        for (const Case &c : all) printf("%s\t%s\n", c.name.c_str(), c.domain.c_str());
    if (argc > 3) scale = atof(argv[3]);
    for (const Case &c : all)
        if (c.name == asked) {
            now = &c;
            etalon_sampler s = {library.c_str(), c.domain.c_str(), 0, [](const double *, double *x) { return *x = scale * now->draw(), 1; }, [](const double *x) { return now->pdf(*x); }, 0,
                                [](unsigned long seed) { gsl_rng_set(r, seed); g.seed(seed); }, 0};
            return etalon_serve_sampler(&s);
        }
    return asked == "list" ? 0 : 2;
}

// std::binomial_distribution of libstdc++, counts against probabilities, and its bound: g++ -O2 libstdcxx.cpp -o binomial && ./binomial
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

static double log_probability(int n, double p, int k) {
    return std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) + k * std::log(p) + (n - k) * std::log1p(-p);
}

// Pearson's statistic over outcomes that are expected at least ten times
static void test(const char *name, int n, double p, const std::vector<long> &counts, double samples) {
    double square = 0, worst = 0;
    int cells = 0, at = 0;
    for (int k = 0; k <= n; k++) {
        const double expected = samples * std::exp(log_probability(n, p, k)), off = (counts[k] - expected) / std::sqrt(expected);
        if (expected < 10) continue;
        square += off * off;
        cells++;
        if (std::fabs(off) > std::fabs(worst)) worst = off, at = k;
    }
    printf("%s(%d, %g), %g samples: chi-square %.1f of %d cells; most off is outcome %d: %.1f standard deviations, %+.2f %%\n", name, n, p, samples, square, cells, at, worst,
           100 * (counts[at] / (samples * std::exp(log_probability(n, p, at))) - 1));
}

// Below the mode m = np the proposal is a half-normal variate of width s2, rounded down: outcome m - y needs a probability of at most exp(-y²/2 s2²) of that of m
static void bound(int n, double p) {
    const double m = std::floor(n * p), q = 1 - m / n, d2 = std::round(std::sqrt(m * q * std::log(128 * n * q / (M_PI * m / n))));
    const double s2 = std::sqrt(m * q) * (1 + d2 / (4 * n * q));
    for (int y = 1; y <= d2; y++) {
        const double excess = log_probability(n, m / n, int(m) - y) - log_probability(n, m / n, int(m)) + y * y / (2 * s2 * s2);
        if (excess > 1e-9) printf("  outcome %d has an acceptance probability of %.4f\n", int(m) - y, std::exp(excess));
    }
}

int main() {
    const struct { int n; double p; long samples; } cases[] = {{1000, 0.02, 20000000}, {1000, 0.1, 20000000}, {50, 0.2, 5000000}, {1000, 0.007, 5000000}, {10, 0.3, 5000000}};
    for (const auto &c : cases) {
        std::mt19937_64 g(7);
        std::binomial_distribution<int> binomial(c.n, c.p);
        std::vector<long> counts(c.n + 1), sums(c.n + 1);
        for (long i = 0; i < c.samples; i++) counts[binomial(g)]++;
        test("std::binomial", c.n, c.p, counts, c.samples);
        if (c.n * c.p >= 8) bound(c.n, c.p);
        // The control: the sum of independent trials
        for (long i = 0; i < c.samples && c.n <= 50; i++) {
            int sum = 0;
            for (int j = 0; j < c.n; j++) sum += std::generate_canonical<double, 53>(g) < c.p;
            sums[sum]++;
        }
        if (c.n <= 50) test("  sum of trials", c.n, c.p, sums, c.samples);
    }
}

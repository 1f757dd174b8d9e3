"""Right samplers of many domains, each with a twin whose pdf is wrong, tested by `etalon validate FILE.py` with the default options.

    pip install numpy scipy
    python benches/domains.py [PATH_OF_ETALON [NAME ...]] [--seeds N]

A twin has the samples of one parameter and the pdf of another. The size of its fault is the root mean square of the relative error of
the pdf; the parameter is moved until that is 1.5 times the error that the test of the right sampler says it detects.
The detectable error is one of the cells' averages: the twin of `thin-ring` is wrong within them only, and is not found.
"""
import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile

import numpy as np
from scipy import special, stats

PI, TAU = np.pi, 2 * np.pi
normal = lambda u: special.ndtri(np.clip(u, 1e-300, 1 - 2**-53))  # of 0 and 1, too: an infinity times 0 is no number
SAMPLERS = {}  # by name: the domain or the functions of a chart, random numbers of a sample, the parameter, and the family


def sampler(name, domain, dimension, parameter):
    """Registers a function from a parameter to sample and pdf. Weights have a target in place of the pdf."""
    return lambda family: SAMPLERS.setdefault(name, (domain, dimension, parameter, family))


def one_variable(name, domain, parameter, distribution):
    """A distribution of SciPy as it is."""
    sampler(name, domain, 1, parameter)(lambda t: (distribution(t).ppf, distribution(t).pdf))


one_variable("arcsine", "interval:-2,3", 0.5, lambda a: stats.beta(a, 0.5, -2, 5))
one_variable("beta-of-two-poles", "line", 0.3, lambda a: stats.beta(a, 0.4))
one_variable("beta-of-zero-ends", "interval:10,11", 6, lambda a: stats.beta(a, 9, 10))
one_variable("truncated-normal", "interval:-1,5", 0.3, lambda s: stats.truncnorm(-1 / s, 5 / s, 0, s))
one_variable("lomax", "half-line", 0.5, stats.lomax)
one_variable("pareto-from-1", "half-line:1", 1.2, stats.pareto)
one_variable("levy", "half-line", 1, lambda c: stats.levy(0, c))
one_variable("gamma-with-a-pole", "half-line", 0.2, stats.gamma)
one_variable("log-normal", "half-line", 3, stats.lognorm)
one_variable("weibull-downwards", "half-line:2,-1", 0.7, lambda k: stats.weibull_max(k, 2))
one_variable("burr", "half-line", 0.8, lambda d: stats.burr12(2, d))
one_variable("cauchy-elsewhere", "real", 7, stats.cauchy)
one_variable("student", "real", 0.7, stats.t)
one_variable("gumbel", "real:3,2", 2, lambda s: stats.gumbel_r(3, s))
one_variable("asymmetric-laplace", "real", 3, stats.laplace_asymmetric)
one_variable("double-weibull", "real", 0.6, stats.dweibull)


@sampler("uniform-with-a-gap", "interval:0,3", 1, 0.25)
def gap(t):
    def sample(u):
        return np.where(u < t, u / t, 2 + (u - t) / (1 - t))

    return sample, lambda x: np.where(x < 1, t, np.where(x > 2, 1 - t, 0))


@sampler("narrow-peaks", "real", 2, 0.01)
def peaks(t):
    places, widths, shares = np.array([-3, 0, 40]), np.array([t, 1, 1e-4]), np.array([0.2, 0.5, 0.3])

    def sample(u):
        i = np.searchsorted(np.cumsum(shares), u[:, 1]).clip(0, 2)
        return places[i] + widths[i] * normal(u[:, 0])

    return sample, lambda x: (shares * stats.norm.pdf(np.reshape(x, (-1, 1)), places, widths)).sum(axis=1)


@sampler("voigt", "real", 2, 0.5)
def voigt(t):
    return lambda u: t * normal(u[:, 0]) + np.tan(PI * (u[:, 1] - 0.5)), lambda x: special.voigt_profile(x, t, 1)


def polar(r, u):
    return np.stack([r * np.cos(TAU * u), r * np.sin(TAU * u)], axis=1)


def direction(u, v):
    z = 2 * u - 1
    return np.column_stack([polar(np.sqrt(1 - z * z), v), z])


@sampler("plane-student", "plane", 2, 1.5)
def plane_student(t):
    """Of t degrees of freedom, with correlation."""

    def sample(u):
        x = polar(np.sqrt(t * np.expm1(-2 / t * np.log1p(-u[:, 0]))), u[:, 1])
        return np.stack([x[:, 0], 0.8 * x[:, 0] + 0.6 * x[:, 1]], axis=1)

    return sample, stats.multivariate_t([0, 0], [[1, 0.8], [0.8, 1]], t).pdf


@sampler("thin-ring", "plane", 2, 0.02)
def ring(t):
    radius = stats.norm(2, t)
    return lambda u: polar(radius.ppf(np.fmax(u[:, 0], 1e-300)), u[:, 1]), lambda x: radius.pdf(np.hypot(*x.T)) / (TAU * np.hypot(*x.T))


@sampler("banana", "plane:2", 2, 0.3)
def banana(t):
    def sample(u):
        x = normal(u[:, 0])
        return np.stack([x, x * x + t * normal(u[:, 1])], axis=1)

    return sample, lambda x: stats.norm.pdf(x[:, 0]) * stats.norm.pdf(x[:, 1], x[:, 0] ** 2, t)


def multivariate_normal(name, domain, n):
    """SciPy's, the standard deviations from 1 to the parameter, neighbours correlated."""

    def family(t):
        scale = np.geomspace(1, t, n)
        covariance = scale[:, None] * 0.5 ** abs(np.subtract.outer(range(n), range(n))) * scale
        root = np.linalg.cholesky(covariance)
        return lambda u: normal(u) @ root.T, stats.multivariate_normal(np.zeros(n), covariance).pdf

    sampler(name, domain, n, 2.0)(family)


# The whole space of n dimensions, by a normal distribution of each coordinate
SPACE = {
    "to_cube": lambda x: special.ndtr(x / 3),
    "from_cube": lambda u: 3 * normal(u),
    "jacobian": lambda u: np.prod(3 / stats.norm.pdf(normal(u)), axis=1),
}
multivariate_normal("normal-in-3d", "space", 3)
for n in (4, 5, 6):
    multivariate_normal(f"normal-in-{n}d", SPACE, n)


@sampler("space-student", "space", 4, 2.0)
def space_student(t):
    shape = np.diag([1, 4, 0.25])
    return lambda u: normal(u[:, :3]) * [1, 2, 0.5] / np.sqrt(special.chdtri(t, np.fmax(u[:, 3:], 1e-300)) / t), stats.multivariate_t(np.zeros(3), shape, t).pdf


@sampler("disk-zero-at-rim", "disk:1.5", 2, 3)
def rim(t):
    return lambda u: polar(1.5 * np.sqrt(1 - u[:, 0] ** (1 / t)), u[:, 1]), lambda x: t / (PI * 2.25) * (1 - (x**2).sum(axis=1) / 2.25) ** (t - 1)


@sampler("disk-pole", "disk", 2, 0.5)
def disk_pole(t):
    return lambda u: polar(u[:, 0] ** (1 / t), u[:, 1]), lambda x: t / TAU * np.hypot(*x.T) ** (t - 2)


def inverse_cdf(density, x):
    """The inverse of the distribution function, from a table."""
    p = density(x)
    below = np.concatenate([[0], np.cumsum(p[1:] + p[:-1])])
    return lambda u: np.interp(u, below / below[-1], x)


CORNERS = np.array([[1, 0, 0], [0, 2, 0], [0, 0, 3.0]])


def dirichlet(alpha, u):
    """Weights of sum 1 by a gamma variate for each."""
    g = special.gammaincinv(alpha, u) + 1e-300
    return g / g.sum(axis=1, keepdims=True)


@sampler("triangle-in-space", "triangle:1,0,0,0,2,0,0,0,3", 3, 2)
def triangle_in_space(t):
    alpha, area = [1, 1, t], 0.5 * np.linalg.norm(np.cross(CORNERS[1] - CORNERS[0], CORNERS[2] - CORNERS[0]))
    return lambda u: dirichlet(alpha, u) @ CORNERS, lambda x: t * (t + 1) / (2 * area) * (x[:, 2] / 3) ** (t - 1)


@sampler("triangle-warped", "triangle", 2, 3)
def triangle(t):
    def sample(u):
        b = 1 - (1 - u[:, 0]) ** (1 / (t + 1))
        return np.stack([b, (1 - b) * u[:, 1] ** 2], axis=1)

    return sample, lambda b: (t + 1) * (1 - b[:, 0]) ** t / (2 * np.sqrt(b[:, 1] * (1 - b[:, 0])))


def simplex(name, domain, alpha):
    def family(t):
        full = [t, *alpha]
        log = special.gammaln(sum(full)) - special.gammaln(full).sum()
        return lambda u: dirichlet(full, u), lambda b: np.exp(log + special.xlogy(np.array(full) - 1, b).sum(axis=1))

    sampler(name, domain, len(alpha) + 1, 2.0)(family)


simplex("dirichlet-of-3", "simplex", [3, 1.5])
simplex("dirichlet-of-3-with-poles", "simplex", [0.5, 0.5])
simplex("dirichlet-of-4", "simplex:4", [1, 3, 2])
simplex("dirichlet-of-5", "simplex:5", [1.5, 1, 1, 4])


@sampler("clayton-copula", "box:0,1,0,1", 2, 2)
def clayton(t):
    def sample(u):
        x, v = np.fmax(u, 1e-30).T  # of 0 an infinity times 0 is no number
        return np.stack([x, (1 + x**-t * (v ** (-t / (1 + t)) - 1)) ** (-1 / t)], axis=1)

    return sample, lambda x: (1 + t) * np.prod(x, axis=1) ** (-1 - t) * (x[:, 0] ** -t + x[:, 1] ** -t - 1) ** (-2 - 1 / t)


def gaussian_copula(name, n):
    """On a box of sides 2: the first two variables correlated, the last of density x/2."""

    def family(t):
        s = np.sqrt(1 - t * t)

        def sample(u):
            y = u.copy()
            y[:, 1] = special.ndtr(t * normal(u[:, 0]) + s * normal(u[:, 1]))
            y[:, -1] = np.sqrt(u[:, -1])
            return 2 * y

        def pdf(x):
            a, b = normal(x[:, 0] / 2), normal(x[:, 1] / 2)
            return 0.5 ** (n - 1) * x[:, -1] / 2 / s * np.exp((2 * t * a * b - t * t * (a * a + b * b)) / (2 * s * s))

        return sample, pdf

    sampler(name, "box:" + ",".join(["0,2"] * n), n, 0.5)(family)


for n in (3, 4, 6):
    gaussian_copula(f"copula-in-{n}d", n)


@sampler("ball-towards-surface", "ball:2", 3, 5)
def ball(t):
    return lambda u: 2 * u[:, :1] ** (1 / t) * direction(u[:, 1], u[:, 2]), lambda x: t / (4 * PI * 2**t) * np.linalg.norm(x, axis=1) ** (t - 3)


@sampler("ball-cosine", "ball", 3, 0.5)
def ball_cosine(t):
    """Linear in the cosine to an axis."""

    def sample(u):
        cos = (np.sqrt((1 - t) ** 2 + 4 * t * u[:, 1]) - 1) / t
        return np.cbrt(u[:, :1]) * direction((cos + 1) / 2, u[:, 2])

    return sample, lambda x: 0.75 / PI * (1 + t * x[:, 2] / np.fmax(np.linalg.norm(x, axis=1), 1e-300))


@sampler("von-mises", "circle", 1, 4)
def von_mises(t):
    turns = inverse_cdf(lambda x: np.exp(t * (np.cos(TAU * x) - 1)), np.linspace(-0.5, 0.5, 1 << 16))
    return lambda u: polar(1, turns(u.ravel())), lambda x: np.exp(t * (x[:, 0] - 1)) / (TAU * special.i0e(t))


@sampler("wrapped-cauchy", "circle", 1, 0.9)
def wrapped_cauchy(t):
    def sample(u):
        return polar(1, np.arctan((1 - t) / (1 + t) * np.tan(PI * (u.ravel() - 0.5))) / PI)

    return sample, lambda x: (1 - t * t) / (TAU * (1 + t * t - 2 * t * x[:, 0]))


@sampler("central-gaussian-rotations", "rotations", 4, 3.0)
def central_gaussian(t):
    """Normal quaternions over their length (Tyler 1987)."""
    scale = np.array([1, 1, 0.5, t])

    def sample(u):
        q = normal(u) * scale + 1e-100  # has a length for u = ½, too
        return q / np.linalg.norm(q, axis=1, keepdims=True)

    return sample, lambda q: ((q / scale) ** 2).sum(axis=1) ** -2 / np.prod(scale)


@sampler("matrix-fisher", "rotations", 3, 2.0)
def matrix_fisher(t):
    """exp(2 t cos ω) of the angle ω; uniform axes."""
    angle = inverse_cdf(lambda x: (1 - np.cos(x)) * np.exp(2 * t * (np.cos(x) - 1)), np.linspace(0, PI, 1 << 16))

    def sample(u):
        half = 0.5 * angle(u[:, :1])
        return np.column_stack([np.sin(half) * direction(u[:, 1], u[:, 2]), np.cos(half)])

    scale = special.i0e(2 * t) - special.i1e(2 * t)
    return sample, lambda q: np.exp(2 * t * (2 * q[:, 3] ** 2 - 2)) / scale


@sampler("binomial", "discrete:41", 1, 0.3)
def binomial(t):
    return lambda u: stats.binom(40, t).ppf(u).clip(0), stats.binom(40, t).pmf


@sampler("points-on-a-mesh", "20*triangle", 3, 0.1)
def mesh(t):
    share = (1 + t * np.arange(20)) / (1 + t * np.arange(20)).sum()

    def sample(u):
        root = np.sqrt(u[:, 1])
        return np.stack([np.searchsorted(np.cumsum(share), u[:, 0]).clip(0, 19), 1 - root, u[:, 2] * root], axis=1)

    return sample, lambda x: 2 * share[x[:, 0].astype(int)]


@sampler("states-and-times", "3*half-line", 2, 5.0)
def states(t):
    share, rate = np.array([0.2, 0.3, 0.5]), np.array([0.1, 1, t])

    def sample(u):
        i = np.searchsorted(np.cumsum(share), u[:, 0]).clip(0, 2)
        return np.stack([i, -np.log1p(-u[:, 1]) / rate[i]], axis=1)

    def pdf(i, x):
        i = i.astype(int)
        return share[i] * rate[i] * np.exp(-rate[i] * x)

    return sample, pdf


# A torus, by its two angles
TORUS = {
    "to_cube": lambda x: np.stack([np.arctan2(x[:, 1], x[:, 0]), np.arctan2(x[:, 2], np.hypot(x[:, 0], x[:, 1]) - 2)], axis=1) / TAU % 1,
    "from_cube": lambda u: torus_point(u[:, 0], u[:, 1]),
    "jacobian": lambda u: TAU**2 * (2 + np.cos(TAU * u[:, 1])),
}


def torus_point(u, v):
    return np.column_stack([polar(2 + np.cos(TAU * v), u), np.sin(TAU * v)])


@sampler("torus", TORUS, 2, 1.0)
def torus(t):
    """Density in proportion to exp(t cos φ), uniform in the angle θ of the tube."""

    def pdf(x):
        rho = np.hypot(x[:, 0], x[:, 1])
        return np.exp(t * x[:, 0] / rho) / (TAU**2 * special.i0(t) * rho)

    turns = inverse_cdf(lambda x: np.exp(t * np.cos(TAU * x)), np.linspace(-0.5, 0.5, 1 << 16))
    return lambda u: torus_point(turns(u[:, 0]), u[:, 1]), pdf


# A patch of a cone of half-angle 30°, by the distance from its tip and the angle
CONE = {
    "to_cube": lambda x: np.stack([np.linalg.norm(x, axis=1), np.arctan2(x[:, 1], x[:, 0]) / PI], axis=1),
    "from_cube": lambda u: np.column_stack([polar(0.5 * u[:, 0], u[:, 1] / 2), np.sqrt(0.75) * u[:, 0]]),
    "jacobian": lambda u: PI / 2 * u[:, 0],
}


@sampler("cone", CONE, 2, 4.0)
def cone(t):
    return lambda u: CONE["from_cube"](np.stack([u[:, 0] ** (1 / t), u[:, 1]], axis=1)), lambda x: 2 * t / PI * np.linalg.norm(x, axis=1) ** (t - 2)


def resampled(name, domain, candidates, point, importance):
    """A weighted reservoir of uniform candidates, and W. A twin's target is not 1 but grows along the importance."""
    count, width = candidates

    def family(t):
        def sample(u):
            u = u.reshape(-1, count, width + 1)
            x = point(u[..., :width].reshape(-1, width))
            weight = importance(x).reshape(-1, count)
            below = np.cumsum(weight, axis=1)
            keep = u[..., -1] * below < weight
            chosen = count - 1 - np.argmax(keep[:, ::-1], axis=1)
            rows = np.arange(len(u))
            return x.reshape(len(u), count, -1)[rows, chosen], below[:, -1] / (count * weight[rows, chosen]) * MEASURES[name]

        return sample, lambda x: np.exp(t * importance(x))

    sampler(name, domain, count * (width + 1), 0.0)(family)


MEASURES = {"resampled-disk": PI, "resampled-mesh": 4.0, "resampled-ball": 4 * PI / 3}
resampled("resampled-disk", "disk", (6, 2), lambda u: polar(np.sqrt(u[:, 0]), u[:, 1]), lambda x: 0.2 + x[:, 0] ** 2)
resampled("resampled-ball", "ball", (4, 3), lambda u: np.cbrt(u[:, :1]) * direction(u[:, 1], u[:, 2]), lambda x: 1.5 + x[:, 2])


def mesh_point(u):
    root = np.sqrt(u[:, 1])
    return np.stack([np.floor(8 * u[:, 0]), 1 - root, u[:, 2] * root], axis=1)


resampled("resampled-mesh", "8*triangle", (5, 3), mesh_point, lambda x: 1 + 0.2 * x[:, 0] + x[:, 1])


def functions_of(name, parameter):
    """The sampler with the pdf of this parameter, as the variables of a file for `etalon validate`."""
    domain, dimension, right, family = SAMPLERS[name]
    sample, pdf = family(right)[0], family(float(parameter))[1]
    is_weighted = name in MEASURES
    place = domain if isinstance(domain, dict) else {"domain": domain}
    return {"sample": sample, "target" if is_weighted else "pdf": pdf, "dimension": dimension, **place}


def error_of(name, parameter):
    """The root mean square of the relative error of the pdf that belongs to this parameter."""
    _, dimension, right, family = SAMPLERS[name]
    u = np.random.default_rng(1).random((1 << 16, dimension))
    (sample, pdf), (_, other) = family(right), family(parameter)
    x = sample(u[:, 0] if dimension == 1 else u)
    x, weight = x if name in MEASURES else (x, 1)
    columns = x.T if name == "states-and-times" else [x]
    return np.sqrt(np.average((other(*columns) / pdf(*columns) - 1) ** 2, weights=np.broadcast_to(weight, len(x))))


def parameter_of(name, error):
    """The parameter whose pdf is wrong by this error, which is about in proportion to the step away from the right one."""
    right = SAMPLERS[name][2]
    step = 0.02 * (abs(right) or 1)
    for _ in range(4):
        step *= error / error_of(name, right + step)
    return right + step


def run(program, name, parameter, seed):
    """The result of a test, or the message of an error, and the user time in seconds."""
    with tempfile.TemporaryDirectory() as folder:
        with open(f"{folder}/{name}.py", "w") as file:
            file.write(f"import sys\nsys.path.append({os.path.dirname(os.path.abspath(__file__))!r})\n")
            file.write(f"import domains, numpy\nglobals().update(domains.functions_of({name!r}, {parameter!r}))\n")
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        command = [program, "validate", f"{folder}/{name}.py", "--seed", str(seed), "--json", "-o", folder]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    if done.returncode == 2 or not done.stdout:
        return {"verdict": "error", "p": np.nan, "detectable": np.nan, "reason": done.stderr.strip()[-300:]}, seconds
    test = json.loads(done.stdout)["tests"][0]
    reason = test["violation"] or test["inconclusive_reason"] or test["named"] or ""
    return {**{key: test[key] for key in ("verdict", "p", "detectable")}, "reason": reason}, seconds


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("program", nargs="?", default="etalon")
    arguments.add_argument("names", nargs="*")
    arguments.add_argument("--seeds", type=int, default=4)
    arguments = arguments.parse_args()
    print(f"{'sampler':<28}{'domain':<28}{'right':<24}{'least p':>8}{'detects':>9}{'twin':>8}  found   CPU s")
    for name in arguments.names or SAMPLERS:
        domain, _, right, _ = SAMPLERS[name]
        seeds = range(1, arguments.seeds + 1)
        tests = [run(arguments.program, name, float(right), seed) for seed in seeds]
        verdicts = [test["verdict"] for test, _ in tests]
        detectable = max(test["detectable"] or np.nan for test, _ in tests)
        p = min(np.nan if test["p"] is None else test["p"] for test, _ in tests)
        told = ", ".join(f"{verdicts.count(v)} {v}" for v in dict.fromkeys(verdicts))
        shown = domain if isinstance(domain, str) else "a chart of its own"
        print(f"{name:<28}{shown[:26]:<28}{told:<24}{p:>8.4f}{detectable:>9.2%}", end="", flush=True)
        wrong, twins = np.nan, []
        if detectable == detectable:
            parameter = parameter_of(name, 1.5 * detectable)
            wrong = error_of(name, parameter)
            twins = [run(arguments.program, name, float(parameter), seed)[0] for seed in seeds]
        found = sum(test["verdict"] == "reject" for test in twins)
        print(f"{wrong:>8.2%}{found:>4} of {len(twins)}{max(seconds for _, seconds in tests):>8.1f}", flush=True)
        for kind, results in (("right", [test for test, _ in tests]), ("twin", twins)):
            unexpected = "accept" if kind == "right" else "reject"
            for seed, test in zip(seeds, results):
                if test["verdict"] != unexpected:
                    print(f"    {kind}, seed {seed}: {test['verdict']}, p = {test['p']}: {test['reason']}", flush=True)


if __name__ == "__main__":
    main()

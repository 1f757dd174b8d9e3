//! Distributions of rand_distr in the protocol of `etalon validate --exec`; densities are those of statrs, or are written here.
//!
//!     client list             names and domains
//!     client NAME [SCALE]     serves one, samples multiplied by SCALE

use std::io::{self, BufRead, Write};

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr as r;
use rand_distr::Distribution;
use statrs::distribution::{self as s, Continuous, Discrete};
use statrs::function::gamma::ln_gamma;

// What is called otherwise in rand_distr 0.4, which packages/rand_distr-0.4.3.toml asks for by the feature
#[cfg(feature = "old")]
mod api {
    pub use rand_distr::weighted_alias::WeightedAliasIndex;
    pub fn pert(low: f64, high: f64, mode: f64) -> rand_distr::Pert<f64> {
        rand_distr::Pert::new(low, high, mode).unwrap()
    }
    pub fn zipf(n: f64, a: f64) -> rand_distr::Zipf<f64> {
        rand_distr::Zipf::new(n as u64, a).unwrap()
    }
}

#[cfg(not(feature = "old"))]
mod api {
    pub use rand_distr::weighted::WeightedAliasIndex;
    pub fn pert(low: f64, high: f64, mode: f64) -> rand_distr::Pert<f64> {
        rand_distr::Pert::new(low, high).with_mode(mode).unwrap()
    }
    pub fn zipf(n: f64, a: f64) -> rand_distr::Zipf<f64> {
        rand_distr::Zipf::new(n, a).unwrap()
    }
}

struct Case {
    name: String,
    domain: String,
    draw: Box<dyn Fn(&mut ChaCha8Rng) -> f64>,
    pdf: Box<dyn Fn(f64) -> f64>,
}

fn cases() -> Vec<Case> {
    let mut all = vec![];
    // A distribution of rand_distr, and the density at x
    macro_rules! case {
        ($name:expr, $domain:expr, $law:expr, |$x:ident| $pdf:expr) => {{
            let law = $law;
            let (name, domain) = ($name.to_string(), $domain.to_string());
            all.push(Case { name, domain, draw: Box::new(move |rng| law.sample(rng) as f64), pdf: Box::new(move |$x: f64| $pdf) });
        }};
    }
    let normal = |x: f64| (-x * x / 2.0).exp() / (2.0 * std::f64::consts::PI).sqrt();
    case!("StandardNormal", "real", r::Normal::new(0.0, 1.0).unwrap(), |x| normal(x));
    case!("Normal(1000, 0.1)", "real:1000,0.1", r::Normal::new(1000.0, 0.1).unwrap(), |x| normal((x - 1000.0) / 0.1) / 0.1);
    for d in [0.2, 2.0] {
        let law = s::LogNormal::new(0.0, d).unwrap();
        case!(format!("LogNormal(0, {d})"), "half-line", r::LogNormal::new(0.0, d).unwrap(), |x| law.pdf(x));
    }
    for a in [-20.0, 0.5, 3.0] {
        case!(format!("SkewNormal(0, 1, {a})"), "real", r::SkewNormal::new(0.0, 1.0, a).unwrap(), |x| {
            normal(x) * statrs::function::erf::erfc(-a * x / 2f64.sqrt())
        });
    }
    for l in [1.0, 1e-4] {
        case!(format!("Exp({l})"), format!("half-line:0,{}", 1.0 / l), r::Exp::new(l).unwrap(), |x| l * (-l * x).exp());
    }
    for (k, t) in [(0.1, 1.0), (0.9, 2.0), (1.0, 1.0), (3.0, 0.2), (1000.0, 1.0)] {
        let law = s::Gamma::new(k, 1.0 / t).unwrap();
        case!(format!("Gamma({k}, {t})"), format!("half-line:0,{}", k * t), r::Gamma::new(k, t).unwrap(), |x| law.pdf(x));
    }
    for k in [0.5, 1.0, 3.0, 60.0] {
        let law = s::ChiSquared::new(k).unwrap();
        case!(format!("ChiSquared({k})"), format!("half-line:0,{k}"), r::ChiSquared::new(k).unwrap(), |x| law.pdf(x));
    }
    for (m, n) in [(3.0, 5.0), (0.8, 2.0), (50.0, 80.0)] {
        let law = s::FisherSnedecor::new(m, n).unwrap();
        case!(format!("FisherF({m}, {n})"), "half-line", r::FisherF::new(m, n).unwrap(), |x| law.pdf(x));
    }
    for n in [0.7, 3.0, 100.0] {
        let law = s::StudentsT::new(0.0, 1.0, n).unwrap();
        case!(format!("StudentT({n})"), "real", r::StudentT::new(n).unwrap(), |x| law.pdf(x));
    }
    for (a, b) in [(0.5, 0.5), (2.0, 5.0), (0.3, 8.0), (1.0, 1.0), (200.0, 300.0)] {
        let law = s::Beta::new(a, b).unwrap();
        case!(format!("Beta({a}, {b})"), "line", r::Beta::new(a, b).unwrap(), |x| law.pdf(x));
    }
    for (m, w) in [(0.0, 1.0), (100.0, 0.1)] {
        let law = s::Cauchy::new(m, w).unwrap();
        case!(format!("Cauchy({m}, {w})"), format!("real:{m},{w}"), r::Cauchy::new(m, w).unwrap(), |x| law.pdf(x));
    }
    for (m, w, a) in [(0.0, 1.0, 2.0), (-1.0, 3.0, 0.5)] {
        case!(format!("Frechet({m}, {w}, {a})"), format!("half-line:{m},{w}"), r::Frechet::new(m, w, a).unwrap(), |x| {
            let z = ((x - m) / w).max(f64::MIN_POSITIVE);
            (a / w) * (-(1.0 + a) * z.ln() - z.powf(-a)).exp()
        });
    }
    for (m, w) in [(0.0, 1.0), (5.0, 0.2)] {
        let law = s::Gumbel::new(m, w).unwrap();
        case!(format!("Gumbel({m}, {w})"), format!("real:{m},{w}"), r::Gumbel::new(m, w).unwrap(), |x| law.pdf(x));
    }
    for (m, l) in [(1.0, 1.0), (3.0, 0.5), (0.1, 40.0)] {
        case!(format!("InverseGaussian({m}, {l})"), format!("half-line:0,{m}"), r::InverseGaussian::new(m, l).unwrap(), |x| {
            if x > 0.0 { (l / (2.0 * std::f64::consts::PI * x.powi(3))).sqrt() * (-l * (x - m).powi(2) / (2.0 * m * m * x)).exp() } else { 0.0 }
        });
    }
    for (m, a) in [(1.0, 0.5), (2.0, 4.0)] {
        let law = s::Pareto::new(m, a).unwrap();
        case!(format!("Pareto({m}, {a})"), format!("half-line:{m},{m}"), r::Pareto::new(m, a).unwrap(), |x| law.pdf(x));
    }
    for (low, high, mode) in [(0.0, 5.0, 2.5), (-1.0, 3.0, 2.9), (0.1, 0.7, 0.4)] {
        let (a, b) = (1.0 + 4.0 * (mode - low) / (high - low), 1.0 + 4.0 * (high - mode) / (high - low));
        let law = s::Beta::new(a, b).unwrap();
        case!(format!("Pert({low}, {high}, {mode})"), format!("interval:{low},{high}"), api::pert(low, high, mode), |x| {
            law.pdf((x - low) / (high - low)) / (high - low)
        });
    }
    for (low, high, mode) in [(-1.0, 3.0, 0.0), (0.0, 1.0, 0.0), (0.0, 1.0, 1.0)] {
        let law = s::Triangular::new(low, high, mode).unwrap();
        case!(format!("Triangular({low}, {high}, {mode})"), format!("interval:{low},{high}"), r::Triangular::new(low, high, mode).unwrap(), |x| law.pdf(x));
    }
    for (w, k) in [(1.0, 0.4), (2.0, 1.0), (2.0, 5.0)] {
        let law = s::Weibull::new(k, w).unwrap();
        case!(format!("Weibull({w}, {k})"), format!("half-line:0,{w}"), r::Weibull::new(w, k).unwrap(), |x| law.pdf(x));
    }
    for (n, p) in [(10, 0.3), (1000, 0.02), (1000, 0.5), (1000, 0.7), (1000, 0.99)] {
        let law = s::Binomial::new(p, n).unwrap();
        case!(format!("Binomial({n}, {p})"), format!("discrete:{}", n + 1), r::Binomial::new(n, p).unwrap(), |x| law.pmf(x as u64));
    }
    for p in [0.05, 0.3, 0.9] {
        case!(format!("Geometric({p})"), "discrete:2000", r::Geometric::new(p).unwrap(), |x| p * (1.0 - p).powf(x));
    }
    case!("StandardGeometric", "discrete:64", r::StandardGeometric, |x| 0.5f64.powf(x + 1.0));
    for (total, good, n) in [(60, 20, 15), (100, 50, 49), (800, 300, 399), (5000, 2000, 400)] {
        // By logarithms: the binomials of 5000 are beyond f64
        let ln_binomial = |n: u64, k: f64| ln_gamma(n as f64 + 1.0) - ln_gamma(k + 1.0) - ln_gamma(n as f64 - k + 1.0);
        let (bad, of_all) = (total - good, ln_binomial(total, n as f64));
        let pmf = move |x: f64| {
            let others = n as f64 - x;
            if x > good as f64 || others > bad as f64 { 0.0 } else { (ln_binomial(good, x) + ln_binomial(bad, others) - of_all).exp() }
        };
        case!(format!("Hypergeometric({total}, {good}, {n})"), format!("discrete:{}", n + 1), r::Hypergeometric::new(total, good, n).unwrap(), |x| pmf(x));
    }
    for m in [0.3, 9.9, 12.1, 400.0, 3000.0] {
        case!(format!("Poisson({m})"), "discrete:5000", r::Poisson::new(m).unwrap(), |x| (x * f64::ln(m) - m - ln_gamma(x + 1.0)).exp());
    }
    // Its skewness is 10⁻⁸, so that the normal law stands for it
    case!("Poisson(1e16)", "real:1e16,1e8", r::Poisson::new(1e16).unwrap(), |x| normal((x - 1e16) / 1e8) / 1e8);
    for (n, a) in [(10.0, 1.0), (300.0, 0.5), (50.0, 3.0)] {
        let sum: f64 = (1..=n as u32).map(|k| f64::from(k).powf(-a)).sum();
        case!(format!("Zipf({n}, {a})"), format!("discrete:{}", n + 1.0), api::zipf(n, a), |x| if x < 1.0 { 0.0 } else { x.powf(-a) / sum });
    }
    for (a, zeta) in [(4.0, std::f64::consts::PI.powi(4) / 90.0), (8.0, std::f64::consts::PI.powi(8) / 9450.0)] {
        case!(format!("Zeta({a})"), "discrete:100000", r::Zeta::new(a).unwrap(), |x| if x < 1.0 { 0.0 } else { x.powf(-a) / zeta });
    }
    let weights = [1.0, 0.0, 3.0, 7.0, 1e-3, 12.0];
    let law = api::WeightedAliasIndex::new(weights.to_vec()).unwrap();
    case!("WeightedAliasIndex", "discrete:6", law, |x| weights[x as usize] / 23.001);
    all
}

fn main() -> io::Result<()> {
    let all = cases();
    let asked = std::env::args().nth(1).unwrap_or_default();
    let scale: f64 = std::env::args().nth(2).map_or(1.0, |scale| scale.parse().expect("a number"));
    if asked == "list" {
        all.iter().for_each(|case| println!("{}\t{}", case.name, case.domain));
        return Ok(());
    }
    let case = all.iter().find(|case| case.name == asked).ok_or_else(|| io::Error::other(format!("no distribution {asked}")))?;
    let (mut lines, mut out) = (io::stdin().lock().lines(), io::BufWriter::new(io::stdout().lock()));
    while let Some(line) = lines.next().transpose()? {
        let words: Vec<&str> = line.split(' ').collect();
        let number = |i: usize| words[i].parse::<u64>().map_err(io::Error::other);
        match words[0] {
            "etalon" => writeln!(out, "etalon 1 name=rand_distr dimension=0 domain={}", case.domain)?,
            "sample" => {
                let mut rng = ChaCha8Rng::seed_from_u64(number(2)?);
                for _ in 0..number(1)? {
                    writeln!(out, "{}", scale * (case.draw)(&mut rng))?;
                }
            }
            "pdf" => {
                for x in lines.by_ref().take(number(1)? as usize) {
                    writeln!(out, "{}", (case.pdf)(x?.parse().map_err(io::Error::other)?))?;
                }
            }
            _ => break,
        }
        writeln!(out, "end")?;
        out.flush()?;
    }
    Ok(())
}

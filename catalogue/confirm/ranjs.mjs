// ranjs 1.24.5: what findings/ranjs.toml says, by the formulas of the laws: cd catalogue/.env/ranjs && node ../../confirm/ranjs.mjs
import { createRequire } from 'node:module'

const { dist } = createRequire(process.cwd() + '/')('ranjs')
const sum = (n, f) => Array.from({ length: n }, (_, i) => f(i)).reduce((all, x) => all + x, 0)
const integral = (f, a, b, n = 50000) => sum(n, i => f(a + (b - a) * (i + 0.5) / n)) * (b - a) / n
const row = (name, at, found, right) => console.log(`${name}(${at}): ${found}, right ${right}`)

// The form of the pdf that converges for small x, by Jacobi's identity
const kolmogorov = x => Math.sqrt(2 * Math.PI) * sum(60, k => {
  const a = ((2 * k + 1) * Math.PI) ** 2 / 8
  return Math.exp(-a / x ** 2) * (2 * a / x ** 4 - x ** -2)
})
const k = new dist.Kolmogorov()
for (const x of [0.001, 0.005, 0.1, 0.2, 0.5, 1]) row('Kolmogorov().pdf', x, k.pdf(x), kolmogorov(x))
console.log(`its integral from 0 to 0.1: ${integral(x => k.pdf(x), 0, 0.1).toFixed(6)}, from 0.1 to 5: ${integral(x => k.pdf(x), 0.1, 5).toFixed(6)}`)
row('Kolmogorov().cdf', 0.001, k.cdf(0.001), 0)

// Negative binomial (1, 1/2) and Poisson (1) convolved
const delaporte = n => {
  let poisson = Math.exp(-1)
  return sum(n + 1, i => (poisson *= i ? 1 / i : 1) * 0.5 ** (n - i + 1))
}
for (const n of [10, 196, 197, 250]) row('Delaporte().pdf', n, new dist.Delaporte().pdf(n), delaporte(n))

// The logarithm of an F variate of 1 and 1 degrees of freedom, halved
for (const x of [-400, -20.2, 17, 20.2, 300]) row('FisherZ().pdf', x, new dist.FisherZ().pdf(x), 1 / (Math.PI * Math.cosh(x)))

// (exp(x/2) - 1/2) exp(x/2 - 2 (exp(x/2) - 1))
for (const x of [5, 1000, 1500]) row('Muth().pdf', x, new dist.Muth().pdf(x), x > 100 ? 0 : (Math.exp(x / 2) - 0.5) * Math.exp(x / 2 - 2 * (Math.exp(x / 2) - 1)))

// x exp(-(x² + 1)/2) I0(x)
const bessel = x => integral(t => Math.exp(x * (Math.cos(t) - 1)), 0, Math.PI) / Math.PI
for (const x of [2, 10, 800, 3000]) row('NoncentralChi().pdf', x, new dist.NoncentralChi().pdf(x), x * Math.exp(-((x - 1) ** 2) / 2) * bessel(x))

// 1/(π x (1 + ln² x)), by logarithms: the largest double is exp(709.78)
const logarithm = x => -Math.log(Math.PI) - Math.log(x) - Math.log1p(Math.log(x) ** 2)
for (const x of [1e-300, 1e-314, 3e-315, 2e-315]) row('LogCauchy().pdf', x, new dist.LogCauchy().pdf(x), `exp(${logarithm(x).toFixed(2)})`)
console.log(`P(X < 3e-315) = ${(Math.atan(-1 / Math.log(3e-315)) / Math.PI).toExponential(2)}`)

const g = new dist.GeneralizedExtremeValue(4.6)
g.seed(1)
const drawn = g.sample(1000000)
console.log(`GeneralizedExtremeValue(4.6): ${drawn.filter(x => g.pdf(x) === Infinity).length} of 10⁶ samples have an infinite density, all at ${[...new Set(drawn.filter(x => g.pdf(x) === Infinity))]}, 1/4.6 = ${1 / 4.6}; P(1 - 4.6 x < 2⁻⁵⁴) = ${(1 - Math.exp(-(2 ** (-54 / 4.6)))).toExponential(2)}`)

const c = new dist.LogCauchy(0, 2.3)
c.seed(1)
const logarithms = c.sample(1000000).map(Math.log)
for (const t of [-300, -40, -1, 0, 1, 21.17, 36.8, 300]) {
  console.log(`LogCauchy(0, 2.3): ln X > ${t} for ${(logarithms.filter(x => x > t).length / 1e6).toFixed(4)} of the samples, right ${(0.5 - Math.atan(t / 2.3) / Math.PI).toFixed(4)}; pdf(exp(${t})) = ${c.pdf(Math.exp(t))}, right ${2.3 / (Math.PI * Math.exp(t) * (t ** 2 + 2.3 ** 2))}`)
}

// exp(-4.6) I_k(4.6), by the series
const skellam = k => {
  let term = Math.exp(-4.6)
  for (let i = 1; i <= Math.abs(k); i++) term *= 2.3 / i
  return sum(200, i => i ? (term *= 2.3 ** 2 / (i * (i + Math.abs(k)))) : term)
}
const s = new dist.Skellam(2.3, 2.3)
for (const k of [-30, -20, -12, -5, 0, 5, 12, 20, 30, 60]) row('Skellam(2.3, 2.3).pdf', k, s.pdf(k), skellam(k))
console.log(`its probabilities add up to ${sum(401, i => s.pdf(i - 200))}, right ${sum(401, i => skellam(i - 200))}`)

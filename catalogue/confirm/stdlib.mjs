// @stdlib/random-base 0.2.3, hypergeometric and binomial: what findings/stdlib.toml says: cd catalogue/.env/stdlib && node ../../confirm/stdlib.mjs
import { createRequire } from 'node:module'

const require = createRequire(process.cwd() + '/')
const hypergeometric = require('@stdlib/random-base').hypergeometric
const { pmf } = require('@stdlib/stats-base-dists').hypergeometric
for (const [N, K, n] of [[60, 20, 15], [170, 60, 40], [171, 60, 40], [5000, 2000, 400]]) {
  const draw = hypergeometric.factory(N, K, n, { seed: 7 })
  const all = Array.from({ length: 100000 }, () => draw())
  const mean = all.reduce((sum, x) => sum + x, 0) / all.length
  const variance = all.reduce((sum, x) => sum + (x - mean) ** 2, 0) / all.length
  let total = 0
  for (let k = 0; k <= n; k++) total += pmf(k, N, K, n)
  console.log(`hypergeometric(${N}, ${K}, ${n}): mean ${mean.toFixed(4)}, right ${n * K / N}; variance ${variance.toFixed(3)}, right ${(n * K / N * (1 - K / N) * (N - n) / (N - 1)).toFixed(3)}; ${all.filter(x => Number.isNaN(x)).length} NaN; the pmf adds up to ${total}; at its mean ${pmf(Math.round(n * K / N), N, K, n)}`)
}

const binomial = require('@stdlib/random-base').binomial
for (const [n, p] of [[10, 0.3], [200, 0.3], [1000, 0.02], [1000, 0.7]]) {
  const draw = binomial.factory(n, p, { seed: 7 })
  const all = Array.from({ length: 300000 }, () => draw())
  const mean = all.reduce((sum, x) => sum + x, 0) / all.length
  const variance = all.reduce((sum, x) => sum + (x - mean) ** 2, 0) / all.length
  console.log(`binomial(${n}, ${p}): mean ${mean.toFixed(3)} ± ${(Math.sqrt(variance / all.length)).toFixed(3)}, right ${n * p}; variance ${variance.toFixed(2)}, right ${(n * p * (1 - p)).toFixed(2)}`)
}

// The same with products that begin one factor later, as the recurrence p(i) / p(i - 1) = (n + 1) r / i - r has it
const { readFileSync } = require('node:fs')
const path = require.resolve('@stdlib/random-base-binomial').replace(/(lib|dist)\/index\.js$/, 'lib/sample2.js')
const source = readFileSync(path, 'utf8').replace('i = m; i <= k', 'i = m + 1; i <= k').replace('i = k; i <= m', 'i = k + 1; i <= m')
const mended = { exports: null }
new Function('require', 'module', source)(require('node:module').createRequire(path), mended)
const uniform = require('@stdlib/random-base').mt19937.factory({ seed: 7 }).normalized
for (const [n, p] of [[200, 0.3], [1000, 0.02]]) {
  const all = Array.from({ length: 300000 }, () => mended.exports(uniform, n, p))
  const mean = all.reduce((sum, x) => sum + x, 0) / all.length
  console.log(`binomial(${n}, ${p}), products mended: mean ${mean.toFixed(3)}, variance ${(all.reduce((sum, x) => sum + (x - mean) ** 2, 0) / all.length).toFixed(2)}`)
}

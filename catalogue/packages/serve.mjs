// Distributions of ranjs and of stdlib in the protocol of `etalon validate --exec`.
//   node serve.mjs LIBRARY list                          names, such as Normal(0, 1), and domains
//   node serve.mjs LIBRARY 'NAME(PARAMETERS)' [SCALE]    serves one, samples multiplied by SCALE
import { createRequire } from 'node:module'
import { createInterface } from 'node:readline'

const require = createRequire(process.cwd() + '/')
// What draws from Math.random, in searches for a root, is made repeatable.
let state = 1
Math.random = () => (state = (state * 48271) % 2147483647) / 2147483647

const libraries = {
  ranjs () {
    const { dist } = require('ranjs')
    const make = (name, parameters) => {
      const d = new dist[name](...parameters)
      const [low, high] = d.support().map(end => end.value)
      return { seed: s => d.seed(s), draw: () => d.sample(), pdf: x => d.pdf(x), low, high, discrete: d.type() === 'discrete' }
    }
    const list = () => Object.keys(dist).filter(name => !['InvalidDiscrete', 'Degenerate'].includes(name)).flatMap(name => {
      // The default parameters, and others, all 2.3 times as large, where that is allowed.
      const usual = Object.values(new dist[name]().p).filter(x => typeof x === 'number')
      const variants = [usual.map(x => +(x * 2.3).toFixed(6))].filter(parameters => {
        try {
          const kept = Object.values(new dist[name](...parameters).p)
          return usual.some(x => x !== 0) && parameters.every((x, i) => kept[i] === x)
        } catch { return false }
      })
      return [[], ...variants].map(parameters => [name, parameters])
    })
    return { make, list }
  },
  stdlib () {
    // Of one distribution alone, as all of them take seconds to load
    const kebab = name => name.replace(/[A-Z]/g, letter => `-${letter.toLowerCase()}`).replace(/1$/, '-type1')
    const cases = {
      arcsine: [[-1, 2]], beta: [[0.5, 0.5], [2, 5], [0.3, 8], [200, 300]], betaprime: [[2, 3], [0.5, 0.7]], cauchy: [[0, 1], [100, 0.1]], chi: [[0.7], [4]],
      chisquare: [[0.5], [3], [60]], cosine: [[1, 2]], erlang: [[3, 2]], exponential: [[1], [1e-4]], f: [[3, 5], [0.8, 2]], frechet: [[2, 1, 0.5], [0.5, 3, -1]],
      gamma: [[0.1, 1], [0.9, 2], [3, 0.2], [1000, 1]], gumbel: [[0, 1]], invgamma: [[0.7, 1], [4, 2]], kumaraswamy: [[0.5, 0.5], [2, 5]], laplace: [[0, 1]],
      levy: [[0, 1]], logistic: [[1, 0.5]], lognormal: [[0, 0.3], [0, 2]], normal: [[0, 1], [1000, 0.1]], pareto1: [[0.5, 1], [4, 2]],
      rayleigh: [[1]], t: [[0.7], [3], [100]], triangular: [[-1, 3, 0], [0, 1, 0.999]], uniform: [[-1, 3]], weibull: [[0.4, 1], [5, 2]],
      bernoulli: [[0.3]], binomial: [[10, 0.3], [1000, 0.02], [1000, 0.7]], discreteUniform: [[-3, 40]], geometric: [[0.01], [0.9]], hypergeometric: [[60, 20, 15], [5000, 2000, 400]],
      negativeBinomial: [[2.5, 0.3], [50, 0.5]], poisson: [[0.3], [9.9], [30.1], [400]]
    }
    const discrete = ['bernoulli', 'binomial', 'discreteUniform', 'geometric', 'hypergeometric', 'negativeBinomial', 'poisson']
    const make = (name, parameters) => {
      const law = require(`@stdlib/stats-base-dists-${kebab(name)}`)
      const family = require(`@stdlib/random-base-${kebab(name)}`)
      let draw = family.factory(...parameters, { seed: 1 })
      const isDiscrete = discrete.includes(name)
      // The ends of cauchy are ±1.6e16: the tangent of π/2 in double precision
      const [low, high] = isDiscrete ? [name === 'discreteUniform' ? parameters[0] : 0, Infinity] : [0, 1].map(p => law.quantile(p, ...parameters)).map(end => Math.abs(end) < 1e12 ? end : Math.sign(end) * Infinity)
      const pdf = (law.pmf || law.pdf).factory(...parameters)
      return { seed: s => { draw = family.factory(...parameters, { seed: s + 1 >>> 0 || 1 }) }, draw: () => draw(), pdf: x => pdf(x), low, high, discrete: isDiscrete }
    }
    return { make, list: () => Object.entries(cases).flatMap(([name, all]) => all.map(parameters => [name, parameters])) }
  }
}

// The domain by the support and the quartiles of some samples, and how samples lie in it.
function placed (law) {
  law.seed(12345)
  const some = Array.from({ length: 4096 }, () => +law.draw()).sort((a, b) => a - b)
  const [lower, median, upper] = [1024, 2048, 3072].map(i => some[i])
  if (!law.discrete) {
    const { low, high } = law
    const domain = isFinite(low) && isFinite(high) ? `interval:${low},${high}`
      : isFinite(low) ? `half-line:${low},${median - low}` : isFinite(high) ? `half-line:${high},${median - high}` : `real:${median},${upper - lower}`
    return { domain, place: x => x, pdf: law.pdf }
  }
  // The first and the last outcome stand for all beyond them.
  const first = Math.floor(Math.max(law.low, some[0] - 3 * (some[4095] - some[0]) - 16))
  const n = Math.floor(Math.min(law.high, some[4095] + 3 * (some[4095] - some[0]) + 16)) - first + 1
  const inner = Array.from({ length: n - 1 }, (_, i) => law.pdf(first + i))
  const rest = 1 - inner.reduce((sum, p) => sum + p, 0)
  const last = Math.abs(rest) < 1e-9 ? Math.max(0, rest) : rest
  return { domain: `discrete:${n}`, place: x => Math.min(Math.max(x - first, 0), n - 1), pdf: i => i < n - 1 ? inner[i] : last }
}

const [library, asked, scale = '1'] = process.argv.slice(2)
const { make, list } = libraries[library]()
if (asked === 'list') {
  console.log(list().map(([name, parameters]) => `${name}(${parameters.join(', ')})\tby support`).join('\n'))
  process.exit()
}
const [, name, parameters] = asked.match(/^(\w+)\((.*)\)$/)
const law = make(name, JSON.parse(`[${parameters}]`))
const { domain, place, pdf } = placed(law)
const lines = createInterface({ input: process.stdin })[Symbol.asyncIterator]()
for (let line; (line = (await lines.next()).value) !== undefined;) {
  const [verb, count, seed] = line.split(' ')
  const out = []
  if (verb === 'quit') break
  if (verb === 'etalon') out.push(`etalon 1 name=${name} dimension=0 domain=${domain}`)
  if (verb === 'sample') {
    state = +seed % 2147483646 + 1
    law.seed(+seed)
    for (let i = 0; i < +count; i++) out.push(place(law.draw() * +scale))
  }
  if (verb === 'pdf') for (let i = 0; i < +count; i++) out.push(pdf(+(await lines.next()).value))
  console.log(out.concat('end').join('\n'))
}

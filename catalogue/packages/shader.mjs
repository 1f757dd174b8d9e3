// The GLSL of three-gpu-pathtracer's BSDF as C++ for GLM, with references for what is written, lists for arrays, functions for
// swizzles, and the scope of a function whose result has its name:
//   node shader.mjs > shader.h       in a folder with node_modules
import { pathToFileURL } from 'node:url'

const load = path => import(pathToFileURL(`node_modules/three-gpu-pathtracer/src/shader/${path}.glsl.js`))
const paths = ['common/math_functions', 'common/fresnel_functions', 'common/util_functions', 'sampling/shape_sampling_functions', 'structs/surface_record_struct',
  'bsdf/ggx_functions', 'bsdf/sheen_functions', 'bsdf/iridescence_functions', 'bsdf/bsdf_functions']
const texts = (await Promise.all(paths.map(load))).map(module => Object.values(module)[0])
texts[3] = texts[3].match(/\tvec3 sampleSphere\([\s\S]*?\n\t}/)[0]
console.log(texts.join('\n').replace(/\binout (\w+) /g, '$1 &').replace(/float\[5\]\(([^)]*)\)/g, '{$1}').replace(/\.xy\b/g, '.xy()').replace(/ (\w+) = \1\(/g, ' $1 = ::$1('))

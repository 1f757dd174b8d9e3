// The BSDF of three-gpu-pathtracer in C++ by GLM: shader.h is its GLSL, by shader.mjs.
// Floating-point constants are single precision, as in GLSL: -fsingle-precision-constant.
#define GLM_FORCE_SWIZZLE
#include <functional>
#include <glm/glm.hpp>
using namespace glm;

// Of three.js, in whose shader these functions are compiled
#define PI 3.141592653589793
#define EPSILON 1e-6
#define saturate(a) clamp(a, 0.0, 1.0)

// The first random number chooses the lobe, the others sample it, whichever it is
static vec3 numbers;
static float rand(int) { return numbers.x; }
static vec2 rand2(int) { return vec2(numbers.y, numbers.z); }
#include "shader.h"

// A surface as getSurfaceRecord makes it, from the front, with the defaults of three.js; roughnesses are those of the material, which are squared
static SurfaceRecord surface(float roughness, std::function<void(SurfaceRecord &)> set = [](SurfaceRecord &) {}) {
    SurfaceRecord s{};
    s.normal = s.faceNormal = s.clearcoatNormal = vec3(0, 0, 1);
    s.ior = 1.5, s.color = vec3(0.8, 0.5, 0.2), s.specularColor = vec3(1.0), s.specularIntensity = 1;
    s.sheenRoughness = 1, s.iridescenceIor = 1.3, s.iridescenceThickness = 400;
    set(s);
    s.frontFace = true, s.eta = 1 / s.ior, s.f0 = iorRatioToF0(s.eta);
    s.roughness = s.filteredRoughness = roughness * roughness;
    s.clearcoatRoughness = s.filteredClearcoatRoughness = s.clearcoatRoughness * s.clearcoatRoughness;
    s.normalBasis = s.clearcoatBasis = getBasisFromNormal(s.normal);
    s.normalInvBasis = s.clearcoatInvBasis = inverse(s.normalBasis);
    return s;
}

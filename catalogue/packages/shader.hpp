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

// The density of the directions l of refract(-wo, h, eta), whose facet h is (0, 0, 1) and a uniform point of a sphere of the radius r, normalized
static float refractionPdf(vec3 wo, vec3 l, float eta, float r) {
    const vec3 sum = l + wo * eta;
    const vec3 h = normalize(sum) * sign(sum.z);
    const float c2 = h.z * h.z, root = c2 + r * r - 1;
    if (root <= 0 || dot(l, h) >= 0) return 0;
    return (root + c2) / (2 * PI * r * sqrt(root)) * -dot(l, h) / dot(sum, sum);
}

// The pdf of refracted directions, of the lobe alone or times its probability, and the value that is the path tracer's weight times the pdf
static float refractedPdf(vec3 wo, vec3 wi, SurfaceRecord s, bool isLobe, vec3 &value) {
    float d, r, t, c, density;
    getLobeWeights(wo, wo, vec3(0, 0, 1), wo, s, d, r, t, c);
    const float asked = transmissionEval(wo, wi, vec3(0.0), s, value);
    if (s.thinFilm) {
        // The second facet is (0, 0, 1): a direction below the surface comes from one on either side
        const vec2 xy = s.eta * vec2(wi.x, wi.y);
        const float z = sqrt(1 - dot(xy, xy));
        density = (refractionPdf(wo, vec3(xy, -z), s.eta, s.filteredRoughness) + refractionPdf(wo, vec3(xy, z), s.eta, s.filteredRoughness)) * s.eta * s.eta * -wi.z / z;
    } else
        density = refractionPdf(wo, wi, s.eta, s.filteredRoughness);
    value = asked > 0 ? value / asked * density : vec3(0.0);
    return asked > 0 ? density * (isLobe ? 1 : t) : 0;
}

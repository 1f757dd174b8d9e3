// The BSDF of three-gpu-pathtracer, its lobes and its distribution of normals in the protocol.
//   client list            names and domains;        client NAME [SCALE]        serves one, pdfs of samplers multiplied by SCALE
#include "etalon.h"
#include "shader.hpp"
#include <string>
#include <vector>

static const char LEFT_OUT[] = "refracted directions are left out: an entry of their own has them";
static const char BY_DENSITY[] = "the package has no pdf of refracted directions; here it is the density that its facets give them, and the value is that times the weight of a refracted sample";

struct Scatter { vec3 wi, value; float pdf; }; // value: f |cos|
using Ask = std::function<Scatter(vec3 wo, vec3 wi, SurfaceRecord)>;
struct Case { std::string name, domain, keys; SurfaceRecord surface; std::function<Scatter(vec3 wo, SurfaceRecord)> sample; Ask ask; vec3 wo; const char *convention; };
static const Case *now;
static float scale = 1;

// From below, the normal turns to the side of wo, and refraction leaves the medium
static SurfaceRecord seen(bool isBelow) {
    SurfaceRecord s = now->surface;
    s.frontFace = !isBelow || s.transmission == 0;
    s.eta = s.thinFilm || s.frontFace ? 1 / s.ior : s.ior;
    s.f0 = iorRatioToF0(s.eta);
    return s;
}
static vec3 direction(const double *x, bool isBelow = false) { return vec3(x[0], x[1], isBelow ? -x[2] : x[2]); }

// As the path tracer does, nothing where the pdf is 0 or a value NaN
static Scatter asked(const double *wo, const double *wi) {
    const bool isBelow = wo[2] < 0;
    const Scatter found = now->ask(direction(wo, isBelow), direction(wi, isBelow), seen(isBelow));
    return found.pdf > 0 && all(greaterThanEqual(found.value, vec3(0.0))) && wi[2] != 0 ? found : Scatter{};
}

static int sampled(const double *wo, const double *u, etalon_bsdf_sample *made) {
    const bool isBelow = wo[2] < 0;
    numbers = direction(u);
    const Scatter found = now->sample(direction(wo, isBelow), seen(isBelow));
    const vec3 weight = found.value / found.pdf;
    if (!(found.pdf > 0) || any(isnan(weight)) || any(isinf(weight))) return 0;
    for (int i = 0; i < 3; i++) made->wi[i] = i == 2 && isBelow ? -found.wi[i] : found.wi[i], made->weight[i] = weight[i];
    // The pdf of a sample is computed before its direction is turned to the world: where only rounding tells them apart, that which is asked for
    const double again = asked(wo, made->wi).pdf;
    made->pdf = std::fabs(again - found.pdf) < 1e-4 * found.pdf ? again : found.pdf;
    return made->delta = 0, 1;
}

int main(int argc, char **argv) {
    std::vector<Case> all;
    const std::string name = argc > 1 ? argv[1] : "", reflected = "energy=at-most-1", refracted = reflected + " scatters=transmission reciprocal=no";
    const auto with = [](std::string text, float x) { return text + std::to_string(x).substr(0, 4); };
    for (float alpha : {0.05, 0.3, 1.0})
        for (vec3 wo : {vec3(0.48, 0.36, 0.8), vec3(-0.7, 0.68, 0.218)})
            all.push_back({with("ggx normals, alpha ", alpha) + (wo.z > 0.5 ? ", oblique" : ", grazing"), "hemisphere", "", surface(std::sqrt(alpha)), nullptr, nullptr, normalize(wo), ""});
    const auto lobe = [&](std::string name, SurfaceRecord s, vec3 (*sample)(vec3, SurfaceRecord), float (*eval)(vec3, vec3, vec3, SurfaceRecord, vec3 &), std::string keys, float side = 1) {
        const Ask ask = [=](vec3 wo, vec3 wi, SurfaceRecord s) {
            Scatter found{wi, vec3(0.0), 0};
            if (wi.z * side > 0) found.pdf = eval(wo, wi, getHalfVector(wi, wo, s.eta), s, found.value);
            return found;
        };
        all.push_back({name, "bsdf", keys, s, [=](vec3 wo, SurfaceRecord s) { return ask(wo, sample(wo, s), s); }, ask, {}, ""});
    };
    // The directions on a side of the surface alone
    const auto bsdf = [&](std::string name, SurfaceRecord s, float side = 1) {
        const auto sample = [=](vec3 wo, SurfaceRecord s) {
            const ScatterRecord made = bsdfSample(wo, s);
            return Scatter{made.direction, made.color, made.direction.z * side > 0 ? made.pdf : 0};
        };
        const Ask ask = [=](vec3 wo, vec3 wi, SurfaceRecord s) {
            Scatter found{wi, vec3(0.0), 0};
            if (wi.z * side > 0) found.pdf = bsdfResult(wo, wi, s, found.value);
            return found;
        };
        all.push_back({name, "bsdf", side > 0 ? reflected : refracted, s, sample, ask, {}, side > 0 && s.transmission > 0 ? LEFT_OUT : ""});
    };
    const auto byDensity = [&](std::string name, SurfaceRecord s, bool isLobe) {
        const Ask ask = [=](vec3 wo, vec3 wi, SurfaceRecord s) {
            Scatter found{wi, vec3(0.0), 0};
            if (wi.z < 0) found.pdf = refractedPdf(wo, wi, s, isLobe, found.value);
            return found;
        };
        const auto lobe = [=](vec3 wo, SurfaceRecord s) { return ask(wo, transmissionDirection(wo, s), s); };
        const auto sample = [=](vec3 wo, SurfaceRecord s) {
            const ScatterRecord made = bsdfSample(wo, s);
            if (!(made.direction.z < 0 && made.pdf > 0)) return Scatter{};
            // Where no facet refracts to, the pdf is the package's own
            const float density = ask(wo, made.direction, s).pdf, pdf = density > 0 ? density : made.pdf;
            return Scatter{made.direction, made.color / made.pdf * pdf, pdf};
        };
        all.push_back({name, "bsdf", refracted, s, isLobe ? decltype(Case::sample)(lobe) : sample, ask, {}, BY_DENSITY});
    };
    const auto metal = [](SurfaceRecord &s) { s.metalness = 1; };
    const auto coated = [](SurfaceRecord &s) { s.clearcoat = 1, s.clearcoatRoughness = 0.5; };
    const auto cloth = [](SurfaceRecord &s) { s.sheen = 1, s.sheenColor = vec3(0.9, 0.5, 0.3), s.sheenRoughness = 0.5, s.color = vec3(0.2); };
    const auto glass = [](float transmission) { return [=](SurfaceRecord &s) { s.transmission = transmission; }; };
    lobe("diffuse lobe", surface(0.7), diffuseDirection, diffuseEval, reflected);
    for (float roughness : {0.25, 1.0}) lobe(with("specular lobe, metal, roughness ", roughness), surface(roughness, metal), specularDirection, specularEval, reflected);
    lobe("specular lobe, plastic", surface(0.5), specularDirection, specularEval, reflected);
    lobe("clearcoat lobe", surface(0.5, coated), clearcoatDirection, clearcoatEval, reflected);
    lobe("transmission lobe", surface(0.5, glass(1)), transmissionDirection, transmissionEval, refracted, -1);
    for (float roughness : {0.25, 0.75}) bsdf(with("plastic, roughness ", roughness), surface(roughness));
    bsdf("metal", surface(0.5, metal));
    bsdf("specular tint", surface(0.4, [](SurfaceRecord &s) { s.specularIntensity = 0.5, s.specularColor = vec3(1.0, 0.5, 0.2); }));
    bsdf("clearcoat on plastic", surface(0.6, coated));
    bsdf("clearcoat on metal", surface(0.3, [=](SurfaceRecord &s) { metal(s), coated(s); }));
    bsdf("sheen", surface(0.8, cloth));
    bsdf("iridescent plastic", surface(0.4, [](SurfaceRecord &s) { s.iridescence = 1; }));
    bsdf("glass, reflected", surface(0.4, glass(1)));
    bsdf("glass, refracted", surface(0.4, glass(1)), -1);
    for (bool isThin : {false, true}) {
        const std::string thin = isThin ? "thin " : "";
        const SurfaceRecord s = surface(1, [=](SurfaceRecord &s) { s.transmission = 1, s.thinFilm = isThin, s.color = vec3(1.0); });
        byDensity(thin + "transmission lobe, by density", s, true);
        byDensity("rough " + thin + "glass, refracted, by density", s, false);
    }

    scale = argc > 2 ? std::atof(argv[2]) : 1;
    for (const Case &each : all) {
        if (name == "list") printf("%s\t%s\t%s\n", each.name.c_str(), each.domain.c_str(), each.convention);
        if (name != each.name) continue;
        now = &each;
        if (each.domain == "hemisphere") {
            const etalon_sampler normals = {
                "normals", "hemisphere", 2,
                [](const double *u, double *x) {
                    const vec3 h = ggxDirection(now->wo, vec2(now->surface.roughness), vec2(u[0], u[1]));
                    return x[0] = h.x, x[1] = h.y, x[2] = h.z, 1;
                },
                [](const double *x) { return double(scale * ggxPDF(now->wo, direction(x), now->surface.roughness)); },
                0, 0, "precision=single", 0, 0, 0,
            };
            return etalon_serve_sampler(&normals);
        }
        const std::string keys = "precision=single " + each.keys;
        const etalon_bsdf served = {
            "bsdf", keys.c_str(), 3, 3,
            [](const double *wo, const double *wi, double *f) { const vec3 value = asked(wo, wi).value; for (int i = 0; i < 3; i++) f[i] = wi[2] == 0 ? 0 : value[i] / std::fabs(wi[2]); },
            [](const double *wo, const double *wi) { return double(asked(wo, wi).pdf); },
            sampled, 0, 0, 0, 0, 0,
        };
        return etalon_serve_bsdf(&served);
    }
    return name == "list" ? 0 : 2;
}

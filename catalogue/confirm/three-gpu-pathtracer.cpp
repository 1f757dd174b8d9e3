// three-gpu-pathtracer 0.0.26: what findings/three-gpu-pathtracer.toml says, by quadrature of its own functions:
//   cd catalogue/.env/three-gpu-pathtracer
//   g++ -O2 -std=c++17 -fsingle-precision-constant -I. -I../../packages -Iusr/include ../../confirm/three-gpu-pathtracer.cpp -o confirm && ./confirm
#include "shader.hpp"
#include <cstdio>
#include <random>

static vec3 direction(double degrees, double azimuth = 0) {
    const double t = degrees * M_PI / 180, phi = azimuth * M_PI / 180;
    return vec3(std::sin(t) * std::cos(phi), std::sin(t) * std::sin(phi), std::cos(t));
}

// The integral over the directions on a side of the surface, by midpoints of θ and φ
static double integral(std::function<double(vec3)> f, double side = 1) {
    const int n = 500;
    double sum = 0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < 2 * n; j++) {
            const double t = (i + 0.5) * M_PI / 2 / n, phi = (j + 0.5) * M_PI / n;
            sum += f(vec3(std::sin(t) * std::cos(phi), std::sin(t) * std::sin(phi), side * std::cos(t))) * std::sin(t);
        }
    return sum * M_PI / 2 / n * M_PI / n;
}

int main() {
    printf("sheen: what sheenColor returns integrates to A, times the cosine to B; directionalAlbedoSheen, the fit by which the package scales what lies below, says E\n");
    for (float roughness : {0.3, 0.5, 1.0})
        for (double wo : {0.0, 60.0, 85.0}) {
            const SurfaceRecord s = surface(0.5, [=](SurfaceRecord &s) { s.sheen = 1, s.sheenColor = vec3(1.0), s.sheenRoughness = roughness; });
            const auto value = [&](vec3 wi) { return double(sheenColor(direction(wo), wi, getHalfVector(direction(wo), wi), s).x); };
            printf("  roughness %.1f, %2.0f°: A = %.3f, B = %.3f, E = %.3f\n", roughness, wo, integral(value), integral([&](vec3 wi) { return value(wi) * wi.z; }), directionalAlbedoSheen(direction(wo).z, roughness * roughness));
        }

    printf("diffuse: f without the cosine from wo to wi, from wi to wo, and with rr = 1/2 + 2 roughness cos² of half their angle in place of 1/2 + 2 roughness fl²\n");
    for (float roughness : {0.25, 0.7, 1.0})
        for (auto [a, b] : {std::pair{0.0, 80.0}, {60.0, 85.0}, {75.0, 88.0}}) {
            const SurfaceRecord s = surface(roughness);
            const vec3 wo = direction(a), wi = direction(b, 180), wh = getHalfVector(wo, wi);
            vec3 there, back;
            diffuseEval(wo, wi, wh, s, there), diffuseEval(wi, wo, wh, s, back);
            const float fl = schlickFresnel(wi.z, 0.0), fv = schlickFresnel(wo.z, 0.0), c = dot(wo, wh), rr = 0.5 + 2 * s.roughness * c * c;
            const float burley = (1 - disneyFresnel(wo, wi, wh, s.f0, s.eta, 0)) * s.color.x * (rr * (fl + fv + fl * fv * (rr - 1)) + (1 - fl / 2) * (1 - fv / 2)) / PI;
            printf("  roughness %.2f, %2.0f° and %2.0f°: %.4f, %.4f, %.4f\n", roughness, a, b, there.x / wi.z, back.x / wo.z, burley);
        }
    for (double wo : {0.0, 60.0, 85.0}) {
        const SurfaceRecord s = surface(0.7);
        vec3 value;
        printf("  roughness 0.7, %2.0f°: the albedo is %.4f; with wo and wi exchanged %.4f\n", wo, integral([&](vec3 wi) { return diffuseEval(direction(wo), wi, getHalfVector(direction(wo), wi), s, value), value.x; }),
               integral([&](vec3 wi) { return diffuseEval(wi, direction(wo), getHalfVector(direction(wo), wi), s, value), value.x / direction(wo).z * wi.z; }));
    }

    const SurfaceRecord rounded = surface(0.75);
    const vec3 normal(0, 0, 1), next(4e-4, 0, 1);
    vec3 there, back;
    bsdfResult(normal, next, rounded, there), bsdfResult(next, normal, rounded, back);
    printf("  roughness 0.75, 0° and 0.02°: %.4f, %.4f; the cosine of wo and their half vector is 1 + %.2g\n", there.x, back.x, dot(next, getHalfVector(normal, next, rounded.eta)) - 1);

    for (float iridescence : {0.0, 1.0}) {
        const SurfaceRecord s = surface(0.4, [=](SurfaceRecord &s) { s.iridescence = iridescence; });
        vec3 value;
        printf("  plastic of roughness 0.4, iridescence %.0f, 85°: the albedos are", iridescence);
        for (int channel = 0; channel < 3; channel++) printf(" %.4f", integral([&](vec3 wi) { return bsdfResult(direction(85), wi, s, value), value[channel]; }));
        printf("\n");
    }

    printf("glass: the pdf of reflected samples in bsdfSample and in bsdfResult, and light of a constant map by both strategies with the power heuristic over light of one\n");
    for (float transmission : {0.5, 1.0})
        for (double out : {0.0, 60.0, 85.0}) {
            const SurfaceRecord s = surface(0.4, [=](SurfaceRecord &s) { s.transmission = transmission, s.color = vec3(1.0); });
            const vec3 wo = direction(out);
            float d, r, t, c, ignored;
            vec3 value;
            getLobeWeights(wo, wo, vec3(0, 0, 1), wo, s, d, r, t, c);
            const auto sampled = [&](vec3 wi) { return bsdfEval(wo, wo, wi, wi, s, d, r, t, c, ignored, value); };
            const double env = 0.25 / M_PI, pdf = integral(sampled), other = integral([&](vec3 wi) { return bsdfResult(wo, wi, s, value); });
            const double right = integral([&](vec3 wi) { return sampled(wi), value.x; });
            const double both = integral([&](vec3 wi) {
                const float result = bsdfResult(wo, wi, s, value);
                return value.x * (misHeuristic(env, result) + misHeuristic(sampled(wi), env));
            });
            const vec3 mirror(-wo.x, -wo.y, wo.z);
            printf("  transmission %.1f, %2.0f°: the pdfs integrate to %.4f and %.4f; in the mirrored direction they are %.4f and %.4f; light %+.2f %%\n", transmission, out, pdf, other, sampled(mirror), bsdfResult(wo, mirror, s, value), 100 * (both / right - 1));
        }

    printf("transmission lobe, roughness 0.5: the pdf, the value and the weights of samples, and the share of samples within 25° of the refracted direction\n");
    std::mt19937 g(7);
    std::uniform_real_distribution<float> u;
    for (double out : {0.0, 60.0}) {
        const SurfaceRecord s = surface(0.5, [](SurfaceRecord &s) { s.transmission = 1, s.color = vec3(0.8); });
        const vec3 wo = direction(out), mean = refract(-wo, vec3(0, 0, 1), s.eta);
        vec3 value;
        const auto pdf = [&](vec3 wi) { return double(transmissionEval(wo, wi, vec3(0.0), s, value)); };
        int near = 0;
        for (int i = 0; i < 100000; i++) numbers = vec3(u(g), u(g), u(g)), near += dot(transmissionDirection(wo, s), mean) > std::cos(25 * M_PI / 180);
        const double ofPdf = integral(pdf, -1), ofValue = integral([&](vec3 wi) { return pdf(wi), value.x; }, -1), weight = value.x / pdf(mean);
        printf("  %2.0f°: the pdf integrates to %.3f, the value to %.3f, all weights are %.3f, %.3f of samples are near\n", out, ofPdf, ofValue, weight, near / 1e5);
    }

    printf("rough white glass: the light that samples of bsdfSample carry to the other side, and what their share without a direction is; by quadrature that of the transmission lobe, and of facets that reflect to the other side, weighted as refracted\n");
    struct { const char *name; bool isThin, isWithin; } sheets[] = {{"from outside", false, false}, {"from within", false, true}, {"thin", true, false}};
    for (auto [name, isThin, isWithin] : sheets)
        for (float roughness : {0.4, 0.7, 1.0})
            for (double out : {0.0, 30.0, 60.0, 85.0}) {
                SurfaceRecord s = surface(roughness, [=](SurfaceRecord &s) { s.transmission = 1, s.thinFilm = isThin, s.color = vec3(1.0); });
                if (isWithin) s.frontFace = false, s.eta = s.ior, s.f0 = iorRatioToF0(s.eta);
                const vec3 wo = direction(out);
                float d, specular, weight, c;
                vec3 value;
                getLobeWeights(wo, wo, vec3(0, 0, 1), wo, s, d, specular, weight, c);
                const float tpdf = transmissionEval(wo, wo, wo, s, value), factor = weight > 0 && tpdf > 0 ? 1 / tpdf : 0;
                const double below = integral([&](vec3 wi) { const vec3 h = normalize(wo + wi); return h.z > 0 ? ggxPDF(wo, h, s.roughness) / (4 * dot(wo, h)) : 0; }, -1);
                double light = 0, none = 0;
                for (int i = 0; i < 200000; i++) {
                    numbers = vec3(u(g), u(g), u(g));
                    const ScatterRecord made = bsdfSample(wo, s);
                    if (made.direction.z < 0 && made.pdf > 0) light += made.color.x / made.pdf / 2e5;
                    if (!(made.direction.z < 0 || made.direction.z >= 0)) none += 1 / 2e5;
                }
                printf("  %s, roughness %.1f, %2.0f°: %.4f, %.3f without; the lobe %.4f, facets %.4f\n", name, roughness, out, light, none, factor, factor > 0 ? specular * below * factor / weight : 0);
            }
    for (double light : {0.25 / M_PI, 1.0, 100.0}) printf("  light with a pdf of %.3f per steradian, found through glass after a reflection, counts %.4f\n", light, misHeuristic(0.75 / 0.96, light));

    const vec3 wo = normalize(vec3(-0.7, 0.68, 0.218)), h = ggxDirection(wo, vec2(0.3), vec2(1, 1.1e-16));
    printf("normals: of the random numbers (1, 1.1e-16) (%g, %g, %g), whose pdf is %g\n", h.x, h.y, h.z, ggxPDF(wo, h, 0.3));
}

//! Materials: `eval`, `sample` and `pdf` under one contract.

pub mod diffuse;
use crate::raster::Rgb;
use crate::scene::Material;
use glam::Vec3;
pub struct BsdfSample {
    pub wi: Vec3,
    pub weight: Rgb,
    pub pdf: f32,
}
pub enum Bsdf {
    Mirror(Rgb),
    Glass { r: Rgb, t: Rgb, eta: f32 },
}
impl Bsdf {
    pub fn new(m: &Material) -> Self {
        match *m {
            Material::Glass { reflectance, transmittance, eta } => {
                Bsdf::Glass { r: reflectance, t: transmittance, eta }
            }
            _ => Bsdf::Mirror(Rgb::ONE),
        }
    }
    pub fn sample(&self, wo: Vec3, uc: f32, _u: [f32; 2]) -> Option<BsdfSample> {
        let mirror = Vec3::new(-wo.x, -wo.y, wo.z);
        match *self {
            Bsdf::Mirror(r) => Some(BsdfSample { wi: mirror, weight: r, pdf: 0.0 }),
            Bsdf::Glass { r, t, eta } => {
                let e = if wo.z > 0.0 { eta } else { 1.0 / eta };
                let f = crate::optics::dielectric::fresnel(wo.z.abs(), e).unpolarized();
                if uc < f {
                    return Some(BsdfSample { wi: mirror, weight: r, pdf: 0.0 });
                }
                let c2 = 1.0 - (1.0 - wo.z * wo.z) / (e * e);
                if c2 <= 0.0 {
                    return None;
                }
                let wi = Vec3::new(-wo.x / e, -wo.y / e, -c2.sqrt().copysign(wo.z)).normalize();
                Some(BsdfSample { wi, weight: t / (e * e), pdf: 0.0 })
            }
        }
    }
}

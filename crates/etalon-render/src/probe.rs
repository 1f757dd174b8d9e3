//! What may be tested from outside: samplers and densities of the renderer, called as the kernel calls them.

pub use crate::bsdf_lanes::{
    Bsdfs, Scattered, TransportMode, eval_many, reverse_pdf_many, sample_cosine_hemisphere, sample_many,
};
pub use crate::camera::PreparedCamera;
pub use crate::geometry::Surface;
pub use crate::lanes::{BLOCK, LANES, Lane, NONE, Rays, at, set};
pub use crate::light_lanes::{sample_one_light, sample_own_lights};
pub use crate::light_sample::{LightSample, LightSampleLanes, SampleLight};
pub use crate::light_selection::Lights;
pub use crate::light_tracing::{SAMPLES_PER_LIGHT_PATH, Start};
pub use crate::light_tree::{LightTree, LightTreeAt};
pub use crate::lights::SampledLight;
pub use crate::prepared::PreparedScene;
pub use crate::shaders::{Kind, adjoint_factor, is_sound};
pub use etalon_core::scene::Ray;

//! Papers and books that figures cite for their formulas.

pub const BURLEY_DISNEY: &str = "B. Burley, \"Physically-Based Shading at Disney\", SIGGRAPH courses, 2012";
pub const BURLEY_OWEN: &str = "B. Burley, \"Practical Hash-based Owen Scrambling\", JCGT 9(4), 2020";
pub const CONTY_KULLA: &str =
    "A. Conty Estevez, C. Kulla, \"Importance Sampling of Many Lights with Adaptive Tree Splitting\", HPG 2018";
pub const COOK_TORRANCE: &str =
    "R. L. Cook, K. E. Torrance, \"A Reflectance Model for Computer Graphics\", ACM TOG 1(1), 1982";
pub const DEBEVEC: &str = "P. Debevec, \"A Median Cut Algorithm for Light Probe Sampling\", SIGGRAPH posters, 2005";
pub const GEORGIEV: &str =
    "I. Georgiev et al., \"Light Transport Simulation with Vertex Connection and Merging\", SIGGRAPH Asia 2012";
pub const HECKBERT: &str =
    "P. S. Heckbert, \"Adaptive Radiosity Textures for Bidirectional Ray Tracing\", SIGGRAPH 1990";
pub const HEITZ: &str = "E. Heitz, \"Sampling the GGX Distribution of Visible Normals\", JCGT 7(4), 2018";
pub const HIGHAM: &str = "N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd edition, SIAM, 2002";
pub const JOHNSON_CHRISTY: &str =
    "P. B. Johnson, R. W. Christy, \"Optical Constants of Transition Metals\", Physical Review B 9, 1974";
pub const KAJIYA: &str = "J. T. Kajiya, \"The Rendering Equation\", SIGGRAPH 1986";
pub const KARLIK: &str = "O. Karlík et al., \"MIS Compensation: Optimizing Sampling Techniques in Multiple Importance \
                          Sampling\", SIGGRAPH Asia 2019";
pub const KULLA_CONTY: &str =
    "C. Kulla, A. Conty, \"Revisiting Physically Based Shading at Imageworks\", SIGGRAPH courses, 2017";
pub const PBRT: &str = "M. Pharr, W. Jakob, G. Humphreys, Physically Based Rendering, 4th edition, MIT Press, 2023";
pub const SCHLICK: &str =
    "C. Schlick, \"An Inexpensive BRDF Model for Physically-based Rendering\", Computer Graphics Forum 13(3), 1994";
pub const SUBR_ARVO: &str =
    "K. Subr, J. Arvo, \"Statistical Hypothesis Testing for Assessing Monte Carlo Estimators\", Pacific Graphics 2007";
pub const TURQUIN: &str =
    "E. Turquin, \"Practical Multiple Scattering Compensation for Microfacet Models\", Industrial Light & Magic, 2019";
pub const VEACH: &str =
    "E. Veach, L. J. Guibas, \"Optimally Combining Sampling Techniques for Monte Carlo Rendering\", SIGGRAPH 1995";
pub const VIRIYOTHAI: &str =
    "K. Viriyothai, P. Debevec, \"Variance Minimization Light Probe Sampling\", SIGGRAPH posters, 2009";
pub const WALTER: &str = "B. Walter et al., \"Microfacet Models for Refraction through Rough Surfaces\", EGSR 2007";

//! Materials: `eval`, `sample` and `pdf` under one contract.

pub mod diffuse;

//! Meshes as binary PLY files.

use crate::scene::Mesh;
use glam::{Vec2, Vec3};

/// The file of a mesh, with the normals and texture coordinates that it has. Corners with texture coordinates become
/// vertices of their own, as vertices have the coordinates in a PLY file.
pub fn encode(mesh: &Mesh) -> Vec<u8> {
    let corners: Vec<(u32, Option<Vec2>)> = if mesh.uv.is_empty() {
        (0..mesh.positions.len() as u32).map(|i| (i, None)).collect()
    } else {
        let corners = mesh.triangles.iter().zip(&mesh.uv);
        corners.flat_map(|(triangle, uv)| (0..3).map(move |i| (triangle[i], Some(uv[i])))).collect()
    };
    let split = |i: usize| [0, 1, 2].map(|corner| (3 * i + corner) as u32);
    let triangles = mesh.triangles.iter().enumerate().map(|(i, t)| if mesh.uv.is_empty() { *t } else { split(i) });
    let property = |names: &[&str]| names.iter().map(|name| format!("property float {name}\n")).collect::<String>();
    let properties = [
        property(&["x", "y", "z"]),
        if mesh.normals.is_empty() { String::new() } else { property(&["nx", "ny", "nz"]) },
        if mesh.uv.is_empty() { String::new() } else { property(&["u", "v"]) },
    ];
    let (vertices, faces) = (corners.len(), mesh.triangles.len());
    let mut file = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\n{}element face {faces}\n\
         property list uchar int vertex_indices\nend_header\n",
        properties.concat()
    )
    .into_bytes();
    for (vertex, uv) in corners {
        let normal = mesh.normals.get(vertex as usize).map(Vec3::to_array);
        let values = mesh.positions[vertex as usize].to_array().into_iter();
        let values = values.chain(normal.into_iter().flatten()).chain(uv.map(|uv| uv.to_array()).into_iter().flatten());
        values.for_each(|value| file.extend(value.to_le_bytes()));
    }
    for triangle in triangles {
        file.push(3);
        triangle.iter().for_each(|i| file.extend(i.to_le_bytes()));
    }
    file
}

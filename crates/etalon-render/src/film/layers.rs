//! The image split by path class: layers whose sum is the image, to the last bit.

use super::accumulate::Film;
use etalon_core::math::Rgb;
use etalon_core::raster::Image;
use rayon::prelude::*;

impl Film {
    /// The mean light of each path class, with the classes' names in their order; nothing without classes.
    ///
    /// The layers of a pixel, added in this order in f64 and rounded to f32, give the value of [`Film::image`]
    /// exactly: the largest layer takes the rounding error.
    pub fn path_layers(&self) -> Vec<(String, Image)> {
        let Some(paths) = &self.paths else { return Vec::new() };
        let count = paths.classes.count();
        let per_pixel = self.paths_per_pixel();
        let image = self.image();
        let mut layers: Vec<Vec<Rgb>> = vec![vec![Rgb::ZERO; self.pixels.len()]; count];
        // One column of values for each pixel; a group of pixels at a time, so that memory stays in proportion.
        for start in (0..self.pixels.len()).step_by(GROUP) {
            let pixels = &self.pixels[start..self.pixels.len().min(start + GROUP)];
            let sums = &paths.sums[start * count..][..pixels.len() * count];
            let columns: Vec<Vec<Rgb>> = pixels
                .par_iter()
                .zip(sums.par_chunks_exact(count))
                .enumerate()
                .map(|(i, (pixel, sums))| {
                    let mut column: Vec<Rgb> = sums.iter().map(|sum| sum.mean(pixel.camera_paths.into())).collect();
                    let i = start + i;
                    if let Some(splats) = &self.splats {
                        let received = &splats.classes[i * count..][..count];
                        column.iter_mut().zip(received).for_each(|(v, sum)| *v += sum.mean(per_pixel));
                    }
                    let total = image.pixels()[i];
                    for c in 0..3 {
                        let mut values: Vec<f32> = column.iter().map(|v| v[c]).collect();
                        settle(&mut values, total[c]);
                        column.iter_mut().zip(values).for_each(|(v, value)| v[c] = value);
                    }
                    column
                })
                .collect();
            for (i, column) in columns.iter().enumerate() {
                layers.iter_mut().zip(column).for_each(|(layer, &value)| layer[start + i] = value);
            }
        }
        let images = layers.into_iter().map(|pixels| Image::from_pixels(self.width(), self.height(), pixels));
        paths.classes.names().zip(images).collect()
    }
}

/// Pixels that are split at a time.
const GROUP: usize = 1 << 14;

/// Changes `values` by as little as makes their sum `total`: the largest one takes the difference.
///
/// One value cannot always do it: where the sum falls between two floats for every choice of the largest, the next
/// largest moves by its last bit first.
fn settle(values: &mut [f32], total: f32) {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    let Some((&largest, others)) = order.split_first() else { return };
    let mut other = others.iter();
    loop {
        let wanted = f64::from(total) - (sum(values) - f64::from(values[largest]));
        let nearest = wanted as f32;
        for value in [values[largest], nearest, nearest.next_down(), nearest.next_up()] {
            values[largest] = value;
            if sum(values) as f32 == total {
                return;
            }
        }
        values[largest] = nearest;
        match other.next() {
            Some(&i) if values[i] > 0.0 => values[i] = values[i].next_down(),
            _ => return,
        }
    }
}

fn sum(values: &[f32]) -> f64 {
    values.iter().fold(0.0, |sum, &v| sum + f64::from(v))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::PathClasses;
    use etalon_core::sampling::stream::{Independent, Stream};

    #[test]
    fn the_layers_of_a_million_pixels_add_up_exactly() {
        let classes = PathClasses::up_to(3);
        let mut film = Film::new(1000, 340, Some(classes)).unwrap();
        film.accumulate(|row| {
            for x in 0..1000 {
                let samples = 1 + (x % 3) as u32;
                for s in 0..samples {
                    let stream = Independent::new(3, (1000 * row.y() + x) as u64, s);
                    // Rounded as a renderer does: each contribution and their sum in f32.
                    let paths: [Rgb; 16] = std::array::from_fn(|class| {
                        let [u, v] = stream.pair(class as u32);
                        let power = if row.y() % 2 == 0 { 30.0 } else { 3.0 };
                        let w = if v < 0.5 { 0.0 } else { (power * (u - 0.9)).exp() as f32 };
                        Rgb::new(w, w * w, u as f32)
                    });
                    row.add(x, paths.iter().sum(), &paths);
                }
            }
        });
        let (image, layers) = (film.image(), film.path_layers());
        assert_eq!(layers.len(), 16);
        for (i, pixel) in image.pixels().iter().enumerate() {
            for c in 0..3 {
                let sum: f64 = layers.iter().map(|(_, layer)| f64::from(layer.pixels()[i][c])).sum();
                assert_eq!((sum as f32).to_bits(), pixel[c].to_bits(), "pixel {i}, channel {c}");
            }
        }
    }

    #[test]
    fn what_one_value_cannot_settle_two_can() {
        // 2^24 + 1 is no float; halves make it a tie for every choice of the first.
        let odd = 16_777_215.0_f32;
        for mut values in [vec![odd, 0.5], vec![0.5, odd - 1.0], vec![0.25, odd, 0.25], vec![odd, odd], vec![0.0, 1.0]]
        {
            let before = values.clone();
            settle(&mut values, odd);
            assert_eq!(sum(&values) as f32, odd, "{before:?} became {values:?}");
        }
        let mut nothing = [0.0; 4];
        settle(&mut nothing, 0.0);
        assert_eq!(nothing, [0.0; 4]);
    }
}

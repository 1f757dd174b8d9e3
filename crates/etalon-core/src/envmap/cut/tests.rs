//! Cuts tile the map and halve its light.

use super::*;
use crate::envmap::info::Info;
use crate::math::Rgb;
use crate::raster::Image;

fn maps() -> Vec<EnvMap> {
    let busy = |x: usize, y: usize| Rgb::new(((x * 31 + y * 17) % 11) as f32, (x % 3) as f32, 0.1);
    let sun = |x: usize, y: usize| if (x, y) == (40, 9) { Rgb::splat(1e6) } else { Rgb::splat(0.2) };
    vec![
        EnvMap::new(Image::from_fn(64, 32, busy)),
        EnvMap::new(Image::from_fn(64, 32, sun)),
        EnvMap::new(Image::from_fn(64, 32, |_, _| Rgb::ONE)),
        EnvMap::new(Image::new(64, 32)),
        EnvMap::new(Image::from_fn(64, 32, |x, y| if (x, y) == (1, 1) { Rgb::ONE } else { Rgb::ZERO })),
        EnvMap::new(Image::from_fn(3, 2, busy)),
    ]
}

#[test]
fn regions_tile_the_map_and_keep_its_flux() {
    for map in maps() {
        let flux = DVec3::from_array(Info::of(&map).flux_rgb);
        let (w, h) = (map.geometry().width(), map.geometry().height());
        for split in Split::ALL {
            for sides in [SideRule::Sphere, SideRule::Texels] {
                let cut = MedianCut::new(&map, split, sides);
                assert!(cut.regions(0).is_err() && cut.regions(w * h + 1).is_err());
                for n in [1, 2, 3, 5, 6, 64, 777, 2048].into_iter().filter(|n| *n <= w * h) {
                    let regions = cut.regions(n).unwrap();
                    assert_eq!(regions.len(), n, "any number can be asked for");
                    let mut covered = vec![0; w * h];
                    for r in &regions {
                        for y in r.block.y0..r.block.y1 {
                            for x in r.block.x0..r.block.x1 {
                                covered[y * w + x] += 1;
                            }
                        }
                        for (cx, cy) in [r.centroid, r.median] {
                            assert!(cx >= r.block.x0 as f64 && cx <= r.block.x1 as f64);
                            assert!(cy >= r.block.y0 as f64 && cy <= r.block.y1 as f64);
                        }
                    }
                    assert!(covered.iter().all(|&c| c == 1));
                    let sum: DVec3 = regions.iter().map(|r| r.flux).sum();
                    assert!((sum - flux).length() <= 1e-12 * flux.length());
                }
            }
        }
    }
}

#[test]
fn halves_hold_half_of_the_energy() {
    let map = &maps()[0];
    let regions = MedianCut::new(map, Split::Energy, SideRule::Sphere).regions(2).unwrap();
    let [a, b] = [regions[0].energy, regions[1].energy];
    assert!((a - b).abs() / (a + b) < 0.02, "{a} {b}");
}

#[test]
fn a_constant_map_is_cut_in_the_middle() {
    let map = &maps()[2];
    let regions = MedianCut::new(map, Split::Energy, SideRule::Sphere).regions(4).unwrap();
    let corners: Vec<_> = regions.iter().map(|r| (r.block.x0, r.block.y0)).collect();
    // The sphere rule cuts the 2:1 map across, then each square half across its middle row's longer side.
    assert!(corners.contains(&(0, 0)) && corners.contains(&(32, 0)), "{corners:?}");
    let energy: f64 = regions.iter().map(|r| r.energy).sum();
    for r in &regions {
        assert!((r.energy / energy - 0.25).abs() < 1e-12);
    }
}

#[test]
fn the_variance_rule_does_not_slice_a_light_in_two() {
    // A large light beside a small one: equal energies need a cut through the large one.
    let light = |x: usize, y: usize| {
        let large = (20..24).contains(&x) && (7..9).contains(&y);
        let small = (40..41).contains(&x) && (7..9).contains(&y);
        if large || small { 1.0 } else { 0.0 }
    };
    let map = EnvMap::new(Image::from_fn(64, 32, |x, y| Rgb::splat(light(x, y))));
    let pieces = |split| {
        let regions = MedianCut::new(&map, split, SideRule::Sphere).regions(2).unwrap();
        regions.iter().filter(|r| r.block.x0 < 24 && r.block.x1 > 20).count()
    };
    assert_eq!(pieces(Split::Energy), 2);
    assert_eq!(pieces(Split::Variance), 1);
}

/// Every region of `few` holds two of `many`.
fn is_next_level(few: &[Region], many: &[Region]) -> bool {
    let inside = |a: Block, b: Block| a.x0 >= b.x0 && a.x1 <= b.x1 && a.y0 >= b.y0 && a.y1 <= b.y1;
    few.iter().all(|old| many.iter().filter(|new| inside(new.block, old.block)).count() == 2)
}

#[test]
fn a_power_of_two_is_cut_level_by_level() {
    let maps = maps();
    for sides in [SideRule::Texels, SideRule::Sphere] {
        for map in &maps[..3] {
            let cut = MedianCut::new(map, Split::Energy, sides);
            let levels: Vec<_> = [1, 2, 4].map(|n| cut.regions(n).unwrap()).into();
            assert!(levels.windows(2).all(|pair| is_next_level(&pair[0], &pair[1])), "{sides:?}: {levels:?}");
        }
        // Where no region is a single texel.
        let cut = MedianCut::new(&maps[2], Split::Energy, sides);
        for n in [4, 32, 64] {
            let (few, many) = (cut.regions(n).unwrap(), cut.regions(2 * n).unwrap());
            assert!(is_next_level(&few, &many), "{sides:?}: {n}");
        }
        // Any other number has the brightest region cut first: the half with the sun, twice.
        let cut = MedianCut::new(&maps[1], Split::Energy, sides);
        let halves = cut.regions(2).unwrap();
        let dim = if halves[0].energy < halves[1].energy { halves[0].block } else { halves[1].block };
        assert!(cut.regions(3).unwrap().iter().any(|region| region.block == dim), "{sides:?}");
    }
}

#[test]
fn sums_behind_a_bright_texel_are_exact() {
    const SIZE: [usize; 2] = [1024, 512];
    const BLOCK: usize = 8;
    const BRIGHT: (usize, usize) = (128, 64);
    // All partial sums are whole multiples of 2⁻¹² below 2⁴¹
    let [hot, cold] = [2f64.powi(20), 1.0 + 2f64.powi(-12)];
    let value = |x: usize, y: usize| if (x, y) == BRIGHT { hot } else { cold };
    let table = SummedArea::new(SIZE[0], SIZE[1], value);
    // The same in f32, as many renderers have it
    let mut single = vec![[0f32; SIZE[0] + 1]; SIZE[1] + 1];
    for y in 0..SIZE[1] {
        let mut row = 0.0;
        for x in 0..SIZE[0] {
            row += value(x, y) as f32;
            single[y + 1][x + 1] = single[y][x + 1] + row;
        }
    }
    let mut largest = 0.0;
    for (x0, y0) in (0..SIZE[1] / BLOCK).flat_map(|y| (0..SIZE[0] / BLOCK).map(move |x| (x * BLOCK, y * BLOCK))) {
        let block = Block { x0, y0, x1: x0 + BLOCK, y1: y0 + BLOCK };
        let cells = (BLOCK * BLOCK) as f64;
        let exact = if (x0, y0) == BRIGHT { hot + (cells - 1.0) * cold } else { cells * cold };
        assert_eq!(table.sum(block), exact, "{block:?}");
        let sum = single[block.y1][block.x1] - single[block.y1][x0] - single[y0][block.x1] + single[y0][x0];
        largest = f64::max(largest, (f64::from(sum) / exact - 1.0).abs());
    }
    assert!(largest > 1e-5, "{largest}");
}

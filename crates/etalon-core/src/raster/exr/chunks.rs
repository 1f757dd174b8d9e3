//! The blocks of an OpenEXR part in the file, and whether their bytes can hold the pixels that the header announces.
//!
//! The codecs reserve memory for whatever size the header, or a compressed stream inside the chunk, announces; a file
//! of a hundred bytes can announce terabytes. So every chunk is checked here before the image is allocated.

use crate::error::{Error, Place, Result};
use exr::compression::Compression;
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use std::path::Path;

/// A rectangle of pixels, relative to the data window, and its compressed bytes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Block<'a> {
    /// Column of the first pixel in the data window.
    pub x: usize,
    /// Row of the first pixel in the data window.
    pub y: usize,
    pub width: usize,
    pub height: usize,
    /// Where the chunk stands in the file.
    pub offset: usize,
    pub data: &'a [u8],
}

/// Finds all blocks of the full resolution of one part; `table` is where the offset tables begin, after the headers.
pub(super) fn locate<'a>(
    path: &Path,
    bytes: &'a [u8],
    meta: &MetaData,
    part: usize,
    table: usize,
) -> Result<Vec<Block<'a>>> {
    let header = &meta.headers[part];
    let entries = |headers: &[Header]| headers.iter().fold(0, |sum: usize, h| sum.saturating_add(h.chunk_count));
    if entries(&meta.headers) > bytes[table..].len() / 8 {
        return Err(Error::input(path, "the file ends within its table of blocks")
            .with_hint("the file is cut off, or its header is damaged; fetch it again"));
    }
    let offsets = bytes[table + 8 * entries(&meta.headers[..part])..].chunks_exact(8);

    let (width, height) = (header.layer_size.0, header.layer_size.1);
    let (step_x, step_y) = match header.blocks {
        BlockDescription::ScanLines => (width, header.compression.scan_lines_per_block()),
        BlockDescription::Tiles(tiles) => (tiles.tile_size.0, tiles.tile_size.1),
    };
    // The full resolution comes first in the table, row by row.
    let (columns, rows) = (width.div_ceil(step_x), height.div_ceil(step_y));
    let mut blocks = Vec::with_capacity(columns * rows);
    for (i, offset) in offsets.take(columns * rows).enumerate() {
        let (column, row) = (i % columns, i / columns);
        let (x, y) = (column * step_x, row * step_y);
        // The place that the chunk must claim for itself.
        let place = match header.blocks {
            BlockDescription::ScanLines => vec![header.own_attributes.layer_position.1 + y as i32],
            BlockDescription::Tiles(_) => vec![column as i32, row as i32, 0, 0],
        };
        let part = meta.requirements.is_multilayer().then_some(part as i32);
        let offset = read_u64(offset);
        let chunk = Chunk { path, bytes, offset, number: i, count: columns * rows };
        let data = chunk.data(part.into_iter().chain(place))?;
        let (width, height) = (step_x.min(width - x), step_y.min(height - y));
        let block = Block { x, y, width, height, offset: offset as usize, data };
        if !can_hold(header, &block) {
            return Err(chunk.error("its size contradicts the header"));
        }
        blocks.push(block);
    }
    if blocks.iter().map(|b| b.data.len()).sum::<usize>() > bytes.len() {
        return Err(Error::input(path, "blocks of the file overlap").with_hint("the file is damaged"));
    }
    Ok(blocks)
}

/// One entry of the offset table.
struct Chunk<'a, 'p> {
    path: &'p Path,
    bytes: &'a [u8],
    offset: u64,
    number: usize,
    count: usize,
}

impl<'a> Chunk<'a, '_> {
    /// The compressed bytes, if the chunk begins with `place` and ends within the file.
    fn data(&self, place: impl Iterator<Item = i32>) -> Result<&'a [u8]> {
        if self.offset == 0 {
            return Err(self.error("it was never written"));
        }
        let mut rest = usize::try_from(self.offset).ok().and_then(|at| self.bytes.get(at..)).unwrap_or_default();
        let mut next = || {
            let (value, tail) = rest.split_first_chunk::<4>()?;
            rest = tail;
            Some(i32::from_le_bytes(*value))
        };
        for expected in place {
            match next() {
                Some(found) if found == expected => {}
                Some(_) => return Err(self.error("it is not where the table says")),
                None => return Err(self.error("it lies beyond the end of the file")),
            }
        }
        let length = next().and_then(|l| usize::try_from(l).ok());
        length.and_then(|l| rest.get(..l)).ok_or_else(|| self.error("it does not end within the file"))
    }

    fn error(&self, why: &str) -> Error {
        Error::input(self.path, format!("block {} of {} is missing: {why}", self.number + 1, self.count))
            .at(Place::Byte(self.offset))
            .with_hint("the file is damaged or cut off; fetch it again")
    }
}

/// Whether the bytes of a block can expand to what the header announces: no codec does better than its factor.
fn can_hold(header: &Header, block: &Block<'_>) -> bool {
    let expected = block.width * block.height * header.channels.bytes_per_pixel;
    let length = block.data.len();
    // A block that would not shrink is stored as it is.
    if length == 0 || length >= expected {
        return length == expected;
    }
    match header.compression {
        Compression::Uncompressed => false,
        Compression::RLE => expected <= 64 * length,
        // Deflate at its best gives 1032 bytes for one; PXR24 adds a fourth byte to three.
        Compression::ZIP1 | Compression::ZIP16 => expected <= 1032 * length,
        Compression::PXR24 => expected <= 1376 * length,
        // A Huffman code of one bit with a repeat count of eight stands for 255 values of two bytes.
        Compression::PIZ => expected <= 512 * length,
        // Three bytes for a flat square of sixteen half floats.
        Compression::B44 | Compression::B44A => expected <= 11 * length,
        Compression::DWAA(_) | Compression::DWAB(_) => dwa_can_hold(header, block),
        // Not decoded: the codec says so.
        Compression::HTJ2K32 | Compression::HTJ2K256 => true,
    }
}

/// Checks the eleven counters with which a DWA chunk begins against the block and against the streams behind them.
fn dwa_can_hold(header: &Header, block: &Block<'_>) -> bool {
    let Some((counters, streams)) = block.data.split_first_chunk::<88>() else {
        return false;
    };
    let mut values = counters.chunks_exact(8).map(read_u64);
    let counters: [u64; 11] = std::array::from_fn(|_| values.next().unwrap_or(0));
    let [_, raw, raw_packed, ac_packed, dc_packed, rle_packed, rle_unpacked, rle, ac, dc, _] = counters;
    let expected = (block.width * block.height * header.channels.bytes_per_pixel) as u64;
    let squares = (block.width.div_ceil(8) * block.height.div_ceil(8) * header.channels.list.len()) as u64;
    let deflated = |bytes: u64, packed: u64| bytes <= packed.saturating_mul(1032);
    let packed = [raw_packed, ac_packed, dc_packed, rle_packed].into_iter().fold(0, u64::saturating_add);
    packed <= streams.len() as u64
        && raw <= expected
        && rle <= expected
        && rle_unpacked <= 2 * expected
        && ac <= 63 * squares
        && dc <= squares
        // Every square has at least the mark that ends it.
        && dc <= ac
        && deflated(raw, raw_packed)
        && deflated(rle_unpacked, rle_packed)
        && rle <= 64 * rle_unpacked
        && deflated(2 * ac, ac_packed)
        && deflated(2 * dc, dc_packed)
        // Every channel is in one of the streams: as it is, in run lengths, or as a square of 64 samples of at most four
        // bytes for each DC value.
        && expected <= raw + rle + 256 * dc
}

fn read_u64(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |value, &b| value << 8 | u64::from(b))
}

//! An OpenEXR file in memory: its headers, its text attributes, its blocks decompressed one after the other, and whether their
//! bytes can hold the pixels that the header announces.

use crate::error::{Error, Place, Result};
use crate::interrupt;
use exr::compression::Compression;
use exr::meta::attribute::IntegerBounds;
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use rayon::prelude::*;
use std::borrow::Cow;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

/// Blocks are decompressed in groups of about this many bytes, to bound the memory besides the result.
const BYTES_AT_ONCE: usize = 1 << 26;
/// Larger blocks are refused: 16 lines of 65536 pixels with 256 channels of four bytes.
const MAX_BLOCK_BYTES: usize = 1 << 30;
/// Files with more channels than this are refused.
const MAX_CHANNELS: usize = 4096;
/// Text attributes beyond these are passed over.
const MAX_TEXTS: usize = 1024;

/// A file whose headers make sense; nothing is known of its blocks.
#[derive(Debug, Clone)]
pub(super) struct Exr<'a> {
    pub path: PathBuf,
    pub bytes: Cow<'a, [u8]>,
    meta: MetaData,
    /// Where the tables of blocks begin.
    table: usize,
}

impl<'a> Exr<'a> {
    /// Reads the headers of all parts.
    pub fn parse(path: &Path, bytes: impl Into<Cow<'a, [u8]>>) -> Result<Self> {
        let bytes = bytes.into();
        let mut cursor = Cursor::new(&*bytes);
        // Not pedantic: damaged attributes that the image does not need are passed over.
        let meta = MetaData::read_from_buffered(&mut cursor, false).map_err(|e| {
            let method = compression_method(&bytes).filter(|m| *m > KNOWN_METHODS);
            method.map_or_else(|| foreign(path, &e), |m| unknown_method(path, m))
        })?;
        if let Some(crowded) = meta.headers.iter().map(|h| h.channels.list.len()).find(|n| *n > MAX_CHANNELS) {
            return Err(Error::limit(path, format!("{crowded} channels in one part are more than are read"))
                .with_hint(format!("at most {MAX_CHANNELS}; the file is damaged, or split it")));
        }
        Ok(Self { path: path.into(), table: cursor.position() as usize, bytes, meta })
    }

    /// One header per part.
    pub fn headers(&self) -> &[Header] {
        &self.meta.headers
    }

    /// Names and values of the first part's text attributes (at most [`MAX_TEXTS`]), in their order.
    pub fn texts(&self) -> Vec<(String, String)> {
        // The headers are sound, or they would not have been read; here only their order is recovered.
        let mut rest = self.bytes.get(8..self.table).unwrap_or_default();
        let mut texts = Vec::new();
        while let Some((name, kind, value)) = attribute(&mut rest).filter(|_| texts.len() < MAX_TEXTS) {
            if kind == b"string" {
                let text = |bytes| String::from_utf8_lossy(bytes).into_owned();
                texts.push((text(name), text(value)));
            }
        }
        texts
    }

    /// The blocks of the full resolution of a part; an error if one is missing or too short for the size in
    /// the header, so that it is safe to allocate the result afterwards.
    pub fn blocks(&self, part: usize) -> Result<Blocks<'_>> {
        let header = &self.meta.headers[part];
        let unread = match header.compression {
            Compression::HTJ2K32 => Some("HTJ2K32"),
            Compression::HTJ2K256 => Some("HTJ2K256"),
            _ => None,
        };
        if let Some(name) = unread {
            return Err(unread_compression(&self.path, name));
        }
        let blocks = locate(&self.path, &self.bytes, &self.meta, part, self.table)?;
        let pixels = blocks.iter().map(|b| b.width * b.height).max().unwrap_or(1);
        let largest = pixels.saturating_mul(header.channels.bytes_per_pixel);
        if largest > MAX_BLOCK_BYTES {
            return Err(Error::limit(&self.path, format!("a block of {} MiB is more than is read", largest >> 20))
                .with_hint("save the image with smaller tiles or fewer channels"));
        }
        Ok(Blocks { path: &self.path, header, blocks, at_once: (BYTES_AT_ONCE / largest.max(1)).max(1) })
    }
}

/// The blocks of one part, known to be there.
pub(super) struct Blocks<'a> {
    path: &'a Path,
    header: &'a Header,
    blocks: Vec<Block<'a>>,
    at_once: usize,
}

impl Blocks<'_> {
    /// Decompresses all blocks. `take` makes something of each, in parallel (the bytes are lines, in each one channel
    /// after the other, in native byte order); `put` gets what it made, in the order of the file.
    pub fn read<T: Send>(
        &self,
        take: impl Fn(&Block<'_>, Vec<u8>) -> T + Sync,
        mut put: impl FnMut(&Block<'_>, T),
    ) -> Result<()> {
        for (number, group) in self.blocks.chunks(self.at_once).enumerate() {
            // A small file, such as the embedded map, is read whole.
            if number > 0 {
                interrupt::check()?;
            }
            let taken = group.par_iter().map(|block| Ok(take(block, self.decompress(block)?)));
            let taken: Vec<T> = taken.collect::<Result<_>>()?;
            group.iter().zip(taken).for_each(|(block, value)| put(block, value));
        }
        Ok(())
    }

    fn decompress(&self, block: &Block<'_>) -> Result<Vec<u8>> {
        let section = IntegerBounds::new((block.x as i32, block.y as i32), (block.width, block.height));
        let data = block.data.to_vec();
        let place = Place::Byte(block.offset as u64);
        // The checks before leave no known way to make the codecs panic; should there be one, it ends as an error.
        let result = catch_unwind(AssertUnwindSafe(|| {
            self.header.compression.decompress_image_section_from_le(self.header, data, section, false)
        }));
        match result {
            Ok(decoded) => decoded.map_err(|e| foreign(self.path, &e).at(place)),
            Err(_) => Err(damaged(self.path, "a block cannot be decompressed").at(place)),
        }
    }
}

/// Takes an attribute (name, type, value) off the front of a header; nothing at its end.
fn attribute<'a>(rest: &mut &'a [u8]) -> Option<(&'a [u8], &'a [u8], &'a [u8])> {
    let mut text = || {
        let end = rest.iter().position(|b| *b == 0)?;
        let (text, tail) = (&rest[..end], &rest[end + 1..]);
        *rest = tail;
        Some(text)
    };
    let name = text().filter(|name| !name.is_empty())?;
    let kind = text()?;
    let (length, tail) = rest.split_first_chunk()?;
    let (value, tail) = tail.split_at_checked(usize::try_from(i32::from_le_bytes(*length)).ok()?)?;
    *rest = tail;
    Some((name, kind, value))
}

/// An error of the `exr` crate as one of this crate.
fn foreign(path: &Path, error: &exr::error::Error) -> Error {
    match error {
        exr::error::Error::NotSupported(what) => {
            Error::unsupported(path, format!("OpenEXR: {what}")).with_hint(CONVERT)
        }
        exr::error::Error::Invalid(what) if what == "reference to missing bytes" => {
            damaged(path, "the header runs beyond the end of the file")
        }
        exr::error::Error::Invalid(what) => damaged(path, what),
        other => damaged(path, &other.to_string()),
    }
}

/// The highest number of a compression method that the `exr` crate has a name for.
const KNOWN_METHODS: u8 = 11;

/// The number of the compression method, looked for without parsing the header (which comes first in the file).
fn compression_method(bytes: &[u8]) -> Option<u8> {
    let name = b"compression\0compression\0\x01\0\0\0";
    let at = bytes[..bytes.len().min(1 << 16)].windows(name.len()).position(|w| w == name)?;
    bytes.get(at + name.len()).copied()
}

/// What turns nearly any OpenEXR file into one that is read.
const CONVERT: &str = "convert it: exrmetrics --convert -z zip in.exr -o out.exr, or oiiotool in.exr --compression zip -o \
                       out.exr";

fn unknown_method(path: &Path, method: u8) -> Error {
    unread_compression(path, &format!("number {method}, which is newer than this program,"))
}

fn unread_compression(path: &Path, name: &str) -> Error {
    Error::unsupported(path, format!("the OpenEXR compression {name} is not read")).with_hint(CONVERT)
}

fn damaged(path: &Path, what: &str) -> Error {
    Error::input(path, format!("damaged OpenEXR file: {what}")).with_hint("fetch the file again")
}

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

/// Finds all blocks of the full resolution of one part before any image is allocated: the codecs reserve memory for whatever size a
/// header or a compressed stream announces, and a file of a hundred bytes can announce terabytes. `table` is where the offset tables begin, after the headers.
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

//! An OpenEXR file in memory: its headers, its text attributes, its blocks decompressed one after the other.

use super::chunks::{Block, locate};
use crate::error::{Error, Place, Result};
use crate::interrupt;
use exr::compression::Compression;
use exr::meta::MetaData;
use exr::meta::attribute::IntegerBounds;
use exr::meta::header::Header;
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

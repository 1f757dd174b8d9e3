//! The choice of the channels of an OpenEXR file that are its image.

use crate::error::{Error, Result};
use exr::math::Vec2;
use exr::meta::attribute::SampleType;
use exr::meta::header::Header;
use std::path::Path;

/// One channel inside the rows of a decoded block: bytes before it per pixel, and its type.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Channel {
    /// Bytes of the channels before it, per pixel.
    pub before: usize,
    pub kind: SampleType,
}

/// The layer that is the image, and the part that it is in.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Choice {
    pub part: usize,
    pub layer: Shown,
}

/// A layer, and the channels shown as red, green and blue (`None`: black).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Shown {
    /// Empty for channels without a layer.
    pub name: String,
    /// How well it serves as the image.
    pub fit: Fit,
    /// Channels for red, green and blue.
    pub rgb: [Option<Channel>; 3],
    /// The channel of its coverage, which is not read into images.
    pub alpha: Option<Channel>,
    /// What is a guess about the channels.
    pub note: Option<String>,
}

/// How well a layer serves as the image; the first layer of the best kind is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Fit {
    Colour,
    Luminance,
    SomeColour,
    OtherChannel,
}

/// Picks, in this order: the first layer with R, G and B; with Y; with some of R, G, B; with a single channel beside
/// alpha. A single channel is shown as grey, of two colours the third is black. A layer is the part of a channel name
/// before the last dot, in one part of the file; deep parts are passed over.
pub(super) fn choose(path: &Path, headers: &[Header]) -> Result<Choice> {
    let mut best: Option<Choice> = None;
    for (part, header) in headers.iter().enumerate().filter(|(_, h)| !h.deep) {
        for layer in layers(header) {
            if best.as_ref().is_none_or(|found| layer.fit < found.layer.fit) {
                best = Some(Choice { part, layer });
            }
        }
    }
    let Some(choice) = best else {
        return Err(if headers.iter().any(|h| h.deep) {
            Error::unsupported(path, "deep OpenEXR data are not read").with_hint("flatten the image when saving it")
        } else {
            let channels = list(headers.iter().flat_map(|h| &h.channels.list).map(|c| c.name.to_string()));
            Error::unsupported(path, format!("no R, G, B or Y among the channels of the OpenEXR file: {channels}"))
                .with_hint("save the image as RGB; X, Y, Z (CIE) and vectors are not converted")
        });
    };
    let channels = &headers[choice.part].channels.list;
    if channels.iter().any(|c| c.sampling != Vec2(1, 1)) || is_luminance_chroma(&headers[choice.part]) {
        return Err(Error::unsupported(path, "OpenEXR luminance/chroma and subsampled channels are not read")
            .with_hint("save the image as RGB"));
    }
    Ok(choice)
}

/// Notes on what is a guess about a choice.
///
/// # Errors
/// [`Error::Unsupported`] when several named layers of the part are equally good.
pub(super) fn notes(path: &Path, headers: &[Header], choice: &Choice) -> Result<Vec<String>> {
    let Choice { part, layer } = choice;
    let others = layers(&headers[*part]);
    let candidates: Vec<&Shown> = others.iter().filter(|other| other.fit == layer.fit).collect();
    if !layer.name.is_empty() && candidates.len() > 1 {
        let names = list(candidates.iter().map(|layer| layer.name.clone()));
        return Err(Error::unsupported(path, format!("which layer of the OpenEXR file is the image? It has {names}"))
            .with_hint("save one of them as R, G, B: oiiotool in.exr --ch R=NAME.R,G=NAME.G,B=NAME.B -o out.exr"));
    }
    let mut notes: Vec<String> = layer.note.clone().into_iter().collect();
    if !layer.name.is_empty() {
        let unnamed = others.iter().any(|other| other.name.is_empty());
        let instead =
            if unnamed { ", not the channels without a layer" } else { " as the image: no other has R, G and B" };
        notes.push(format!("the layer {:?} is taken{instead}", layer.name));
    }
    let fits = |header: &&Header| !header.deep && layers(header).iter().any(|other| other.fit == layer.fit);
    let parts = headers.iter().filter(fits).count();
    if parts > 1 {
        let name = headers[*part]
            .own_attributes
            .layer_name
            .as_ref()
            .map_or(String::new(), |name| format!(" ({:?})", name.to_string()));
        notes.push(format!("part {}{name} is taken, the first of {parts} that hold an image", part + 1));
    }
    Ok(notes)
}

/// Names for a message: quoted, and not too many.
fn list(names: impl Iterator<Item = String>) -> String {
    const MOST: usize = 12;
    let quoted: Vec<String> = names.map(|name| format!("{:?}", name.chars().take(60).collect::<String>())).collect();
    let rest = if quoted.len() > MOST { format!(" and {} more", quoted.len() - MOST) } else { String::new() };
    quoted[..quoted.len().min(MOST)].join(", ") + &rest
}

fn is_luminance_chroma(header: &Header) -> bool {
    let has = |name: &str| header.channels.list.iter().any(|c| c.name.to_string() == name);
    has("Y") && has("RY") && has("BY")
}

/// The layers of a part in the order of their first channels, the unnamed one first.
pub(super) fn layers(header: &Header) -> Vec<Shown> {
    let mut before = 0;
    let mut groups: Vec<(String, Vec<(String, Channel)>)> = vec![(String::new(), Vec::new())];
    for description in &header.channels.list {
        let name = description.name.to_string();
        let (layer, role) = name.rsplit_once('.').unwrap_or(("", &name));
        let channel = (role.to_ascii_lowercase(), Channel { before, kind: description.sample_type });
        match groups.iter_mut().find(|(known, _)| known == layer) {
            Some((_, channels)) => channels.push(channel),
            None => groups.push((layer.into(), vec![channel])),
        }
        before += description.sample_type.bytes_per_sample();
    }
    groups.into_iter().filter_map(|(name, channels)| shown(name, &channels)).collect()
}

/// Three channels of a layer by their names, if they are all there.
pub(super) fn named(header: &Header, layer: &str, roles: [&str; 3]) -> Option<Shown> {
    let mut before = 0;
    let mut rgb = [None; 3];
    for description in &header.channels.list {
        let name = description.name.to_string();
        let (of, role) = name.rsplit_once('.').unwrap_or(("", &name));
        if let Some(place) = roles.iter().position(|known| *known == role).filter(|_| of == layer) {
            rgb[place] = Some(Channel { before, kind: description.sample_type });
        }
        before += description.sample_type.bytes_per_sample();
    }
    let is_whole = rgb.iter().all(Option::is_some);
    is_whole.then(|| Shown { name: layer.into(), fit: Fit::OtherChannel, rgb, alpha: None, note: None })
}

/// A layer as an image, if its channels can be one.
fn shown(name: String, channels: &[(String, Channel)]) -> Option<Shown> {
    const COLOURS: [[&str; 2]; 3] = [["r", "red"], ["g", "green"], ["b", "blue"]];
    let find = |names: [&str; 2]| channels.iter().find(|(role, _)| names.contains(&role.as_str())).map(|&(_, c)| c);
    let rgb = COLOURS.map(find);
    // The y of x, y and z is a CIE tristimulus value or the component of a vector.
    let luminance = find(["y", "luminance"]).filter(|_| find(["x", "x"]).is_none());
    let mut others = channels.iter().filter(|(role, _)| role != "a" && role != "alpha");
    let colours = || rgb.iter().zip(COLOURS).map(|(found, [letter, _])| (found, letter.to_uppercase()));
    let (fit, rgb, note) = match rgb.iter().flatten().count() {
        3 => (Fit::Colour, rgb, None),
        _ if luminance.is_some() => {
            (Fit::Luminance, [luminance; 3], Some("there is luminance Y and no colour: it is taken as grey".into()))
        }
        2 => {
            let missing: String = colours().filter(|(found, _)| found.is_none()).map(|(_, letter)| letter).collect();
            (Fit::SomeColour, rgb, Some(format!("there is no channel {missing}: it is taken as black")))
        }
        1 => {
            let only: String = colours().filter(|(found, _)| found.is_some()).map(|(_, letter)| letter).collect();
            let note = format!("{only} is the only channel of R, G and B: it is taken as grey");
            (Fit::SomeColour, [rgb[0].or(rgb[1]).or(rgb[2]); 3], Some(note))
        }
        _ => {
            let (role, channel) = others.next().filter(|_| others.next().is_none())?;
            let note = format!("the only channel, {role:?}, is neither a colour nor Y: it is taken as grey");
            (Fit::OtherChannel, [Some(*channel); 3], Some(note))
        }
    };
    Some(Shown { name, fit, rgb, alpha: find(["a", "alpha"]), note })
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::meta::attribute::{ChannelDescription, Text};

    fn part(names: &[&str]) -> Header {
        let channels = names.iter().map(|&n| ChannelDescription::named(n, SampleType::F16)).collect();
        Header::new(Text::from("part"), (1, 1), channels)
    }

    /// The positions, in the channel list, of what is shown as R, G, B.
    fn shown(names: &[&str]) -> [Option<usize>; 3] {
        choose(Path::new("a.exr"), &[part(names)]).unwrap().layer.rgb.map(|c| c.map(|c| c.before / 2))
    }

    /// What is said about the choice.
    fn said(parts: &[&[&str]]) -> Result<String> {
        let (path, headers) = (Path::new("a.exr"), parts.iter().map(|names| part(names)).collect::<Vec<_>>());
        notes(path, &headers, &choose(path, &headers)?).map(|notes| notes.join("; "))
    }

    #[test]
    fn guesses_are_noted() {
        for plain in [&["A", "B", "G", "R"][..], &["B", "G", "R", "id.Y", "noise.B", "noise.G", "noise.R"]] {
            assert_eq!(said(&[plain]).unwrap(), "", "{plain:?}");
        }
        for (guessed, expected) in [
            (&["G"][..], "G is the only channel of R, G and B: it is taken as grey"),
            (&["A", "G", "R"], "no channel B: it is taken as black"),
            (&["A", "Y"], "no colour: it is taken as grey"),
            (
                &["N.x", "N.y", "N.z", "beauty.B", "beauty.G", "beauty.R", "depth.Z"],
                "the layer \"beauty\" is taken as the image",
            ),
            (&["A", "Z"], "\"z\", is neither a colour nor Y"),
            (&["Y", "beauty.B", "beauty.G", "beauty.R"], "the layer \"beauty\" is taken"),
        ] {
            let said = said(&[guessed]).unwrap();
            assert!(said.contains(expected), "{guessed:?}: {said}");
        }
        let said = said(&[&["Z"], &["B", "G", "R"], &["B", "G", "R"]]).unwrap();
        assert!(said.contains("part 2 (\"part\") is taken, the first of 2"), "{said}");
    }

    #[test]
    fn ambiguous_layers_are_refused_with_their_names() {
        for (names, expected) in [
            (&["X", "Y", "Z"][..], "\"X\", \"Y\", \"Z\""),
            (&["N.x", "N.y", "N.z"], "\"N.x\""),
            (&["u", "v"], "\"u\", \"v\""),
            (&["albedo.B", "albedo.G", "albedo.R", "beauty.B", "beauty.G", "beauty.R"], "\"albedo\", \"beauty\""),
            (&["depth.Z", "mask.m"], "\"depth\", \"mask\""),
        ] {
            let error = said(&[names]).unwrap_err();
            assert!(matches!(error, Error::Unsupported { .. }) && error.hint().is_some());
            assert!(error.to_string().contains(expected), "{names:?}: {error}");
        }
    }

    #[test]
    fn the_first_suitable_layer_is_shown() {
        assert_eq!(shown(&["A", "B", "G", "R"]), [Some(3), Some(2), Some(1)]);
        assert_eq!(shown(&["A", "Y"]), [Some(1); 3]);
        assert_eq!(shown(&["G"]), [Some(0); 3]);
        assert_eq!(shown(&["G", "R"]), [Some(1), Some(0), None]);
        assert_eq!(shown(&["A", "Z"]), [Some(1); 3]);
        assert_eq!(shown(&["N.x", "diffuse.B", "diffuse.G", "diffuse.R"]), [Some(3), Some(2), Some(1)]);
        assert_eq!(shown(&["B", "G", "R", "a.B", "a.G", "a.R"]), [Some(2), Some(1), Some(0)]);
        assert_eq!(shown(&["a.b.blue", "a.b.green", "a.b.red"]), [Some(2), Some(1), Some(0)]);
    }

    #[test]
    fn a_later_part_wins_when_it_alone_has_colour() {
        let choice = choose(Path::new("a.exr"), &[part(&["Z"]), part(&["B", "G", "R"]), part(&["B", "G", "R"])]);
        assert_eq!(choice.unwrap().part, 1);
    }

    #[test]
    fn files_without_colour_are_errors() {
        let path = Path::new("a.exr");
        assert!(matches!(choose(path, &[part(&["A"])]), Err(Error::Unsupported { .. })));
        assert!(matches!(choose(path, &[part(&["BY", "RY", "Y"])]), Err(Error::Unsupported { .. })));
        let mut halved = part(&["B", "G", "R"]);
        halved.channels.list[0].sampling = Vec2(2, 2);
        assert!(matches!(choose(path, &[halved]), Err(Error::Unsupported { .. })));
        let mut deep = part(&["B", "G", "R"]);
        deep.deep = true;
        assert!(choose(path, &[deep]).unwrap_err().to_string().contains("deep"));
    }
}

//! Which channels of an OpenEXR file are its picture.

use crate::error::{Error, Result};
use exr::math::Vec2;
use exr::meta::attribute::SampleType;
use exr::meta::header::Header;
use std::path::Path;

/// One channel inside the rows of a decoded block: bytes before it per pixel, and its type.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Channel {
    pub before: usize,
    pub kind: SampleType,
}

/// The channels shown as red, green and blue (`None`: black), and the part that they are in.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Choice {
    pub part: usize,
    pub rgb: [Option<Channel>; 3],
}

/// A layer, and how its channels are shown.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Shown {
    pub name: String,
    pub fit: Fit,
    pub rgb: [Option<Channel>; 3],
}

/// How well a layer serves as the picture; the first layer of the best kind is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Fit {
    Colour,
    Luminance,
    SomeColour,
    OtherChannel,
}

/// Picks, in this order: the first layer with R, G and B; with Y; with some of R, G, B; any channel but alpha. A
/// single channel is shown as grey, of two colours the third is black. A layer is the part of a channel name before
/// the last dot, in one part of the file; deep parts are passed over.
pub(super) fn choose(path: &Path, headers: &[Header]) -> Result<Choice> {
    let mut best: Option<(Fit, Choice)> = None;
    for (part, header) in headers.iter().enumerate().filter(|(_, h)| !h.deep) {
        for Shown { fit, rgb, .. } in layers(header) {
            if best.as_ref().is_none_or(|(found, _)| fit < *found) {
                best = Some((fit, Choice { part, rgb }));
            }
        }
    }
    let Some((_, choice)) = best else {
        return Err(if headers.iter().any(|h| h.deep) {
            Error::unsupported(path, "deep OpenEXR data are not read").with_hint("flatten the image when saving it")
        } else {
            Error::input(path, "the OpenEXR file has no colour channel")
        });
    };
    let channels = &headers[choice.part].channels.list;
    if channels.iter().any(|c| c.sampling != Vec2(1, 1)) || is_luminance_chroma(&headers[choice.part]) {
        return Err(Error::unsupported(path, "OpenEXR luminance/chroma and subsampled channels are not read")
            .with_hint("save the image as RGB"));
    }
    Ok(choice)
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
    let shown = |(name, channels): (String, Vec<_>)| picture(&channels).map(|(fit, rgb)| Shown { name, fit, rgb });
    groups.into_iter().filter_map(shown).collect()
}

fn picture(channels: &[(String, Channel)]) -> Option<(Fit, [Option<Channel>; 3])> {
    let find = |names: [&str; 2]| channels.iter().find(|(role, _)| names.contains(&role.as_str())).map(|&(_, c)| c);
    let rgb = [find(["r", "red"]), find(["g", "green"]), find(["b", "blue"])];
    let luminance = find(["y", "luminance"]);
    let other = channels.iter().find(|(role, _)| role != "a" && role != "alpha").map(|&(_, c)| c);
    match rgb.iter().flatten().count() {
        3 => Some((Fit::Colour, rgb)),
        _ if luminance.is_some() => Some((Fit::Luminance, [luminance; 3])),
        2 => Some((Fit::SomeColour, rgb)),
        1 => Some((Fit::SomeColour, [rgb[0].or(rgb[1]).or(rgb[2]); 3])),
        _ => other.map(|c| (Fit::OtherChannel, [Some(c); 3])),
    }
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
        choose(Path::new("a.exr"), &[part(names)]).unwrap().rgb.map(|c| c.map(|c| c.before / 2))
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
    fn what_cannot_be_shown_is_an_error() {
        let path = Path::new("a.exr");
        assert!(matches!(choose(path, &[part(&["A"])]), Err(Error::Input { .. })));
        assert!(matches!(choose(path, &[part(&["BY", "RY", "Y"])]), Err(Error::Unsupported { .. })));
        let mut halved = part(&["B", "G", "R"]);
        halved.channels.list[0].sampling = Vec2(2, 2);
        assert!(matches!(choose(path, &[halved]), Err(Error::Unsupported { .. })));
        let mut deep = part(&["B", "G", "R"]);
        deep.deep = true;
        assert!(choose(path, &[deep]).unwrap_err().to_string().contains("deep"));
    }
}

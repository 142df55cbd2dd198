//! The container of MP4: boxes in boxes, with all tables before the pictures so that players can begin while they load.
//!
//! Source: [Isobmff](crate::references#isobmff) (boxes), [`AvcFile`](crate::references#avcfile) (how H.264 lies in them).

use super::h264::{ParameterSets, Sample};

/// A film with one track of pictures.
#[derive(Clone, Copy, Debug)]
pub struct Track<'a> {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Frames per second.
    pub fps: u32,
    /// What players must know before the first picture.
    pub sets: &'a ParameterSets,
    /// The pictures, in the order in which they are shown.
    pub samples: &'a [Sample],
}

/// Units of time in a frame: some players round in large units.
const TICKS: u32 = 512;
/// Pictures whose places are told by one number.
const CHUNK: usize = 64;
/// 1 as a fixed-point number with 16 bits behind the point.
const ONE: u32 = 1 << 16;

/// The bytes of the file.
pub fn file(track: &Track<'_>) -> Vec<u8> {
    let start = full(
        b"ftyp",
        &[b"isom", &be(512), b"isom", b"iso2", b"avc1", b"mp41"],
    );
    let size: usize = track.samples.iter().map(|sample| sample.data.len()).sum();
    // With 64-bit places the tables have the same size wherever the pictures lie, so they can be made twice.
    let head = 16;
    let tables = movie(track, 0).len();
    let first = (start.len() + tables + head) as u64;
    let mut out = start;
    out.extend(movie(track, first));
    out.extend_from_slice(&be(1));
    out.extend_from_slice(b"mdat");
    out.extend_from_slice(&((size + head) as u64).to_be_bytes());
    for sample in track.samples {
        out.extend_from_slice(&sample.data);
    }
    out
}

/// All that is told about the pictures, the first of which lies at byte `first` of the file.
fn movie(track: &Track<'_>, first: u64) -> Vec<u8> {
    let n = u32::try_from(track.samples.len()).unwrap_or(u32::MAX);
    let scale = track.fps * TICKS;
    let duration = be(n.saturating_mul(TICKS));
    let matrix: Vec<u8> = [ONE, 0, 0, 0, ONE, 0, 0, 0, 1 << 30]
        .into_iter()
        .flat_map(be)
        .collect();
    let none = be(0);
    let header = full(
        b"mvhd",
        &[
            &none,
            &none,
            &none,
            &be(scale),
            &duration,
            &be(ONE),
            &[1, 0],
            &[0; 10],
            &matrix,
            &[0; 24],
            &be(2),
        ],
    );
    let place = full(
        b"tkhd",
        &[
            &be(3),
            &none,
            &none,
            &be(1),
            &none,
            &duration,
            &[0; 16],
            &matrix,
            &be(track.width * ONE),
            &be(track.height * ONE),
        ],
    );
    // Language: undetermined.
    let media = full(
        b"mdhd",
        &[
            &none,
            &none,
            &none,
            &be(scale),
            &duration,
            &[0x55, 0xc4, 0, 0],
        ],
    );
    let handler = full(b"hdlr", &[&none, &none, b"vide", &[0; 12], b"pictures\0"]);
    let video = full(b"vmhd", &[&be(1), &[0; 8]]);
    let here = full(
        b"dinf",
        &[&full(b"dref", &[&none, &be(1), &full(b"url ", &[&be(1)])])],
    );
    let table = tables(track, n, first);
    let info = full(b"minf", &[&video, &here, &table]);
    let trak = full(
        b"trak",
        &[&place, &full(b"mdia", &[&media, &handler, &info])],
    );
    full(b"moov", &[&header, &trak])
}

/// What each picture is, how long, and where.
fn tables(track: &Track<'_>, n: u32, first: u64) -> Vec<u8> {
    let none = be(0);
    let kind = full(b"stsd", &[&none, &be(1), &entry(track)]);
    let times = full(b"stts", &[&none, &be(1), &be(n), &be(TICKS)]);
    let keys: Vec<u8> = (1..)
        .zip(track.samples)
        .filter(|(_, sample)| sample.is_key)
        .flat_map(|(number, _)| be(number))
        .collect();
    let begins = full(b"stss", &[&none, &be((keys.len() / 4) as u32), &keys]);

    // Chunks of equally many pictures; the last may hold fewer.
    let chunks: Vec<&[Sample]> = track.samples.chunks(CHUNK).collect();
    let rest = track.samples.len() % CHUNK;
    let mut runs = vec![[1, CHUNK.min(track.samples.len()) as u32, 1]];
    if rest != 0 && chunks.len() > 1 {
        runs.push([chunks.len() as u32, rest as u32, 1]);
    }
    let n_runs = runs.len() as u32;
    let runs: Vec<u8> = runs.into_iter().flatten().flat_map(be).collect();
    let runs = full(b"stsc", &[&none, &be(n_runs), &runs]);

    let lengths: Vec<u8> = track
        .samples
        .iter()
        .flat_map(|sample| be(sample.data.len() as u32))
        .collect();
    let lengths = full(b"stsz", &[&none, &none, &be(n), &lengths]);
    let mut at = first;
    let mut places = Vec::new();
    for chunk in &chunks {
        places.extend_from_slice(&at.to_be_bytes());
        at += chunk
            .iter()
            .map(|sample| sample.data.len() as u64)
            .sum::<u64>();
    }
    let places = full(b"co64", &[&none, &be(chunks.len() as u32), &places]);
    full(b"stbl", &[&kind, &times, &begins, &runs, &lengths, &places])
}

/// The description of the pictures: their size, how they are encoded, their colors.
fn entry(track: &Track<'_>) -> Vec<u8> {
    let sets = track.sets;
    let half = |n: u32| [(n >> 8) as u8, n as u8];
    let length = |set: &[u8]| half(set.len() as u32);
    let profile = sets.sequence.get(1..4).unwrap_or(&[0; 3]);
    // After the sets: 4:2:0, 8 bits of brightness, 8 of color, no more sets; only for profiles from High up.
    let fine: &[u8] = if profile[0] >= 100 {
        &[0xfd, 0xf8, 0xf8, 0]
    } else {
        &[]
    };
    let config = full(
        b"avcC",
        &[
            &[1],
            profile,
            &[0xff, 0xe1],
            &length(&sets.sequence),
            &sets.sequence,
            &[1],
            &length(&sets.picture),
            &sets.picture,
            fine,
        ],
    );
    // BT.709 three times, not the full range.
    let colors = full(b"colr", &[b"nclx", &[0, 1, 0, 1, 0, 1, 0]]);
    let pixels = full(b"pasp", &[&be(1), &be(1)]);
    // 72 dots per inch, one frame, no name, 24 bits, no palette.
    full(
        b"avc1",
        &[
            &[0; 6],
            &[0, 1],
            &[0; 16],
            &half(track.width),
            &half(track.height),
            &be(72 * ONE),
            &be(72 * ONE),
            &be(0),
            &[0, 1],
            &[0; 32],
            &[0, 24],
            &[0xff, 0xff],
            &config,
            &colors,
            &pixels,
        ],
    )
}

/// A box of these parts.
fn full(name: &[u8; 4], parts: &[&[u8]]) -> Vec<u8> {
    let length: usize = parts.iter().map(|part| part.len()).sum();
    let mut out = Vec::with_capacity(length + 8);
    out.extend_from_slice(&be((length + 8) as u32));
    out.extend_from_slice(name);
    for part in parts {
        out.extend_from_slice(part);
    }
    out
}

fn be(number: u32) -> [u8; 4] {
    number.to_be_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The content of the box at the end of a path of boxes without content of their own.
    fn find<'a>(file: &'a [u8], path: &[&[u8; 4]]) -> &'a [u8] {
        let (name, rest) = path.split_first().unwrap();
        let mut at = 0;
        while at < file.len() {
            let size = u32::from_be_bytes(*file[at..].first_chunk().unwrap()) as usize;
            if file[at + 4..at + 8] == **name {
                let content = &file[at + 8..at + size];
                return if rest.is_empty() {
                    content
                } else {
                    find(content, rest)
                };
            }
            at += size;
        }
        panic!("no box {:?}", std::str::from_utf8(&path[0][..]));
    }

    #[test]
    fn places_lead_to_the_pictures_and_tables_come_first() {
        let sets = ParameterSets {
            sequence: vec![0x67, 100, 0, 30, 5],
            picture: vec![0x68, 1],
        };
        let samples: Vec<Sample> = (0..150_usize)
            .map(|i| Sample {
                data: vec![i as u8; 10 + i],
                is_key: i % 50 == 0,
            })
            .collect();
        let track = Track {
            width: 64,
            height: 32,
            fps: 24,
            sets: &sets,
            samples: &samples,
        };
        let bytes = file(&track);
        let table: &[&[u8; 4]] = &[b"moov", b"trak", b"mdia", b"minf", b"stbl"];
        let places = find(&bytes, &[table, &[b"co64"]].concat());
        assert_eq!(places[4..8], be(3));
        for (chunk, place) in places[8..].chunks(8).enumerate() {
            let place = u64::from_be_bytes(place.try_into().unwrap()) as usize;
            assert_eq!(bytes[place..place + 10], [(chunk * CHUNK) as u8; 10]);
        }
        let keys = find(&bytes, &[table, &[b"stss"]].concat());
        assert_eq!(keys[8..], [be(1), be(51), be(101)].concat());
        let position = |name: &[u8]| bytes.windows(4).position(|w| w == name).unwrap();
        assert!(position(b"moov") < position(b"mdat"));
        let header = find(&bytes, &[b"moov", b"mvhd"]);
        assert_eq!(header[12..20], [be(24 * TICKS), be(150 * TICKS)].concat());
    }
}

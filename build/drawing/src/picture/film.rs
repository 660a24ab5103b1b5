//! An animation of a run.
//!
//! The pictures of an animated PNG share a palette: a robot has few colours. What does not change
//! from one picture to the next is transparent in it, and only the rectangle that changes is
//! written, so that a run of some seconds takes as much as two or three still pictures.
//!
//! Source: APNG specification 1.0.

use super::camera::Camera;
use super::look::{Look, Picture};
use super::solid::Stage;
use super::still::Subject;
use crate::image::png::{File, big, compressed};
use crate::scene::Scene;
use std::collections::BTreeMap;
use std::ops::Range;
use urdf2fmu_core::spatial::{Pose, Vec3};

/// Colours of a palette but for the transparent one.
const COLORS: usize = 255;

/// A camera that stands still shows a run that goes no further than this, in sizes of the robot.
const FAR: f64 = 2.0;

/// An animated PNG: one picture for each entry of `run`, which holds the poses of all links.
///
/// - `delay`: time from one picture to the next, ms
pub fn film(scene: &Scene, run: &[Vec<Pose>], delay: u16, look: &Look) -> Vec<u8> {
    let stage = Stage::new(scene);
    let cameras = cameras(&stage, run, look);
    let Some(camera) = cameras.first() else {
        return encode(&[], delay);
    };
    let subject = Subject::new(scene, stage, camera, look);
    let frames: Vec<Picture> = run
        .iter()
        .zip(&cameras)
        .map(|(poses, camera)| subject.draw(poses, camera, look))
        .collect();
    encode(&frames, delay)
}

/// A camera for each picture: one that sees the whole run if it stays near, else one that follows
/// the base.
fn cameras(stage: &Stage, run: &[Vec<Pose>], look: &Look) -> Vec<Camera> {
    let Some(first) = run.first() else {
        return Vec::new();
    };
    let start = first[0].p;
    let size = Camera::fit(stage.corners(first), look).size;
    let moved = |poses: &Vec<Pose>| {
        let p = poses[0].p - start;
        Vec3::new(p.x, p.y, 0.0)
    };
    let way = run.iter().map(|poses| moved(poses).norm());
    if way.fold(0.0, f64::max) <= FAR * size {
        let all = run.iter().flat_map(|poses| stage.corners(poses));
        return vec![Camera::fit(all, look); run.len()];
    }
    let all = run.iter().flat_map(|poses| {
        let by = moved(poses);
        stage.corners(poses).map(move |p| p - by)
    });
    let camera = Camera::fit(all, look);
    run.iter()
        .map(|poses| camera.moved(&moved(poses)))
        .collect()
}

/// Pictures of one size → an animated PNG that repeats.
fn encode(frames: &[Picture], delay: u16) -> Vec<u8> {
    let mut file = File::new();
    let Some(first) = frames.first() else {
        return file.end();
    };
    let (width, height) = (first.width, first.height);
    let palette = Palette::of(frames);
    file.header(width, height, 3);
    // Pictures, and 0 for endless repetition.
    file.chunk(*b"acTL", &[big(frames.len()), big(0)].concat());
    file.chunk(*b"PLTE", &palette.colors.concat());
    file.chunk(*b"tRNS", &[0]);
    let mut number = 0;
    let mut before: Option<Vec<u8>> = None;
    for frame in frames {
        let places: Vec<u8> = frame.pixels.iter().map(|&p| palette.place(p)).collect();
        let (columns, rows) = match &before {
            Some(before) => changed(before, &places, width),
            None => (0..width, 0..height),
        };
        let mut raw = Vec::with_capacity(columns.len() * rows.len());
        for y in rows.clone() {
            for k in y * width + columns.start..y * width + columns.end {
                let same = before.as_ref().is_some_and(|before| before[k] == places[k]);
                raw.push(if same { 0 } else { places[k] });
            }
        }
        let mut control = big(number).to_vec();
        number += 1;
        for x in [columns.len(), rows.len(), columns.start, rows.start] {
            control.extend(big(x));
        }
        control.extend(delay.to_be_bytes());
        control.extend(1000_u16.to_be_bytes());
        // What is there stays, and what is transparent shows it.
        control.extend([0, u8::from(before.is_some())]);
        file.chunk(*b"fcTL", &control);
        let data = compressed(&raw, columns.len(), 0);
        if before.is_some() {
            file.chunk(*b"fdAT", &[&big(number), data.as_slice()].concat());
            number += 1;
        } else {
            file.chunk(*b"IDAT", &data);
        }
        before = Some(places);
    }
    file.end()
}

/// Columns and rows of the rectangle outside of which two pictures are equal; never empty.
fn changed(before: &[u8], now: &[u8], width: usize) -> (Range<usize>, Range<usize>) {
    let (mut columns, mut rows) = ([usize::MAX, 0], [usize::MAX, 0]);
    for (k, _) in before
        .iter()
        .zip(now)
        .enumerate()
        .filter(|(_, (a, b))| a != b)
    {
        for (range, x) in [(&mut columns, k % width), (&mut rows, k / width)] {
            *range = [range[0].min(x), range[1].max(x + 1)];
        }
    }
    let range = |[start, end]: [usize; 2]| if start < end { start..end } else { 0..1 };
    (range(columns), range(rows))
}

/// Bits of a colour's numbers by which it is looked up.
const BITS: u32 = 5;

/// A palette: 0 is transparent.
struct Palette {
    colors: Vec<[u8; 3]>,
    /// Place in `colors` of each colour that occurs, by its upper bits.
    places: BTreeMap<[u8; 3], u8>,
}

/// Colours that become one: their upper bits, how often they occur, and the sums of their numbers.
type Bin = ([u8; 3], u64, [u64; 3]);

impl Palette {
    /// Median cut: the box of colours that reaches furthest is halved until there are enough.
    fn of(frames: &[Picture]) -> Self {
        let mut bins: BTreeMap<[u8; 3], (u64, [u64; 3])> = BTreeMap::new();
        for &pixel in frames.iter().flat_map(|frame| &frame.pixels) {
            let bin = bins.entry(upper(pixel)).or_default();
            bin.0 += 1;
            for (sum, number) in bin.1.iter_mut().zip(pixel) {
                *sum += u64::from(number);
            }
        }
        let all: Vec<Bin> = bins
            .into_iter()
            .map(|(key, (n, sum))| (key, n, sum))
            .collect();
        let mut boxes = vec![all];
        while boxes.len() < COLORS {
            let reach = |bins: &Vec<Bin>| {
                let spans = (0..3).map(|i| {
                    let values = bins.iter().map(|bin| bin.0[i]);
                    let span = values.clone().max().unwrap_or(0) - values.min().unwrap_or(0);
                    (span, i)
                });
                spans.max_by_key(|(span, _)| *span).unwrap_or((0, 0))
            };
            // Of colours that are far apart and often seen, the more the better.
            let worth = |bins: &Vec<Bin>| {
                let count: u64 = bins.iter().map(|bin| bin.1).sum();
                let (span, _) = reach(bins);
                u64::from(span) * u64::from(span) * u64::from(count.ilog2() + 1)
            };
            let Some(k) = (0..boxes.len()).max_by_key(|&k| (worth(&boxes[k]), usize::MAX - k))
            else {
                break;
            };
            let (span, axis) = reach(&boxes[k]);
            if span == 0 {
                break;
            }
            let mut bins = boxes.swap_remove(k);
            bins.sort_by_key(|bin| (bin.0[axis], bin.0));
            let middle = bins.len() / 2;
            let rest = bins.split_off(middle);
            boxes.push(bins);
            boxes.push(rest);
        }
        let mut palette = Self {
            colors: vec![[0; 3]],
            places: BTreeMap::new(),
        };
        for bins in boxes.iter().filter(|bins| !bins.is_empty()) {
            let count: u64 = bins.iter().map(|bin| bin.1).sum();
            let mean = |i: usize| {
                let sum: u64 = bins.iter().map(|bin| bin.2[i]).sum();
                u8::try_from((sum + count / 2) / count).unwrap_or(u8::MAX)
            };
            let place = u8::try_from(palette.colors.len()).unwrap_or(u8::MAX);
            palette.colors.push([mean(0), mean(1), mean(2)]);
            palette.places.extend(bins.iter().map(|bin| (bin.0, place)));
        }
        palette
    }

    fn place(&self, pixel: [u8; 4]) -> u8 {
        self.places.get(&upper(pixel)).copied().unwrap_or(0)
    }
}

fn upper(pixel: [u8; 4]) -> [u8; 3] {
    [0, 1, 2].map(|i| pixel[i] >> (8 - BITS))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_changes_is_written() {
        let picture = |spot: usize| Picture {
            width: 8,
            height: 4,
            pixels: (0..32)
                .map(|k| {
                    if k == spot {
                        [250, 0, 0, 255]
                    } else {
                        [9, 9, 9, 255]
                    }
                })
                .collect(),
        };
        let bytes = encode(&[picture(10), picture(11), picture(11)], 40);
        // Width, height, column, row of each picture behind its number.
        let controls: Vec<[u32; 4]> = bytes
            .windows(4)
            .enumerate()
            .filter(|(_, name)| name == b"fcTL")
            .map(|(at, _)| {
                std::array::from_fn(|i| {
                    let at = at + 8 + 4 * i;
                    u32::from_be_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
                })
            })
            .collect();
        assert_eq!(controls, [[8, 4, 0, 0], [2, 1, 2, 1], [1, 1, 0, 0]]);
    }
}

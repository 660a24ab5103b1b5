//! A PNG of 256 colours that stand for all of a picture: a third of the size of one with them all.
//!
//! Colours are multiplied by their alpha, as they are seen on black; alpha itself is the fourth
//! number. Their set is split where it varies most until there are enough groups (Wan, Wong and
//! Prusinkiewicz 1988: at the mean of the axis of greatest variance), and the means of the groups
//! are then moved (Lloyd 1982). Sums are taken in the order of the colours: the same picture gives
//! the same bytes.

use super::png::{self, File};

/// Most entries of a palette.
const MOST: usize = 256;

/// Times that means are moved; more change nothing that is seen.
const ROUNDS: usize = 4;

/// Colours of a picture beyond which it is a photograph, and the search would take long.
const MANY: usize = 40_000;

/// Mean error (root of the mean square) that is not seen, of 255.
const UNSEEN: f32 = 2.0;

/// A colour of the picture, or of the palette.
type Color = [f32; 4];

/// A colour of the picture.
struct Used {
    color: Color,
    /// Pixels that have it.
    count: usize,
    /// Its part in a mean. Less than its pixels: else the ground has all entries, and an edge none.
    weight: f32,
    /// Its place in the palette.
    entry: usize,
}

/// The content of a PNG file; none where 256 colours are too few for this picture.
pub fn encode(width: usize, height: usize, pixels: &[[u8; 4]]) -> Option<Vec<u8>> {
    let mut sorted = pixels.to_vec();
    sorted.sort_unstable();
    let mut used: Vec<Used> = sorted.chunk_by(PartialEq::eq).map(Used::new).collect();
    sorted.dedup();
    if used.len() > MANY {
        return None;
    }
    let mut palette = groups(&used);
    for _ in 0..ROUNDS {
        assign(&mut used, &palette);
        move_to_means(&mut palette, &used);
    }
    // Like colours side by side, those that shine through first: the others need no alpha.
    palette.sort_by(|a, b| a[3].total_cmp(&b[3]).then(sum(a).total_cmp(&sum(b))));
    assign(&mut used, &palette);
    if error(&used, &palette) > UNSEEN {
        return None;
    }
    let entry = |pixel: &[u8; 4]| {
        let place = sorted.binary_search(pixel).unwrap_or_default();
        byte(used[place].entry)
    };
    let raw: Vec<u8> = pixels.iter().map(entry).collect();
    let written: Vec<[u8; 4]> = palette.iter().map(straight).collect();
    let mut file = File::new();
    file.header(width, height, 3);
    let colors: Vec<u8> = written.iter().flat_map(|c| &c[..3]).copied().collect();
    file.chunk(*b"PLTE", &colors);
    let mut alpha: Vec<u8> = written.iter().map(|c| c[3]).collect();
    while alpha.last() == Some(&255) {
        alpha.pop();
    }
    if !alpha.is_empty() {
        file.chunk(*b"tRNS", &alpha);
    }
    file.chunk(*b"IDAT", &png::compressed(&raw, width, 0));
    Some(file.end())
}

impl Used {
    /// - `same`: all pixels of one colour
    fn new(same: &[[u8; 4]]) -> Self {
        let [r, g, b, alpha] = same[0].map(f32::from);
        let seen = |x: f32| x * alpha / 255.0;
        let count = number(same.len());
        Self {
            color: [seen(r), seen(g), seen(b), alpha],
            count: same.len(),
            weight: count.sqrt() * count.sqrt().sqrt(),
            entry: 0,
        }
    }
}

/// Some of the picture's colours.
struct Group {
    places: Vec<usize>,
    mean: Color,
    /// Sum of the squares of what its colours differ from the mean, along each axis.
    spread: Color,
}

impl Group {
    fn new(places: Vec<usize>, used: &[Used]) -> Self {
        let (mut total, mut mean, mut spread) = (0.0, [0.0; 4], [0.0; 4]);
        for Used { color, weight, .. } in places.iter().map(|&place| &used[place]) {
            total += weight;
            for (mean, x) in mean.iter_mut().zip(color) {
                *mean += weight * x;
            }
        }
        let mean: Color = mean.map(|sum: f32| sum / f32::max(total, 1.0));
        for Used { color, weight, .. } in places.iter().map(|&place| &used[place]) {
            for ((spread, mean), x) in spread.iter_mut().zip(&mean).zip(color) {
                *spread += weight * (x - mean) * (x - mean);
            }
        }
        Self {
            places,
            mean,
            spread,
        }
    }

    /// Two of one, at the mean of the axis where it varies most.
    fn split(self, used: &[Used]) -> [Self; 2] {
        let axes = 0..4;
        let most = axes.max_by(|&a, &b| self.spread[a].total_cmp(&self.spread[b]));
        let axis = most.unwrap_or_default();
        let (low, high) = self
            .places
            .into_iter()
            .partition(|&place| used[place].color[axis] <= self.mean[axis]);
        [Self::new(low, used), Self::new(high, used)]
    }
}

/// The means of as many groups as a palette has entries, or as there are colours.
fn groups(used: &[Used]) -> Vec<Color> {
    let mut groups = vec![Group::new((0..used.len()).collect(), used)];
    while groups.len() < MOST {
        let splits = (0..groups.len()).filter(|&k| groups[k].places.len() > 1);
        let worst = splits.max_by(|&a, &b| {
            let [a, b] = [a, b].map(|k| sum(&groups[k].spread));
            a.total_cmp(&b)
        });
        let Some(worst) = worst else { break };
        let parts = groups.swap_remove(worst).split(used);
        groups.extend(parts.into_iter().filter(|part| !part.places.is_empty()));
    }
    groups.into_iter().map(|group| group.mean).collect()
}

/// Gives each colour the nearest entry.
fn assign(used: &mut [Used], palette: &[Color]) {
    let mut distances = vec![0.0_f32; palette.len()];
    for used in used {
        for (distance, entry) in distances.iter_mut().zip(palette) {
            *distance = apart(&used.color, entry);
        }
        let mut best = (0, f32::INFINITY);
        for (entry, &distance) in distances.iter().enumerate() {
            if distance < best.1 {
                best = (entry, distance);
            }
        }
        used.entry = best.0;
    }
}

/// Moves each entry to the mean of the colours that it stands for.
fn move_to_means(palette: &mut [Color], used: &[Used]) {
    let mut sums = vec![([0.0_f32; 4], 0.0_f32); palette.len()];
    for Used {
        color,
        weight,
        entry,
        ..
    } in used
    {
        let (sum, total) = &mut sums[*entry];
        *total += weight;
        for (sum, x) in sum.iter_mut().zip(color) {
            *sum += weight * x;
        }
    }
    for (entry, (sum, total)) in palette.iter_mut().zip(sums) {
        if total > 0.0 {
            *entry = sum.map(|x| x / total);
        }
    }
}

/// Root of the mean square of what a pixel's numbers are wrong by.
fn error(used: &[Used], palette: &[Color]) -> f32 {
    let (mut squares, mut pixels) = (0.0, 0.0);
    for used in used {
        let count = number(used.count);
        squares += count * apart(&used.color, &palette[used.entry]);
        pixels += count;
    }
    (squares / f32::max(4.0 * pixels, 1.0)).sqrt()
}

/// Square of the distance of two colours.
fn apart(a: &Color, b: &Color) -> f32 {
    let [r, g, b, alpha] = [0, 1, 2, 3].map(|axis| (a[axis] - b[axis]) * (a[axis] - b[axis]));
    (r + g) + (b + alpha)
}

fn sum(color: &Color) -> f32 {
    color.iter().sum()
}

/// A colour as files have it, not multiplied by its alpha.
fn straight(color: &Color) -> [u8; 4] {
    let whole = |x: f32| {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped"
        )]
        let byte = (x.clamp(0.0, 255.0) + 0.5) as u8;
        byte
    };
    let alpha = whole(color[3]);
    if alpha == 0 {
        return [0; 4];
    }
    let [r, g, b] = [0, 1, 2].map(|axis| whole(color[axis] * 255.0 / f32::from(alpha)));
    [r, g, b, alpha]
}

fn number(count: usize) -> f32 {
    #[allow(clippy::cast_precision_loss, reason = "pixels of a picture")]
    let number = count as f32;
    number
}

/// A place in the palette.
fn byte(entry: usize) -> u8 {
    u8::try_from(entry).unwrap_or(u8::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::png::{ColorType, Decoder, Transformations};
    use std::io::Cursor;

    /// Pixels of a file, by a reader of another's.
    fn decoded(file: &[u8]) -> Vec<[u8; 4]> {
        let mut decoder = Decoder::new(Cursor::new(file));
        decoder.set_transformations(Transformations::EXPAND | Transformations::ALPHA);
        let mut reader = decoder.read_info().expect("a PNG");
        assert_eq!(reader.info().color_type, ColorType::Indexed);
        let mut bytes = vec![0; reader.output_buffer_size().expect("small")];
        reader.next_frame(&mut bytes).expect("a PNG");
        bytes.as_chunks::<4>().0.to_vec()
    }

    #[test]
    fn few_colours_stay_what_they_are() {
        let color = |k: u8| [k, 255 - k, 2 * k, 55 + 2 * k];
        let colors = (0..100).map(|k| if k < 20 { [0; 4] } else { color(k) });
        let pixels: Vec<[u8; 4]> = colors.cycle().take(64 * 32).collect();
        let file = encode(64, 32, &pixels).expect("few colours");
        for (found, was) in decoded(&file).iter().zip(&pixels) {
            assert!(found == was, "{was:?} became {found:?}");
        }
    }

    /// A ball with light on it, whose edge shines through.
    #[test]
    fn many_colours_are_a_little_wrong_and_take_much_less() {
        let side = 200_u16;
        let pixel = |k: u16| {
            let [x, y] = [k % side, k / side].map(|x| f64::from(x) / 100.0 - 1.0);
            let radius = libm::hypot(x, y);
            let light = 128.0 + 60.0 * x + 60.0 * y;
            let color = [light, 0.5 * light, 255.0 - light, 600.0 * (1.0 - radius)];
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "clamped"
            )]
            let pixel = color.map(|x| x.clamp(0.0, 255.0) as u8);
            if pixel[3] == 0 { [0; 4] } else { pixel }
        };
        let pixels: Vec<[u8; 4]> = (0..side * side).map(pixel).collect();
        let side = usize::from(side);
        let file = encode(side, side, &pixels).expect("smooth colours");
        assert_eq!(encode(side, side, &pixels).as_ref(), Some(&file));
        let whole = png::encode(side, side, 4, &pixels.concat()).len();
        assert!(3 * file.len() < 2 * whole, "{} of {whole}", file.len());
        // As it is seen on black.
        let seen = |pixel: &[u8; 4], axis: usize| {
            let alpha = f64::from(pixel[3]);
            f64::from(pixel[axis]) * if axis == 3 { 1.0 } else { alpha / 255.0 }
        };
        let mut worst = 0.0_f64;
        for (found, was) in decoded(&file).iter().zip(&pixels) {
            for axis in 0..4 {
                worst = worst.max((seen(found, axis) - seen(was, axis)).abs());
            }
        }
        assert!(worst < 25.0, "{worst}");
    }

    /// Each pixel has a colour of its own, from all corners of the space.
    #[test]
    fn what_needs_more_colours_gets_no_palette() {
        let pixels: Vec<[u8; 4]> = (0..150 * 100_u32)
            .map(|k| {
                let [a, b, c, _] = k.wrapping_mul(0x9E37_79B1).to_le_bytes();
                [a, b, c, 255]
            })
            .collect();
        assert_eq!(encode(150, 100, &pixels), None);
    }
}

//! A picture as a PNG.

use super::look::Picture;
use crate::image::png::{self, Rows};
use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, Sender, channel};
use urdf2fmu_core::parallel;

/// The content of a PNG file; without alpha where nothing shines through.
pub fn encode(picture: &Picture) -> Vec<u8> {
    let channels = channels(picture);
    let raw = raw(&picture.pixels, channels);
    png::encode(picture.width, picture.height, channels, &raw)
}

/// Numbers of a pixel that are written.
fn channels(picture: &Picture) -> usize {
    let opaque = picture.pixels.iter().all(|pixel| pixel[3] == 255);
    if opaque { 3 } else { 4 }
}

fn raw(pixels: &[[u8; 4]], channels: usize) -> Vec<u8> {
    let numbers = pixels.iter().flat_map(|pixel| &pixel[..channels]);
    numbers.copied().collect()
}

/// Some rows of a picture that are done: their place among all such pieces, and their numbers.
type Piece = (usize, Vec<u8>);

/// Takes pieces of a picture.
pub(super) struct Writer {
    channels: usize,
    send: Sender<Piece>,
}

impl Writer {
    /// Takes the piece of this number.
    pub(super) fn take(&self, piece: usize, pixels: &[[u8; 4]]) {
        // Whoever compresses them waits for all of them, or was stopped by a panic that is told.
        _ = self.send.send((piece, raw(pixels, self.channels)));
    }
}

/// What [`encode`] gives, compressed while the picture is still drawn.
///
/// - `clear`: whether something is likely to shine through; if not, all is compressed again
/// - `draw`: gives each piece of the picture to the writer
pub(super) fn while_drawn(
    width: usize,
    clear: bool,
    draw: impl FnOnce(Writer) -> Picture,
) -> Vec<u8> {
    let likely = if clear { 4 } else { 3 };
    let (send, pieces) = channel();
    let writer = Writer {
        channels: likely,
        send,
    };
    let (data, picture) = parallel::both(
        move || compressed(&pieces, width * likely, likely),
        || draw(writer),
    );
    if channels(&picture) == likely {
        png::of_compressed(width, picture.height, likely, &data)
    } else {
        encode(&picture)
    }
}

/// The pieces in their order, whichever comes first.
fn compressed(pieces: &Receiver<Piece>, row: usize, channels: usize) -> Vec<u8> {
    let mut rows = Rows::new(row, channels);
    let mut waiting = BTreeMap::new();
    let mut next = 0;
    for (piece, raw) in pieces {
        waiting.insert(piece, raw);
        while let Some(raw) = waiting.remove(&next) {
            rows.push(&raw);
            next += 1;
        }
    }
    rows.end()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether the pieces come in order or not, and whether something shines through or not.
    #[test]
    fn a_picture_in_pieces_gives_the_bytes_of_the_whole() {
        for alpha in [255, 130] {
            let pixel = |k: u32| [k * k % 251, k * 7 % 256, k / 300 % 256, alpha];
            let pixels = (0..300 * 200).map(|k| pixel(k).map(|x| u8::try_from(x).unwrap_or(0)));
            let picture = Picture {
                width: 300,
                height: 200,
                pixels: pixels.collect(),
            };
            let whole = encode(&picture);
            for (clear, order) in [(false, [0, 1, 2, 3]), (true, [3, 1, 0, 2])] {
                let bytes = while_drawn(300, clear, |writer| {
                    for piece in order {
                        let rows = &picture.pixels[piece * 15_000..(piece + 1) * 15_000];
                        writer.take(piece, rows);
                    }
                    picture.clone()
                });
                assert!(bytes == whole, "{alpha} {clear}");
            }
        }
    }
}

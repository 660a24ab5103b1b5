//! A texture: a PNG, or where the first byte is odd a JPEG.

#[path = "../../../build/drawing/src/image/png.rs"]
mod png;
#[path = "../../../build/drawing/src/image/read.rs"]
mod read;

pub fn image(data: &[u8]) {
    let Some((&first, bytes)) = data.split_first() else {
        return;
    };
    let kind = ["image/png", "image/jpeg"][usize::from(first % 2)];
    if let Some(pixels) = read::read(kind, bytes) {
        assert_eq!(pixels.bytes.len(), 3 * pixels.width * pixels.height);
    }
}

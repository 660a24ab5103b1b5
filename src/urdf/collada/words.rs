//! Numbers between blanks, many megabytes of them: read in pieces on all cores, because one mesh is
//! often larger than all others of a robot.

use crate::parallel;

/// Bytes of a piece; where it is cut depends on the text alone.
const PIECE: usize = 1 << 20;

/// An index that cannot be used: no whole number, or beyond all that a file can have.
pub(super) const NO_INDEX: u32 = u32::MAX;

/// The whole numbers of a text, in pieces that follow each other: one list of them all would have
/// to be written to memory once more.
pub(super) fn indices(text: &str) -> Vec<Vec<u32>> {
    parallel::map(&pieces(text), |piece| indices_of(piece))
}

/// The numbers of a text, or the first word that is none.
pub(super) fn floats(text: &str) -> Result<Vec<f64>, &str> {
    let found = parallel::map(&pieces(text), |piece| floats_of(piece));
    Ok(found.into_iter().collect::<Result<Vec<_>, _>>()?.concat())
}

fn floats_of(text: &str) -> Result<Vec<f64>, &str> {
    let words = text.split_ascii_whitespace();
    words.map(|word| word.parse().map_err(|_| word)).collect()
}

/// Cuts a text at blanks.
fn pieces(text: &str) -> Vec<&str> {
    let mut list = Vec::with_capacity(text.len() / PIECE + 1);
    let mut rest = text;
    while let Some(behind) = rest.as_bytes().get(PIECE..) {
        let Some(blank) = behind.iter().position(u8::is_ascii_whitespace) else {
            break;
        };
        let (piece, next) = rest.split_at(PIECE + blank);
        list.push(piece);
        rest = next;
    }
    list.push(rest);
    list
}

/// As `str::parse` reads each word, at a fifth of its time.
fn indices_of(text: &str) -> Vec<u32> {
    // An index and its blank have three bytes or more in all but the smallest files.
    let mut list = Vec::with_capacity(text.len() / 3);
    let (mut value, mut digits, mut sign) = (0_u64, 0_u32, false);
    let mut wrong = false;
    for byte in text.bytes().chain([b' ']) {
        match byte {
            b'0'..=b'9' => {
                value = (value * 10 + u64::from(byte - b'0')).min(u64::from(NO_INDEX));
                digits += 1;
            }
            _ if byte.is_ascii_whitespace() => {
                if wrong || sign && digits == 0 {
                    list.push(NO_INDEX);
                } else if digits > 0 {
                    list.push(u32::try_from(value).unwrap_or(NO_INDEX));
                }
                (value, digits, sign, wrong) = (0, 0, false, false);
            }
            b'+' if digits == 0 && !sign => sign = true,
            _ => wrong = true,
        }
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_are_read_as_the_standard_library_reads_them() {
        let text =
            " 0 1\t22\n+7 -1 +-3 ++4 5. x 4294967294 4294967295 99999999999999999999999 + 08 ä\r8";
        let expected = text.split_ascii_whitespace();
        let expected = expected.map(|word| word.parse().unwrap_or(NO_INDEX));
        assert_eq!(indices(text).concat(), expected.collect::<Vec<u32>>());
        assert!(indices("").concat().is_empty());
    }

    #[test]
    fn pieces_give_what_the_whole_gives() {
        let numbers: Vec<u32> = (0..600_000).collect();
        let words: Vec<String> = numbers.iter().map(u32::to_string).collect();
        let text = words.join(" ");
        assert!(pieces(&text).len() > 3);
        assert_eq!(indices(&text).concat(), numbers);
        let expected: Vec<f64> = numbers.iter().copied().map(f64::from).collect();
        assert_eq!(floats(&text), Ok(expected));
        let wrong = format!("{text} a {text} b");
        assert_eq!(floats(&wrong), Err("a"));
    }
}

//! The page that shows a robot in motion, as one HTML file.
//!
//! In: a scene, and a run for a report; without one the page asks the program that served it, or
//! shows the robot's start in an FMU's documentation. The page itself is `build/page`, made of its
//! sources by `build/page/build.mjs`. Everything that comes from a robot is data in base64, and the
//! page runs no script but its own two, whose hashes stand in its content security policy.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD as BASE64;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use serde_json::{Value, json};
use std::io::Write as _;

/// The page with places for its contents.
const SHELL: &str = include_str!("../page/dist/page.html");

/// The page's code, deflated by the build script.
const CODE: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/page.deflate"));

/// The page.
///
/// - `title`: any text
/// - `scene`: content of `scene.bin`
/// - `run`: what [`crate::report`] makes of a table; none for a live view
/// - `connect`: what the page may connect to, in the words of a content security policy
pub fn html(title: &str, scene: &[u8], run: Option<&[u8]>, connect: &str) -> String {
    let parts = [
        ("@CONNECT@", connect.to_owned()),
        ("@TITLE@", escaped(title)),
        ("@SCENE@", BASE64.encode(deflate(scene))),
        (
            "@RUN@",
            run.map_or(String::new(), |run| BASE64.encode(deflate(run))),
        ),
        ("@CODE@", BASE64.encode(CODE)),
    ];
    let mut html =
        String::with_capacity(SHELL.len() + parts.iter().map(|p| p.1.len()).sum::<usize>());
    let mut rest = SHELL;
    // The shell has its places in this order, and what is filled in is not looked at again.
    for (place, content) in &parts {
        if let Some((before, after)) = rest.split_once(place) {
            html.push_str(before);
            html.push_str(content);
            rest = after;
        }
    }
    html + rest
}

/// The page of a robot that stands as it starts, without a run, plots and tables.
///
/// - `title`: any text
/// - `scene`: content of `scene.bin`
pub fn still(title: &str, scene: &[u8]) -> String {
    let time = json!({ "name": "time", "low": 0, "step": 0, "planes": 0, "order": 1 });
    let run = container(
        &json!({
            "format": 1,
            "rows": 1,
            "columns": [time],
            "notes": [],
            "changed": {},
            "still": true,
        }),
        &[],
    );
    html(title, scene, Some(&run), "'none'")
}

/// A head of JSON and a binary body, as the page reads them.
pub fn container(head: &Value, body: &[u8]) -> Vec<u8> {
    let mut text = head.to_string().into_bytes();
    while !text.len().is_multiple_of(4) {
        text.push(b' ');
    }
    let length = u32::try_from(text.len()).unwrap_or(u32::MAX);
    [&length.to_le_bytes(), text.as_slice(), body].concat()
}

/// Raw deflate, which browsers decode themselves.
pub fn deflate(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
    // Writing to memory does not fail.
    _ = encoder.write_all(bytes);
    encoder.finish().unwrap_or_default()
}

/// Text of an element.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            _ => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use sha2::{Digest, Sha256};

    #[test]
    fn the_policy_holds_the_hashes_of_the_two_scripts() {
        let boot = SHELL.rsplit_once("<script>").map(|(_, rest)| rest);
        let boot = boot
            .and_then(|rest| rest.split_once("</script>"))
            .expect("a script")
            .0;
        for script in [boot, include_str!("../page/dist/page.js")] {
            let hash = BASE64.encode(Sha256::digest(script.as_bytes()));
            assert!(SHELL.contains(&format!("'sha256-{hash}'")), "{hash}");
        }
    }

    #[test]
    fn a_page_without_a_robot_is_small() {
        // What the design allows; a fifth of it is the picture of a robot.
        let bytes = html("", b"", None, "'none'").len();
        assert!(bytes <= 270_000, "{bytes}");
    }

    #[test]
    fn a_title_is_text_and_places_are_filled_once() {
        let page = html("<script>@CODE@\"'&", b"@RUN@", None, "'none'");
        assert!(page.contains("<title>&lt;script&gt;@CODE@&quot;&#39;&amp;</title>"));
        assert!(!page.contains("@SCENE@") && page.contains("connect-src 'none'"));
    }
}

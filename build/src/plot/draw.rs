//! Writes the picture.
//!
//! Colours are those of the page of reports. They follow the reader's choice of light or dark where
//! the viewer knows it; the background is part of the picture, so that it can be read anywhere.

use super::axis::Axis;
use super::curve::{Curve, Plot};
use super::panels::{CURVES, Panel, groups, panels};
use std::fmt::Write as _;

/// Panels, at most: a picture of more is not looked at.
const PANELS: usize = 40;

// Lengths in pixels.
const WIDTH: f64 = 960.0;
const LEFT: f64 = 72.0;
const PLOT_WIDTH: f64 = 640.0;
const LEGEND: f64 = LEFT + PLOT_WIDTH + 24.0;
const TOP: f64 = 64.0;
const HEADER: f64 = 26.0;
const PLOT_HEIGHT: f64 = 152.0;
const PANEL: f64 = HEADER + PLOT_HEIGHT + 44.0;
const LINE: f64 = 19.0;

/// Letters of a name in the legend.
const LETTERS: usize = 25;

/// Letters of the title of a panel, whose letters are 14/12 as wide as those of the legend, and of
/// the whole, 20/12: `a_title_that_is_wider_than_the_picture_is_shortened_and_written_beside_it`.
const TITLES: [usize; 2] = [86, 64];

/// Colours of text, lines and curves, light and dark: those of `build/page/src`.
const LOOK: [[&str; 6]; 2] = [
    [
        "#ffffff", "#f7f8fa", "#dde2e9", "#7d8896", "#1c2430", "#56616f",
    ],
    [
        "#16191f", "#1b1f26", "#2c323c", "#707b8c", "#e3e8ef", "#9ba6b6",
    ],
];
const COLORS: [[&str; CURVES]; 2] = [
    [
        "#0a62c4", "#b34d08", "#0f7553", "#7a3fc4", "#806000", "#c3265b", "#0b6e80", "#4a5565",
    ],
    [
        "#58a6ff", "#f0883e", "#56d39b", "#d2a8ff", "#f2cc60", "#ff7b9c", "#76e3ea", "#b9c4d0",
    ],
];

/// Draws curves over time, in the order given.
///
/// - `title`: of the whole; `time`: s, never decreasing
pub fn svg(title: &str, time: &[f64], curves: &[Curve]) -> Plot {
    let groups = groups(curves);
    let all: Vec<Panel> = groups.iter().flat_map(|group| panels(group)).collect();
    let (drawn, left_out) = all.split_at(all.len().min(PANELS));
    let missing: usize = left_out.iter().map(|panel| panel.curves.len()).sum();
    let across = Axis::along(time, 8.0);
    #[expect(clippy::cast_precision_loss, reason = "at most 40")]
    let height = TOP + PANEL * drawn.len() as f64 + 8.0;
    let name = escaped(title);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" \
         viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"{name}, over time\">\n\
         <title>{name}, over time</title>\n{style}\
         <rect class=\"back\" width=\"{WIDTH}\" height=\"{height}\" rx=\"8\"/>\n\
         <text class=\"name\" x=\"{LEFT}\" y=\"36\">{}</text>\n",
        escaped(&shortened(title, TITLES[1])),
        style = style()
    );
    let mut top = TOP;
    for panel in drawn {
        draw(&mut out, panel, time, &across, top);
        top += PANEL;
    }
    out.push_str("</svg>\n");
    Plot {
        svg: out,
        note: (missing > 0).then(|| {
            format!(
                "The plot shows {} of {} variables; choose with --output-variable.",
                curves.len() - missing,
                curves.len()
            )
        }),
    }
}

fn style() -> String {
    let look = |theme: usize| {
        let [back, field, grid, edge, text, dim] = LOOK[theme];
        let mut css = format!(
            ".back{{fill:{back}}}.field{{fill:{field}}}.grid{{stroke:{grid}}}.zero{{stroke:{edge}}}\
             text{{fill:{text}}}.dim{{fill:{dim}}}"
        );
        for (i, color) in COLORS[theme].iter().enumerate() {
            _ = write!(css, ".c{i}{{stroke:{color}}}");
        }
        css
    };
    format!(
        "<style>text{{font:12px system-ui,-apple-system,'Segoe UI','Noto Sans','Noto Sans CJK JP',\
         sans-serif}}.name{{font-size:20px;font-weight:600}}.title{{font-size:14px;\
         font-weight:600}}.number{{font-variant-numeric:tabular-nums}}path{{fill:none;\
         stroke-width:1.6;stroke-linejoin:round;stroke-linecap:round}}.grid,.zero{{stroke-width:1}}\
         .end{{text-anchor:end}}.middle{{text-anchor:middle}}\n{}\n\
         @media (prefers-color-scheme:dark){{{}}}</style>\n",
        look(0),
        look(1)
    )
}

/// One panel: header, grid, curves, legend.
fn draw(out: &mut String, panel: &Panel, time: &[f64], across: &Axis, top: f64) {
    let values = panel.curves.iter().flat_map(|curve| curve.values);
    let up = Axis::around(values.copied(), 5.0);
    let (upper, lower) = (top + HEADER, top + HEADER + PLOT_HEIGHT);
    let x_of = |t: f64| LEFT + PLOT_WIDTH * across.place(t);
    let y_of = |value: f64| lower - PLOT_HEIGHT * up.place(value);
    let times_ten = match up.power {
        0 => String::new(),
        power => format!("10{} ", raised(power)),
    };
    let title = shortened(&panel.title, TITLES[0]);
    _ = writeln!(
        out,
        "<text x=\"{LEFT}\" y=\"{}\"><tspan class=\"title\">{}</tspan>\
         <tspan class=\"dim\" dx=\"10\">{times_ten}{}</tspan></text>\n\
         <rect class=\"field\" x=\"{LEFT}\" y=\"{upper}\" width=\"{PLOT_WIDTH}\" \
         height=\"{PLOT_HEIGHT}\"/>",
        top + 16.0,
        escaped(&title),
        escaped(&unit(panel.unit))
    );
    for (value, text) in &up.ticks {
        let y = y_of(*value);
        let class = if *value == 0.0 { "zero" } else { "grid" };
        _ = writeln!(
            out,
            "<path class=\"{class}\" d=\"M{LEFT} {}h{PLOT_WIDTH}\"/>\
             <text class=\"dim number end\" x=\"{}\" y=\"{}\">{text}</text>",
            place(y),
            LEFT - 8.0,
            place(y + 4.0)
        );
    }
    for (t, text) in &across.ticks {
        let x = x_of(*t);
        _ = writeln!(
            out,
            "<path class=\"grid\" d=\"M{} {upper}v{PLOT_HEIGHT}\"/>\
             <text class=\"dim number middle\" x=\"{}\" y=\"{}\">{text}</text>",
            place(x),
            place(x),
            lower + 17.0
        );
    }
    let seconds = match across.power {
        0 => "s".to_owned(),
        power => format!("10{} s", raised(power)),
    };
    _ = writeln!(
        out,
        "<text class=\"dim\" x=\"{}\" y=\"{}\">{seconds}</text>",
        LEFT + PLOT_WIDTH + 14.0,
        lower + 17.0
    );
    let mut y = upper + 12.0;
    for ((i, curve), name) in panel.curves.iter().enumerate().zip(&panel.names) {
        let path = path(time, curve, x_of, y_of);
        _ = writeln!(
            out,
            "<path class=\"c{i}\" d=\"{path}\"><title>{}</title></path>",
            escaped(curve.name)
        );
        // The title of a single curve may be its name, where that is not too long.
        if title == curve.name {
            y += LINE;
        } else {
            _ = writeln!(
                out,
                "<path class=\"c{i}\" style=\"stroke-width:3\" d=\"M{LEGEND} {}h14\"/>",
                y - 4.0
            );
            for line in lines(name, CURVES / panel.curves.len()) {
                _ = writeln!(
                    out,
                    "<text x=\"{}\" y=\"{y}\">{}<title>{}</title></text>",
                    LEGEND + 22.0,
                    escaped(&line),
                    escaped(curve.name)
                );
                y += LINE;
            }
        }
    }
}

/// A curve: of each pixel's width its first, least, greatest and last value, which is all that can
/// be seen.
fn path(
    time: &[f64],
    curve: &Curve,
    x_of: impl Fn(f64) -> f64,
    y_of: impl Fn(f64) -> f64,
) -> String {
    let mut out = String::new();
    let values = curve.values;
    let mut row = 0;
    while row < values.len().min(time.len()) {
        let rest = values[row..].iter().zip(&time[row..]);
        let length = rest.take_while(|(value, _)| value.is_finite()).count();
        let rows = thinned(row, row + length, |i| x_of(time[i]), values);
        let points: Vec<(String, String)> = rows
            .into_iter()
            .map(|i| (place(x_of(time[i])), place(y_of(values[i]))))
            .collect();
        for (i, (x, y)) in points.iter().enumerate() {
            let level = |other: Option<&(String, String)>| other.is_some_and(|(_, o)| o == y);
            if i == 0 {
                // Without a length, a single value would not be seen.
                _ = write!(out, "M{x} {y}h0");
                continue;
            }
            // Within a level line only its ends count.
            if level(points.get(i - 1)) && level(points.get(i + 1)) {
                continue;
            }
            if curve.stepped {
                _ = write!(out, "H{x}V{y}");
            } else {
                _ = write!(out, "L{x} {y}");
            }
        }
        row += length.max(1);
    }
    out
}

/// Rows that can be seen of those from `from` to `to`.
fn thinned(from: usize, to: usize, x_of: impl Fn(usize) -> f64, values: &[f64]) -> Vec<usize> {
    let mut kept = Vec::new();
    let mut first = from;
    while first < to {
        let pixel = x_of(first).floor();
        let (mut low, mut high, mut last) = (first, first, first);
        while last + 1 < to && x_of(last + 1) < pixel + 1.0 {
            last += 1;
            if values[last] < values[low] {
                low = last;
            }
            if values[last] > values[high] {
                high = last;
            }
        }
        let mut shown = [first, low, high, last];
        shown.sort_unstable();
        kept.extend(shown);
        first = last + 1;
    }
    kept.dedup();
    kept
}

/// A tenth of a pixel, without a zero behind it.
fn place(x: f64) -> String {
    let text = format!("{x:.1}");
    text.strip_suffix(".0").map(str::to_owned).unwrap_or(text)
}

/// `m/s²` for FMI's `m/s2`, `N·m` for `N.m`; no unit for plain numbers.
fn unit(name: &str) -> String {
    if name == "1" {
        return String::new();
    }
    name.replace('.', "·").replace('2', "²").replace('3', "³")
}

/// Digits as an exponent.
fn raised(power: i32) -> String {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digit = |c: char| c.to_digit(10).map_or('⁻', |d| digits[d as usize]);
    power.to_string().chars().map(digit).collect()
}

/// The columns of a letter: those of Asian scripts are twice as wide.
fn width(c: char) -> usize {
    if u32::from(c) < 0x1100 { 1 } else { 2 }
}

/// A name in lines that fit beside the plot, or in one without its middle where that takes more
/// than `most`.
fn lines(name: &str, most: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    let mut room = LETTERS;
    for c in name.chars() {
        if width(c) > room {
            lines.push(String::new());
            room = LETTERS;
        }
        room -= width(c);
        if let Some(line) = lines.last_mut() {
            line.push(c);
        }
    }
    if lines.len() > most {
        lines = vec![shortened(name, LETTERS)];
    }
    lines
}

/// A name in so many letters: names differ at their beginning or at their end.
fn shortened(name: &str, letters: usize) -> String {
    if name.chars().map(width).sum::<usize>() <= letters {
        return name.to_owned();
    }
    let half = |part: &mut dyn Iterator<Item = char>| -> String {
        let mut room = letters / 2;
        part.take_while(|c| {
            let fits = width(*c) <= room;
            room = room.saturating_sub(width(*c));
            fits
        })
        .collect()
    };
    let front = half(&mut name.chars());
    let back = half(&mut name.chars().rev());
    front + "…" + &back.chars().rev().collect::<String>()
}

/// Text in XML; characters that it cannot hold become `\u{fffd}`.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve<'c>(name: &'c str, values: &'c [f64]) -> Curve<'c> {
        Curve {
            name,
            unit: "m/s2",
            stepped: false,
            values,
        }
    }

    #[test]
    fn a_curve_keeps_its_peaks_and_its_gaps() {
        let time: Vec<f64> = (0..=5000).map(f64::from).collect();
        let mut values = vec![0.0; 5001];
        values[2501] = 1.0;
        values[2502] = -1.0;
        values[4000] = f64::NAN;
        let path = path(&time, &curve("x", &values), |t| t * 0.1, |v| v);
        assert!(path.contains("L250.1 1L250.2 -1"), "{path}");
        assert_eq!(path.matches('M').count(), 2);
        assert!(path.len() < 200, "{path}");
        let noise: Vec<f64> = (0..=5000).map(|i| f64::from(i % 7)).collect();
        let path = super::path(&time, &curve("x", &noise), |t| t * 0.1, |v| v);
        assert!(path.len() < 20_000, "{} bytes", path.len());
    }

    #[test]
    fn names_are_text_and_the_same_values_give_the_same_bytes() {
        let time = [0.0, 1.0];
        let names = ["a.<script>alert(1)</script>", "a.\"'&\u{1b}関節"];
        let curves = names.map(|name| curve(name, &[0.0, 2.0]));
        let svg = || super::svg("<b>\"&", &time, &curves).svg;
        let text = svg();
        assert_eq!(text, svg());
        assert!(!text.contains("<script") && !text.contains("<b>") && !text.contains('\u{1b}'));
        assert!(text.contains("&lt;script&gt;alert(1)&lt;/script&gt;") && text.contains("関節"));
        let mut reader = quick_xml::Reader::from_str(&text);
        while reader.read_event().expect("well-formed XML") != quick_xml::events::Event::Eof {}
    }

    #[test]
    fn no_curve_one_row_and_very_many_curves_are_pictures_too() {
        assert!(svg("r", &[0.0], &[]).svg.ends_with("</svg>\n"));
        let one = svg("r", &[3.0], &[curve("x", &[1.0])]).svg;
        assert!(one.contains("h0\""), "{one}");
        assert!(!one.contains("NaN") && !one.contains("inf"));
        let names: Vec<String> = (0..400).map(|i| format!("a{i}.b")).collect();
        let curves: Vec<Curve> = names.iter().map(|name| curve(name, &[1.0])).collect();
        let note = svg("r", &[0.0], &curves).note.expect("too many");
        assert!(note.contains("40 of 400 variables"), "{note}");
    }

    /// 150 letters are six lines of 25; two curves have room for four lines each.
    #[test]
    fn a_long_name_is_written_whole_where_there_is_room_for_its_lines() {
        let name: String = ('a'..='z').cycle().take(150).collect();
        let whole = lines(&name, CURVES);
        assert_eq!((whole.len(), whole.concat()), (6, name.clone()));
        assert_eq!(lines(&name, 5), [shortened(&name, LETTERS)]);
        assert_eq!(lines("short", 1), ["short"]);
        assert_eq!(
            lines(&"関".repeat(13), 2),
            ["関".repeat(12), "関".to_owned()]
        );
        let parts = ["l", "r"].map(|side| format!("{side}{}", &name[..99]));
        let names = parts
            .each_ref()
            .map(|part| format!("joint.{part}.velocity"));
        let curves = names.each_ref().map(|name| curve(name, &[1.0]));
        let svg = svg("r", &[0.0], &curves).svg;
        for line in parts.iter().flat_map(|part| lines(part, CURVES / 2)) {
            assert!(svg.contains(&format!(">{line}<title>")), "{line}: {svg}");
        }
    }

    /// A letter of the legend has 8.08 px, which is its room over 25; titles have 14 and 20 px in
    /// place of 12, and that of a panel leaves room for its unit.
    #[test]
    fn a_title_that_is_wider_than_the_picture_is_shortened_and_written_beside_it() {
        let letter = (WIDTH - LEGEND - 22.0) / 25.0;
        let fits = |letters: usize, size: f64, room: f64| {
            let letters: f64 = (0..letters).map(|_| letter * size / 12.0).sum();
            LEFT + letters <= WIDTH - room
        };
        assert!(fits(TITLES[0], 14.0, 72.0) && !fits(TITLES[0] + 1, 14.0, 72.0));
        assert!(fits(TITLES[1], 20.0, 16.0) && !fits(TITLES[1] + 1, 20.0, 16.0));
        let name: String = ('a'..='z').cycle().take(150).collect();
        let svg = svg(&name, &[0.0], &[curve(&name, &[1.0])]).svg;
        let title = |letters| format!(">{}</t", shortened(&name, letters));
        assert!(svg.contains(&title(TITLES[0])) && svg.contains(&title(TITLES[1])));
        for line in lines(&name, CURVES) {
            assert!(svg.contains(&format!(">{line}<title>")), "{line}");
        }
    }

    #[test]
    fn long_names_keep_their_beginning_and_their_end() {
        let name = "a_very_long_name_of_a_joint_on_the_left";
        assert_eq!(shortened(name, LETTERS), "a_very_long_…_on_the_left");
        assert_eq!(
            shortened("関節関節関節関節関節関節関節", LETTERS),
            "関節関節関節…関節関節関節"
        );
        assert_eq!(unit("N.m.s2"), "N·m·s²");
        assert_eq!(raised(-12), "⁻¹²");
    }
}

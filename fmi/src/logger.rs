//! Messages to the importer, through its logger callback and nowhere else.
//!
//! In a message `#` is special (`#r12#` names a variable) and is doubled. The callback of FMI 2
//! takes a printf format: `%` is doubled, too, and no arguments follow. Only categories that
//! modelDescription.xml declares are used.
#![allow(unsafe_code, reason = "calls the importer's function")]

use crate::common::{LoggerOfFmi2, LoggerOfFmi3, Status, Version};
use std::ffi::{CStr, CString, c_void};

/// A log category, as declared in modelDescription.xml.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Category {
    /// What happens when: debug logging.
    Events,
    /// The solver's iterations: debug logging.
    NonlinearSystems,
    /// Belongs to `fmi2Warning`.
    StatusWarning,
    /// Belongs to `fmi2Discard`.
    StatusDiscard,
    /// Belongs to `fmi2Error`.
    StatusError,
    /// Belongs to `fmi2Fatal`.
    StatusFatal,
}

impl Category {
    const ALL: [Self; 6] = [
        Self::Events,
        Self::NonlinearSystems,
        Self::StatusWarning,
        Self::StatusDiscard,
        Self::StatusError,
        Self::StatusFatal,
    ];

    fn name(self) -> &'static CStr {
        match self {
            Self::Events => c"logEvents",
            Self::NonlinearSystems => c"logNonlinearSystems",
            Self::StatusWarning => c"logStatusWarning",
            Self::StatusDiscard => c"logStatusDiscard",
            Self::StatusError => c"logStatusError",
            Self::StatusFatal => c"logStatusFatal",
        }
    }

    const fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// Every category; what `logAll` stands for.
const ALL: u8 = 0b11_1111;
/// What is said even while debug logging is off: why something went wrong.
const STATUS: u8 = Category::StatusWarning.bit()
    | Category::StatusDiscard.bit()
    | Category::StatusError.bit()
    | Category::StatusFatal.bit();

/// What FMI 3 does not allow to be switched off.
const ALWAYS: u8 = Category::StatusError.bit() | Category::StatusFatal.bit();

/// The importer's function.
#[derive(Clone, Debug)]
pub(crate) enum Sink {
    /// Null: nothing is heard.
    None,
    /// With the instance's name, which it is told each time.
    Fmi2(LoggerOfFmi2, CString),
    /// Its errors are heard whatever categories are selected.
    Fmi3(LoggerOfFmi3),
}

/// The importer's logger and what it wants to hear.
#[derive(Clone, Debug)]
pub(crate) struct Logger {
    sink: Sink,
    /// Passed back as it came.
    environment: *mut c_void,
    /// Bits of the enabled categories.
    enabled: u8,
}

impl Logger {
    /// Debug categories are on if `logging_on`; the status categories are on either way.
    pub(crate) fn new(sink: Sink, environment: *mut c_void, logging_on: bool) -> Self {
        Self {
            sink,
            environment,
            enabled: if logging_on { ALL } else { STATUS },
        }
    }

    /// What fmi2SetDebugLogging asks for. On: exactly the categories named, or all where none is
    /// named. Off: the categories named, or the debug categories where none is named. Returns the
    /// names that are not declared.
    pub(crate) fn select(&mut self, on: bool, names: &[String]) -> Vec<String> {
        let mut bits = 0;
        let mut unknown = Vec::new();
        for name in names {
            let known = Category::ALL
                .into_iter()
                .find(|category| category.name().to_bytes() == name.as_bytes());
            match known {
                Some(category) => bits |= category.bit(),
                None if name == "logAll" => bits = ALL,
                None => unknown.push(name.clone()),
            }
        }
        if unknown.is_empty() {
            self.enabled = match (on, names.is_empty()) {
                (true, true) => ALL,
                (true, false) => bits,
                (false, true) => STATUS,
                (false, false) => self.enabled & !bits,
            };
        }
        unknown
    }

    /// Whether a message of this category would be heard; spares making it up.
    pub(crate) fn wants(&self, category: Category) -> bool {
        let enabled = match self.sink {
            Sink::None => 0,
            Sink::Fmi2(..) => self.enabled,
            Sink::Fmi3(_) => self.enabled | ALWAYS,
        };
        enabled & category.bit() != 0
    }

    /// Hands over `message` if its category is enabled.
    #[cfg_attr(small, optimize(size))]
    pub(crate) fn log(&self, status: Status, category: Category, message: &str) {
        if !self.wants(category) {
            return;
        }
        let category = category.name().as_ptr();
        match &self.sink {
            Sink::None => {}
            Sink::Fmi2(callback, name) => {
                let message = escaped(message, Version::V2);
                let (name, message) = (name.as_ptr(), message.as_ptr());
                // SAFETY: the importer's function, with the arguments that FMI 2.0 prescribes; all
                // strings end with a zero and live until it returns, the message refers to no
                // variadic argument.
                unsafe { callback(self.environment, name, status, category, message) }
            }
            Sink::Fmi3(callback) => {
                let message = escaped(message, Version::V3);
                // SAFETY: as above, for FMI 3.0.
                unsafe { callback(self.environment, status, category, message.as_ptr()) }
            }
        }
    }
}

/// Bytes of a message that are handed over: many importers print it into 1024 bytes together with
/// the instance's name and the category, and not all of them look whether it fits.
const LONGEST: usize = 900;

/// `message` with its special signs doubled: for FMI 2 as a printf format that prints it. A zero
/// byte would end it and becomes a blank. What is too long ends with `…`.
#[cfg_attr(small, optimize(size))]
fn escaped(message: &str, version: Version) -> CString {
    const END: &str = "…";
    let mut format: Vec<u8> = Vec::with_capacity(message.len().min(LONGEST) + 9);
    // Where the text can be cut so that the end still fits.
    let mut cut = 0;
    for letter in message.chars() {
        match letter {
            '#' => format.extend(b"##"),
            '%' if version == Version::V2 => format.extend(b"%%"),
            '\0' => format.push(b' '),
            _ => format.extend(letter.encode_utf8(&mut [0; 4]).bytes()),
        }
        if format.len() + END.len() <= LONGEST {
            cut = format.len();
        }
        if format.len() > LONGEST {
            format.truncate(cut);
            format.extend(END.bytes());
            break;
        }
    }
    CString::new(format).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn logger(on: bool) -> Logger {
        unsafe extern "C" fn ignore(
            _: *mut c_void,
            _: *const std::ffi::c_char,
            _: Status,
            _: *const std::ffi::c_char,
            _: *const std::ffi::c_char,
        ) {
        }
        // SAFETY: a callee that reads no variadic argument has the same calling convention on every
        // platform that this test runs on; it is never called here.
        let callback =
            unsafe { std::mem::transmute::<*const (), LoggerOfFmi2>(ignore as *const ()) };
        Logger::new(
            Sink::Fmi2(callback, c"robot".into()),
            std::ptr::null_mut(),
            on,
        )
    }

    fn heard(logger: &Logger) -> Vec<&str> {
        Category::ALL
            .into_iter()
            .filter(|category| logger.wants(*category))
            .map(|category| category.name().to_str().expect("ASCII"))
            .collect()
    }

    #[test]
    fn percent_and_hash_are_doubled_and_a_nul_does_not_cut_the_message() {
        assert_eq!(
            escaped("100 %s #r1#\0end", Version::V2).as_bytes(),
            b"100 %%s ##r1## end"
        );
        assert_eq!(
            escaped("100 %s #r1#\0end", Version::V3).as_bytes(),
            b"100 %s ##r1## end"
        );
    }

    #[test]
    fn a_long_message_is_cut_between_letters_and_says_so() {
        assert_eq!(escaped(&"a".repeat(900), Version::V2).as_bytes().len(), 900);
        let cut = escaped(&"%".repeat(2000), Version::V2);
        assert_eq!(cut.as_bytes().len(), 899);
        assert!(cut.to_str().is_ok_and(|text| text.ends_with("%%…")));
        let cut = escaped(&"ω".repeat(2000), Version::V2);
        let text = cut.to_str().expect("whole letters");
        assert!(text.len() <= 900 && text.ends_with("ω…"), "{}", text.len());
    }

    #[test]
    fn errors_are_logged_while_debug_logging_is_off() {
        let status = [
            "logStatusWarning",
            "logStatusDiscard",
            "logStatusError",
            "logStatusFatal",
        ];
        assert_eq!(heard(&logger(false)), status);
        let mut logger = logger(true);
        assert_eq!(heard(&logger).len(), 6);
        logger.select(false, &[]);
        assert_eq!(heard(&logger), status);
    }

    #[test]
    fn only_the_selected_categories_are_logged() {
        let mut logger = logger(false);
        assert!(logger.select(true, &["logEvents".into()]).is_empty());
        assert_eq!(heard(&logger), ["logEvents"]);
        assert!(logger.select(true, &["logAll".into()]).is_empty());
        assert_eq!(heard(&logger).len(), 6);
        assert!(logger.select(false, &["logStatusError".into()]).is_empty());
        assert!(!logger.wants(Category::StatusError) && logger.wants(Category::Events));
    }

    #[test]
    fn errors_of_fmi_3_cannot_be_switched_off() {
        unsafe extern "C" fn ignore(
            _: *mut c_void,
            _: Status,
            _: *const std::ffi::c_char,
            _: *const std::ffi::c_char,
        ) {
        }
        let mut logger = Logger::new(Sink::Fmi3(ignore), std::ptr::null_mut(), false);
        assert!(logger.select(true, &["logEvents".into()]).is_empty());
        assert_eq!(
            heard(&logger),
            ["logEvents", "logStatusError", "logStatusFatal"]
        );
    }

    #[test]
    fn an_unknown_category_is_returned_and_nothing_changes() {
        let mut logger = logger(false);
        let before = logger.enabled;
        let names = ["logEvents".to_owned(), "logWeather".to_owned()];
        assert_eq!(logger.select(true, &names), ["logWeather"]);
        assert_eq!(logger.enabled, before);
    }

    #[test]
    fn without_a_logger_no_message_is_made() {
        let logger = Logger::new(Sink::None, std::ptr::null_mut(), true);
        assert!(!logger.wants(Category::StatusError));
        logger.log(Status::Error, Category::StatusError, "unheard");
    }
}
